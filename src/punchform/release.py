"""The release: the punch leaves, what is held stays, and the grid springs to its equilibrium in space."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import CrossingSpring, PressCase, ReleaseCase, SolverCase
from punchform.errors import NoEquilibrium
from punchform.grid import Grid
from punchform.holds import Held, holds
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Loads
from punchform.mechanics.frames import State, crossing_angle
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome, Solution
from punchform.mechanics.rigid import free_motions
from punchform.press import Formed
from punchform.progress import Observer, silent
from punchform.solved import Shaped, Solved, bars_of, joined, solved
from punchform.springback import Springback, springback
from punchform.stability import Stability, stability
from punchform.start import flat
from punchform.whole import state_on, unfold_vectors
from punchform.wire import Element

SOFTENED = 30.0
"""How much softer the wires are to stretching while the grid finds its large motion."""
ROUGH = 1e-2
"""Relative decrement at which the softened grid is near enough."""
SHARES = (0.75, 0.5, 0.25, 0.1, 0.0)
"""Shares of the tool's forces that are left, one after the other, when the grid cannot be let go at once."""
TIE = 1e-9
"""Mirror images sink alike, to this part of the largest move."""
FOLDED = 0.8
"""Crossings turned by more than this part of a right angle are folded up."""


@dataclass(frozen=True)
class Released(Solved):
    """The grid without the punch.

    moved (N, 3): of the whole grid's nodes, from where the stage before left them [mm]; reactions (N, 3): what holds
    each node [N];
    held_nodes: nodes of the solved part that are held in any direction; stability: of the whole grid;
    hold: what was held; split: what made it spring back, None where that is not told: after another stage than a
    press, for wires not read from their chords, where the grid keeps no energy, and where it rests in no minimum.
    """

    moved: Floats
    reactions: Floats
    hold: Held
    stability: Stability
    split: Springback | None = None

    @property
    def apex(self) -> float:
        """How far the node nearest to the axis moved up [mm]."""
        nearest = int(np.argmin(np.linalg.norm(self.whole.flat, axis=1)))
        return float(self.moved[nearest, 2])

    @property
    def lowest(self) -> int:
        """The crossing of the whole grid that sank most; of mirror images the one with the largest i, then j."""
        sunk = self.moved[: self.whole.crossings, 2]
        return int(np.flatnonzero(sunk <= sunk.min() + TIE * np.abs(self.moved).max())[-1])

    @property
    def max_sag(self) -> float:
        """Largest vertical move downwards, with its sign [mm]."""
        return float(self.moved[self.lowest, 2])

    @property
    def largest_reaction(self) -> float:
        """Largest force that holds a node [N]."""
        return float(np.linalg.norm(self.reactions, axis=1).max())


def release(
    formed: Shaped,
    elements: tuple[Element, ...],
    case: ReleaseCase,
    press: PressCase,
    *,
    full_grid: Grid | None = None,
    crossing: str | CrossingSpring = "pinned",
    solver: SolverCase | None = None,
    yield_strength: float | None = None,
    observe: Observer = silent,
) -> Released:
    """Let the formed grid go: the minimum of its energy with only the held nodes where they are, Eq. (7.1).

    formed: the stage before, which may be a trim, another release or a load too; what is held keeps the place it has
    there. full_grid: the same grid laid without mirror planes, on which the release is then solved. Raises InputError
    for holds that hold nothing and NoEquilibrium when the solve ends without an equilibrium.
    """
    solver = solver or SolverCase()
    grid, state = (formed.grid, formed.state) if full_grid is None else (full_grid, state_on(full_grid, formed.whole))
    held = holds(grid, state.positions, case)
    start = replace(state, positions=held.positions)
    energy = free_energy(grid, elements, press, held, start, crossing=crossing)
    yields = energy.bars.yielding is not None
    if held.count == 0 and not yields:
        return released_by(energy, _flat(grid), formed, elements, held, Stability(0, None), yield_strength)
    solution = _let_go(energy, start, state, solver, observe)
    if not solution.outcome.usable:
        raise NoEquilibrium(f"release: {solution.outcome.value}")
    if energy.at(solution.state) <= solver.tolerance * energy.at(start):
        # No grid has less energy than none: a negative eigenvalue is the rounding of a motion that costs nothing,
        # as the shear of a flat pinned grid.
        solution = replace(solution, outcome=Outcome.CONVERGED, negative_eigenvalues=0)
        return released_by(energy, solution, formed, elements, held, Stability(0, None), yield_strength)
    solution = replace(solution, state=energy.settled(solution.state))
    found = stability(energy, solution.state, linear=solver.linear, negative=solution.negative_eigenvalues)
    done = released_by(energy, solution, formed, elements, held, found, yield_strength)
    if not isinstance(formed, Formed) or solution.outcome is not Outcome.CONVERGED:
        return done
    return replace(done, split=springback(energy, formed, state, done.state, done.moved, linear=solver.linear))


def free_energy(
    grid: Grid,
    elements: tuple[Element, ...],
    press: PressCase,
    held: Held,
    start: State,
    *,
    crossing: str | CrossingSpring,
) -> Energy:
    """The energy of the grid in space, Eq. (3.3), over the unknowns that are not held."""
    kinematics = FreeFrames(grid, None, held.held, welded=crossing == "welded", fixed=held.fixed)
    return Energy(
        grid,
        bars_of(elements, press),
        replace(kinematics, pins=free_motions(grid, kinematics, kinematics.chart(start))),
        crossing=crossing.stiffness if isinstance(crossing, CrossingSpring) else 0.0,
    )


def _flat(grid: Grid) -> Solution:
    """What is left of elastic wires that nothing holds: the flat grid, which has no energy, and none has less."""
    return Solution(
        flat(grid), Outcome.CONVERGED, history=(), negative_eigenvalues=0, linear_solver="none", seconds={"total": 0.0}
    )


def _let_go(energy: Energy, start: State, formed: State, solver: SolverCase, observe: Observer) -> Solution:
    """First with wires that stretch easily, which finds the large motion; then with the real ones, Eq. (7.4).

    Wires that yield are let go at once: what has flowed keeps their motion small. Where that fails the forces of the
    tool are taken away bit by bit.
    """
    begun = energy.at(start)
    passes, state = [], start
    if energy.bars.yielding is None:
        rough = max(ROUGH, solver.tolerance)
        passes.append(_minimised(softened(energy), start, solver, observe, tolerance=rough, begun=begun))
        state = passes[-1].state
    if not passes or passes[-1].outcome is not Outcome.SINGULAR:
        real = _minimised(energy, state, solver, observe, tolerance=solver.tolerance, begun=begun)
        if real.outcome.usable:
            return joined([*passes, real])
    tool, state = node_forces(energy, formed), start
    for share in SHARES:
        left = replace(energy, loads=Loads(share * tool, start.positions)) if share else energy
        passes.append(_minimised(left, state, solver, observe, tolerance=solver.tolerance, begun=begun))
        if not passes[-1].outcome.usable:
            break
        state = passes[-1].state
    return joined(passes)


def _minimised(
    energy: Energy, start: State, solver: SolverCase, observe: Observer, *, tolerance: float, begun: float
) -> Solution:
    return minimise(
        energy,
        start,
        max_steps=solver.max_steps,
        tolerance=tolerance,
        linear=solver.linear,
        stage="release",
        exact=True,
        scale=begun,
        observe=observe,
    )


def softened(energy: Energy) -> Energy:
    """The energy of wires that stretch more easily, Eq. (7.4)."""
    B = np.linalg.inv(energy.bars.C)
    B[:, 0, 0] *= SOFTENED
    return replace(energy, bars=replace(energy.bars, C=np.linalg.inv(B)))


def node_forces(energy: Energy, state: State) -> Floats:
    """The force (N, 3) [N] that must act on every solved node to keep it where it is.

    Across a mirror plane there is none: the other half of the grid pulls as hard.
    """
    G = energy.gradient(energy.kinematics.chart(state)).G
    forces = G.reshape(-1, 2, 6)[:, :, :3].sum(axis=1)
    forces[:, :2][energy.grid.on_mirror] = 0.0
    return np.asarray(forces)


def released_by(
    energy: Energy,
    solution: Solution,
    formed: Shaped,
    elements: tuple[Element, ...],
    held: Held,
    found: Stability,
    yield_strength: float | None,
) -> Released:
    """The stage that a release makes which ended so."""
    grid = energy.grid
    done = solved(energy, solution, elements, np.zeros(grid.nodes), yield_strength)
    forces = np.where(held.held[:, None] | held.fixed, node_forces(energy, solution.state), 0.0)
    reactions = unfold_vectors(grid, forces / grid.node_weight[:, None])
    told = _remarks(grid, done, held, found, yields=energy.bars.yielding is not None)
    return Released(
        **{**vars(done), "notes": told},
        moved=done.whole.positions - formed.whole.positions,
        reactions=reactions,
        hold=held,
        stability=found,
    )


def _remarks(grid: Grid, done: Solved, held: Held, found: Stability, *, yields: bool) -> tuple[str, ...]:
    """What a user should know about a released grid."""
    notes = []
    if grid.quarter and found.negative and not done.negative_eigenvalues:
        notes.append(
            f"the released quarter is an equilibrium that the whole grid would leave ({found.negative} ways of leaving "
            'it): it is not symmetric when let go; run it with release.symmetry = "full"'
        )
    if done.outcome is Outcome.SADDLE:
        notes.append("the released grid rests on a saddle: the least disturbance moves it along the mode shown")
    if held.count == 0 and not yields:
        notes.append("elastic wires that nothing holds spring back to the flat grid: only what yields or is held stays")
    if held.count == 0 and yields:
        notes.append(
            "nothing holds the grid, so where it lies in space says nothing: its shape is what a best fit says "
            '(target.alignment = "best fit")'
        )
    lean = np.abs(crossing_angle(done.state) - 0.5 * np.pi).max(initial=0.0)
    if lean > 0.5 * np.pi * FOLDED:
        notes.append(f"crossings turn by up to {np.rad2deg(lean):.3g} degrees: neighbouring wires would touch before")
    return tuple(notes)
