"""The stages of a run at rest: what their tangents and adjoints begin with.

Each is its energy, the unknowns around its state, and its Hessian, factored once. Where wires yield every stroke of the
press is a stage of its own, and the press is done once more to know where each ended.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from punchform.arrays import Floats
from punchform.case import Case, PressCase
from punchform.errors import InputError
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import Chart
from punchform.mechanics.linear import Factor, solver_for
from punchform.optimise.knots import slope
from punchform.prepare import Prepared, prepare
from punchform.press import energy_of, press
from punchform.punch import lowered
from punchform.release import free_energy
from punchform.run import Run


@dataclass(frozen=True)
class Rest:
    """A stage at rest: its energy, the unknowns around its state, and the factored Hessian."""

    energy: Energy
    chart: Chart
    factor: Factor

    def follow(self, residuals: Sequence[Floats], step: float) -> Floats:
        """The rate dz/dp of the unknowns (n,) from the gradients at the knots, Eq. (13.21)."""
        return -self.factor.solve(slope(residuals, step))


@dataclass(frozen=True)
class Landing:
    """The end of a stroke: at a share of the depth, in a state whose past is that of the strokes before, foreseen to go
    on `times` as far as the last, Eq. (12.18)."""

    share: float
    state: State
    times: float


@dataclass(frozen=True)
class Equilibria:
    """A run and its stages at rest; `released` and `loaded` are None where there is no such stage or nothing held.

    trail: the strokes whose past matters, the last of which ends where `pressed` rests.
    """

    run: Run
    ready: Prepared
    trail: tuple[Landing, ...]
    pressed: Rest
    released: Rest | None
    loaded: Rest | None

    @property
    def factorisations(self) -> int:
        """How many matrices must be factored for all of this."""
        return len(self.trail) + sum(rest is not None for rest in (self.released, self.loaded))

    @property
    def remembers(self) -> bool:
        """Whether the strokes depend on their past."""
        return self.run.case.wire.yields

    def rest_at(self, landing: Landing) -> Rest:
        """The press at the end of a stroke."""
        if landing is self.trail[-1]:
            return self.pressed
        return _rest_of_press(self.run.case, self.ready, landing)


def why_not(run: Run, ready: Prepared | None = None) -> str:
    """Why the equilibria of a run cannot be followed by their tangents; empty when they can.

    ready: what its case was prepared to, where that is at hand.
    """
    case = run.case
    kinds = [stage.kind for stage in run.stages]
    released = run.released
    if case.press.hold is not None:
        return "a blank holder brakes the flange, so that every stroke depends on those before it"
    if case.press.pull is not None:
        return "the pull follows the wire ends and has no energy"
    if case.press.method != "newton":
        return "the descent ends before the minimum"
    if kinds != ["press", "release", "load"][: len(kinds)]:
        return "the grid goes through stages other than one press, one release and one load"
    if any(stage.settings != getattr(case, stage.kind) for stage in run.stages):
        return "a stage has settings of its own"
    if run.accuracy is not None and run.accuracy.surface.offset:
        return "the shape is judged by the middle of its wires, which lies above its nodes and moves with the wire"
    if released is not None and not released.hold.count and case.wire.yields:
        return "nothing holds the released grid, which keeps what has flowed and may lie anywhere"
    if released is not None and released.grid.nodes != run.formed.grid.nodes:
        return "the release leaves the mirror planes of the press"
    if (
        released is not None
        and released.hold.count
        and freed_of(run, ready or prepare(case), released.state).kinematics.pins
    ):
        return "what is held leaves the released grid free to move as a whole"
    return ""


def equilibria(run: Run) -> Equilibria:
    """The stages of a run at rest, each factored once. Raises InputError where `why_not` finds a reason."""
    ready = prepare(run.case)
    reason = why_not(run, ready)
    if reason:
        raise InputError.of(f"there are no tangents of this run: {reason}")
    released = run.released
    trail = _trail(run, ready)
    return Equilibria(
        run,
        ready,
        trail,
        _rest_of_press(run.case, ready, trail[-1]),
        None if released is None or released.hold.count == 0 else _rest_of_release(run, ready),
        None if run.loaded is None else _rest_of_load(run, ready),
    )


def _trail(run: Run, ready: Prepared) -> tuple[Landing, ...]:
    """The strokes of the press, which is done once more where they have a past; else only where it ended."""
    if not run.case.wire.yields:
        return (Landing(1.0, run.formed.state, 0.0),)
    case, states = run.case, list[State]()

    def settle(energy: Energy, state: State) -> State:
        states.append(state)
        return energy.settled(state)

    again = press(
        ready.grid,
        ready.elements,
        ready.punch,
        press_of(case),
        crossing=case.grid.crossing,
        solver=case.solver,
        settle=settle,
    )
    shares = (0.0, *(stroke.share for stroke in again.strokes))
    times = [0.0] + [(shares[k + 1] - shares[k]) / (shares[k] - shares[k - 1]) for k in range(1, len(states))]
    return tuple(Landing(*landed) for landed in zip(shares[1:], states, times, strict=True))


def _rest(energy: Energy, state: State, linear: str) -> Rest:
    chart = energy.kinematics.chart(state)
    values = energy.model(chart, Hessian.EXACT).values
    return Rest(energy, chart, solver_for(energy.pattern, linear).factor(values))


def _rest_of_press(case: Case, ready: Prepared, landing: Landing) -> Rest:
    tool, state = lowered(ready.punch, landing.share), landing.state
    energy = energy_of(ready.grid, ready.elements, tool, press_of(case), crossing=case.grid.crossing, start=state)
    return _rest(energy, state, case.solver.linear)


def _rest_of_release(run: Run, ready: Prepared) -> Rest:
    assert run.released is not None
    # As it was sought: with the past that the press has left.
    state = replace(run.released.state, history=run.formed.state.history)
    return _rest(freed_of(run, ready, state), state, run.case.solver.linear)


def _rest_of_load(run: Run, ready: Prepared) -> Rest:
    assert run.released is not None
    assert run.loaded is not None
    state = replace(run.loaded.state, history=run.released.state.history)
    return _rest(freed_of(run, ready, state), state, run.case.solver.linear)


def freed_of(run: Run, ready: Prepared, state: State) -> Energy:
    assert run.released is not None
    case = run.case
    return free_energy(
        ready.grid, ready.elements, press_of(case), run.released.hold, state, crossing=case.grid.crossing
    )


def press_of(case: Case) -> PressCase:
    """The settings of the press with the frame that the wire asks for."""
    return case.framed(case.press)
