"""Best fits: exact recovery, published figures, derivatives, and when a fit hides error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from perfect_dishes import FOCAL_LENGTH, RADIUS, TURN, Disc, disc, dish, net, turned, with_error

from punchform.accuracy import (
    ALIGNMENTS,
    MEASURES,
    PARAMETERS,
    Aperture,
    Fit,
    Measure,
    Pose,
    Target,
    best_fit,
    deviations,
    feet,
    hidden_error,
    implied_shift,
    measure,
    place,
    slopes,
)
from punchform.arrays import Floats
from punchform.case import ConeProfile, EllipsoidProfile, PolynomialProfile, Profile, SphereProfile
from punchform.errors import InputError

every_measure = pytest.mark.parametrize("how", MEASURES)
DISC = disc()
OTHERS: dict[str, Profile] = {
    "sphere": SphereProfile(radius=700.0),
    "ellipsoid": EllipsoidProfile(radius=400.0, height=150.0),
    "cone": ConeProfile(half_angle=math.radians(70.0), nose_radius=80.0),
    "polynomial": PolynomialProfile(coefficients=(3.0, 0.0, -5e-4, 0.0, -1e-9)),
}


def rotation(alpha: float, beta: float) -> Floats:
    sa, ca, sb, cb = math.sin(alpha), math.cos(alpha), math.sin(beta), math.cos(beta)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, ca, -sa], [0.0, sa, ca]])
    about_y = np.array([[cb, 0.0, sb], [0.0, 1.0, 0.0], [-sb, 0.0, cb]])
    return np.asarray(about_y @ about_x)


def fitted(points: Floats, alignment: str, how: Measure, where: Disc = DISC) -> Fit:
    return best_fit(points, where.weights, dish(), ALIGNMENTS[alignment], how)


def displaced() -> Floats:
    """T1: vertex (1.2, -0.8, 2.5) mm, tilts 0.4 and -0.25 deg, f = 303.2 mm, in the vertex frame."""
    there = rotation(math.radians(0.4), math.radians(-0.25))
    z = (DISC.x**2 + DISC.y**2) / (4 * 303.2)
    moved = np.column_stack((DISC.x, DISC.y, z)) @ there.T + np.array([1.2, -0.8, 2.5])
    return turned(*moved.T)


def coma() -> Floats:
    return with_error(DISC, DISC.rho**3 * np.cos(DISC.phi))


@every_measure
def test_a_displaced_paraboloid_is_recovered_exactly(how: Measure) -> None:
    """T1."""
    fit = fitted(displaced(), "6-parameter", how)
    there = fit.pose.shift * TURN
    assert there == pytest.approx([1.2, -0.8, 2.5], abs=1e-9)
    assert fit.pose.alpha == pytest.approx(math.radians(0.4), abs=1e-11)
    assert fit.pose.beta == pytest.approx(math.radians(0.25), abs=1e-11)
    assert fit.pose.f == pytest.approx(303.2, abs=1e-9)
    assert fit.rms < 1e-10
    assert fit.converged


@pytest.mark.parametrize(
    ("how", "rms", "longer"),
    [("axial", 0.408248, 0.0), ("normal", 0.374957, -0.0149), ("half-path", 0.344688, -0.0272)],
)
def test_astigmatism_survives_every_fit(how: Measure, rms: float, longer: float) -> None:
    """T3: each of the three figures is the rms of its own measure, minimised, over equal projected areas."""
    points = with_error(DISC, (DISC.x**2 - DISC.y**2) / RADIUS**2)
    for alignment in ("4-parameter", "6-parameter"):
        fit = fitted(points, alignment, how)
        assert fit.rms == pytest.approx(rms, abs=5e-7)
        assert fit.pose.f == pytest.approx(FOCAL_LENGTH + longer, abs=5e-5)
    if how == "axial":
        assert fit.rms == pytest.approx(1 / math.sqrt(6), rel=1e-9)


@pytest.mark.parametrize(
    ("how", "four", "tilt", "shift", "six"),
    [
        ("axial", 0.108745, -0.1186, -0.62, 0.008778),
        ("normal", 0.102443, -0.1166, -0.61, 0.008089),
        ("half-path", 0.096522, -0.1146, -0.60, 0.007461),
    ],
)
def test_coma_hides_in_six_parameters(how: Measure, four: float, tilt: float, shift: float, six: float) -> None:
    """T4."""
    points, target = coma(), dish()
    narrow, wide = fitted(points, "4-parameter", how), fitted(points, "6-parameter", how)
    assert narrow.rms == pytest.approx(four, abs=5e-7)
    assert -math.degrees(narrow.pose.beta) == pytest.approx(tilt, abs=5e-5)
    assert implied_shift(target, narrow.pose)[0] == pytest.approx(shift, abs=6e-3)
    assert wide.rms == pytest.approx(six, abs=5e-7)
    warning = hidden_error(points, DISC.weights, target, narrow, wide)
    assert warning is not None
    assert "hides error" in warning
    if how == "axial":
        assert wide.pose.u == pytest.approx(15.786, abs=5e-4)
        assert -math.degrees(wide.pose.beta) == pytest.approx(-1.510, abs=6e-4)
        assert implied_shift(target, wide.pose)[0] == pytest.approx(7.89, abs=5e-3)


@pytest.mark.parametrize(("how", "rms"), [("axial", 0.117851), ("normal", 0.110865), ("half-path", 0.104305)])
def test_coma_without_tilts(how: Measure, rms: float) -> None:
    """T4: a lateral shift does what the tilt does; axially 1/(6 sqrt 2) by a shift of -4/3 mm."""
    fit = best_fit(coma(), DISC.weights, dish(), ("u", "v", "w", "f"), how)
    assert fit.rms == pytest.approx(rms, abs=1.1e-6)
    if how == "axial":
        assert fit.pose.u == pytest.approx(-1.333, abs=2e-3)


@pytest.mark.parametrize(("how", "rms"), [("axial", 0.316228), ("normal", 0.287804), ("half-path", 0.262054)])
def test_rim_lobes_are_not_fitted_away(how: Measure, rms: float) -> None:
    """T6."""
    points = with_error(DISC, DISC.rho**4 * np.cos(8 * DISC.phi))
    for alignment in ("4-parameter", "6-parameter"):
        assert fitted(points, alignment, how).rms == pytest.approx(rms, abs=5e-7)


def noisy(points: Floats) -> Floats:
    return points + 0.002 * np.random.default_rng(3).normal(size=points.shape)


@pytest.mark.parametrize(
    "points",
    [
        displaced(),
        noisy(displaced()),
        with_error(DISC, (DISC.x**2 - DISC.y**2) / RADIUS**2),
        with_error(DISC, DISC.rho**4 * np.cos(8 * DISC.phi)),
        with_error(DISC, 0 * DISC.x),
        noisy(with_error(DISC, 0 * DISC.x) + np.array([10.0, 0.0, 0.0])),
    ],
    ids=["T1", "T1 with noise", "T3", "T6", "no error", "moved sideways"],
)
def test_no_warning_where_nothing_is_hidden(points: Floats) -> None:
    narrow, wide = fitted(points, "4-parameter", "half-path"), fitted(points, "6-parameter", "half-path")
    assert hidden_error(points, DISC.weights, dish(), narrow, wide) is None


def test_a_warning_is_not_drowned_by_a_wrong_height() -> None:
    points = coma() + np.array([0.0, 0.0, 5.0])
    narrow, wide = fitted(points, "4-parameter", "half-path"), fitted(points, "6-parameter", "half-path")
    assert hidden_error(points, DISC.weights, dish(), narrow, wide) is not None


def test_shifts_and_tilts_together_are_ill_conditioned() -> None:
    """Condition about 280 with six parameters, 14 with either the tilts or the shifts left out."""
    points, target = with_error(DISC, 0 * DISC.x), dish()
    six = fitted(points, "6-parameter", "half-path").condition
    assert six == pytest.approx(280, rel=0.03)
    for free in (("w", "alpha", "beta", "f"), ("u", "v", "w", "f")):
        assert best_fit(points, DISC.weights, target, free, "half-path").condition == pytest.approx(14, rel=0.02)


def assert_exact(target: Target, pose: Pose, points: Floats, how: Measure) -> None:
    value, jacobian = slopes(points, target, pose, how)
    assert value == pytest.approx(deviations(points, target, pose).of(how), abs=1e-11)
    for column, name in enumerate(PARAMETERS):
        if name == "f" and pose.f is None:
            assert not jacobian[:, column].any()
            continue
        step = 1e-5 if name in ("alpha", "beta") else 1e-3
        here = getattr(pose, name)
        ahead, behind = (slopes(points, target, pose.moved({name: here + k * step}), how)[0] for k in (1, -1))
        assert jacobian[:, column] == pytest.approx((ahead - behind) / (2 * step), rel=1e-6, abs=1e-6)


@every_measure
def test_derivatives_of_a_paraboloid(how: Measure) -> None:
    points = displaced() + np.random.default_rng(1).normal(size=(len(DISC.x), 3))
    assert_exact(dish(apex_height=4.0), Pose(1.0, -2.0, 3.0, 0.02, -0.03, 290.0), points, how)


@every_measure
@pytest.mark.parametrize("profile", OTHERS.values(), ids=OTHERS)
def test_derivatives_of_other_surfaces(profile: Profile, how: Measure) -> None:
    target = place(profile, RADIUS, apex_height=80.0)
    rng = np.random.default_rng(2)
    # Neither the joint of a cone's nose (second derivatives jump) nor the end of the formula.
    rho, phi = rng.uniform(100.0, 270.0, 50), rng.uniform(0, 2 * math.pi, 50)
    x, y = rho * np.cos(phi), rho * np.sin(phi)
    z = target.surface.height(np.column_stack((x, y))) + 80.0 - target.surface.height_at_axis
    points = np.column_stack((x, y, z + rng.normal(size=50)))
    assert_exact(target, Pose(1.0, -2.0, 0.5, 0.01, -0.02), points, how)


@pytest.mark.parametrize("profile", OTHERS.values(), ids=OTHERS)
def test_a_rigid_fit_recovers_where_another_surface_stands(profile: Profile) -> None:
    target = place(profile, 290.0, apex_height=50.0)
    x, y = 0.9 * DISC.x, 0.9 * DISC.y
    z = target.surface.height(np.column_stack((x, y))) - target.surface.height_at_axis
    there = rotation(0.004, -0.006)
    straight = np.column_stack((x, y, z)) @ there.T + np.array([0.0, 0.0, 51.5])
    fit = best_fit(straight, DISC.weights, target, ALIGNMENTS["3-parameter"], "normal")
    assert (fit.pose.w, fit.pose.alpha, fit.pose.beta) == pytest.approx((1.5, 0.004, -0.006), abs=1e-9)
    moved = straight + np.array([0.7, -0.3, 0.0])
    fit = best_fit(moved, DISC.weights, target, ALIGNMENTS["5-parameter"], "normal")
    assert fit.rms < 1e-9
    if math.isfinite(fit.condition):
        assert fit.pose.shift == pytest.approx([0.7, -0.3, 1.5], abs=1e-6)


def test_a_sphere_cannot_tell_a_shift_from_a_tilt() -> None:
    target = place(SphereProfile(radius=700.0), RADIUS, apex_height=-2.0)
    points = feet(with_error(DISC, 0 * DISC.x), target)
    fit = best_fit(points, DISC.weights, target, ALIGNMENTS["5-parameter"], "normal")
    assert math.isinf(fit.condition)
    assert all(math.isnan(sigma) for sigma in fit.sigmas.values())
    assert [one.name for one in measure(points, target, Aperture(RADIUS)).alignments] == ["as held", "3-parameter"]


@every_measure
def test_a_best_fit_does_not_depend_on_how_the_points_are_held(how: Measure) -> None:
    """Moved and tilted together, points keep the rms of a fit that may move and tilt."""
    points = with_error(DISC, 0.3 * DISC.rho**2 * np.cos(2 * DISC.phi) + 0.2 * DISC.rho**4)
    here = fitted(points, "6-parameter", how)
    moved = points @ rotation(0.003, -0.002).T + np.array([0.4, 0.2, -1.0])
    assert fitted(moved, "6-parameter", how).rms == pytest.approx(here.rms, rel=1e-9)
    straight = points @ rotation(0.003, -0.002).T + np.array([0.0, 0.0, -1.0])
    assert fitted(straight, "4-parameter", how).rms == pytest.approx(fitted(points, "4-parameter", how).rms, rel=1e-9)


def test_wider_fits_never_leave_more() -> None:
    points = noisy(with_error(DISC, 0.4 * np.cos(3 * DISC.phi) * DISC.rho**3 + 0.1 * DISC.rho**3 * np.sin(DISC.phi)))
    rms = [fitted(points, name, "half-path").rms for name in ALIGNMENTS]
    held, three, four, five, six = rms
    assert held >= three >= four >= six
    assert three >= five >= six


def test_standard_errors_are_those_of_repeated_noise() -> None:
    """Unequal weights too: the errors found in 100 draws of noise agree with those each fit tells."""
    rng = np.random.default_rng(11)
    few = disc(5, 12)
    target, free = dish(), ALIGNMENTS["4-parameter"]
    perfect = with_error(few, 0 * few.x)
    normals = target.surface.distance_gradient(perfect)[1]
    found, told = [], []
    for _ in range(100):
        fit = best_fit(
            perfect + 0.05 * rng.normal(size=len(few.x))[:, None] * normals, few.weights, target, free, "normal"
        )
        found.append([getattr(fit.pose, name) for name in free])
        told.append([fit.sigmas[name] for name in free])
    assert np.std(found, axis=0) == pytest.approx(np.sqrt(np.mean(np.square(told), axis=0)), rel=0.25)


def test_unusable_input_is_told() -> None:
    points, target = with_error(DISC, 0 * DISC.x), dish()
    with pytest.raises(InputError, match="4 nodes with an area, too few"):
        best_fit(points[:4], np.ones(4), target, ALIGNMENTS["4-parameter"], "normal")
    sphere = place(SphereProfile(radius=700.0), RADIUS, apex_height=0.0)
    with pytest.raises(InputError, match="no focal length"):
        best_fit(points, DISC.weights, sphere, ALIGNMENTS["6-parameter"], "normal")
    with pytest.raises(InputError, match="profile ends"):
        place(SphereProfile(radius=200.0), RADIUS, apex_height=0.0)
    with pytest.raises(ValueError, match="focus"):
        sphere.focus(Pose())


def test_a_perfect_net_needs_no_fit() -> None:
    points, cells = net(25.0)
    accuracy = measure(points, dish(), Aperture(RADIUS), cells=cells)
    for aligned in accuracy.alignments:
        assert aligned.statistics["normal"].rms < 1e-10
        assert aligned.implied_shift == pytest.approx(np.zeros(3), abs=1e-8)
    assert accuracy.warnings == ()
