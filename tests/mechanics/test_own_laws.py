"""The checks of `punchform.testing` pass sound laws, and catch the mistakes that one makes in a law."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from small_grids import BLANK, PUNCH, Plane, energy_of, free_frames, grid, random_state

from punchform.mechanics.assembly import Energy
from punchform.mechanics.frames import State
from punchform.mechanics.newton import minimise
from punchform.start import flat_start
from punchform.testing import assert_derivatives, assert_equilibrium, assert_rigid_invariance, slope_and_curvature


def case() -> tuple[Energy, State]:
    laid = grid()
    energy = energy_of(free_frames(laid))
    return energy, random_state(energy.kinematics, laid, np.random.default_rng(0))


def test_a_sound_law_passes() -> None:
    energy, state = case()
    assert_derivatives(energy, state, rng=np.random.default_rng(1))
    assert_rigid_invariance(energy, state, rng=np.random.default_rng(1))


def test_a_stiffness_that_is_not_symmetric_has_no_energy() -> None:
    # F = C D is the gradient of ½ D C D only for a symmetric C, P(5)-(7).
    energy, state = case()
    C = energy.bars.C.copy()
    C[:, 0, 4] *= 1.01
    skew = replace(energy, bars=replace(energy.bars, C=C))
    with pytest.raises(AssertionError, match="the gradient along a direction"):
        assert_derivatives(skew, state, rng=np.random.default_rng(1))


@dataclass(frozen=True)
class Heavy(Energy):
    """Wires with a weight, whose gradient was forgotten."""

    def springs(self, state: State) -> float:
        return float(state.positions[:, 2].sum())


def test_an_energy_without_its_gradient_is_caught() -> None:
    energy, state = case()
    heavy = Heavy(energy.grid, energy.bars, energy.kinematics)
    with pytest.raises(AssertionError, match="the gradient along a direction"):
        assert_derivatives(heavy, state, rng=np.random.default_rng(1))


def test_an_energy_that_knows_up_from_down_is_not_invariant() -> None:
    energy, state = case()
    heavy = Heavy(energy.grid, energy.bars, energy.kinematics)
    with pytest.raises(AssertionError, match="the energy of the turned grid"):
        assert_rigid_invariance(heavy, state, rng=np.random.default_rng(1))


def test_unknowns_without_stiffness_are_counted() -> None:
    energy, state = case()
    weightless = replace(energy, bars=replace(energy.bars, C=0 * energy.bars.C))
    with pytest.raises(AssertionError, match=f"{energy.kinematics.count} unknowns carry no stiffness"):
        assert_derivatives(weightless, state, rng=np.random.default_rng(1))


def test_equilibrium_is_told_from_its_neighbourhood() -> None:
    laid = grid(BLANK)
    energy = energy_of(free_frames(laid, PUNCH))
    answer = minimise(energy, flat_start(laid, PUNCH), tolerance=1e-18).state
    assert_equilibrium(energy, answer, tolerance=1e-15)
    chart = energy.kinematics.chart(answer)
    near = chart.moved(1e-4 * np.random.default_rng(0).uniform(-1, 1, energy.kinematics.count))
    with pytest.raises(AssertionError, match="no equilibrium: a Newton step would still gain"):
        assert_equilibrium(energy, near)


def test_a_grid_that_nothing_holds_is_in_no_equilibrium_one_could_check() -> None:
    laid = grid()
    energy = energy_of(free_frames(laid, Plane()))
    nothing = replace(energy, bars=replace(energy.bars, C=0 * energy.bars.C))
    with pytest.raises(AssertionError, match="singular"):
        assert_equilibrium(nothing, flat_start(laid, Plane()))


def test_slope_and_curvature_are_exact_to_ten_digits() -> None:
    for function, slope, curvature in (
        (np.exp, 1.0, 1.0),
        (lambda x: np.sin(3 * x + 1), 3 * np.cos(1), -9 * np.sin(1)),
        (lambda x: (1 + x) ** 5, 5.0, 20.0),
        (lambda x: 1 / (2 - x), 0.25, 0.25),
    ):
        found = slope_and_curvature(function, 0.3)
        assert found == pytest.approx((slope, curvature), rel=1e-9)


def test_slope_and_curvature_take_arrays() -> None:
    v = np.array([[1.0, -2.0], [0.5, 3.0]])
    slope, curvature = slope_and_curvature(lambda x: np.exp(v * x), 0.2)
    np.testing.assert_allclose(slope, v, rtol=1e-10)
    np.testing.assert_allclose(curvature, v**2, rtol=1e-9)
