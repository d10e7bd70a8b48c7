"""The signed distance of every punch: derivatives, limits, closed forms, scaling."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from punches import CHECK, PUNCHES, points_near, punch, table_of_paraboloid

from punchform.arrays import Floats
from punchform.case import (
    ConeProfile,
    EllipsoidProfile,
    ExpressionProfile,
    ParaboloidProfile,
    PolynomialProfile,
    Profile,
    PunchCase,
    SphereProfile,
)
from punchform.punch import Paraboloid, Revolution, Sphere, bare, profile_curve, uncorrected
from punchform.punch.segments import Line

every_punch = pytest.mark.parametrize("made", PUNCHES.values(), ids=PUNCHES.keys())


def test_nodes_of_the_check_case_lie_on_the_punch() -> None:
    """docs/theory.md, section 11: formed positions, given there to 1e-5 mm."""
    nodes = np.array(
        [
            (74.72575, 0.0, 79.65979),
            (74.72546, 74.72585, 74.07588),
            (147.87856, 147.87598, 41.50836),
            (218.26221, 0.0, 37.60534),
        ]
    )
    assert np.abs(uncorrected(CHECK).distance(nodes)).max() < 1e-5


@every_punch
def test_gap_vanishes_on_the_meridian_and_the_height_agrees(made: Revolution) -> None:
    rho, z = made.meridian(500).T
    for angle in (0.0, 2.0):
        points = np.column_stack((rho * math.cos(angle), rho * math.sin(angle), z))
        assert np.abs(made.distance(points)).max() < 1e-12 * 300
    rho = np.linspace(0.0, 400.0, 777)
    on_surface = np.column_stack((rho, 0 * rho, made.height(np.column_stack((rho, 0 * rho)))))
    assert np.abs(made.distance(on_surface)).max() < 1e-12 * 300


@every_punch
def test_distance_is_the_distance_to_the_nearest_point(made: Revolution) -> None:
    """Also far away, and deep inside the punch, where several feet compete."""
    rng = np.random.default_rng(3)
    points = np.column_stack((rng.uniform(0, 400, 300), np.zeros(300), rng.uniform(-150, 500, 300)))
    line = made.meridian(20_000, radius=600.0)
    nearest = np.array([np.hypot(*(line - point[[0, 2]]).T).min() for point in points])
    value = made.distance(points)
    spacing = np.hypot(*np.diff(line, axis=0).T).max()
    assert (np.abs(value) <= nearest + 1e-9).all()
    assert (nearest - np.abs(value) <= np.minimum(spacing, spacing**2 / np.abs(value)) + 1e-9).all()
    above = points[:, 2] > made.height(points[:, :2])
    assert ((value > 0) == above).all()


@every_punch
def test_derivatives_against_differences(made: Revolution) -> None:
    points = points_near(made, 400)
    gap = made.gap(points)
    h = 1e-3
    near_joint = np.zeros(len(points), dtype=bool)
    for axis in range(3):
        shift = np.eye(3)[axis] * h
        plus, minus = made.gap(points + shift), made.gap(points - shift)
        slope = (plus.value - minus.value) / (2 * h)
        jump = np.abs(plus.hessian - minus.hessian).max(axis=(1, 2))
        near_joint |= jump > 2e-5
        smooth = ~near_joint
        assert np.abs(slope - gap.gradient[:, axis])[smooth].max() < 1e-9
        bend = (plus.gradient - minus.gradient) / (2 * h)
        assert np.abs(bend - gap.hessian[:, axis])[smooth].max() < 1e-9
    assert near_joint.sum() < 20


@every_punch
def test_gradient_has_length_one_and_the_hessian_keeps_it(made: Revolution) -> None:
    gap = made.gap(points_near(made, 500))
    assert np.abs(np.linalg.norm(gap.gradient, axis=1) - 1).max() < 1e-14
    assert np.abs(np.einsum("nij,nj->ni", gap.hessian, gap.gradient)).max() < 1e-14
    assert (gap.hessian == gap.hessian.transpose(0, 2, 1)).all()


@every_punch
def test_cheaper_calls_agree_with_gap(made: Revolution) -> None:
    points = points_near(made, 200)
    gap = made.gap(points)
    value, gradient = made.distance_gradient(points)
    assert (value == gap.value).all()
    assert (made.distance(points) == gap.value).all()
    assert (gradient == gap.gradient).all()


@every_punch
def test_segments_join_with_a_common_tangent(made: Revolution) -> None:
    segments = made.chain.segments
    for one, other in itertools.pairwise(segments):
        end, start = one.trace(2, 500.0), other.trace(2, 500.0)
        assert end.rho[-1] == pytest.approx(start.rho[0], abs=1e-9)
        assert end.z[-1] == pytest.approx(start.z[0], abs=1e-9)
        assert end.normal_rho[-1] == pytest.approx(start.normal_rho[0], abs=1e-10)
        assert end.normal_z[-1] == pytest.approx(start.normal_z[0], abs=1e-10)


@every_punch
def test_the_fillet_touches_the_flange_at_the_rim(made: Revolution) -> None:
    at_rim = np.array([(300.0, 0.0, 0.0), (300.0 - 1e-6, 0.0, 0.0), (333.0, 0.0, 0.0)])
    gap = made.gap(at_rim)
    assert np.abs(gap.value).max() < 1e-13
    assert gap.gradient[:, 2] == pytest.approx(1.0)
    fillet = made.chain.segments[-2]
    centre = made.distance(np.array([(300.0, 0.0, 30.0)]))
    assert centre == pytest.approx(30.0)
    assert fillet.trace(2, 500.0).curvature == pytest.approx(1 / 30)


@every_punch
def test_on_the_axis_everything_is_finite_and_isotropic(made: Revolution) -> None:
    top = made.height_at_axis
    z = np.array([top - 1.0, top, top + 5.0])
    gap = made.gap(np.column_stack((0 * z, 0 * z, z)))
    assert gap.value == pytest.approx([-1.0, 0.0, 5.0], abs=1e-12)
    assert gap.gradient == pytest.approx(np.tile([0.0, 0.0, 1.0], (3, 1)), abs=1e-14)
    assert gap.hessian[:, 0, 0] == pytest.approx(gap.hessian[:, 1, 1], abs=1e-15)
    assert np.abs(gap.hessian[:, 2]).max() < 1e-15
    for rho in (1e-3, 1e-6, 1e-12, 1e-300):
        near = made.gap(np.column_stack((rho * 0.6 + 0 * z, rho * 0.8 + 0 * z, z)))
        # The surface turns at the rate kappa, so the Hessian off the axis differs by kappa^2 rho.
        assert near.hessian == pytest.approx(gap.hessian, abs=1e-8 + 1e-3 * rho)


@every_punch
def test_no_points_is_no_problem(made: Revolution) -> None:
    assert made.gap(np.empty((0, 3))).hessian.shape == (0, 3, 3)


def test_height_at_axis_of_a_sphere_follows_from_two_touching_circles() -> None:
    """(R + r_f)^2 = R0^2 + (r_f - z_c)^2, apex = z_c + R."""
    made = PUNCHES["sphere"]
    assert made.height_at_axis == pytest.approx(400 + 30 - math.sqrt(430**2 - 300**2), rel=1e-14)


def test_hemisphere_down_to_its_equator() -> None:
    """R0 = R + r_f: the fillet is a full quarter circle, and its top the equator."""
    made = PUNCHES["hemisphere"]
    assert made.height_at_axis == 300.0
    equator = made.gap(np.array([(0.0, 270.0, 30.0), (0.0, 272.0, 30.0 + 1e-7), (265.0, 0.0, 30.0)]))
    assert equator.value == pytest.approx([0.0, 2.0, -5.0], abs=1e-12)
    assert equator.gradient[0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
    up = np.array([(0.0, 270.0 * math.cos(a), 30 + 270.0 * math.sin(a)) for a in np.linspace(1e-6, 1.5, 50)])
    expected = [(np.eye(3) - np.outer(n, n)) / 270 for n in (up - [0, 0, 30]) / 270]
    assert made.gap(up).hessian == pytest.approx(np.array(expected), abs=1e-12)


def test_an_ellipsoid_with_equal_axes_is_the_sphere() -> None:
    for radius in (270.0, 270.0001, 400.0):
        sphere = punch(SphereProfile(radius=radius))
        ellipsoid = punch(EllipsoidProfile(radius=radius, height=radius))
        points = points_near(sphere, 300)
        a, b = sphere.gap(points), ellipsoid.gap(points)
        assert b.value == pytest.approx(a.value, abs=1e-10)
        assert b.gradient == pytest.approx(a.gradient, abs=1e-10)


def test_half_ellipsoid_stands_on_its_equator() -> None:
    made = PUNCHES["half ellipsoid"]
    assert made.height_at_axis == pytest.approx(430.0, rel=1e-15)
    assert made.distance(np.array([(270.0, 0.0, 30.0)])) == pytest.approx(0.0, abs=1e-12)


def test_cone_has_its_angle_nose_and_height() -> None:
    made = PUNCHES["cone"]
    wall = made.gap(np.array([(150.0, 0.0, float(made.height(np.array([(150.0, 0.0)]))[0]))]))
    a = math.radians(35.0)
    assert wall.gradient[0] == pytest.approx([math.cos(a), 0.0, math.sin(a)], abs=1e-14)
    eigenvalues = np.linalg.eigvalsh(wall.hessian[0])
    assert eigenvalues == pytest.approx([0, 0, math.cos(a) / 150], abs=1e-15)
    nose = made.gap(np.array([(0.0, 0.0, made.height_at_axis)]))
    assert nose.hessian[0] == pytest.approx(np.diag([1 / 60, 1 / 60, 0]), abs=1e-15)
    tip = made.height_at_axis + 60 * (1 / math.sin(a) - 1)
    foot = (300 - 30 * math.tan((math.pi / 2 - a) / 2)) / math.tan(a)
    assert tip == pytest.approx(foot, rel=1e-14)


def test_cup_has_a_flat_bottom_and_a_vertical_wall() -> None:
    made = PUNCHES["cup"]
    points = np.array([(100.0, 0.0, 92.0), (270.0, 0.0, 50.0), (0.0, 273.0, 45.0)])
    gap = made.gap(points)
    assert gap.value == pytest.approx([2.0, 0.0, 3.0], abs=1e-13)
    assert gap.gradient == pytest.approx(np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0)]), abs=1e-15)
    assert np.abs(gap.hessian[0]).max() == 0.0
    assert gap.hessian[1] == pytest.approx(np.diag([0, 1 / 270, 0]))
    assert 30.0 <= made.height(np.array([(270.0, 0.0)]))[0] <= 65.0


def test_height_on_a_vertical_line_is_one_of_its_heights() -> None:
    assert Line((5.0, 9.0), (0.0, -1.0), 4.0).height(np.array([5.0])) == 7.0


def test_paraboloid_curves_by_half_its_inverse_focal_length_at_the_apex() -> None:
    gap = Paraboloid(250.0).gap(np.zeros((1, 3)))
    assert gap.hessian[0] == pytest.approx(np.diag([1 / 500, 1 / 500, 0]), rel=1e-15)


@given(st.floats(0.0, 4.0), st.floats(-3.0, 3.0))
@settings(max_examples=60, deadline=None)
def test_foot_on_a_bare_paraboloid_solves_its_cubic(rho: float, z: float) -> None:
    """f = 1: the foot t >= 0 is the root of t^3/8 + t (1 + z/2) = rho; exact far away and deep inside."""
    roots = np.roots([1 / 8, 0.0, 1 + z / 2, -rho])
    real = roots.real[np.abs(roots.imag) < 1e-6]
    t = real[real >= -1e-9]
    nearest = np.hypot(t - rho, -(t**2) / 4 - z).min()
    value = Paraboloid(1.0).distance(np.array([(rho, 0.0, z)]))[0]
    assert abs(value) == pytest.approx(nearest, abs=1e-6)


def test_bare_sphere_is_the_closed_form() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(size=(200, 3))
    gap = Sphere(1.3).gap(points)
    radius = np.linalg.norm(points, axis=1)
    n = points / radius[:, None]
    assert gap.value == pytest.approx(radius - 1.3, abs=1e-14)
    assert gap.gradient == pytest.approx(n, abs=1e-14)
    expected = (np.eye(3) - n[:, :, None] * n[:, None, :]) / radius[:, None, None]
    assert gap.hessian == pytest.approx(expected, rel=1e-10, abs=1e-12)
    assert np.isfinite(Sphere(1.3).gap(np.zeros((1, 3))).hessian).all()
    assert Sphere(5.0).height(np.array([(3.0, 0.0), (0.0, 4.0), (6.0, 0.0)])) == pytest.approx(
        [4.0, 3.0, math.nan], nan_ok=True
    )


@pytest.mark.parametrize("factor", [1e-3, 1e3])
@pytest.mark.parametrize(
    ("profile", "scaled"),
    [
        (ParaboloidProfile(focal_length=250), lambda c: ParaboloidProfile(focal_length=250 * c)),
        (EllipsoidProfile(radius=270, height=90), lambda c: EllipsoidProfile(radius=270 * c, height=90 * c)),
        (
            ConeProfile(half_angle=0.5, nose_radius=50),
            lambda c: ConeProfile(half_angle=0.5, nose_radius=50 * c),
        ),
        (
            PolynomialProfile(coefficients=(0, 0, 1e-3, 0, -2e-8)),
            lambda c: PolynomialProfile(coefficients=(0, 0, 1e-3 / c, 0, -2e-8 / c**3)),
        ),
    ],
    ids=["paraboloid", "ellipsoid", "cone", "polynomial"],
)
def test_scaling_all_lengths_scales_the_gap(profile: Profile, scaled: object, factor: float) -> None:
    assert callable(scaled)
    one, other = punch(profile), punch(scaled(factor), 300 * factor, 30 * factor)
    points = points_near(one, 300)
    a, b = one.gap(points), other.gap(points * factor)
    assert b.value / factor == pytest.approx(a.value, abs=1e-10)
    assert b.gradient == pytest.approx(a.gradient, abs=1e-10)
    assert b.hessian * factor == pytest.approx(a.hessian, abs=1e-10)


@pytest.mark.parametrize(
    "same",
    [
        ExpressionProfile(z="-rho**2 / 1000"),
        ExpressionProfile(z="7 - (rho/10)**2/10"),
        PolynomialProfile(coefficients=(3.0, 0.0, -1e-3)),
    ],
    ids=["expression", "another expression", "polynomial"],
)
def test_formulas_of_the_paraboloid_agree_with_it(same: Profile) -> None:
    one, other = uncorrected(CHECK), punch(same)
    points = points_near(one, 300)
    a, b = one.gap(points), other.gap(points)
    assert np.abs(b.value - a.value).max() < 1e-12
    assert np.abs(b.gradient - a.gradient).max() < 1e-12
    assert np.abs(b.hessian - a.hessian).max() < 1e-12


def test_table_converges_at_fourth_order() -> None:
    """A cosine, which is no polynomial; errors at 12, 24 and 48 intervals fall by about 2^4."""

    def height(rho: Floats) -> Floats:
        return np.asarray(50 * np.cos(np.pi * rho / 400), dtype=np.float64)

    def error(count: int) -> float:
        rho = np.linspace(0, 320, count + 1)
        points = tuple(zip(rho.tolist(), height(rho).tolist(), strict=True))
        profile = table_of_paraboloid(4).model_copy(update={"points": points})
        made = bare(profile, 320.0)
        fine = np.linspace(0, 320, 1001)
        return float(np.abs(made.height(np.column_stack((fine, 0 * fine))) - height(fine)).max())

    errors = [error(12), error(24), error(48)]
    assert 13 < errors[0] / errors[1] < 20
    assert 13 < errors[1] / errors[2] < 20


def test_surface_of_revolution_has_mirror_planes_and_its_rim() -> None:
    made = uncorrected(CHECK)
    assert made.mirror_planes
    assert made.rim_radius == 300.0
    assert math.isinf(Sphere(1.0).rim_radius)


def test_meridian_shows_all_joints_and_its_ends() -> None:
    made = PUNCHES["cup"]
    line = made.meridian(60, radius=350.0)
    assert line.shape == (60, 2)
    for joint in ((0.0, 90.0), (245.0, 90.0), (270.0, 65.0), (270.0, 30.0), (300.0, 0.0), (350.0, 0.0)):
        assert np.hypot(*(line - joint).T).min() < 1e-12
    assert (np.diff(line[:, 0]) >= -1e-12).all()
    assert Sphere(2.0).meridian(31)[-1] == pytest.approx([0.0, -2.0], abs=1e-12)
    assert bare(PolynomialProfile(coefficients=(0.0, 0.0)), 5.0).meridian(6)[-1].tolist() == [5.0, 0.0]
    with pytest.raises(ValueError, match="at least 6 points"):
        made.meridian(5)


@pytest.mark.parametrize(
    ("profile", "height"),
    [
        (ParaboloidProfile(focal_length=250), -0.4),
        (SphereProfile(radius=400), math.sqrt(400**2 - 400)),
        (EllipsoidProfile(radius=400, height=200), 0.5 * math.sqrt(400**2 - 400)),
        (ConeProfile(half_angle=0.5, nose_radius=50), math.sqrt(50**2 - 400) - 50),
        (
            ConeProfile(half_angle=0.5, nose_radius=1),
            -20 / math.tan(0.5) + (1 / math.sin(0.5) - 1),
        ),
        (ConeProfile(half_angle=0.01, nose_radius=500), math.sqrt(500**2 - 400) - 500),
        (PolynomialProfile(coefficients=(1, 0, -1e-3)), 0.6),
        (table_of_paraboloid(9), -0.4),
        (ExpressionProfile(z="sqrt(rho**2 + 225)"), 25.0),
    ],
)
def test_bare_profiles_lie_where_their_formulas_put_them(profile: Profile, height: float) -> None:
    curve = profile_curve(profile, 60.0)
    assert curve.height(np.array([20.0])) == pytest.approx(height, rel=1e-12, abs=1e-12)
    made = bare(profile, 60.0)
    assert made.distance(np.array([(0.0, -20.0, height)])) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(made.height(np.array([(61.0, 0.0)]))).all()


def test_beyond_its_end_a_bare_profile_goes_on_straight() -> None:
    made = bare(PolynomialProfile(coefficients=(0.0, 0.0, -0.5)), 1.0)
    outside = made.gap(np.array([(2.0, 0.0, -1.5), (3.0, 0.0, -1.5)]))
    assert outside.value[0] == pytest.approx(0.0, abs=1e-15)
    assert outside.gradient[1] == pytest.approx([math.sqrt(0.5), 0, math.sqrt(0.5)])


def test_a_rim_fillet_wider_than_the_rim_may_fit_a_shallow_dome() -> None:
    made = uncorrected(PunchCase(profile=ParaboloidProfile(focal_length=1e4), rim_radius=300, fillet=400))
    assert 0 < made.height_at_axis < 3.0
    assert np.abs(made.distance(np.column_stack((made.meridian(99), np.zeros(99)))[:, [0, 2, 1]])).max() < 1e-11
