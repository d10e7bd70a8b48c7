"""A punch at part of its depth: derivatives, closed forms, projection, the limits of its share."""

from __future__ import annotations

import math

import numpy as np
import pytest
from punches import PUNCHES, points_near

from punchform.arrays import Floats
from punchform.punch import Paraboloid, Revolution, lowered, project
from punchform.punch.lowered import Lowered

every_punch = pytest.mark.parametrize("made", PUNCHES.values(), ids=PUNCHES.keys())
SHARES = (1.0 / 48, 1.0 / 12, 0.5, 0.95)


def on_surface(made: Revolution, share: float, count: int = 300) -> Floats:
    """Points of the lowered surface, (count, 3), walls included."""
    rng = np.random.default_rng(5)
    rho, z = made.meridian(4001)[rng.integers(0, 4001, count)].T
    angle = rng.uniform(0, 2 * math.pi, count)
    return np.column_stack((rho * np.cos(angle), rho * np.sin(angle), share * z))


@every_punch
@pytest.mark.parametrize("share", SHARES)
def test_its_points_are_those_of_the_punch_with_scaled_heights(made: Revolution, share: float) -> None:
    low, points = lowered(made, share), on_surface(made, share)
    assert np.abs(low.distance(points)).max() < 1e-11 * 300
    np.testing.assert_allclose(low.height(points[:, :2]), share * made.height(points[:, :2]))
    up, down = (low.distance(points + np.array((0, 0, shift))) for shift in (0.5, -0.5))
    apart = np.abs(made.gap(points / (1, 1, share)).gradient[:, 2]) > 0.01
    assert (up > 0)[apart].all()
    assert (down < 0)[apart].all()
    assert low.rim_radius == made.rim_radius
    assert low.mirror_planes


@every_punch
@pytest.mark.parametrize("share", SHARES)
def test_on_the_surface_its_derivatives_are_those_of_a_signed_distance(made: Revolution, share: float) -> None:
    low, points = lowered(made, share), on_surface(made, share)
    gap, h = low.gap(points), 1e-3 * share**2
    np.testing.assert_allclose(np.linalg.norm(gap.gradient, axis=1), 1.0)
    np.testing.assert_allclose(gap.hessian @ gap.gradient[:, :, None], 0.0, atol=1e-12)
    slope, bend = np.empty((len(points), 3)), np.empty((len(points), 3, 3))
    smooth = np.ones(len(points), dtype=bool)
    for axis in range(3):
        shift = h * np.eye(3)[axis]
        plus, minus = low.gap(points + shift), low.gap(points - shift)
        slope[:, axis] = (plus.value - minus.value) / (2 * h)
        bend[:, axis] = (plus.gradient - minus.gradient) / (2 * h)
        jump = np.abs(plus.hessian - minus.hessian).max(axis=(1, 2))
        smooth &= jump < 0.05 * np.abs(gap.hessian).max(axis=(1, 2)) + 1e-9
    assert smooth.mean() > 0.9
    np.testing.assert_allclose(slope[smooth], gap.gradient[smooth], atol=1e-5)
    across = np.eye(3) - gap.gradient[:, :, None] * gap.gradient[:, None]
    size = np.abs(gap.hessian).max() + 1e-3
    np.testing.assert_allclose((across @ bend @ across)[smooth], gap.hessian[smooth], atol=1e-3 * size)


def test_a_lowered_paraboloid_is_one_of_longer_focal_length() -> None:
    rng = np.random.default_rng(1)
    for share in SHARES:
        low, shallow = Lowered(Paraboloid(60.0), share), Paraboloid(60.0 / share)
        xy = rng.uniform(-80, 80, (200, 2))
        points = np.column_stack((xy, shallow.height(xy)))
        ours, theirs = low.gap(points), shallow.gap(points)
        np.testing.assert_allclose(ours.gradient, theirs.gradient, atol=1e-12)
        np.testing.assert_allclose(ours.hessian, theirs.hessian, atol=1e-12)
        near = points + rng.uniform(-0.1, 0.1, (200, 1)) * theirs.gradient
        np.testing.assert_allclose(low.distance(near), shallow.distance(near), atol=3e-3)


@every_punch
def test_at_its_full_depth_it_is_the_punch(made: Revolution) -> None:
    assert lowered(made, 1.0) is made
    points = points_near(made, 100)
    same, gap = Lowered(made, 1.0).gap(points), made.gap(points)
    np.testing.assert_allclose(same.value, gap.value, atol=1e-12)
    np.testing.assert_allclose(same.gradient, gap.gradient, atol=1e-12)
    np.testing.assert_allclose(same.hessian, gap.hessian, atol=1e-9 * np.abs(gap.hessian).max())


@every_punch
@pytest.mark.parametrize("share", SHARES)
def test_points_are_projected_along_the_normals_that_they_left(made: Revolution, share: float) -> None:
    low, points = lowered(made, share), on_surface(made, share)
    normals = low.gap(points).gradient
    # A step along the tangent plane, a tenth of the least radius: of an upright wall's edge, which shrinks so fast.
    along = np.cross(normals, np.random.default_rng(2).standard_normal(points.shape))
    after = points + 2.5 * share**2 * along / np.linalg.norm(along, axis=1)[:, None]
    found = project(low, after, normals)
    assert np.isfinite(found).all()
    assert np.abs(low.distance(found)).max() < 1e-11 * 300
    np.testing.assert_allclose(np.cross(found - after, normals), 0.0, atol=1e-9)
