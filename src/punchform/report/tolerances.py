"""The report of a tolerance analysis: result.json and report.html."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from punchform import __version__
from punchform.case import Case
from punchform.case.scattering import Scattered, scattered
from punchform.optimise.figures import in_its_tool
from punchform.optimise.tolerances import CONFIDENCE, Tolerances
from punchform.report.figures.files import save
from punchform.report.figures.picture import Picture
from punchform.report.figures.tolerances import draw_histogram, draw_influences
from punchform.report.page import FIGURES, PAGE, render
from punchform.report.section import Images, Rows
from punchform.report.words import percent, size

LINEAR = 0.7
"""Below this share of the variance told in a straight line, standardised slopes are doubtful."""


def tolerances_json(case: Case, found: Tolerances, *, samples: int, seed: int) -> str:
    """The text of result.json."""
    content: dict[str, Any] = {
        "schema": 1,
        "version": __version__,
        "case_title": case.title,
        "samples": samples,
        "seed": seed,
        "failed": found.samples - len(found.values),
        "failures": dict(found.failures),
        "nominal_rms_mm": found.nominal,
        "rms_mm": {
            "mean": found.mean,
            "standard_deviation": found.deviation,
            "least": float(found.values.min()),
            "most": float(found.values.max()),
            "percentiles": {str(p): value for p, value in found.percentiles.items()},
        },
        "tolerance_mm": found.tolerance,
        "within": found.within,
        "yield": found.yielded,
        "yield_interval": {"confidence": CONFIDENCE, "low": found.low, "high": found.high},
        "influences": [vars(one) for one in found.influences],
        "explained": found.explained,
        "held_otherwise": found.held_otherwise,
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def write_tolerances_report(case: Case, found: Tolerances, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    html = render(
        case,
        subtitle="What the scatter of wire, grid and tool does to the accuracy of the shape",
        good=found.nominal is not None and found.nominal <= found.tolerance and found.low >= 0.5,
        verdict=(*_beyond(found), *_verdict(found)),
        results=(("The rms deviation", _rms_rows(found)), ("What varies", _scatter_rows(scattered(case)))),
        details_title="What matters most",
        details=(("Share of the variance of the rms", _influence_rows(found)),),
        images=_draw(found, folder / FIGURES),
        notes=notes(found, case),
        beside="table.csv (one row for each sample), record.jsonl, result.json, case.toml",
    )
    (folder / PAGE).write_text(html, encoding="utf-8", newline="\n")


def _beyond(found: Tolerances) -> tuple[str, ...]:
    """That the scatter is not the trouble where the nominal case is out of tolerance itself."""
    if found.nominal is None or found.nominal <= found.tolerance:
        return ()
    return (
        f"The nominal case, with {size(found.nominal, 'mm')} rms, is beyond the tolerance of "
        f"{size(found.tolerance, 'mm')} before anything varies: compensate its punch first (`punchform compensate`).",
    )


def notes(found: Tolerances, case: Case) -> tuple[str, ...]:
    """What to beware of."""
    told = [*in_its_tool(case), *(sentence[0].lower() + sentence[1:].rstrip(".") for sentence in _beyond(found))]
    told += [f"{count} of {found.samples} samples failed: {message}" for message, count in found.failures.items()]
    if found.held_otherwise:
        told.append(
            f"{found.held_otherwise} of {found.samples} samples hold other crossings than the nominal case, so their "
            "figures jump: a crossing lies on the rim or where `release.hold` begins, or nearly; a radius between two "
            "crossings avoids it"
        )
    if found.explained is not None and found.explained < LINEAR:
        told.append(
            f"only {percent(found.explained)} of the variance of the rms is linear in the numbers that vary: trust the "
            "ranks more than the shares"
        )
    return tuple(told)


def _draw(found: Tolerances, folder: Path) -> Images:
    folder.mkdir(parents=True, exist_ok=True)
    captions = (
        (
            "histogram",
            "How the rms scatters",
            "Samples by their rms deviation; those beyond the tolerance are drawn in the colour of the punch. The "
            "share of the area before the tolerance is the yield.",
            draw_histogram,
        ),
        (
            "influences",
            "What makes it scatter",
            "The number on top is the one to hold more tightly. The figure beside a bar is the standardised slope: "
            "with a plus (and the colour of the punch) more of it makes the shape worse.",
            draw_influences,
        ),
    )
    drawn = []
    for name, title, caption, draw in captions:
        if draw is draw_influences and not found.influences:
            continue
        path = folder / f"{name}.png"
        save(draw(found), path)
        drawn.append((Picture(name, title, caption, lambda run: draw_histogram(found)), path))
    return tuple(drawn)


def _verdict(found: Tolerances) -> tuple[str, ...]:
    yielded = (
        f"{percent(found.yielded)} of the samples ({found.within} of {found.samples}) are within the tolerance of "
        f"{size(found.tolerance, 'mm')}; of all that will be made it is {percent(found.low)} to {percent(found.high)}, "
        "with 95 % confidence."
    )
    if not found.influences:
        return (yielded,)
    first = found.influences[0]
    worse = "more of it makes the shape worse" if first.slope > 0 else "more of it makes the shape better"
    return (
        yielded,
        f"What matters most is `{first.place}`: {percent(first.share)} of the variance of the rms comes from it, and "
        f"{worse}.",
    )


def _rms_rows(found: Tolerances) -> Rows:
    failed = found.samples - len(found.values)
    return (
        ("Nominal case", "failed" if found.nominal is None else size(found.nominal, "mm")),
        ("Mean", size(found.mean, "mm")),
        ("Standard deviation", size(found.deviation, "mm", 3)),
        *((f"{p} % of the samples are below", size(value, "mm")) for p, value in found.percentiles.items()),
        ("Largest", size(float(found.values.max()), "mm")),
        ("Tolerance", size(found.tolerance, "mm")),
        ("Within it", f"{found.within} of {found.samples} samples"),
        ("Failed, and counted as out of tolerance", f"{failed}"),
    )


def _scatter_rows(numbers: tuple[Scattered, ...]) -> Rows:
    words = {"normal": "standard deviation", "uniform": "evenly within ±"}
    return tuple(
        (one.place, f"{size(one.nominal, one.unit)}, {words[one.kind]} {size(one.amount, one.unit, 3)}")
        for one in numbers
    )


def _influence_rows(found: Tolerances) -> Rows:
    return tuple(
        (one.place, f"{percent(one.share)}; standardised slope {one.slope:+.2f}, rank correlation {one.rank:+.2f}")
        for one in found.influences
    ) or (("Not known", "too few samples, or no scatter of the rms"),)
