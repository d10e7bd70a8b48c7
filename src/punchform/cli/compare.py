"""`punchform compare`: a measured shape against the target and the prediction of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np

from punchform.case import Case, read_case
from punchform.cli.exits import Exit
from punchform.cli.lengths import length_above_zero
from punchform.cli.talk import notes
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.compare import COMPARISON, POINTS, comparison_json, mark_json, points_csv
from punchform.measured import Comparison, Predicted, Wish, compare, read_cloud
from punchform.report.compare import alignment_words, motion_words, write_comparison_report
from punchform.report.words import size
from punchform.store import CASE, RESULT, check_folder, keep_apart, read_run, write_folder
from punchform.units import ANGLE, UnitError, quantity


def compare_points(
    run: str,
    points: str,
    output: str,
    *,
    units: str | None,
    align: Literal["best-fit", "rim", "as-given"],
    fit_to: Literal["nodes", "target", "prediction"] | None,
    rim_points: str | None,
    clock: str | None,
    tolerance: str | None,
    skip_bad_rows: bool,
    drop_outliers: bool,
    overwrite: bool,
    voice: Voice,
    as_json: bool,
) -> Exit:
    """Compare a cloud with a run and write the folder of the comparison.

    Raises InputError for a run, cloud, folder or quantity that cannot be used, and for an alignment that these
    points do not allow.
    """
    keep_apart(output, run, points)
    check_folder(output, overwrite=overwrite)
    _fits_alignment(align, fit_to=fit_to, rim_points=rim_points, clock=clock)
    wish = Wish(align, fit_to, rim_points, _clock(clock), drop_outliers)
    limit = length_above_zero("--tolerance", tolerance, hint="such as '0.5 mm'", refusal="a tolerance is above zero")
    case, predicted = read_predicted(run)
    cloud = read_cloud(points, unit=units, skip_bad_rows=skip_bad_rows)
    done = compare(case, predicted, cloud, wish, tolerance=limit)
    folder = write_comparison(done, output, overwrite=overwrite)
    notes(done.notes, voice)
    print((folder / COMPARISON).read_text(encoding="utf-8").rstrip() if as_json else summary(done, folder))
    return Exit.OUT_OF_TOLERANCE if done.within is False else Exit.DONE


def read_predicted(run: str | Path) -> tuple[Case, Predicted]:
    """The case and the predicted nodes of a run folder: released where the run has a release, else formed.

    Raises InputError for a folder that is not one of `punchform form`.
    """
    stored = read_run(run)
    case = read_case(stored.folder / CASE)
    nodes = stored.nodes
    index = np.column_stack((nodes["i"], nodes["j"]))
    flat = np.column_stack((nodes["x0"], nodes["y0"]))
    released = np.column_stack((nodes["xr"], nodes["yr"], nodes["zr"]))
    formed = np.column_stack((nodes["x"], nodes["y"], nodes["z"]))
    if case.stages is not None:
        # What a trim has cut off is in the table, without a place.
        left = np.isfinite(released if np.isfinite(released).any() else formed).all(axis=1)
        index, flat, released, formed = index[left], flat[left], released[left], formed[left]
    if np.isfinite(released).all():
        return case, Predicted(index, flat, released, "released")
    if not np.isfinite(formed).all():
        raise InputError.of("some nodes of the run have no place", where=str(run), hint="form the case again")
    return case, Predicted(index, flat, formed, "formed")


def write_comparison(done: Comparison, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write comparison.json, points.csv, figures, report.html and result.json; see `write_folder` for its errors."""

    def write(folder: Path) -> None:
        (folder / COMPARISON).write_text(comparison_json(done), encoding="utf-8", newline="\n")
        (folder / POINTS).write_text(points_csv(done), encoding="utf-8", newline="\n")
        (folder / RESULT).write_text(mark_json(done), encoding="utf-8", newline="\n")
        write_comparison_report(done, folder)

    return write_folder(output, write, overwrite=overwrite)


def summary(done: Comparison, folder: Path) -> str:
    """What a person wants to know first about a comparison, in a few lines."""
    table, fit = done.judged.table, done.alignment.fit
    assert table is not None
    surface = "prediction" if done.target is None else "target"
    facts = {
        "points": f"{len(done.cloud.points)} read in {done.cloud.unit}, {table.n} over the {surface}, "
        f"{int(done.outliers.sum())} outliers",
        "alignment": alignment_words(done),
    }
    if done.alignment.kind != "as-given":
        facts["shift"] = motion_words(fit.pose.shift, fit.errors[:3], "mm")
        facts["turn"] = motion_words(np.degrees(fit.pose.rotation_vector), np.degrees(fit.errors[3:]), "deg")
    facts |= {
        f"from the {surface}": f"rms {size(table.rms, 'mm')}, from {size(table.minimum, 'mm')} "
        f"to {size(table.maximum, 'mm')}",
        "tolerance": _judgement(done),
        "same shape": done.shape.verdict,
        "report": str(folder / "report.html"),
    }
    width = max(map(len, facts))
    return "\n".join([done.case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])


def _judgement(done: Comparison) -> str:
    table = done.judged.table
    if table is None or table.tolerance is None or table.in_tol is None:
        return "none given"
    word = "within" if done.within else "out of"
    return f"{word} {size(table.tolerance, 'mm')} rms; {100 * table.in_tol:.4g} % of the points within ± that"


def _fits_alignment(align: str, *, fit_to: str | None, rim_points: str | None, clock: str | None) -> None:
    """Refuse options that the alignment would not look at."""
    for name, given, needed in (
        ("--fit-to", fit_to, "best-fit"),
        ("--rim-points", rim_points, "rim"),
        ("--clock", clock, "rim"),
    ):
        if given is not None and align != needed:
            raise InputError.of(f"belongs to --align {needed}, not to --align {align}", where=f"{name} {given}")


def _clock(text: str | None) -> tuple[str, float] | None:
    if text is None:
        return None
    name, _, angle = text.rpartition("=")
    try:
        if not name:
            raise UnitError("a point and its direction are needed")
        return name.strip(), quantity(angle, ANGLE)
    except UnitError as problem:
        raise InputError.of(str(problem), where=f"--clock {text}", hint="such as --clock 'P7=90 deg'") from problem
