"""What the files and the report tell of a run with stages: its last press, and what came after that."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.whole import Whole, places_in

if TYPE_CHECKING:
    from punchform.release import Released
    from punchform.run import Run, Stage
    from punchform.solved import Shaped, Solved


def told(run: Run) -> Run:
    """The run without what was undone by a later press, its case with the settings of the stages that are left.

    The same run where the case names no stages.
    """
    if run.case.stages is None:
        return run
    last: dict[str, Stage] = {}
    for stage in run.stages:
        if stage.kind in ("press", "release"):
            later = ("release", "load") if stage.kind == "press" else ("load",)
            last = {kind: one for kind, one in last.items() if kind not in later}
        last[stage.kind] = stage
    settings = {kind: last[kind].settings if kind in last else None for kind in ("press", "release", "load")}
    return replace(
        run,
        case=run.case.model_copy(update={"stages": None, **settings}),
        released=_released(run, last["release"]) if "release" in last else None,
        loaded=run.loaded if "load" in last else None,
    )


def _released(run: Run, stage: Stage) -> Released | None:
    """The last release, which says from where its moves are counted when that is not the shape in the tool."""
    assert run.released is not None
    place = next(number for number, one in enumerate(run.stages) if one is stage)
    before = run.stages[place - 1]
    if before.kind == "press" or [one.kind for one in run.stages[place - 2 : place]] == ["press", "trim"]:
        return run.released
    return replace(run.released, notes=(*run.released.notes, f"moves are counted from the stage before, {before.name}"))


def compared(run: Run) -> Run:
    """The run with its formed grid told of the nodes that are left in the end, so that the two can be compared."""
    if run.case.stages is None:
        return run
    from punchform.trim import narrowed

    shown = told(run)
    kept = places_in(shown.final.whole.flat, shown.formed.whole.flat) >= 0
    if kept.all():
        return shown
    return replace(shown, formed=narrowed(shown.formed, kept, run.case.grid.crossing))


def laid(run: Run) -> Shaped:
    """The grid before anything was cut off."""
    return run.formed if run.case.stages is None else run.stages[0].done


def with_the_rest(run: Run) -> tuple[Solved, Floats | None]:
    """The formed grid and the released positions for the nodes of the grid as it was laid: NaN for what was cut off."""
    shown = told(run)
    if run.case.stages is None:
        return run.formed, None if run.released is None else run.released.whole.positions
    whole, formed = laid(run).whole, shown.formed.whole
    there = places_in(formed.flat, whole.flat)
    known = replace(whole, positions=spread(formed.positions, there), contact=spread(formed.contact, there))
    return replace(shown.formed, whole=known), released_on(run, whole)


def released_on(run: Run, whole: Whole) -> Floats | None:
    """Released positions for nodes of a whole grid (N, 3) [mm], NaN for what was cut off; None without a release."""
    released = told(run).released
    if released is None or run.case.stages is None:
        return None if released is None else released.whole.positions
    return spread(released.whole.positions, places_in(released.whole.flat, whole.flat))


def spread(values: Floats, places: Ints) -> Floats:
    """Values (n, ...) at places (N,) among them; NaN where the place is -1."""
    beside = np.full((1, *values.shape[1:]), np.nan)
    return np.asarray(np.concatenate((values, beside))[places])
