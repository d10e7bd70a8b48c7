"""The core idea: form the grid over the punch, let it go, load it, and measure it."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TypedDict

import numpy as np

from punchform.accuracy import Accuracy, measure_case
from punchform.case import Case, CrossingSpring, SolverCase
from punchform.grid import Grid, lay
from punchform.load import Loaded, load
from punchform.prepare import Prepared, prepare
from punchform.press import Formed, press
from punchform.progress import Observer, silent
from punchform.release import Released, release


@dataclass(frozen=True)
class Run:
    """A case and what became of it: the formed grid, and what the case asks for after that, else None.

    accuracy is that of the released shape, or of the formed one when there is no release.
    """

    case: Case
    formed: Formed
    released: Released | None
    loaded: Loaded | None
    accuracy: Accuracy | None
    notes: tuple[str, ...]
    seconds: float

    @property
    def final(self) -> Formed | Released:
        """The last stage before the loads: what leaves the workshop."""
        return self.formed if self.released is None else self.released


class _Wires(TypedDict):
    """What every stage needs beside grid and elements."""

    crossing: str | CrossingSpring
    solver: SolverCase
    yield_strength: float | None
    observe: Observer


def run(case: Case, *, observe: Observer = silent) -> Run:
    """Form the grid over the punch, let it go, load it, and measure it.

    Raises InputError when the case cannot be pressed, NoEquilibrium when no equilibrium is found.
    """
    begun = perf_counter()
    ready = prepare(case)
    hardening = ready.elements[0].hardening
    # A tensile test says where its wire yields.
    strength = case.wire.yield_strength if hardening is None else hardening.yield_strength
    wires = _Wires(crossing=case.grid.crossing, solver=case.solver, yield_strength=strength, observe=observe)
    formed = press(ready.grid, ready.elements, ready.punch, case.pressing, **wires)
    released = loaded = None
    if case.release is not None:
        whole_grid = _whole_grid(case, ready)
        released = release(formed, ready.elements, case.release, case.pressing, full_grid=whole_grid, **wires)
        if case.load is not None:
            loaded = load(released, ready.elements, case.load, case.wire, case.pressing, **wires)
    final = released or formed
    accuracy = None
    if case.target is not None:
        whole = final.whole
        # The shape is judged at its crossings, wherever else a wire has nodes.
        crossings = np.where(whole.between[:, None] == 0, whole.positions, np.nan)
        accuracy = measure_case(crossings, whole.cells, case.target, apex_height=ready.punch.height_at_axis)
    notes = tuple(doubt.message for doubt in ready.doubts)
    return Run(case, formed, released, loaded, accuracy, notes, perf_counter() - begun)


def _whole_grid(case: Case, ready: Prepared) -> Grid | None:
    """The grid without mirror planes, when the release shall be free to leave the symmetry."""
    assert case.release is not None
    if case.release.symmetry == "as pressed" or not ready.grid.quarter:
        return None
    return lay(case.grid.model_copy(update={"symmetry": "full"}), rim_radius=case.tool.rim_radius)
