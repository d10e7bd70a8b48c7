"""What a mesh lets through, against an exact solution of round wires and the limits of the formula."""

from __future__ import annotations

import math

import pytest

from punchform.antenna import SPEED_OF_LIGHT, leak, leaks_above


@pytest.mark.parametrize(
    ("frequency", "reflected", "within"),
    [(1.0, 0.99825, 2e-4), (2.4, 0.99003, 6e-4), (4.0, 0.97282, 2e-3), (8.0, 0.89977, 8e-3), (12.0, 0.79961, 0.022)],
)
def test_round_wires_solved_exactly(frequency: float, reflected: float, within: float) -> None:
    """M1: |R| of wires of 0.75 mm at steps of 7.5 mm; the formula is the thin-wire, long-wave limit."""
    found = leak(7.5, 0.75, SPEED_OF_LIGHT / frequency)
    assert 10 ** (-found / 20) == pytest.approx(reflected, abs=within)


def test_the_leak_grows_with_the_square_of_the_frequency_at_first() -> None:
    assert leak(7.5, 0.75, 500.0) == pytest.approx(4 * leak(7.5, 0.75, 1000.0), rel=1e-2)
    assert leak(7.5, 0.5, 75.0) > leak(7.5, 0.75, 75.0)


def test_a_mesh_leaks_from_a_tenth_of_a_wavelength_on() -> None:
    assert leaks_above(7.5) == pytest.approx(4.0, rel=1e-2)
    assert math.isclose(SPEED_OF_LIGHT / leaks_above(10.0), 100.0)
