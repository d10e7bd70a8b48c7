"""One page on several runs: words, figures side by side with common colours, what differs in the cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure

from punchform.antenna import leaks_above
from punchform.export.told import compared, told
from punchform.report.accuracy_words import listed
from punchform.report.figures.conclusions import found
from punchform.report.figures.contact import draw_contact
from punchform.report.figures.deviation import draw_deviation
from punchform.report.figures.files import save_for_page
from punchform.report.figures.measured import reach_of
from punchform.report.figures.moves import draw_sag
from punchform.report.figures.picture import Picture
from punchform.report.figures.shear import draw_shear
from punchform.report.figures.stress import draw_stress
from punchform.report.page import render
from punchform.report.section import Images, Matrix, Section
from punchform.report.side_by_side import Line, Side, changed_settings, lines, shortened
from punchform.report.side_words import comparison_words
from punchform.report.viewer import pack, scene_of
from punchform.report.words import size
from punchform.run import Run

NOTHING = "–"
MANY = 1000.0
"""A change of more per cent than this says no more than that the first value is small."""


@dataclass(frozen=True)
class Kind:
    """A figure that all runs show on one scale.

    name, title, short title, caption: how to read it; reach: how far its scale must go for a run, None where the run
    has no such figure; draw: draws it to a given reach.
    """

    name: str
    title: str
    short: str
    caption: str
    reach: Callable[[Run], float | None]
    draw: Callable[[Run, float], Figure]


def comparison_page(runs: Sequence[Side]) -> str:
    """The HTML of a page that shows runs side by side; the first is what the others are compared with."""
    first, *others = comparison_words(runs)
    with TemporaryDirectory() as folder:
        images = _draw(runs, Path(folder))
        shown = {picture.section for picture, _ in images}
        return render(
            None,
            title=" · ".join(side.name for side in runs),
            subtitle=f"{len(runs)} runs of punchform side by side",
            good=all(side.run.accuracy is None or side.run.accuracy.within is not False for side in runs),
            lead=(first,),
            verdict=tuple(others),
            sections=(
                Section("figures", "The runs side by side", matrices=(_figures(runs),), short="Numbers"),
                Section("settings", "What differs in the cases", matrices=_settings(runs), short="Cases"),
                *(Section(kind.name, kind.title, short=kind.short) for kind in KINDS if kind.name in shown),
            ),
            results=(),
            details_title="",
            details=(),
            images=images,
            scenes=tuple(pack(scene_of(side.run, side.name), f"scene-{n}") for n, side in enumerate(runs, start=1)),
            notes=(),
            beside="",
        )


def table_lines(runs: Sequence[Side]) -> list[str]:
    """The figures of the runs as lines of text, for a terminal."""
    table = _figures(runs)
    rows = (table.head, *table.rows)
    widths = [max(len(row[column]) for row in rows) for column in range(len(table.head))]
    return [
        "  ".join(
            [row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]
        ).rstrip()
        for row in rows
    ]


def _figures(runs: Sequence[Side]) -> Matrix:
    head = ["", runs[0].name]
    for side in runs[1:]:
        head += [side.name, "difference"]
    rows = [
        ("Crossings", *_spread([f"{side.content['grid']['nodes']}" for side in runs])),
        ("Outcome of the press", *_spread([str(side.content["formed"]["outcome"]).replace("_", " ") for side in runs])),
        ("Within tolerance", *_spread([_within(side.run) for side in runs])),
    ]
    judged = [len(rows) + place for place, line in enumerate(lines(runs)) if line.key == "accuracy.judged_on.rms_mm"]
    rows += [_row(line) for line in lines(runs)]
    antenna = any(line.unit == "GHz" for line in lines(runs))
    return Matrix(
        f"Figures of result.json; differences are to {runs[0].name}",
        tuple(head),
        tuple(rows),
        tuple(judged),
        note="All figures are of the whole grid. Of a run with stages those of its last press, release and load."
        + (f" {_leaks(runs)}" if antenna else ""),
        wide=True,
    )


def _leaks(runs: Sequence[Side]) -> str:
    """From which frequency on the meshes of the runs leak, as a sentence."""
    steps = dict.fromkeys(max(side.run.case.grid.step) for side in runs)
    names = {step: listed([side.name for side in runs if max(side.run.case.grid.step) == step]) for step in steps}
    above = [size(leaks_above(step), "GHz", 2) + (f" ({names[step]})" if len(steps) > 1 else "") for step in steps]
    return f"The frequencies of the antenna are by the shape alone: above about {listed(above)} the mesh itself leaks."


def _spread(cells: list[str]) -> tuple[str, ...]:
    """Cells of runs with nothing in the columns of the differences."""
    return (cells[0], *(cell for one in cells[1:] for cell in (one, "")))


def _row(line: Line) -> tuple[str, ...]:
    cells = [line.name, _cell(line.values[0], line.unit)]
    for value, change, share in list(zip(line.values, line.differences, line.percent, strict=True))[1:]:
        cells += [_cell(value, line.unit), _change(change, share)]
    return tuple(cells)


def _cell(value: float | None, unit: str) -> str:
    return NOTHING if value is None else size(value, unit)


def _change(change: float | None, share: float | None) -> str:
    """A difference with its sign, and in per cent where that says something."""
    if change is None:
        return ""
    if change == 0:
        return "0"
    sign = "+" if change > 0 else ""
    return f"{sign}{size(change, '', 3)}" + (
        "" if share is None or abs(share) > MANY else f" ({sign}{size(share, '', 3)} %)"
    )


def _within(run: Run) -> str:
    if run.accuracy is None or run.accuracy.within is None:
        return NOTHING
    return "yes" if run.accuracy.within else "no"


def _settings(runs: Sequence[Side]) -> tuple[Matrix, ...]:
    changed = changed_settings(runs)
    if not changed:
        return ()
    rows = tuple((key, *(shortened(value) for value in values)) for key, values in changed)
    head = ("setting", *(side.name for side in runs))
    return (Matrix("Settings that differ; all others are the same", head, rows, wide=True, words=True),)


def _draw(runs: Sequence[Side], folder: Path) -> Images:
    """Every figure of every run, kind by kind, on the scale of the run that needs most."""
    drawn = []
    for kind in KINDS:
        shown = [compared(side.run) if kind.name in LEFT_OF_IT else told(side.run) for side in runs]
        reaches = [kind.reach(run) for run in shown]
        most = max((reach for reach in reaches if reach is not None), default=0.0)
        for number, (side, run, reach) in enumerate(zip(runs, shown, reaches, strict=True), start=1):
            if reach is None:
                continue
            path = folder / f"{kind.name}_{number}.png"
            save_for_page(kind.draw(run, most), path)
            picture = Picture(path.stem, side.name, kind.caption, partial(_to, kind, most), section=kind.name)
            drawn.append((replace(picture, found=found(kind.name, run)), path))
    return tuple(drawn)


def _to(kind: Kind, reach: float, run: Run) -> Figure:
    return kind.draw(run, reach)


def _reach_of_deviation(run: Run) -> float | None:
    if run.accuracy is None:
        return None
    values = run.accuracy.aligned.deviations.of(run.accuracy.judge.measure)[run.accuracy.mask]
    return reach_of(values, run.accuracy.judge.tolerance)


def _deviation(run: Run, reach: float) -> Figure:
    assert run.accuracy is not None
    return draw_deviation(run, run.accuracy, run.accuracy.aligned, reach=reach)


def _reach_of_stress(run: Run, *, released: bool) -> float | None:
    stage = run.released if released else run.formed
    stress = None if stage is None else stage.whole.stress[np.isfinite(stage.whole.stress)]
    return None if stress is None or not len(stress) else float(stress.max())


def _stress(run: Run, reach: float, *, released: bool) -> Figure:
    stage = run.released if released else run.formed
    assert stage is not None
    return draw_stress(run, stage.whole, reach=reach)


KINDS = (
    Kind(
        "deviation",
        "Deviation from the target",
        "Deviation",
        "As judged; red lies above the target, blue below, green is within the tolerance. One scale for all runs.",
        _reach_of_deviation,
        _deviation,
    ),
    Kind(
        "shear",
        "Shear of the cells",
        "Shear",
        "How far the angle between the wires has left 90°. One scale for all runs.",
        lambda run: float(np.degrees(run.formed.max_shear)) if len(run.formed.whole.cells) else None,
        lambda run, reach: draw_shear(run, reach=reach),
    ),
    Kind(
        "sag",
        "How the release moves the crossings",
        "Release",
        "Blue crossings sink, red ones rise when the punch has gone. One scale for all runs.",
        lambda run: None if run.released is None else float(np.abs(run.released.moved[:, 2]).max()),
        lambda run, reach: draw_sag(run, reach=reach),
    ),
    Kind(
        "stress",
        "Stress in the wires, in the tool",
        "Stress",
        "The largest stress in each wire piece, both families. One scale for all runs.",
        partial(_reach_of_stress, released=False),
        partial(_stress, released=False),
    ),
    Kind(
        "stress_released",
        "Stress in the wires after the release",
        "Stress released",
        "The largest stress in each wire piece, both families. One scale for all runs.",
        partial(_reach_of_stress, released=True),
        partial(_stress, released=True),
    ),
    Kind(
        "contact",
        "Contact force on the nodes",
        "Contact",
        "Where it is red the punch pushes the grid; where it is blue something has to hold it down. One scale, which "
        "goes with the root of the force, for all runs.",
        lambda run: float(np.abs(run.formed.whole.contact).max()),
        lambda run, reach: draw_contact(run, reach=reach),
    ),
)
"""The figures of the page, in order."""
LEFT_OF_IT = ("deviation", "sag", "stress_released")
"""Figures that look at what is left of the grid in the end."""
