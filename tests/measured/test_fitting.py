"""Best fits find what they must, and the errors they state are those they make."""

from __future__ import annotations

import numpy as np
import pytest
from measured_clouds import NOISE, off_by, pose, predicted, scene

from punchform.arrays import Floats
from punchform.case import FlatProfile, SphereProfile
from punchform.measured.alignment import straying
from punchform.measured.fitting import SMOOTH, fit_to_points, fit_to_surface
from punchform.measured.pose import Pose, rotation, shortest_turn, unmoved
from punchform.measured.start import rough_pose
from punchform.measured.target import Reference, Target
from punchform.punch import bare

SEEDS = 40
SHAPE = predicted()
SCENE = scene(SHAPE)
TRUE = pose()
RANDOM = np.random.default_rng(0)
ROWS = RANDOM.choice(len(SHAPE.nodes), 300, replace=False)


def on_target(count: int = 300) -> Floats:
    target = SCENE.target
    assert target is not None
    plan = np.random.default_rng(5).uniform(-190, 190, (count, 2))
    return np.column_stack((plan, target.surface.height(plan) + target.lift))


def pulls(points: Floats, fits: str) -> tuple[float, int]:
    """Chi-square of the true pose in the stated covariances over the seeds, and its degrees of freedom."""
    total, free = 0.0, 0
    for seed in range(SEEDS):
        noise = np.random.default_rng(seed).normal(0, NOISE, points.shape)
        measured = TRUE.to_measured(points + noise)
        ones = np.ones(len(points))
        if fits == "nodes":
            fit = fit_to_points(measured, points, weights=ones)
        else:
            reference: Reference | None = SCENE.target if fits == "target" else SCENE.prediction
            assert reference is not None
            least = 1e-6 if fits == "target" else SMOOTH
            fit = fit_to_surface(measured, reference, unmoved(), kept=ones > 0, weights=ones, least=least)
            assert fit.settled
        off = off_by(fit.pose, TRUE)[fit.determined]
        covariance = fit.covariance[np.ix_(fit.determined, fit.determined)]
        total += float(off @ np.linalg.solve(covariance, off))
        free += len(off)
    return total, free


@pytest.mark.parametrize(("fits", "motions"), [("target", 5), ("prediction", 6), ("nodes", 6)])
def test_the_alignment_is_recovered_to_its_stated_errors(fits: str, motions: int) -> None:
    chi_square, free = pulls(on_target() if fits == "target" else SHAPE.nodes[ROWS], fits)
    assert free == SEEDS * motions
    # Four standard deviations of a chi-square of so many degrees of freedom.
    assert abs(chi_square - free) < 4 * np.sqrt(2 * free)


def test_kabsch_is_exact_without_noise() -> None:
    for way in (pose(), pose(150.0, (2000.0, -3000.0, 500.0)), pose(10.0, flipped=True)):
        fit = fit_to_points(way.to_measured(SHAPE.nodes), SHAPE.nodes, weights=np.ones(len(SHAPE.nodes)))
        np.testing.assert_allclose(fit.pose.turn, way.turn, atol=1e-13)
        np.testing.assert_allclose(fit.pose.shift, way.shift, atol=1e-9)


def test_kabsch_never_mirrors() -> None:
    flat = SHAPE.nodes * np.array([1.0, 1.0, 0.0])
    fit = fit_to_points(flat * np.array([1.0, -1.0, 1.0]), flat, weights=np.ones(len(flat)))
    assert np.linalg.det(fit.pose.turn) == pytest.approx(1.0)


def test_weights_are_those_of_repeated_points() -> None:
    points, known = SHAPE.nodes[:20] + RANDOM.normal(0, 1, (20, 3)), SHAPE.nodes[:20]
    weights = np.where(np.arange(20) < 7, 3.0, 1.0)
    twice = np.repeat(np.arange(20), weights.astype(np.int64))
    one = fit_to_points(points, known, weights=weights)
    other = fit_to_points(points[twice], known[twice], weights=np.ones(len(twice)))
    np.testing.assert_allclose(one.pose.turn, other.pose.turn, atol=1e-12)
    np.testing.assert_allclose(one.pose.shift, other.pose.shift, atol=1e-9)


@pytest.mark.parametrize(
    ("profile", "lost"),
    [
        (SphereProfile(radius=400.0), {3, 4, 5}),
        (FlatProfile(height=40.0, edge_radius=30.0), {0, 1, 5}),
    ],
)
def test_motions_that_a_surface_does_not_feel_are_left_alone_and_said(
    profile: SphereProfile | FlatProfile, lost: set[int]
) -> None:
    target = Target(bare(profile, 250.0), 0.0, 250.0)
    plan = np.random.default_rng(3).uniform(-150, 150, (100, 2))
    points = np.column_stack((plan, target.surface.height(plan))) + np.random.default_rng(4).normal(0, 0.01, (100, 3))
    ones = np.ones(100)
    fit = fit_to_surface(pose(0.1, (0.0, 0.0, 2.0)).to_measured(points), target, unmoved(), kept=ones > 0, weights=ones)
    # A sphere feels no turn about its own centre: tilt is lost together with a shift.
    assert lost <= set(np.flatnonzero(~fit.determined))
    assert 2 not in np.flatnonzero(~fit.determined)
    assert fit.scatter == pytest.approx(0.01, rel=0.3)
    assert np.isinf(fit.errors[5])


@pytest.mark.parametrize(
    ("tilt", "shift", "flipped"),
    [
        (0.0, (0.0, 0.0, 0.0), False),
        (30.0, (2000.0, -3000.0, 500.0), False),
        (12.0, (-50.0, 90.0, 4000.0), False),
        (25.0, (100.0, 0.0, -900.0), True),
    ],
)
def test_a_cloud_is_found_wherever_it_lies(tilt: float, shift: tuple[float, float, float], flipped: bool) -> None:
    true = pose(tilt, shift, flipped=flipped)
    found = rough_pose(true.to_measured(SHAPE.nodes[ROWS]), SCENE.punch)
    # Up to the turn about the axis, which the punch does not feel.
    np.testing.assert_allclose(found.turn[:, 2], true.turn[:, 2], atol=0.02)
    np.testing.assert_allclose(found.shift, true.shift, atol=6.0)


def test_half_a_dish_is_found_too() -> None:
    true = pose(20.0, (500.0, 40.0, 3.0))
    half = SHAPE.nodes[SHAPE.nodes[:, 0] > 0]
    found = rough_pose(true.to_measured(half), SCENE.punch)
    np.testing.assert_allclose(found.turn[:, 2], true.turn[:, 2], atol=0.03)


def test_poses_go_there_and_back() -> None:
    true = pose(70.0, (1.0, 2.0, 3.0))
    np.testing.assert_allclose(true.to_run(true.to_measured(SHAPE.nodes)), SHAPE.nodes, atol=1e-10)
    moved = Pose(np.eye(3), np.zeros(3)).moved(np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]))
    np.testing.assert_allclose(moved.turn, rotation(np.array([0.1, 0.2, 0.3])))
    for axis in (np.array([0.6, 0.0, -0.8]), np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 1.0])):
        np.testing.assert_allclose(shortest_turn(axis) @ axis, [0, 0, 1], atol=1e-12)


def test_only_strays_are_called_strays() -> None:
    values = np.append(np.random.default_rng(6).normal(0, 1, 500), [30.0, np.nan])
    assert np.flatnonzero(straying(values)).tolist() == [500]
    assert not straying(np.zeros(5)).any()
