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
from dataclasses import dataclass
from itertools import islice
from time import perf_counter

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.assembly import Energy, Hessian, Model
from punchform.mechanics.frames import State, is_finite
from punchform.mechanics.kinematics import Chart
from punchform.mechanics.linear import multiply, upper_matrix
from punchform.mechanics.outcome import Outcome, Solution, Step
from punchform.progress import Observer, Progress, silent

STILL = 1e-12
"""The descent is stationary when its best step would gain less than this fraction of the energy."""
SHORTEST = 2.0**-40
"""Halvings of lambda below this fraction of its first value end the descent."""
REPORT_EVERY = 100
"""The history keeps the first so many steps, and from then on one in so many."""


@dataclass(frozen=True)
class _Taken:
    """One step: the energy and gradient before it, lambda, the state after it, and how many gradients it cost."""

    energy: float
    gradient: Floats
    length: float
    after: State
    gradients: int = 1


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
    # The kinematics may have frames of its own for these positions.
    start = energy.kinematics.chart(start).state
    taken = {
        "exact": _exact(energy, start),
        "fixed": _fixed(energy, start, step_length or 0.0),
        "reuse-direction": _reused(energy, start, step_length or 0.0),
    }[rule]
    history: list[Step] = []
    state, gradients, steps, outcome = start, 0, 0, Outcome.STEP_LIMIT
    for step in islice(taken, max_steps):
        state, gradients = step.after, gradients + step.gradients
        if steps < REPORT_EVERY or steps % REPORT_EVERY == 0:
            history.append(_as_step(steps, step))
            observe(Progress(stage, steps, step.energy, history[-1].gradient))
        steps += 1
    if steps and history[-1].number != steps - 1:
        history.append(_as_step(steps - 1, step))
    if steps < max_steps:
        outcome = Outcome.STATIONARY if _is_still(energy, state) else Outcome.NO_DESCENT
    return Solution(
        state=state,
        outcome=outcome,
        history=tuple(history),
        steps=steps,
        evaluations=gradients,
        seconds={"total": perf_counter() - begun},
    )


def _as_step(number: int, taken: _Taken) -> Step:
    largest = float(np.abs(taken.gradient).max(initial=0.0))
    return Step(number, taken.energy, largest, float("nan"), taken.length, "none")


def _exact(energy: Energy, state: State) -> Iterator[_Taken]:
    while True:
        chart = energy.kinematics.chart(state)
        model = energy.model(chart, Hessian.EXACT)
        length = first = _best_length(energy, chart, model)
        while not _lower(energy, after := chart.moved(-length * model.gradient), model.energy):
            length *= 0.5
            if length < SHORTEST * first:
                return
        state = after
        yield _Taken(model.energy, model.gradient, length, state)


def _best_length(energy: Energy, chart: Chart, model: Model) -> float:
    """lambda = aᵀa / aᵀHa with the exact Hessian where aᵀHa is positive, else with its Gauss-Newton part."""
    a = model.gradient
    along = float(a @ multiply(upper_matrix(energy.pattern, model.values), a))
    if along <= 0:
        values = energy.model(chart, Hessian.GAUSS_NEWTON).values
        along = float(a @ multiply(upper_matrix(energy.pattern, values), a))
    return float(a @ a) / max(along, 1e-300)


def _fixed(energy: Energy, state: State, length: float) -> Iterator[_Taken]:
    while True:
        chart = energy.kinematics.chart(state)
        model = energy.gradient(chart)
        after = chart.moved(-length * model.gradient)
        if not _lower(energy, after, model.energy):
            return
        state = after
        yield _Taken(model.energy, model.gradient, length, state)


def _reused(energy: Energy, state: State, first: float) -> Iterator[_Taken]:
    length = first
    while length >= SHORTEST * first:
        chart = energy.kinematics.chart(state)
        model = energy.gradient(chart)
        reached, value = 0, model.energy
        while _lower(energy, after := chart.moved(-(reached + 1) * length * model.gradient), value):
            reached, state = reached + 1, after
            yield _Taken(value, model.gradient, length, state, gradients=int(reached == 1))
            value = energy.at(after)
        if reached == 0:
            length *= 0.5


def _lower(energy: Energy, state: State, value: float) -> bool:
    return is_finite(state) and energy.at(state) < value


def _is_still(energy: Energy, state: State) -> bool:
    """Whether the best step along the gradient would gain next to nothing: ½ lambda aᵀa with the exact lambda."""
    chart = energy.kinematics.chart(state)
    model = energy.model(chart, Hessian.EXACT)
    gain = 0.5 * _best_length(energy, chart, model) * float(model.gradient @ model.gradient)
    return gain <= STILL * model.size
