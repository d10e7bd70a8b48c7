"""The report of a measured shape: verdict, statistics, alignment with its errors, call-outs and figures."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.arrays import Floats
from punchform.export.compare import COMPARISON, POINTS
from punchform.report.figures.files import save
from punchform.report.figures.measured import (
    draw_call_outs,
    draw_deviation_map,
    draw_histogram,
    draw_prediction_map,
)
from punchform.report.figures.picture import Picture
from punchform.report.page import FIGURES, PAGE, render
from punchform.report.section import Rows
from punchform.report.words import percent, size

if TYPE_CHECKING:
    from punchform.measured import Comparison, Deviation

SIGNS = "positive above the surface, on the side away from the punch"


def write_comparison_report(done: Comparison, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    html = render(
        done.case,
        subtitle=f"A measured shape against what was wanted and what was predicted: {Path(done.cloud.source).name}",
        good=done.within is not False,
        verdict=sentences(done),
        results=(
            *((("Deviation from the target", _statistics_rows(done.target)),) if done.target else ()),
            (f"Deviation from the predicted shape ({done.stage})", _statistics_rows(done.prediction)),
        ),
        details_title="Alignment, shape and call-outs",
        details=(
            ("Alignment", _alignment_rows(done)),
            ("Is it the predicted shape?", _shape_rows(done)),
            ("Points", _point_rows(done)),
            ("Call-outs: x, y, z; dx, dy, dz; deviation [mm]", _call_out_rows(done)),
        ),
        images=_draw(done, folder / FIGURES),
        notes=done.notes,
        beside=f"{COMPARISON}, {POINTS} (aligned points with deviations and flags)",
    )
    (folder / PAGE).write_text(html, encoding="utf-8", newline="\n")


def sentences(done: Comparison) -> tuple[str, ...]:
    """What a person wants to hear first, without HTML."""
    table = done.judged.table
    assert table is not None
    surface = "predicted shape" if done.target is None else "target"
    rms = size(table.rms, "mm", 3)
    if done.within is None or table.tolerance is None or table.in_tol is None:
        first = f"The measured points lie {rms} rms from the {surface}; there is no tolerance to judge them by."
    else:
        limit, word = size(table.tolerance, "mm", 3), "Within" if done.within else "Out of"
        first = (
            f"{word} tolerance: the measured points lie {rms} rms from the {surface}, {limit} are allowed; "
            f"{percent(table.in_tol)} of them lie within ±{limit}."
        )
    return first, f"Is it the predicted shape? {done.shape.verdict[:1].upper()}{done.shape.verdict[1:]}."


def alignment_words(done: Comparison) -> str:
    """How the cloud was aligned."""
    match done.alignment.kind:
        case "as-given":
            return "as given: the points are taken in the axes of the run"
        case "rim":
            return "rim datum, 3-2-1"
        case _:
            return f"best fit to the {done.alignment.to}"


def motion_words(values: Floats, errors: Floats, unit: str) -> str:
    """Three components with their standard errors.

    >>> motion_words(np.array([3.0, -0.25, 0.0]), np.array([0.01, 0.02, np.inf]), "mm").replace(chr(0xA0), " ")
    '3.000 ± 0.010, −0.250 ± 0.020, 0 (not determined) mm'
    """
    parts = []
    for value, error in zip(values, errors, strict=True):
        if not math.isfinite(error):
            parts.append(f"{value:.4g} (not determined)")
            continue
        digits = int(np.clip(1 - math.floor(math.log10(error)), 0, 9)) if error > 0 else 6
        parts.append(f"{value:.{digits}f} ± {error:.{digits}f}")
    return f"{', '.join(parts)}{chr(0xA0)}{unit}".replace("-", "−")


PREDICTION_MAP = (
    "prediction_map",
    "Deviation from the predicted shape",
    "The same points against the shape that was predicted, on a scale of their own: noise where the prediction is "
    "right, a pattern where the part differs from it.",
    draw_prediction_map,
    False,
)


def _draw(done: Comparison, folder: Path) -> tuple[tuple[Picture, Path], ...]:
    folder.mkdir(parents=True, exist_ok=True)
    surface = "predicted shape" if done.target is None else "target"
    band = "" if done.tolerance is None else " Green is within the tolerance."
    drawn = []
    # Without a target the first map is that of the prediction already.
    second = () if done.target is None else (PREDICTION_MAP,)
    for name, title, caption, draw, wide in (
        (
            "deviation_map",
            f"Deviation from the {surface}",
            f"Plan view of the aligned points; colour is the signed distance along the normal, {SIGNS}.{band} Outliers "
            "are ringed; pale points are not over the part that counts. Two points in a hundred may lie beyond the "
            "ends of the scale.",
            draw_deviation_map,
            False,
        ),
        (
            "deviation_histogram",
            "How the deviations are spread",
            "Share of the points by their deviation; dashed lines are the tolerance, the full line is the average.",
            draw_histogram,
            False,
        ),
        *second,
        (
            "call_outs",
            "Call-outs",
            "Some of the worst points, well apart, and others spread evenly; the table below has their coordinates.",
            draw_call_outs,
            True,
        ),
    ):
        picture = Picture(name, title, caption, _of(draw, done), wide)
        path = folder / f"{name}.png"
        save(draw(done), path)
        drawn.append((picture, path))
    return tuple(drawn)


def _of(draw: Callable[[Comparison], Figure], done: Comparison) -> Callable[[object], Figure]:
    return lambda run: draw(done)


def _statistics_rows(deviation: Deviation) -> Rows:
    table = deviation.table
    if table is None:
        return (("Points", "none lie on it"),)
    rows: Rows = (
        ("Min", size(table.minimum, "mm")),
        ("Max", size(table.maximum, "mm")),
        ("Average", size(table.average, "mm")),
        ("RMS", size(table.rms, "mm")),
        ("Std dev", size(table.std, "mm")),
        ("Var", size(table.var, "mm²")),
        ("+Avg", size(table.plus_avg, "mm")),
        ("−Avg", size(table.minus_avg, "mm")),
    )
    shares = (table.in_tol, table.out_tol, table.over_tol, table.under_tol)
    names = ("In Tol", "Out Tol", "Over Tol", "Under Tol")
    if table.tolerance is not None:
        rows += (("Tolerance", f"±{size(table.tolerance, 'mm')}"),)
    rows += tuple((name, percent(share)) for name, share in zip(names, shares, strict=True) if share is not None)
    return (*rows, ("N", f"{table.n}"))


def _alignment_rows(done: Comparison) -> Rows:
    alignment = done.alignment
    fit, pose = alignment.fit, alignment.pose
    if alignment.kind == "as-given":
        return (("Kind", alignment_words(done)),)
    tilt = math.degrees(pose.tilt)
    return (
        ("Kind", alignment_words(done)),
        ("Points used", f"{int(fit.used.sum())}"),
        ("Middle of the rim plane, as measured: x, y, z", motion_words(pose.shift, fit.errors[:3], "mm")),
        ("Turn about x, y, z", motion_words(np.degrees(pose.rotation_vector), np.degrees(fit.errors[3:]), "°")),
        ("Tilt of the axis", f"{size(tilt, '°')}" + (" (upside down)" if tilt > 90 else "")),
        ("Scatter of the residuals", size(fit.scatter, "mm")),
        ("Condition of the fit", size(fit.condition, "", 3)),
        ("±", "standard errors, as if the residuals were independent"),
    )


def _shape_rows(done: Comparison) -> Rows:
    shape, sheet = done.shape, done.sheet
    rows: Rows = (("Measured − predicted, rms", size(shape.left, "mm")),)
    if shape.expected is not None and shape.found is not None:
        rows += (
            ("Predicted − target, rms", size(shape.expected, "mm")),
            ("Measured − target, rms", size(shape.found, "mm")),
            ("Correlation of the two", "not known" if shape.correlation is None else size(shape.correlation, "", 4)),
        )
    return (
        *rows,
        ("Points, in the best fit to the prediction", f"{shape.n}"),
        ("Flat cells would lie off the predicted surface by, rms", size(sheet.facet_error[0], "mm", 2)),
        ("Closure of that surface at its own nodes, rms", size(sheet.own_error[0], "mm", 2)),
    )


def _point_rows(done: Comparison) -> Rows:
    cloud = done.cloud
    return (
        ("File", Path(cloud.source).name),
        ("Points read", f"{len(cloud.points)}"),
        ("Unit", cloud.unit + (" (stated)" if cloud.stated else " (by size)")),
        ("Bad rows left out", f"{cloud.skipped}"),
        ("Outliers", f"{int(done.outliers.sum())}"),
        ("Left out of fit and statistics", f"{int((~done.counted).sum())}"),
    )


def _call_out_rows(done: Comparison) -> Rows:
    judged = done.judged

    def numbers(values: Floats, form: str) -> str:
        return ", ".join(f"{value:{form}}" for value in values).replace("-", "−")

    return tuple(
        (
            done.cloud.names[row],
            f"{numbers(done.aligned[row], '.2f')}; {numbers(judged.vector[row], '+.3f')}; "
            f"{judged.value[row]:+.3f}".replace("-", "−"),
        )
        for row in done.labelled
    )
