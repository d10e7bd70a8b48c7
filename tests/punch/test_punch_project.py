"""The retraction of the press: points moved along their directions onto the surface."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from punches import CHECK, PUNCHES, points_near

from punchform.arrays import Floats
from punchform.punch import Gap, Revolution, Sphere, project, uncorrected

every_punch = pytest.mark.parametrize("made", PUNCHES.values(), ids=PUNCHES.keys())


@dataclass
class Counting:
    """A surface that counts how often it is asked."""

    inner: Revolution
    asked: list[int] = field(default_factory=list)
    rim_radius: float = 300.0
    mirror_planes: bool = True

    def gap(self, points: Floats) -> Gap:
        return self.inner.gap(points)

    def distance(self, points: Floats) -> Floats:
        return self.inner.distance(points)

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        self.asked.append(len(points))
        return self.inner.distance_gradient(points)

    def height(self, xy: Floats) -> Floats:
        return self.inner.height(xy)


@every_punch
def test_points_near_the_surface_arrive_along_slanted_directions(made: Revolution) -> None:
    points = points_near(made, 300)
    rng = np.random.default_rng(5)
    directions = 3.0 * (made.gap(points).gradient + rng.uniform(-0.3, 0.3, points.shape))
    moved = project(made, points, directions)
    assert np.abs(made.distance(moved)).max() < 1e-12 * 300
    across = np.cross(moved - points, directions / np.linalg.norm(directions, axis=1)[:, None])
    assert np.abs(across).max() < 1e-12 * 300


def test_length_and_sign_of_a_direction_do_not_matter() -> None:
    made = uncorrected(CHECK)
    points = points_near(made, 100)
    normals = made.gap(points).gradient
    assert project(made, points, -7e5 * normals) == pytest.approx(project(made, points, normals), abs=1e-12)


def test_a_step_of_the_press_takes_three_evaluations() -> None:
    """From a point of the surface one grid step along the tangent plane, back along the old normal."""
    inner = uncorrected(CHECK)
    counting = Counting(inner)
    feet = project(inner, points_near(inner, 300), np.tile([0.0, 0.0, 1.0], (300, 1)))
    _, normals = inner.distance_gradient(feet)
    tangents = np.cross(normals, [0.3, 1.0, 0.1])
    moved = project(counting, feet + 7.5 * tangents / np.linalg.norm(tangents, axis=1)[:, None], normals)
    assert np.abs(inner.distance(moved)).max() < 1e-12 * 300
    assert len(counting.asked) <= 5
    assert sum(counting.asked) < 3.2 * 300


def test_known_intersections_with_a_sphere() -> None:
    points = np.array([(0.5, 0.0, 3.0), (0.5, 0.0, 0.5), (0.0, 0.8, -2.0)])
    moved = project(Sphere(1.0), points, np.tile([0.0, 0.0, 1.0], (3, 1)))
    expected = np.array([(0.5, 0.0, 0.75**0.5), (0.5, 0.0, 0.75**0.5), (0.0, 0.8, -0.6)])
    assert moved == pytest.approx(expected, abs=1e-14)


def test_a_line_that_misses_says_nan_for_its_point_only() -> None:
    points = np.array([(2.0, 0.0, 0.5), (0.5, 0.0, 2.0), (0.1, 0.0, 2.0), (0.1, np.nan, 1.0)])
    directions = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
    moved = project(Sphere(1.0), points, directions)
    assert np.isnan(moved).any(axis=1).tolist() == [True, False, True, True]


def test_nothing_to_move() -> None:
    assert project(Sphere(1.0), np.empty((0, 3)), np.empty((0, 3))).shape == (0, 3)


def test_a_line_that_starts_parallel_to_the_surface_still_finds_it() -> None:
    moved = project(Sphere(1.0), np.array([(0.9, 0.0, 0.0)]), np.array([(0.0, 0.0, 1.0)]))
    assert np.abs(Sphere(1.0).distance(moved)) < 1e-14
