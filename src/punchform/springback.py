"""What makes a pressed grid spring back: the pull in its wires, their bending and twist, or the rim that lets go.

Eqs. (12.50) and (12.51) of docs/theory.md: two small linear problems around the released grid.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.forces import cloth
from punchform.grid import Grid
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import FreeFrames, spread
from punchform.mechanics.linear import SingularMatrix, solver_for
from punchform.mechanics.rigid import free_motions
from punchform.press import Formed
from punchform.whole import numbers_in_whole, spread_over, unfold_vectors


@dataclass(frozen=True)
class Share:
    """One part of the springback.

    moved (N, 3): of the whole grid's nodes [mm]; rms: of it along the normals of the formed grid, each node with the
    area of cloth that belongs to it; apex: of the node nearest to the axis, upwards; largest: longest move [mm].
    """

    moved: Floats
    rms: float
    apex: float
    largest: float


@dataclass(frozen=True)
class Springback:
    """The springback of a release and its parts, whose moves add up to it.

    membrane: by the pull along the wires, the rim still held; bending: by their bending and twist and the springs of
    their crossings, likewise; rim: what follows when the rim lets go too; remainder: what a linear answer misses, what
    ribs lift, and what flows in the release.
    """

    membrane: Share
    bending: Share
    rim: Share
    remainder: Share
    total: Share


def springback(
    energy: Energy, formed: Formed, before: State, after: State, moved: Floats, *, linear: str
) -> Springback | None:
    """The parts of the release from one state to another, Eqs. (12.50) and (12.51).

    energy: of the released grid; before, after: states of its solved part, formed and released; moved (N, 3): of the
    whole grid's nodes [mm]. None for wires that are not read from their chords, whose pull is not that of Eq. (3.12),
    and where the released grid does not resist every motion.
    """
    if not energy.bars.chord:
        return None
    rim = _let_go(energy, formed)
    try:
        membrane, bending = driven(energy, before, after, linear=linear)
        by_rim = np.zeros_like(membrane)
        if rim.any():
            all_of_it = membrane + bending
            membrane, bending = driven(_still_held(energy, rim, after), before, after, linear=linear)
            by_rim = all_of_it - membrane - bending
    except SingularMatrix:
        return None
    parts = membrane, bending, by_rim, moved - membrane - bending - by_rim
    return Springback(*(_share(formed, part) for part in (*parts, moved)))


def driven(energy: Energy, before: State, after: State, *, linear: str) -> tuple[Floats, Floats]:
    """How the pull of the formed wires moves the nodes of the whole grid, (N, 3) [mm], and how the rest of their end
    forces does: the linear answers of the released grid, Eq. (12.50). Raises SingularMatrix."""
    F = energy.elastic(before)[1]
    here, there = energy.kinematics.chart(after), energy.kinematics.chart(before)
    pull = energy.gradient_of(here, pulls(energy, F))
    # Springs turn nothing but the wires about their normals: what they do is the same around both states.
    springs = energy.gradient(there).gradient - energy.gradient_of(there, F) if energy.crossing else 0.0
    rest = energy.gradient_of(here, F) - pull + springs
    factor = solver_for(energy.pattern, linear).factor(energy.model(here, Hessian.EXACT).values)
    return _shifts(energy, factor.solve(-pull)), _shifts(energy, factor.solve(-rest))


def pulls(energy: Energy, F: Floats) -> Floats:
    """The part of end forces F (M, 6) that pulls along the chords, (M, 6): N of Eq. (12.50) alone."""
    step, rise = energy.bars.length[energy.grid.kind], energy.bars.rise[energy.grid.kind]
    along = np.stack((step, rise), axis=1) / np.hypot(step, rise)[:, None]
    part = np.zeros_like(F)
    part[:, [0, 2]] = along * np.sum(along * F[:, [0, 2]], axis=1)[:, None]
    return part


def _let_go(energy: Energy, formed: Formed) -> Bools:
    """The solved nodes (N,) that the rim held in the press and that the release leaves free to move in any way."""
    own = energy.kinematics
    assert isinstance(own, FreeFrames)
    rim = spread_over(formed.grid, formed.held)[numbers_in_whole(energy.grid)]
    return np.asarray(rim & ~own.held)


def _still_held(energy: Energy, rim: Bools, after: State) -> Energy:
    """The energy of the grid whose rim is held as in the press, the punch gone."""
    own = energy.kinematics
    assert isinstance(own, FreeFrames)
    fixed = None if own.fixed is None else own.fixed & ~rim[:, None]
    held = replace(own, held=own.held | rim, fixed=fixed, pins=())
    return replace(energy, kinematics=replace(held, pins=free_motions(energy.grid, held, held.chart(after))))


def _shifts(energy: Energy, step: Floats) -> Floats:
    """The shifts of the whole grid's nodes (N, 3) in a step of the unknowns."""
    grid = energy.grid
    first = np.where(grid.passes[:, 0], 0, 1)
    slots = spread(energy.kinematics.unknowns, step).reshape(grid.nodes, 2, -1)
    return unfold_vectors(grid, slots[np.arange(grid.nodes), first, :3])


def _share(formed: Formed, moved: Floats) -> Share:
    whole = formed.whole
    normal = np.sum(moved * whole.normals, axis=1)
    axis = int(np.argmin(np.linalg.norm(whole.flat, axis=1)))
    return Share(
        moved,
        rms=float(np.sqrt(np.average(normal**2, weights=_areas(formed.grid)))),
        apex=float(moved[axis, 2]),
        largest=float(np.linalg.norm(moved, axis=1).max()),
    )


def _areas(grid: Grid) -> Floats:
    """Area of cloth of the whole grid's nodes (N,) [mm²]; all alike where no wires cross."""
    areas = spread_over(grid, cloth(grid) / grid.node_weight)
    return areas if areas.any() else np.ones_like(areas)
