"""Ruze's loss against published figures, and with the scattered part against averages of physical optics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from punchform.antenna import (
    SPEED_OF_LIGHT,
    error_for_loss,
    gain_with_scatter,
    highest_frequency,
    loss,
    wavelength_for_loss,
)
from punchform.arrays import Floats


def test_the_factor() -> None:
    """R1."""
    assert loss(1.0, 1.0) == pytest.approx(685.8104, abs=5e-5)


def test_published_losses() -> None:
    """R2: Katow and Guiar, 0.63 mm made 0.15 mm at 8.42 GHz; R3: a spun dish, 0.020 in at 24 GHz."""
    wavelength = SPEED_OF_LIGHT / 8.42
    assert loss(0.63, wavelength) - loss(0.15, wavelength) == pytest.approx(0.2025, abs=5e-5)
    assert loss(0.020 * 25.4, SPEED_OF_LIGHT / 24) == pytest.approx(1.134, abs=5e-4)


@pytest.mark.parametrize(
    ("part", "decibel"), [(16, 2.679), (20, 1.715), (25, 1.097), (30, 0.762), (32, 0.670), (40, 0.429), (50, 0.274)]
)
def test_losses_of_parts_of_a_wavelength(part: int, decibel: float) -> None:
    """R4."""
    assert loss(1.0, part) == pytest.approx(decibel, abs=5e-4)


@pytest.mark.parametrize(
    ("decibel", "part"),
    [(0.05, 117.1), (0.1, 82.8), (0.2, 58.6), (0.25, 52.4), (0.5, 37.0), (1, 26.2), (2, 18.5), (3, 15.1)],
)
def test_parts_of_a_wavelength_for_a_loss(decibel: float, part: float) -> None:
    """R4, inverted."""
    assert 1 / error_for_loss(decibel, 1.0) == pytest.approx(part, abs=0.05)
    assert wavelength_for_loss(0.4, decibel) == pytest.approx(0.4 * part, abs=0.02)
    assert loss(0.4, SPEED_OF_LIGHT / highest_frequency(0.4, decibel)) == pytest.approx(decibel, rel=1e-12)


def test_a_perfect_reflector_works_at_any_frequency() -> None:
    assert highest_frequency(0.0, 0.5) == math.inf
    assert loss(0.0, 25.0) == 0.0


RADIUS, FOCAL_LENGTH, WAVELENGTH = 300.0, 300.0, 25.0
NODE, WEIGHT = np.polynomial.legendre.leggauss(32)
RHO = 0.5 * RADIUS * (NODE + 1)
AREA = math.pi * RADIUS * WEIGHT * RHO


def half_path(axial: float) -> Floats:
    """Rms half-path-length error of an axial error that is alike everywhere."""
    return axial / (1 + (RHO / (2 * FOCAL_LENGTH)) ** 2)


def cos4_feed() -> Floats:
    """Aperture amplitude of a feed of gain cos^4."""
    angle = 2 * np.arctan(RHO / (2 * FOCAL_LENGTH))
    return np.asarray(np.cos(angle) ** 2 * np.cos(0.5 * angle) ** 2)


@pytest.mark.parametrize(
    ("feed", "axial", "correlation", "coherent", "both"),
    [
        (np.ones(32), 0.5, 30.0, -0.219, -0.217),
        (np.ones(32), 1.0, 30.0, -0.877, -0.868),
        (np.ones(32), 1.0, 60.0, -0.877, -0.840),
        (np.ones(32), 2.0, 30.0, -3.500, -3.456),
        (cos4_feed(), 0.5, 30.0, -0.229, -0.227),
        (cos4_feed(), 1.0, 30.0, -0.917, -0.906),
        (cos4_feed(), 1.0, 60.0, -0.917, -0.872),
        (cos4_feed(), 2.0, 30.0, -3.660, -3.608),
    ],
)
def test_extended_formula(feed: Floats, axial: float, correlation: float, coherent: float, both: float) -> None:
    error = half_path(axial)
    alone = gain_with_scatter(error, feed, AREA, wavelength=WAVELENGTH)
    assert 10 * math.log10(alone) == pytest.approx(coherent, abs=5.1e-4)
    with_scatter = gain_with_scatter(error, feed, AREA, wavelength=WAVELENGTH, correlation=correlation)
    assert 10 * math.log10(with_scatter) == pytest.approx(both, abs=5.1e-4)


def test_even_errors_and_light_give_the_closed_form() -> None:
    """exp(-s²) (1 + (2c/D)² sum of s^2n/(n n!)), with the sum written as Ein(-s²)."""
    from scipy.special import expi

    error, correlation = 1.5, 40.0
    variance = (4 * math.pi * error / WAVELENGTH) ** 2
    series = float(expi(variance)) - np.euler_gamma - math.log(variance)
    closed = math.exp(-variance) * (1 + (correlation / RADIUS) ** 2 * series)
    found = gain_with_scatter(np.full(32, error), np.ones(32), AREA, wavelength=WAVELENGTH, correlation=correlation)
    assert found == pytest.approx(closed, rel=1e-12)
    alone = gain_with_scatter(np.full(32, error), np.ones(32), AREA, wavelength=WAVELENGTH)
    assert -10 * math.log10(alone) == pytest.approx(loss(error, WAVELENGTH), rel=1e-12)


def test_large_errors_leave_what_is_scattered() -> None:
    found = gain_with_scatter(np.full(32, 60.0), np.ones(32), AREA, wavelength=WAVELENGTH, correlation=30.0)
    assert 0 <= found < 1e-4
