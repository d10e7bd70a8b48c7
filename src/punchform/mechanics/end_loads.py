"""What acts on the two ends of every element: the loads that hold it in the shape that the grid has given it."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.mechanics import sweeps
from punchform.mechanics.bars import Bars
from punchform.mechanics.frames import State


def end_loads(grid: Grid, state: State, bars: Bars, F: Floats) -> Floats:
    """Forces [N] and moments about the node [N mm] on O and B of every solved element, (M, 2, 6): dE/d(a, w) of
    Eq. (3.4), not weighed.

    F (M, 6): the end forces of wires that yield, which do not follow from C; those of elastic wires are not looked at.
    The loads on an element balance each other, since its energy does not change when it moves as a whole.
    """
    count, ends = grid.elements, np.column_stack((grid.start, grid.end)).ravel()
    each = np.arange(count)
    yields = bars.yielding is not None
    rest = np.zeros((1, 10)) if state.history is None or not yields else state.history.measures
    G = np.zeros((4 * count, 6))
    # Every element gets nodes of its own, so that the loads of neighbours do not add up.
    sweeps.models(
        *(each, state.positions[ends], state.normals[ends], state.tangents[ends].reshape(-1, 3)),
        *(grid.family, grid.kind, 2 * each, 2 * each + 1),
        *(grid.direction.astype(np.float64), grid.sigma.astype(np.float64), np.ones(count)),
        *(bars.C, bars.offset, bars.length, bars.rise, bars.chord, rest),
        *(bars.C[grid.kind], yields, np.ascontiguousarray(F), np.zeros((1, 6, 1))),
        *(np.empty((0, 0), dtype=np.int32), sweeps.NO_HESSIAN, np.empty(count), G, np.empty(0)),
    )
    return G.reshape(count, 2, 2, 6)[each, :, grid.family]
