"""What acts on the two ends of every element: the loads that hold it in the shape that the grid has given it."""

from __future__ import annotations

from typing import Any

import numpy as np

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.mechanics import sweeps
from punchform.mechanics.bars import Bars
from punchform.mechanics.chord import to_modes
from punchform.mechanics.frames import State


def end_loads(grid: Grid, state: State, bars: Bars, D: Floats, F: Floats) -> Floats:
    """Forces [N] and moments about the node [N mm] on O and B of every solved element, (M, 2, 6): dE/d(a, w) of
    Eq. (3.4), not weighed.

    D, F (M, 6): modes and end forces that the solve ended with, looked at for wires that yield: their end forces do not
    follow from C, and what they remember follows from D. The loads on an element balance each other, since its energy
    does not change when it moves as a whole.
    """
    count, ends = grid.elements, np.column_stack((grid.start, grid.end)).ravel()
    each = np.arange(count)
    rest, yields = np.zeros((1, 10)), bars.yielding is not None

    def of(rest: Floats) -> tuple[Any, ...]:
        # Every element gets nodes of its own, so that the loads of neighbours do not add up.
        return (
            *(state.positions[ends], state.normals[ends], state.tangents[ends].reshape(-1, 3)),
            *(grid.family, grid.kind, 2 * each, 2 * each + 1),
            *(grid.direction.astype(np.float64), grid.sigma.astype(np.float64), np.ones(count)),
            *(bars.C, bars.offset, bars.length, bars.rise, bars.chord, rest),
        )

    if yields:
        new = np.empty((count, 6))
        sweeps.states(*of(rest), new, np.empty((count, 6)), np.empty(count))
        rest = np.concatenate((_measures(grid, bars, new - D), np.zeros((count, 4))), axis=1)
    G = np.zeros((4 * count, 6))
    sweeps.models(
        *(each, *of(rest), bars.C[grid.kind], yields, np.ascontiguousarray(F), np.zeros((1, 6, 1))),
        *(np.empty((0, 0), dtype=np.int32), sweeps.NO_HESSIAN, np.empty(count), G, np.empty(0)),
    )
    return G.reshape(count, 2, 2, 6)[each, :, grid.family]


def _measures(grid: Grid, bars: Bars, D: Floats) -> Floats:
    """The chord measures (M, 6) that these modes belong to, Eq. (3.13) the other way."""
    found = np.empty_like(D)
    for kind, (rise, length) in enumerate(zip(bars.rise.tolist(), bars.length.tolist(), strict=True)):
        T = np.array([to_modes(tuple(row), rise, length) for row in np.eye(6).tolist()]).T
        found[grid.kind == kind] = np.linalg.solve(T, D[grid.kind == kind].T).T
    return found
