"""What beats what, and what a surrogate foretells."""

from __future__ import annotations

import numpy as np
import pytest

from punchform.optimise.pareto import gain, push, undominated
from punchform.optimise.surrogate import surrogate


@pytest.mark.parametrize("seed", range(5))
def test_the_front_is_what_nothing_dominates(seed: int) -> None:
    """Eq. (13.40), row by row."""
    objectives = np.random.default_rng(seed).integers(0, 6, size=(40, 3)).astype(float)
    free = undominated(objectives)
    for row, one in enumerate(objectives):
        beaten = any((other <= one).all() and (other < one).any() for other in objectives)
        earlier = any((other == one).all() for other in objectives[:row])
        assert free[row] == (not beaten and not earlier)


def test_gain_and_push_by_hand() -> None:
    """Eq. (13.41) on a front of two designs."""
    front = np.array([[0.0, 2.0], [2.0, 0.0]])
    candidates = np.array([[1.0, 1.0], [3.0, 3.0], [-0.5, 1.9], [0.0, 2.0]])
    np.testing.assert_allclose(gain(candidates, front), [1.0, -1.0, 0.5, 0.0])
    np.testing.assert_allclose(push(candidates, front), [-1.0, -3.0, 0.1, 0.0], atol=1e-12)


def test_only_what_dominates_pushes_and_what_gains_is_not_dominated() -> None:
    rng = np.random.default_rng(7)
    front, candidates = rng.random((20, 3)), rng.random((200, 3))
    front = front[undominated(front)]
    beats = np.array([any((one < old).all() for old in front) for one in candidates])
    beaten = np.array([any((old < one).all() for old in front) for one in candidates])
    np.testing.assert_array_equal(push(candidates, front) > 0, beats)
    np.testing.assert_array_equal(gain(candidates, front) < 0, beaten)


def test_a_surrogate_keeps_what_is_known_and_is_exact_for_lines() -> None:
    rng = np.random.default_rng(1)
    x, elsewhere = rng.random((25, 3)), rng.random((50, 3))
    bent = np.sin(3 * x[:, 0]) + x[:, 1] * x[:, 2]
    np.testing.assert_allclose(surrogate(x, bent)(x), bent, atol=1e-9)
    line = np.array([1.0, -2.0, 0.5])
    np.testing.assert_allclose(surrogate(x, x @ line)(elsewhere), elsewhere @ line, atol=1e-8)


@pytest.mark.parametrize("power", [-4.0, 2.0])
def test_a_power_law_is_a_line_on_its_scale(power: float) -> None:
    """Compliance falls by decades with the diameter: foretold on the scale of logarithms."""
    x = np.linspace(0, 1, 9)[:, None]
    law = np.exp(power * x[:, 0])
    between = np.linspace(0, 1, 31)[:, None]
    np.testing.assert_allclose(surrogate(x, law)(between), np.exp(power * between[:, 0]), rtol=1e-8)


def test_the_root_of_a_sum_of_squares_is_foretold_by_its_square() -> None:
    """An rms has a kink where it vanishes; its square has none."""
    x = np.linspace(0, 1, 12)[:, None]
    rms = np.abs(x[:, 0] - 0.47)
    between = np.linspace(0, 1, 100)[:, None]
    guess = surrogate(x, rms)(between)
    assert np.abs(guess - np.abs(between[:, 0] - 0.47)).max() < 0.02


def test_what_is_left_out_is_foretold_as_by_an_interpolant_without_it() -> None:
    """Eq. (13.43), the closed form, against interpolants of all but one."""
    rng = np.random.default_rng(3)
    x = rng.random((15, 2))
    values = 1 - np.cos(2 * x[:, 0]) + x[:, 1] ** 2 - 2.0
    whole = surrogate(x, values)
    missed = []
    for row in range(len(x)):
        rest = np.delete(np.arange(len(x)), row)
        stretched = x * whole.stretch
        tail = np.column_stack((np.ones(len(x)), stretched))
        kernel = np.linalg.norm(stretched[:, None] - stretched[None], axis=2) ** 3
        system = np.block([[kernel[np.ix_(rest, rest)], tail[rest]], [tail[rest].T, np.zeros((3, 3))]])
        weights = np.linalg.solve(system, np.concatenate((values[rest], np.zeros(3))))
        guess = np.concatenate((kernel[row, rest], tail[row])) @ weights
        missed.append(abs(np.clip(guess, values.min(), values.max()) - values[row]))
    assert whole.missed == pytest.approx(np.mean(missed), rel=1e-6)
