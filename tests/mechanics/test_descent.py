"""The paper's descent, P(18)-P(20): downhill with every rule, towards Newton's answer, and honest about its end."""

from __future__ import annotations

import numpy as np
import pytest
from small_grids import BLANK, PUNCH, differences, energy_of, free_frames, grid

from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.descent import descend
from punchform.mechanics.frames import State
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome
from punchform.progress import Progress
from punchform.start import flat_start

SHORT = 1e-5
"""A lambda [mm/N] below 2 over the largest eigenvalue of the Hessian of these grids."""
RULES = [("exact", None), ("fixed", SHORT), ("reuse-direction", 1e-3)]


@pytest.fixture(params=["free", "differences"])
def case(request: pytest.FixtureRequest) -> tuple[Energy, State]:
    laid = grid(3.2 * 10.0)
    kinematics = free_frames(laid, PUNCH) if request.param == "free" else differences(laid, PUNCH)
    return energy_of(kinematics), flat_start(laid, PUNCH)


@pytest.mark.parametrize(("rule", "length"), RULES)
def test_every_step_lowers_the_energy(case: tuple[Energy, State], rule: str, length: float | None) -> None:
    energy, start = case
    solution = descend(energy, start, rule=rule, step_length=length, max_steps=90)
    energies = np.array([step.energy for step in solution.history])
    assert solution.outcome is Outcome.STEP_LIMIT
    assert len(energies) == 90
    assert (np.diff(energies) < 0).all()
    assert energy.at(solution.state) <= energies[-1]


@pytest.mark.parametrize(("rule", "length"), RULES)
def test_the_history_begins_with_the_energy_of_the_start(
    case: tuple[Energy, State], rule: str, length: float | None
) -> None:
    energy, start = case
    first = descend(energy, start, rule=rule, step_length=length, max_steps=3).history[0]
    assert first.number == 0
    model_energy = energy.at(energy.kinematics.chart(start).state)
    assert first.energy == pytest.approx(model_energy, rel=1e-12)
    assert np.isnan(first.decrement)


def test_the_gain_of_a_short_step_is_that_of_the_paper(case: tuple[Energy, State]) -> None:
    # P(20): dE = - lambda aᵀa, to first order in lambda.
    energy, start = case
    chart = energy.kinematics.chart(start)
    a = energy.model(chart, Hessian.GAUSS_NEWTON).gradient
    for length in (1e-10, 1e-11):
        after = descend(energy, start, rule="fixed", step_length=length, max_steps=1).state
        gained = energy.at(chart.state) - energy.at(after)
        assert gained == pytest.approx(length * float(a @ a), rel=1e6 * length + 1e-5)


@pytest.mark.parametrize(("rule", "length"), [("exact", None), ("reuse-direction", 1e-3)])
def test_the_descent_approaches_newtons_energy_from_above(
    case: tuple[Energy, State], rule: str, length: float | None
) -> None:
    energy, start = case
    least = energy.at(minimise(energy, start).state)
    above = [
        energy.at(descend(energy, start, rule=rule, step_length=length, max_steps=steps).state) / least - 1
        for steps in (10, 60, 250)
    ]
    assert above[0] > above[1] >= above[2] > -1e-12
    assert above[2] < 1e-4


@pytest.mark.parametrize(("rule", "length"), [("exact", None), ("reuse-direction", 1e-3)])
def test_a_descent_that_reached_the_minimum_says_that_it_is_stationary(
    case: tuple[Energy, State], rule: str, length: float | None
) -> None:
    # Energies that differ by rounding cannot be told apart: at the bottom no step lowers it any more.
    energy, start = case
    bottom = minimise(energy, start, tolerance=1e-18).state
    solution = descend(energy, bottom, rule=rule, step_length=length, max_steps=50)
    assert energy.at(solution.state) == pytest.approx(energy.at(bottom), rel=1e-12)
    assert solution.outcome is Outcome.STATIONARY


@pytest.mark.parametrize("length", [1e-4, 1e-3, 1.0])
def test_a_lambda_that_is_too_long_never_leaves_the_grid_with_more_energy_than_the_start(
    case: tuple[Energy, State], length: float
) -> None:
    energy, start = case
    before = energy.at(energy.kinematics.chart(start).state)
    solution = descend(energy, start, rule="fixed", step_length=length, max_steps=50)
    assert solution.outcome is Outcome.NO_DESCENT
    # The answer has the frames of its kinematics, also when it is the start.
    assert energy.at(solution.state) <= before * (1 + 1e-12)


def test_reuse_direction_shortens_a_lambda_that_is_too_long(case: tuple[Energy, State]) -> None:
    energy, start = case
    solution = descend(energy, start, rule="reuse-direction", step_length=1.0, max_steps=60)
    lengths = [step.length for step in solution.history]
    assert lengths[0] < 1e-2
    assert (np.diff(lengths) <= 0).all()
    np.testing.assert_allclose(np.log2(lengths), np.round(np.log2(lengths)), atol=1e-12)


def test_a_long_history_is_thinned_out_and_seen_by_the_observer() -> None:
    laid = grid(BLANK)
    energy, start = energy_of(free_frames(laid, PUNCH)), flat_start(laid, PUNCH)
    seen: list[Progress] = []
    solution = descend(energy, start, rule="fixed", step_length=SHORT, max_steps=301, observe=seen.append)
    numbers = [step.number for step in solution.history]
    assert numbers[:100] == list(range(100))
    assert numbers[100:] == [100, 200, 300]
    assert [event.step for event in seen] == numbers
