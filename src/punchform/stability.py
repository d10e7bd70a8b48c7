"""Whether the equilibrium of a quarter is one that the whole grid keeps, Eq. (7.2).

Every small motion of the whole grid is a sum of four: mirrored across both planes, or changing its sign across one
or both. The quarter was solved among those of the first kind; the other three are three more matrices of its size.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.buckling import negative_modes
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import FreeFrames, spread
from punchform.mechanics.linear import Factor, SingularMatrix, solver_for
from punchform.mechanics.rigid import free_motions
from punchform.whole import unfold_vectors

OTHERS = ((True, False), (False, True), (True, True))
MOST_MODES = 8
"""With more negative eigenvalues than this the lowest mode is not looked for."""


@dataclass(frozen=True)
class Stability:
    """negative: number of negative eigenvalues of the whole grid's Hessian, None when a solver cannot tell;
    mode (N, 3): shifts of the whole grid's nodes in the lowest of them, of largest length 1; None without one."""

    negative: int | None
    mode: Floats | None


def stability(energy: Energy, state: State, *, linear: str, negative: int | None) -> Stability:
    """Count the negative eigenvalues; `negative` are those of the solved part's own kind of motions."""
    own = energy.kinematics
    assert isinstance(own, FreeFrames)
    counts, lowest, mode = [negative], 0.0, None
    kinds = OTHERS if energy.grid.quarter else ()
    for odd in ((False, False), *kinds) if negative else kinds:
        kinematics = replace(own, odd=odd, pins=())
        kinematics = replace(kinematics, pins=free_motions(energy.grid, kinematics, kinematics.chart(state)))
        one = replace(energy, kinematics=kinematics)
        model = one.model(kinematics.chart(state), Hessian.EXACT)
        try:
            factor = solver_for(one.pattern, linear).factor(model.values)
        except SingularMatrix:
            counts.append(None)
            continue
        if odd != (False, False):
            counts.append(factor.negative)
        value, shape = _lowest(factor)
        if shape is not None and value < lowest:
            lowest, mode = value, _shifts(one, state, shape, odd)
    known = [count for count in counts if count is not None]
    return Stability(sum(known) if len(known) == len(counts) else None, mode)


def _lowest(factor: Factor) -> tuple[float, Floats | None]:
    if not factor.negative or factor.negative > MOST_MODES:
        return 0.0, None
    modes = negative_modes(factor, factor.negative)
    if modes is None:
        return 0.0, None
    lowest = int(modes.values.argmin())
    return float(modes.values[lowest]), modes.shapes[:, lowest]


def _shifts(energy: Energy, state: State, shape: Floats, odd: tuple[bool, bool]) -> Floats:
    grid = energy.grid
    first = np.where(grid.passes[:, 0], 0, 1)
    unknowns = energy.kinematics.unknowns.reshape(grid.nodes, 2, -1)[np.arange(grid.nodes), first, :3]
    shifts = spread(unknowns, shape)
    size = np.linalg.norm(shifts, axis=1).max()
    return unfold_vectors(grid, shifts / size if size else shifts, odd)
