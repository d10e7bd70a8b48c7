"""What can be shown of a run as colours on its grid: at cells, wires or crossings, stage by stage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats
from punchform.export.told import told
from punchform.load import Loaded
from punchform.press import Formed
from punchform.release import Released
from punchform.report.quantities import Place, deviation_label, readings, with_unit

if TYPE_CHECKING:
    from punchform.run import Done, Run


@dataclass(frozen=True)
class Field:
    """A field of a stage: values at its nodes (N,), wires (M,) or cells (K,), NaN where they are not known.

    label: for a legend, with the unit; signed: whether zero is in the middle of the scale; force: whether it is a
    force, which at the rim is tens of times that elsewhere.
    """

    name: str
    label: str
    place: Place
    values: Floats
    signed: bool = False
    force: bool = False


def stage_of(run: Run, stage: str) -> Done:
    """The stage of a run: "formed", "released" or "loaded", or the name of one of `run.stages`, such as "trim 1".

    A release or a load that a later press has undone is there by its name alone, such as "release 1". Raises ValueError
    for a stage that the run has not, with those that it has.
    """
    left = told(run)
    known: dict[str, Done | None] = {"formed": left.formed, "released": left.released, "loaded": left.loaded}
    known |= {one.name: one.done for one in run.stages}
    found = known.get(stage)
    if found is None:
        there = ", ".join(name for name, done in known.items() if done is not None)
        raise ValueError(f"the run has no stage {stage!r}; it has: {there}")
    return found


def fields(run: Run, stage: str) -> dict[str, Field]:
    """All fields of a stage by their names: those that are not known or do not apply are left out. See `stage_of`."""
    done = stage_of(run, stage)
    whole = done.whole
    found = [
        Field(one.key, one.legend, one.place, one.of(whole), signed=one.signed, force=one.force)
        for one in readings(yields=done.hardening is not None)
        if isinstance(done, Formed) or not one.in_tool
    ]
    if isinstance(done, Released | Loaded):
        found.append(Field("moved", with_unit("move", "mm"), "node", np.linalg.norm(done.moved, axis=1)))
    # A release is told with remarks of its own; its whole grid is the one that was judged.
    if run.accuracy is not None and done.whole is run.final.whole:
        judge = run.accuracy.judge
        values = np.where(run.accuracy.mask, run.accuracy.aligned.deviations.of(judge.measure), np.nan)
        label = with_unit(deviation_label(judge.measure, judge.alignment), "mm")
        found.append(Field("deviation", label, "node", values, signed=True))
    return {one.name: one for one in found if np.isfinite(one.values).any()}


def field_of(run: Run, field: str, stage: str) -> Field:
    """One field of a stage. Raises ValueError for one that the stage has not, with those that it has."""
    known = fields(run, stage)
    if field not in known:
        raise ValueError(f"there is no field {field!r} of the stage {stage!r}; there are: shape, {', '.join(known)}")
    return known[field]
