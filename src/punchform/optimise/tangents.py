"""Equilibria that move with a setting: press, release and load to first order, Eqs. (13.21)-(13.24).

A stage rests where the gradient g(z, p) over its unknowns is zero. With the Hessian H, factored once,

    dz/dp = -H⁻¹ ∂g/∂p,

where ∂g/∂p is taken at fixed unknowns, with the nodes carried by the punch as it changes and, after the press, with
what is held carried by the stage before. The explicit derivatives are differences of closed forms; no equilibrium is
solved again. Where wires yield, every stroke of the press is such a stage, and what flowed in it goes on to the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from punchform.accuracy import Judged, Measure, judged_at
from punchform.arrays import Floats
from punchform.case import CrossingSpring
from punchform.errors import InputError
from punchform.forces import forces
from punchform.holds import Held, followed
from punchform.load import Loaded, loaded_by
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Loads
from punchform.mechanics.differences import Differences
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State
from punchform.mechanics.history import History, Recall
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome, Solution
from punchform.optimise.equilibria import Equilibria, Landing, Rest, freed_of, press_of
from punchform.optimise.knots import Knot, between
from punchform.press import Formed, formed_by
from punchform.punch import lowered, project
from punchform.release import Released, released_by
from punchform.run import Run, Stage
from punchform.solved import Solved
from punchform.start import flat_start
from punchform.strokes import Descent
from punchform.whole import unfold_vectors

PASSES, AT_REST, SLOW = 40, 1e-10, 0.5
"""Of wires that yield: how often a knot is brought nearer to its rest, the move that is none [mm, rad], and the part of
the last move that a pass may leave at most."""
CLOSE = 1e-15
"""Relative decrement at which a knot is at rest that had to be solved anew."""


@dataclass(frozen=True)
class Moved:
    """A stage at one knot: its energy there, and a state with its gradient that may still have to follow."""

    energy: Energy
    state: State

    @property
    def residual(self) -> Floats:
        """The gradient over the unknowns, (n,)."""
        return self.energy.gradient(self.energy.kinematics.chart(self.state)).gradient

    def along(self, z: Floats) -> Moved:
        """The stage after the step z (n,) of its unknowns."""
        return replace(self, state=self.energy.kinematics.chart(self.state).moved(z))

    @property
    def settled(self) -> Moved:
        """The stage with what flowed in it as its past."""
        return replace(self, state=self.energy.settled(self.state))


def tangent_runs(rest: Equilibria, knots: Sequence[Knot], *, loaded: bool = False) -> tuple[Run, ...]:
    """The run at the knots of one setting, see `tangents_of`."""
    return tangents_of(rest, [knots], loaded=loaded)[0]


def tangents_of(
    rest: Equilibria, settings: Sequence[Sequence[Knot]], *, loaded: bool = False
) -> tuple[tuple[Run, ...], ...]:
    """The run at the knots of some settings, as its equilibria follow to first order: figures of these have the right
    derivative. They are not measured against the target: `judged` does that for what is asked.

    loaded: also the load, whose compliance costs a factorisation at each knot.
    """
    pressed: list[list[Moved | None]] = [[None] * len(knots) for knots in settings]
    for landing in rest.trail:
        here = rest.rest_at(landing)
        for before, knots in zip(pressed, settings, strict=True):
            there = [
                pressed_at(rest, here, landing, knot, None if past is None else past.state.history)
                for past, knot in zip(before, knots, strict=True)
            ]
            before[:] = [moved.settled for moved in _following(here, there, knots)]
    return tuple(
        _runs(rest, knots, [moved for moved in there if moved is not None], loaded=loaded)
        for knots, there in zip(settings, pressed, strict=True)
    )


def _runs(rest: Equilibria, knots: Sequence[Knot], pressed: Sequence[Moved], *, loaded: bool) -> tuple[Run, ...]:
    """The run at the knots of one setting after the press has followed."""
    formed = tuple(_formed(rest, knot, moved) for knot, moved in zip(knots, pressed, strict=True))
    released: tuple[Released | None, ...] = (None,) * len(knots)
    under_load: tuple[Loaded | None, ...] = (None,) * len(knots)
    if rest.run.released is not None:
        freed = released_at_all(rest, knots, [moved.state for moved in pressed])
        released = tuple(
            _released(rest, knot, moved, one) for knot, moved, one in zip(knots, freed, formed, strict=True)
        )
    if loaded and rest.run.loaded is not None:
        under_load = _loaded(rest, knots, released)
    return tuple(
        _run(rest.run, knot, *stages)
        for knot, stages in zip(knots, zip(formed, released, under_load, strict=True), strict=True)
    )


def judged(rest: Equilibria, knot: Knot, state: State, measure: Measure, *, fitted: bool) -> Judged:
    """The deviations of a state from the target of a knot, at the nodes that were judged in the run."""
    like, target = rest.run.accuracy, knot.case.target
    if like is None or target is None:
        raise InputError.of("the case has no [target], so there is no deviation from it", where="target")
    points, height = crossings(rest, state), knot.punch.height_at_axis
    cells = rest.run.final.whole.cells
    return judged_at(points, cells, target, like, apex_height=height, measure=measure, fitted=fitted)


def crossings(rest: Equilibria, state: State) -> Floats:
    """Places (n, 3) [mm] of the crossings of the whole grid in a state, NaN for nodes between them."""
    points = unfold_vectors(rest.ready.grid, state.positions)
    return np.where(rest.run.final.whole.between[:, None] == 0, points, np.nan)


def pressed_at(rest: Equilibria, here: Rest, landing: Landing, knot: Knot, past: History | None) -> Moved:
    """A stroke at a knot before its unknowns follow: nodes on the punch there, clamped ones on the flat grid there,
    and in its wires what flowed there in the strokes before."""
    state, old, tool = landing.state, here.energy.kinematics, lowered(knot.punch, landing.share)
    assert isinstance(old, FreeFrames | Differences)
    assert old.surface is not None
    kinematics = replace(old, grid=knot.grid, surface=tool)
    positions, normals, tangents = (part.copy() for part in (state.positions, state.normals, state.tangents))
    free, held = ~old.held, old.held
    if held.any():
        laid, first = flat_start(knot.grid, tool), rest.trail[0]
        positions[held] = laid.positions[held]
        # The clamp holds the frames that it took in the first stroke.
        taken = laid if landing is first else flat_start(knot.grid, lowered(knot.punch, first.share))
        normals[held], tangents[held] = taken.normals[held], taken.tangents[held]
    across = normals_of(old.surface.gap(state.positions[free]))
    positions[free] = project(tool, positions[free], across)
    foreseen = None if past is None else past.foreseen(landing.times)
    moved = _moved(here.energy, knot, State(positions, normals, tangents, foreseen))
    # Where frames follow from the positions, the chart has them.
    followed_ = replace(kinematics.chart(moved.state).state, history=foreseen)
    return Moved(replace(moved.energy, kinematics=kinematics), followed_)


def released_at(rest: Equilibria, knot: Knot, formed: State) -> Moved:
    """The release at a knot before its unknowns follow: what is held has moved with the state it was formed to."""
    assert rest.released is not None
    assert rest.run.released is not None
    assert knot.case.release is not None
    held, state = rest.run.released.hold, rest.run.released.state
    places = followed(held, rest.run.formed.state.positions, formed.positions, knot.case.release, knot.grid)
    # What is free goes along with the formed grid, so that wires that yield do not flow on the way to their rest.
    along = replace(state, positions=state.positions + formed.positions - rest.run.formed.state.positions)
    return _moved(rest.released.energy, knot, _holding(along, held, replace(formed, positions=places)))


def released_at_all(rest: Equilibria, knots: Sequence[Knot], formed: Sequence[State]) -> list[Moved]:
    """The release at the knots after its unknowns have followed; of a grid that nothing holds the flat grid there."""
    if rest.released is None:
        assert rest.run.released is not None
        energy = freed_of(rest.run, rest.ready, rest.run.released.state)
        flat = rest.run.released.state
        steps = [np.column_stack((knot.grid.flat, flat.positions[:, 2])) for knot in knots]
        return [_moved(energy, knot, replace(flat, positions=at)) for knot, at in zip(knots, steps, strict=True)]
    moved = [released_at(rest, knot, state) for knot, state in zip(knots, formed, strict=True)]
    return [one.settled for one in _following(rest.released, moved, knots)]


def _following(rest: Rest, moved: Sequence[Moved], knots: Sequence[Knot]) -> list[Moved]:
    """The stage at the knots after its unknowns have followed the setting."""
    step = between(knots)
    rate = rest.follow([one.residual for one in moved], step)
    followed_ = [one.along(knot.offset * rate) for one, knot in zip(moved, knots, strict=True)]
    if rest.energy.bars.yielding is None:
        return followed_
    return [_settling(rest, one) for one in followed_]


def _settling(rest: Rest, moved: Moved) -> Moved:
    """A stage of wires that yield after it has come to rest, Eq. (13.29).

    At fixed unknowns a wire may flow that does not on the way that the grid goes: its first answer is a guess.
    """
    near, last = moved, np.inf
    for _ in range(PASSES):
        z = -rest.factor.solve(near.residual)
        size = max(rest.chart.size(z))
        if not size < SLOW * last:
            break
        near, last = near.along(z), size
        if size < AT_REST:
            return near
    # Sections have begun or ceased to yield: the old matrix does not know them.
    found = minimise(moved.energy, moved.state, tolerance=CLOSE, exact=True)
    if not found.outcome.usable:
        raise InputError.of("there are no tangents of this run: beside one of its numbers the grid finds no rest")
    return replace(moved, state=found.state)


def _moved(energy: Energy, knot: Knot, state: State) -> Moved:
    """A stage with grid, wires and crossings of a knot."""
    crossing, kinematics = knot.case.grid.crossing, energy.kinematics
    assert isinstance(kinematics, FreeFrames | Differences)
    there = replace(
        energy,
        grid=knot.grid,
        bars=knot.bars,
        kinematics=replace(kinematics, grid=knot.grid),
        crossing=crossing.stiffness if isinstance(crossing, CrossingSpring) else 0.0,
        recall=Recall(),
    )
    return Moved(there, state)


def _holding(state: State, held: Held, places: State) -> State:
    """The state with what is held where `places` has it, and with its past."""
    positions = np.where(held.held[:, None] | held.fixed, places.positions, state.positions)
    normals = np.where(held.held[:, None], places.normals, state.normals)
    tangents = np.where(held.held[:, None, None], places.tangents, state.tangents)
    return State(positions, normals, tangents, places.history)


def _strength(knot: Knot) -> float | None:
    """Where the wire yields; a tensile test says it itself."""
    hardening = knot.elements[0].hardening
    return knot.case.wire.yield_strength if hardening is None else hardening.yield_strength


def _ended(done: Solved, state: State) -> Solution:
    return Solution(state, Outcome.CONVERGED, (), done.steps, done.factorisations, 0, done.negative_eigenvalues)


def _formed(rest: Equilibria, knot: Knot, moved: Moved) -> Formed:
    down = Descent(moved.energy, _ended(rest.run.formed, moved.state), rest.run.formed.strokes, None)
    return formed_by(down, knot.elements, knot.punch, press_of(knot.case), _strength(knot))


def _released(rest: Equilibria, knot: Knot, moved: Moved, formed: Formed) -> Released:
    base = rest.run.released
    assert base is not None
    ended = _ended(base, moved.state)
    strength = _strength(knot)
    return released_by(moved.energy, ended, formed, knot.elements, base.hold, base.stability, strength)


def _loaded(rest: Equilibria, knots: Sequence[Knot], released: Sequence[Released | None]) -> tuple[Loaded, ...]:
    """The load at the knots: dead forces of the released state there, and what is held where that has it."""
    assert rest.loaded is not None
    assert rest.run.loaded is not None
    base, moved = rest.run.loaded, []
    for knot, freed in zip(knots, released, strict=True):
        assert freed is not None
        assert knot.case.load is not None
        lengths = tuple(element.wire_length for element in knot.elements)
        dead = forces(knot.grid, freed.state, knot.case.load, knot.case.wire, lengths)
        there = _moved(rest.loaded.energy, knot, _holding(base.state, freed.hold, freed.state))
        moved.append(replace(there, energy=replace(there.energy, loads=Loads(dead, freed.state.positions))))
    under_load = []
    for one, knot, freed in zip(_following(rest.loaded, moved, knots), knots, released, strict=True):
        one = one.settled
        assert freed is not None
        strength, linear = _strength(knot), knot.case.solver.linear
        ended = _ended(base, one.state)
        under_load.append(loaded_by(one.energy, ended, freed, knot.elements, knot.case.wire, strength, linear=linear))
    return tuple(under_load)


def _run(run: Run, knot: Knot, formed: Formed, released: Released | None, loaded: Loaded | None) -> Run:
    done = [stage for stage in (formed, released, loaded) if stage is not None]
    stages = tuple(Stage(old.kind, old.number, old.settings, new) for old, new in zip(run.stages, done, strict=False))
    return Run(knot.case, formed, released, loaded, None, run.notes, 0.0, stages)
