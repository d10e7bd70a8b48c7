"""Which lobes a deviation has."""

from __future__ import annotations

import numpy as np
import pytest
from perfect_dishes import RADIUS, disc, net

from punchform.accuracy import Aperture, harmonics, statistics, tributary_areas

DISC = disc()


@pytest.mark.parametrize("m", range(1, 9))
def test_a_pure_harmonic_is_found_alone(m: int) -> None:
    start = min(m, 4 + m % 2)
    values = DISC.rho**start * (0.3 * np.cos(m * DISC.phi) - 0.4 * np.sin(m * DISC.phi))
    points = np.column_stack((DISC.x, DISC.y))
    found = harmonics(values, points, DISC.weights, RADIUS)
    assert found is not None
    part = found.parts[m]
    assert part.m == m
    assert part.share == pytest.approx(1.0, abs=1e-9)
    assert (part.cosine, part.sine, part.amplitude) == pytest.approx((0.3, -0.4, 0.5), abs=1e-8)
    assert part.rms == pytest.approx(found.sigma, rel=1e-9)
    assert found.mean == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("step", [20.0, 10.0])
def test_lobes_on_a_square_grid_keep_their_amplitude(step: float) -> None:
    """On a square grid m = 0, 4 and 8 are not quite orthogonal; the parts are told apart all the same."""
    points, cells = net(step)
    inside = Aperture(RADIUS).mask(points)
    points, area = points[inside], tributary_areas(points, cells)[inside]
    rho, phi = np.hypot(*points[:, :2].T) / RADIUS, np.arctan2(points[:, 1], points[:, 0])
    found = harmonics(2.0 + 0.7 * rho**4 * np.cos(4 * phi), points, area, RADIUS)
    assert found is not None
    assert found.parts[4].cosine == pytest.approx(0.7, abs=1e-6)
    assert found.parts[4].share == pytest.approx(1.0, abs=1e-6)
    assert found.residual < 1e-9
    assert found.mean == pytest.approx(2.0, abs=step / RADIUS)


def test_shares_and_residual_add_up_to_the_variance() -> None:
    rng = np.random.default_rng(4)
    values = rng.normal(size=len(DISC.x)) + DISC.rho**2 * np.cos(2 * DISC.phi)
    found = harmonics(values, np.column_stack((DISC.x, DISC.y)), DISC.weights, RADIUS)
    assert found is not None
    assert sum(part.share for part in found.parts) + found.residual == pytest.approx(1.0, rel=1e-12)
    assert found.sigma == pytest.approx(statistics(values, DISC.weights).sigma, rel=1e-12)
    assert found.residual > 0.3


def test_a_narrow_ring_has_fewer_radial_functions_and_the_same_lobes() -> None:
    ring = 0.999 + 0.001 * DISC.rho
    points = RADIUS * np.column_stack((ring * np.cos(DISC.phi), ring * np.sin(DISC.phi)))
    found = harmonics(np.cos(4 * DISC.phi), points, np.ones(len(points)), RADIUS)
    assert found is not None
    assert found.parts[4].share == pytest.approx(1.0, abs=1e-6)
    assert found.parts[4].cosine == pytest.approx(1.0, abs=1e-4)


def test_harmonics_of_nothing_and_of_too_little() -> None:
    points = np.column_stack((DISC.x, DISC.y))
    none = harmonics(np.full(len(points), 3.0), points, DISC.weights, RADIUS)
    assert none is not None
    assert none.mean == pytest.approx(3.0)
    assert none.sigma < 1e-12
    assert all(part.share == 0 for part in none.parts)
    assert harmonics(DISC.x[:60], points[:60], DISC.weights[:60], RADIUS) is None
