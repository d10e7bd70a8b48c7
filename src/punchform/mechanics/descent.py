"""The paper's minimisation P(18)-P(20): steps against the gradient, kept as the reference method.

`u <- u - lambda a` with a = dE/du, P(19) mended; to first order dE = -lambda aᵀa, P(20). Three ways to choose lambda:

* fixed            one lambda throughout;
* reuse-direction  the paper's trial: one direction until the energy grows, then a new one; lambda halves when the
                   first step along a new direction already raises the energy;
* exact            lambda = aᵀa / aᵀHa from the second derivatives, as the paper plans.

The unknowns are those of the kinematics, so that steep walls work too; at the apex they are the paper's u_x, u_y.
"""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.assembly import Energy, Hessian, Model
from punchform.mechanics.frames import State, is_finite
from punchform.mechanics.kinematics import Chart
from punchform.mechanics.linear import multiply, upper_matrix
from punchform.mechanics.outcome import Outcome, Solution, Step
from punchform.progress import Observer, Progress, silent

GRADIENT_RATIO = 1e-8
"""The descent counts as stationary when the gradient has fallen to this fraction of its first value."""
SHORTEST = 1e-12
"""Halvings of lambda below this fraction of its first value end the descent."""
REPORT_EVERY = 100
"""The history keeps the first so many steps, and from then on one in so many."""


def descend(
    energy: Energy,
    start: State,
    *,
    rule: str,
    step_length: float | None = None,
    max_steps: int = 20_000,
    stage: str = "press",
    observe: Observer = silent,
) -> Solution:
    """Follow the gradient from the start; `rule` is exact, fixed or reuse-direction, step_length is lambda [mm/N].

    Ends as STATIONARY (the method cannot tell a minimum), STEP_LIMIT, or NO_DESCENT when no lambda lowers the energy.
    """
    begun = perf_counter()
    steps = {
        "exact": _exact(energy, start),
        "fixed": _fixed(energy, start, step_length or 0.0),
        "reuse-direction": _reused(energy, start, step_length or 0.0),
    }[rule]
    history: list[Step] = []
    state, outcome, evaluations, first = start, Outcome.STEP_LIMIT, 0, np.inf
    for number in range(max_steps):
        taken = next(steps, None)
        if taken is None:
            outcome = Outcome.NO_DESCENT
            break
        state, value, size, length, cost = taken
        evaluations += cost
        first = size if number == 0 else first
        if number < REPORT_EVERY or number % REPORT_EVERY == 0 or size <= GRADIENT_RATIO * first:
            history.append(Step(number, value, size, float("nan"), length, "none"))
            observe(Progress(stage, number, value, size))
        if size <= GRADIENT_RATIO * first:
            outcome = Outcome.STATIONARY
            break
    return Solution(
        state=state,
        outcome=outcome,
        history=tuple(history),
        evaluations=evaluations,
        seconds={"total": perf_counter() - begun},
    )


_Taken = tuple[State, float, float, float, int]
"""State after a step, energy and largest gradient entry before it, lambda, gradients that it cost."""


def _largest(gradient: Floats) -> float:
    return float(np.abs(gradient).max(initial=0.0))


def _exact(energy: Energy, state: State) -> Iterator[_Taken]:
    while True:
        chart = energy.kinematics.chart(state)
        model = energy.model(chart, Hessian.EXACT)
        a = model.gradient
        length = float(a @ a) / _curvature(energy, chart, model, a)
        after = chart.moved(-length * a)
        while not _lower(energy, after, model.energy):
            length *= 0.5
            if length * float(a @ a) <= SHORTEST * abs(model.energy) * 1e-3:
                return
            after = chart.moved(-length * a)
        state = after
        yield state, model.energy, _largest(a), length, 1


def _curvature(energy: Energy, chart: Chart, model: Model, a: Floats) -> float:
    """aᵀHa of the exact Hessian where it is positive, else of its Gauss-Newton part."""
    along = float(a @ multiply(upper_matrix(energy.pattern, model.values), a))
    if along > 0:
        return along
    values = energy.model(chart, Hessian.GAUSS_NEWTON).values
    return max(float(a @ multiply(upper_matrix(energy.pattern, values), a)), 1e-300)


def _fixed(energy: Energy, state: State, length: float) -> Iterator[_Taken]:
    last = np.inf
    while True:
        chart = energy.kinematics.chart(state)
        model = energy.model(chart, Hessian.GAUSS_NEWTON)
        after = chart.moved(-length * model.gradient)
        if model.energy > last or not is_finite(after):
            return
        state, last = after, model.energy
        yield state, model.energy, _largest(model.gradient), length, 1


def _reused(energy: Energy, state: State, first: float) -> Iterator[_Taken]:
    length = first
    while length >= SHORTEST * first:
        chart = energy.kinematics.chart(state)
        model = energy.model(chart, Hessian.GAUSS_NEWTON)
        reached, value = 0, model.energy
        while _lower(energy, after := chart.moved(-(reached + 1) * length * model.gradient), value):
            reached, value, state = reached + 1, energy.at(after), after
            yield state, value, _largest(model.gradient), length, int(reached == 1)
        if reached == 0:
            length *= 0.5


def _lower(energy: Energy, state: State, value: float) -> bool:
    return is_finite(state) and energy.at(state) < value
