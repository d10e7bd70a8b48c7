"""The load: what gravity, wind and single forces do to the released grid, and how rigid its shape is (Eq. (7.3))."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import CrossingSpring, LoadCase, PressCase, SolverCase, WireCase
from punchform.errors import NoEquilibrium
from punchform.forces import forces, wire_mass
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.bars import Loads
from punchform.mechanics.kinematics import FreeFrames, spread
from punchform.mechanics.linear import SingularMatrix, solver_for
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Solution
from punchform.progress import Observer, silent
from punchform.release import Released, free_energy, node_forces
from punchform.solved import Solved, solved
from punchform.whole import unfold_vectors
from punchform.wire import Element


@dataclass(frozen=True)
class Loaded(Solved):
    """The released grid under its loads.

    moved (N, 3): from the released positions of the whole grid's nodes [mm]; applied (N, 3): forces on them [N];
    reactions (N, 3): what holds each node [N]; compliance: rms deflection along the normals per newton of load, of
    small loads [mm/N]; mass: of all wire [kg], None without a density.
    """

    moved: Floats
    applied: Floats
    reactions: Floats
    compliance: float
    mass: float | None

    @property
    def rms_deflection(self) -> float:
        """Root mean square of the deflections along the normals over all nodes [mm]."""
        return _rms_along(self.moved, self.whole.normals)

    @property
    def largest_deflection(self) -> float:
        """Largest move of a node [mm]."""
        return float(np.linalg.norm(self.moved, axis=1).max())

    @property
    def load(self) -> float:
        """Sum of the sizes of all forces on nodes [N]."""
        return _size(self.applied)


def load(
    released: Released,
    elements: tuple[Element, ...],
    case: LoadCase,
    wire: WireCase,
    press: PressCase,
    *,
    crossing: str | CrossingSpring = "pinned",
    solver: SolverCase | None = None,
    yield_strength: float | None = None,
    observe: Observer = silent,
) -> Loaded:
    """Load the released grid: the minimum of its energy less the work of dead forces.

    Raises InputError for a load that the grid cannot take as it was solved and NoEquilibrium when the solve ends
    without an equilibrium.
    """
    solver = solver or SolverCase()
    grid, start = released.grid, released.state
    lengths = tuple(element.wire_length for element in elements)
    dead = forces(grid, start, case, wire, lengths)
    bare = free_energy(grid, elements, press, released.hold, start, crossing=crossing)
    energy = replace(bare, loads=Loads(dead, start.positions))
    solution = minimise(
        energy,
        start,
        max_steps=solver.max_steps,
        tolerance=solver.tolerance,
        linear=solver.linear,
        stage="load",
        exact=True,
        observe=observe,
    )
    if not solution.outcome.usable:
        raise NoEquilibrium(f"load: {solution.outcome.value}")
    solution = replace(solution, state=energy.settled(solution.state))
    return loaded_by(energy, solution, released, elements, wire, yield_strength, linear=solver.linear)


def loaded_by(
    energy: Energy,
    solution: Solution,
    released: Released,
    elements: tuple[Element, ...],
    wire: WireCase,
    yield_strength: float | None,
    *,
    linear: str,
) -> Loaded:
    """The stage that a load makes which ended so."""
    assert energy.loads is not None
    grid, dead, bare = energy.grid, energy.loads.forces, replace(energy, loads=None)
    lengths = tuple(element.wire_length for element in elements)
    done = solved(energy, solution, elements, np.zeros(grid.nodes), yield_strength)
    held = released.hold.held[:, None] | released.hold.fixed
    applied = unfold_vectors(grid, dead / grid.node_weight[:, None])
    pull = np.where(held, node_forces(bare, solution.state) - dead, 0.0)
    return Loaded(
        **vars(done),
        moved=done.whole.positions - released.whole.positions,
        applied=applied,
        reactions=unfold_vectors(grid, pull / grid.node_weight[:, None]),
        compliance=_compliance(energy, released, applied, linear),
        mass=wire_mass(grid, wire, lengths),
    )


def _compliance(energy: Energy, released: Released, applied: Floats, linear: str) -> float:
    """Of the tangent at the released state: the load's own pattern, scaled to a sum of 1 N."""
    grid = energy.grid
    chart = energy.kinematics.chart(released.state)
    model = energy.model(chart, Hessian.EXACT)
    try:
        # The released grid is in equilibrium, so what is left of the gradient is the load's.
        z = solver_for(energy.pattern, linear).factor(model.values).solve(-model.gradient)
    except SingularMatrix:
        return float("nan")
    assert isinstance(energy.kinematics, FreeFrames)
    first = np.where(grid.passes[:, 0], 0, 1)
    shifts = spread(energy.kinematics.unknowns, z).reshape(grid.nodes, 2, -1)[np.arange(grid.nodes), first, :3]
    return _rms_along(unfold_vectors(grid, shifts), released.whole.normals) / _size(applied)


def _rms_along(moved: Floats, normals: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum(moved * normals, axis=1) ** 2)))


def _size(applied: Floats) -> float:
    return float(np.linalg.norm(applied, axis=1).sum())
