"""Newton's method on the sparse Hessian: the production method of docs/theory.md, section 5.

The Gauss-Newton part of the Hessian, which is never indefinite, while steps are cut or the model is poor; the exact
one near the answer. Where that has a few negative eigenvalues, their modes are turned round so that the step leads
downhill in them too, and the grid is pushed along them: so a saddle is left, not approached. The step length follows
Armijo's rule on the energy, a step is capped at a few grid steps and half a radian. The last factorisation, of the
exact Hessian, tells whether the answer is a minimum.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.assembly import Energy, Hessian, Model
from punchform.mechanics.buckling import negative_modes
from punchform.mechanics.frames import State, is_finite
from punchform.mechanics.kinematics import Chart
from punchform.mechanics.linear import Factor, SingularMatrix, Solver, solver_for
from punchform.mechanics.outcome import Outcome, Solution, Step
from punchform.progress import Observer, Progress, silent

ARMIJO = 1e-4
SHORTEST = 2.0**-20
"""The shortest fraction of a step that is tried."""
LARGEST_TURN = 0.5
"""Cap of a step's rotations [rad]."""
FIRST_PUSH, LEAST_PUSH = 1e-3, 1e-6
"""First and least push along a mode of negative curvature: rotation [rad], or shift in grid steps."""
MOST_MODES = 8
"""With more negative eigenvalues than this the exact Hessian is left for its convex part."""
GRID_STEPS = 4.0
"""Cap of a step's shifts, in grid steps."""
GOOD_MODEL = 0.05
"""The exact Hessian is used after a full step whose gain was this near, relatively, to what the model foretold ..."""
NEAR = 1e-2
"""... or whose decrement was below this fraction of the energy."""


@dataclass
class _Tally:
    """What a solve counts as it goes."""

    history: list[Step] = field(default_factory=list)
    factorisations: int = 0
    evaluations: int = 0
    factorisation: float = 0.0
    solve: float = 0.0


@dataclass(frozen=True)
class _Direction:
    """A Newton direction with what it promises; push (n, k): modes of negative curvature as columns."""

    z: Floats
    decrement: float
    hessian: Hessian
    negative: int | None
    push: Floats | None = None


def minimise(
    energy: Energy,
    start: State,
    *,
    max_steps: int = 200,
    tolerance: float = 1e-12,
    linear: str = "auto",
    stage: str = "press",
    exact: bool = False,
    scale: float = 0.0,
    observe: Observer = silent,
) -> Solution:
    """The minimum of the energy nearest to the start.

    tolerance: the solve ends when the Newton decrement, Eq. (5.1), falls below this fraction of the energy; the step
    that belongs to it is still taken. exact: begin with the exact Hessian, as from an equilibrium that changes
    little. scale: an energy that is large here, as that before the tool left [mJ]: a grid that springs back to
    nothing is done when it has lost all of it. Never raises for a solve that fails: `Solution.outcome` says how it
    ended.
    """
    begun = perf_counter()
    solver = solver_for(energy.pattern, linear)
    tally = _Tally()
    state, near, outcome, negative, largest = start, False, Outcome.STEP_LIMIT, None, scale
    for number in range(max_steps):
        chart = energy.kinematics.chart(state)
        try:
            model, direction = _direction(energy, chart, solver, exact, near, tally)
        except SingularMatrix:
            outcome = Outcome.SINGULAR
            break
        negative = direction.negative
        largest = max(largest, model.size)
        least = max(tolerance * model.size, tolerance**2 * largest, _smallest_energy(energy))
        if direction.decrement <= least and exact and direction.push is None:
            state, length = _last_step(energy, chart, model, direction), 1.0
            outcome = _ending(direction)
            _record(tally, number, model, direction, length, observe, stage)
            break
        after, length, gained = _search(energy, chart, model, direction, tally)
        _record(tally, number, model, direction, length, observe, stage)
        if after is None:
            outcome = Outcome.NO_DESCENT
            break
        if direction.decrement <= least and exact and gained <= model.rounding:
            outcome = Outcome.SADDLE
            break
        state = after
        promised = 2 * direction.decrement * length * (1 - 0.5 * length)
        near = direction.decrement <= NEAR * model.size
        exact = near or (length == 1.0 and abs(gained - promised) <= GOOD_MODEL * promised)
    return Solution(
        state=state,
        outcome=outcome,
        history=tuple(tally.history),
        steps=len(tally.history),
        factorisations=tally.factorisations,
        evaluations=tally.evaluations,
        negative_eigenvalues=negative,
        linear_solver=solver.name,
        seconds=_split(energy, tally, perf_counter() - begun),
    )


def _direction(
    energy: Energy, chart: Chart, solver: Solver, exact: bool, near: bool, tally: _Tally
) -> tuple[Model, _Direction]:
    """The Newton direction: of the exact Hessian if it is asked for, of its convex part where it is indefinite.

    Near the answer a few modes of negative curvature are turned round instead: there they are worth their solves.
    """
    kind = Hessian.EXACT if exact else Hessian.GAUSS_NEWTON
    model = energy.model(chart, kind)
    factor = _factor(solver, model, tally)
    negative = factor.negative if exact else None
    modes = None
    if near and negative and negative <= MOST_MODES:
        begun = perf_counter()
        modes = negative_modes(factor, negative)
        tally.solve += perf_counter() - begun
    if negative and modes is None:
        kind = Hessian.PROJECTED
        # A factor can be most of the memory: let it go before the next is made.
        del factor
        model = energy.model(chart, kind)
        factor = _factor(solver, model, tally)
    begun = perf_counter()
    z = factor.solve(-model.gradient)
    if modes is not None:
        z = modes.downhill(z, model.gradient)
    tally.solve += perf_counter() - begun
    return model, _Direction(
        z,
        decrement=-0.5 * float(model.gradient @ z),
        hessian=kind,
        negative=negative,
        push=None if modes is None else modes.shapes,
    )


def _factor(solver: Solver, model: Model, tally: _Tally) -> Factor:
    begun = perf_counter()
    factor = solver.factor(model.values)
    tally.factorisation += perf_counter() - begun
    tally.factorisations += 1
    return factor


def _search(
    energy: Energy, chart: Chart, model: Model, direction: _Direction, tally: _Tally
) -> tuple[State | None, float, float]:
    """The first state along the direction that satisfies Armijo's rule, its fraction, and the energy gained."""
    shift, turned = chart.size(direction.z)
    cap = GRID_STEPS * max(energy.grid.step)
    length = min(1.0, cap / max(shift, 1e-300), LARGEST_TURN / max(turned, 1e-300))
    slope = 2 * direction.decrement
    while length >= SHORTEST:
        after = chart.moved(length * direction.z)
        tally.evaluations += 1
        energy_after = energy.at(after) if is_finite(after) else np.inf
        gained = model.energy - energy_after
        if gained >= ARMIJO * length * slope - model.rounding:
            if direction.push is not None:
                after, energy_after = _pushed(energy, chart, direction, length, energy_after, tally)
            return after, length, model.energy - energy_after
        length *= _shortened(length, slope, gained)
    return None, 0.0, 0.0


def _pushed(
    energy: Energy, chart: Chart, direction: _Direction, length: float, reached: float, tally: _Tally
) -> tuple[State, float]:
    """The lowest state beyond the step along each mode of negative curvature, by doubling, and its energy."""
    assert direction.push is not None
    best = length * direction.z
    for mode in direction.push.T:
        shift, turned = chart.size(mode)
        unit = 1.0 / max(shift / max(energy.grid.step), turned, 1e-300)
        for sign in (1.0, -1.0):
            reach, further = FIRST_PUSH, best
            while LEAST_PUSH <= reach <= LARGEST_TURN:
                trial = best + sign * reach * unit * mode
                after = chart.moved(trial)
                tally.evaluations += 1
                lower = energy.at(after) if is_finite(after) else np.inf
                if lower < reached:
                    further, reached = trial, lower
                    reach *= 2.0
                elif further is best:
                    reach *= 0.1
                else:
                    break
            if further is not best:
                best = further
                break
    return chart.moved(best), reached


def _shortened(length: float, slope: float, gained: float) -> float:
    """Factor on the length: the minimum of the parabola through what is known, between 0.1 and 0.5."""
    if not np.isfinite(gained):
        return 0.25
    return float(np.clip(0.5 * slope * length / (slope * length - gained), 0.1, 0.5))


def _last_step(energy: Energy, chart: Chart, model: Model, direction: _Direction) -> State:
    """The state after the step that belongs to a converged decrement, unless rounding spoils it."""
    after = chart.moved(direction.z)
    worse = energy.at(after) > model.energy + model.rounding
    return chart.state if worse or not is_finite(after) else after


def _ending(direction: _Direction) -> Outcome:
    if direction.negative:
        return Outcome.SADDLE
    return Outcome.CONVERGED if direction.negative == 0 else Outcome.STATIONARY


def _smallest_energy(energy: Energy) -> float:
    """An energy that is zero for every purpose: strains of 1e-12 in one element."""
    return float(1e-24 * (energy.bars.C[:, 0, 0] * energy.bars.length**2).max())


def _record(
    tally: _Tally,
    number: int,
    model: Model,
    direction: _Direction,
    length: float,
    observe: Observer,
    stage: str,
) -> None:
    gradient = float(np.abs(model.gradient).max(initial=0.0))
    relative = direction.decrement / model.size if model.size else 0.0
    tally.history.append(Step(number, model.energy, gradient, relative, length, direction.hessian.words))
    observe(Progress(stage, number, model.energy, gradient))


def _split(energy: Energy, tally: _Tally, total: float) -> dict[str, float]:
    known = {
        "kernel": energy.clock.kernel,
        "assembly": energy.clock.assembly,
        "factorisation": tally.factorisation,
        "solve": tally.solve,
    }
    return known | {"other": max(total - sum(known.values()), 0.0), "total": total}
