"""A punch with a correction: derivatives, order of its spline, mirror planes, limits, what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from corrections import CORRECTED, REACH, Shape, as_revolution, dome, fading, field, lobed, skew, turned
from punches import CHECK, PUNCHES, points_near

from punchform.arrays import Floats
from punchform.case import PunchCase
from punchform.errors import InputError
from punchform.punch import (
    Corrected,
    Correction,
    HeightField,
    Paraboloid,
    RadialCorrection,
    check_correction,
    corrected,
    lowered,
    project,
    section,
    section_angles,
    surface,
    uncorrected,
)

every_corrected = pytest.mark.parametrize("made", CORRECTED.values(), ids=CORRECTED.keys())
BASE = PUNCHES["paraboloid"]
FLATTER = 260.0
"""Focal length [mm] of another paraboloid than the base's 250 mm."""


def on_surface(made: Corrected, count: int = 400) -> Floats:
    """Points of the corrected surface, (count, 3), walls included."""
    rng = np.random.default_rng(3)
    rho, z = made.base.meridian(4001)[rng.integers(0, 4001, count)].T
    angle = rng.uniform(0, 2 * math.pi, count)
    xy = rho[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    return np.column_stack((xy, z + made.correction.value(xy)))


def on_plane(count: int = 3000, reach: float = 1.1 * REACH) -> Floats:
    """Points in plan, on the axis and on both mirror planes among them."""
    xy = np.random.default_rng(4).uniform(-reach, reach, (count, 2))
    xy[:3], xy[3:30, 0], xy[30:60, 1] = 0.0, 0.0, 0.0
    return xy


@pytest.mark.parametrize(
    "added", [field(lobed), field(skew, whole=True), turned(dome)], ids=["quarter", "whole", "turned"]
)
def test_a_correction_is_twice_differentiable_everywhere(added: Correction) -> None:
    """Also across its points, its mirror lines and its edge."""
    xy, h = on_plane(), 1e-3
    rise = added.rise(xy)
    for axis in range(2):
        shift = h * np.eye(2)[axis]
        plus, minus = added.rise(xy + shift), added.rise(xy - shift)
        np.testing.assert_allclose((plus.value - minus.value) / (2 * h), rise.gradient[:, axis], atol=1e-9)
        slope = (plus.gradient - minus.gradient) / (2 * h)
        np.testing.assert_allclose(slope, rise.hessian[:, axis], atol=1e-6 * np.abs(rise.hessian).max())
        assert np.abs(plus.hessian - minus.hessian).max() < 1e-3 * np.abs(rise.hessian).max()


@pytest.mark.parametrize(
    "added", [field(lobed), field(skew, whole=True), turned(dome)], ids=["quarter", "whole", "turned"]
)
def test_a_correction_goes_through_its_points_and_is_nil_outside(added: Correction) -> None:
    *xy, dz = added.points.T
    places = np.column_stack((xy[0], xy[1] if len(xy) > 1 else np.zeros_like(dz)))
    np.testing.assert_allclose(added.value(places), dz, atol=1e-13)
    outside = on_plane(500, 3 * REACH)
    outside = outside[np.abs(outside).max(axis=1) >= REACH]
    rise = added.rise(outside)
    assert not any(part.any() for part in rise)


@every_corrected
def test_its_points_are_those_of_the_punch_moved_up_or_down(made: Corrected) -> None:
    points = on_surface(made)
    assert np.abs(made.distance(points)).max() < 1e-11 * 300
    up, down = (made.distance(points + np.array((0, 0, shift))) for shift in (0.5, -0.5))
    apart = np.abs(made.gap(points).gradient[:, 2]) > 0.01
    assert (up > 0)[apart].all()
    assert (down < 0)[apart].all()
    xy = points[apart, :2]
    np.testing.assert_allclose(made.height(xy), made.base.height(xy) + made.correction.value(xy))
    assert (made.rim_radius, made.height_at_axis) == (made.base.rim_radius, made.base.height_at_axis)


@every_corrected
def test_on_the_surface_its_derivatives_are_those_of_a_signed_distance(made: Corrected) -> None:
    points, h = on_surface(made), 1e-4
    gap = made.gap(points)
    np.testing.assert_allclose(np.linalg.norm(gap.gradient, axis=1), 1.0)
    np.testing.assert_allclose(gap.hessian, gap.hessian.transpose(0, 2, 1), atol=1e-15)
    np.testing.assert_allclose(gap.hessian @ gap.gradient[:, :, None], 0.0, atol=1e-14)
    slope, bend = np.empty((len(points), 3)), np.empty((len(points), 3, 3))
    smooth = np.ones(len(points), dtype=bool)
    for axis in range(3):
        shift = h * np.eye(3)[axis]
        plus, minus = made.gap(points + shift), made.gap(points - shift)
        slope[:, axis] = (plus.value - minus.value) / (2 * h)
        bend[:, :, axis] = (plus.gradient - minus.gradient) / (2 * h)
        smooth &= np.abs(plus.hessian - minus.hessian).max(axis=(1, 2)) < 1e-3 * np.abs(gap.hessian).max() + 1e-9
    assert smooth.mean() > 0.95
    np.testing.assert_allclose(slope, gap.gradient, atol=1e-5)
    across = np.eye(3) - gap.gradient[:, :, None] * gap.gradient[:, None]
    np.testing.assert_allclose((across @ bend @ across)[smooth], gap.hessian[smooth], atol=1e-6)
    alone, normals = made.distance_gradient(points)
    np.testing.assert_array_equal(alone, made.distance(points))
    np.testing.assert_array_equal(normals, gap.gradient)


@pytest.mark.parametrize("name", PUNCHES)
def test_a_correction_of_nil_changes_nothing(name: str) -> None:
    base = PUNCHES[name]
    nil = np.zeros(5)
    points = points_near(base, 200)
    theirs = base.gap(points)
    for added in (HeightField(np.arange(5.0), np.arange(5.0), np.zeros((5, 5))), RadialCorrection(np.arange(5.0), nil)):
        ours = Corrected(base, added).gap(points)
        np.testing.assert_allclose(ours.value, theirs.value, rtol=1e-15, atol=1e-15)
        np.testing.assert_allclose(ours.gradient, theirs.gradient, atol=1e-15)
        np.testing.assert_allclose(ours.hessian, theirs.hessian, atol=1e-12 * np.abs(theirs.hessian).max())
    assert corrected(base, None) is base


@pytest.mark.parametrize(("make", "shape"), [(field, lobed), (turned, dome)], ids=["field", "turned"])
def test_the_spline_is_of_the_fourth_order(make: Callable[..., Correction], shape: Shape) -> None:
    """Half the step: a 16th of the error of values, an 8th of that of slopes, a quarter of that of bends."""
    xy, h = on_plane(2000, REACH), 1e-3

    def exact(points: Floats) -> Floats:
        return shape(np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0]))

    east = np.array((h, 0.0))
    truth = exact(xy), (exact(xy + east) - exact(xy - east)) / (2 * h), make(shape, 401).hessian(xy)[:, 0, 0]
    errors = []
    for count in (26, 51, 101):
        rise = make(shape, count).rise(xy)
        found = rise.value, rise.gradient[:, 0], rise.hessian[:, 0, 0]
        errors.append([np.abs(one - other).max() for one, other in zip(found, truth, strict=True)])
    coarse, middle, fine = np.array(errors)
    assert middle[0] < 1e-4
    assert (coarse / middle > np.array([11.0, 5.5, 2.7])).all()
    assert (middle / fine > np.array([14.0, 7.0, 3.4])).all()


@pytest.mark.parametrize("make", [field, turned], ids=["field", "turned"])
def test_one_paraboloid_becomes_another(make: Callable[..., Correction]) -> None:
    """c = (1/4f - 1/4F) rho² inside: what the spline does further out dies away by 0.27 a step."""

    def to_the_flatter(rho: Floats, phi: Floats) -> Floats:
        return (0.25 / 250.0 - 0.25 / FLATTER) * rho**2 * fading(rho, 0.6 * REACH, 0.98 * REACH)

    xy = on_plane(2000, 0.25 * REACH)
    z = BASE.height_at_axis - 0.25 * (xy**2).sum(axis=1) / FLATTER
    ours = Corrected(BASE, make(to_the_flatter, 51)).gap(np.column_stack((xy, z)))
    theirs = Paraboloid(FLATTER).gap(np.column_stack((xy, z - BASE.height_at_axis)))
    assert np.abs(ours.value).max() < 1e-10
    np.testing.assert_allclose(ours.gradient, theirs.gradient, atol=1e-10)
    np.testing.assert_allclose(ours.hessian, theirs.hessian, atol=1e-10)


def test_a_correction_of_revolution_is_another_surface_of_revolution() -> None:
    added = turned(dome)
    same, made = as_revolution(BASE, added), Corrected(BASE, added)
    points = on_surface(made)
    ours, theirs = made.gap(points), same.gap(points)
    assert np.abs(theirs.value).max() < 1e-10
    np.testing.assert_allclose(ours.gradient, theirs.gradient, atol=1e-11)
    np.testing.assert_allclose(ours.hessian, theirs.hessian, atol=1e-9)
    np.testing.assert_allclose(made.height(points[:, :2]), same.height(points[:, :2]), atol=1e-11)


def test_a_mirrored_quarter_is_the_whole() -> None:
    quarter, whole = field(lobed), field(lobed, whole=True)
    assert quarter.mirror_planes
    assert whole.mirror_planes
    assert turned(dome).mirror_planes
    assert not field(skew, whole=True).mirror_planes
    xy = on_plane()
    for one, other in zip(quarter.rise(xy), whole.rise(xy), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-13)
    for turn in ((-1.0, 1.0), (1.0, -1.0)):
        np.testing.assert_array_equal(quarter.value(xy * turn), quarter.value(xy))
        np.testing.assert_array_equal(quarter.gradient(xy * turn) * turn, quarter.gradient(xy))
        np.testing.assert_array_equal(quarter.hessian(xy * turn) * np.outer(turn, turn), quarter.hessian(xy))


@every_corrected
@pytest.mark.parametrize("share", [1.0 / 12, 0.5])
def test_on_the_way_down_its_heights_are_a_share_of_it(made: Corrected, share: float) -> None:
    low, points = lowered(made, share), on_surface(made) * (1.0, 1.0, share)
    assert np.abs(low.distance(points)).max() < 1e-11 * 300
    np.testing.assert_allclose(low.height(points[:, :2]), share * made.height(points[:, :2]))
    normals = low.gap(points).gradient
    across = np.cross(normals, np.random.default_rng(2).standard_normal(points.shape))
    after = points + 2.5 * share**2 * across / np.linalg.norm(across, axis=1)[:, None]
    found = project(low, after, normals)
    assert np.abs(low.distance(found)).max() < 1e-11 * 300


def test_a_correction_of_the_lowered_punch_is_lowered_with_it() -> None:
    added, share = field(lobed), 0.25
    part = HeightField(added.x, added.y, share * added.dz)
    far, near = Paraboloid(60.0 / share), Paraboloid(60.0)
    ours, theirs = lowered(Corrected(near, added), share), Corrected(far, part)
    xy = on_plane(300, 80.0)
    points = np.column_stack((xy, theirs.height(xy)))
    a, b = ours.gap(points), theirs.gap(points)
    np.testing.assert_allclose(a.gradient, b.gradient, atol=1e-12)
    np.testing.assert_allclose(a.hessian, b.hessian, atol=1e-12)


def test_sections_follow_the_correction() -> None:
    made = CORRECTED["quarter"]
    assert section_angles(made) == (0.0, 22.5, 45.0)
    assert section_angles(CORRECTED["turned"]) == section_angles(BASE) == (0.0,)
    assert len(section_angles(CORRECTED["whole"])) == 16
    for degrees in section_angles(made):
        line = section(made, degrees, count=200, radius=345.0)
        angle = math.radians(degrees)
        points = np.column_stack((line[:, 0] * math.cos(angle), line[:, 0] * math.sin(angle), line[:, 1]))
        assert np.abs(made.distance(points)).max() < 1e-11 * 300


def test_a_case_gives_the_punch_with_its_correction() -> None:
    added = field(lobed, 9)
    case = CHECK.model_copy(update={"correction": added.setting})
    made = surface(PunchCase.model_validate(case.model_dump()))
    assert isinstance(made, Corrected)
    assert isinstance(made.correction, HeightField)
    np.testing.assert_array_equal(made.correction.points, added.points)
    assert made.base == uncorrected(CHECK)
    rows = list(added.points)
    np.random.default_rng(0).shuffle(rows)
    shuffled = surface(CHECK.model_copy(update={"correction": {"kind": "field", "points": np.array(rows).tolist()}}))
    assert isinstance(shuffled, Corrected)
    np.testing.assert_array_equal(shuffled.correction.points, added.points)


AXES = np.linspace(0.0, 90.0, 10)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: HeightField(AXES, AXES, np.ones((10, 10))), "still 1 mm at its edge, at x = 90 mm, y = 0 mm"),
        (lambda: HeightField(AXES - 40, AXES, np.eye(10)), "still 1 mm at its edge, at x = 50 mm, y = 90 mm"),
        (lambda: HeightField(AXES[:3], AXES, np.ones((3, 10))), "3 different x are too few"),
        (lambda: HeightField(AXES[::-1], AXES, np.ones((10, 10))), "x must be finite and increase"),
        (lambda: HeightField(AXES, AXES, np.ones((9, 10))), "one for every x and y"),
        (lambda: HeightField(AXES, AXES, np.full((10, 10), np.nan)), "must be finite"),
        (lambda: RadialCorrection(AXES, np.ones(10)), "still 1 mm at its edge, at rho = 90 mm"),
        (lambda: RadialCorrection(AXES + 1, np.zeros(10)), "starts at rho = 1 mm, not on the axis"),
        (lambda: RadialCorrection(AXES, np.zeros(9)), "one for every rho"),
    ],
)
def test_what_cannot_be_a_correction_is_refused(make: Callable[[], Correction], words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()


def scaled(added: HeightField, times: float) -> Corrected:
    return Corrected(BASE, HeightField(added.x, added.y, times * added.dz))


def test_bends_slopes_and_depth_of_a_correction_are_looked_at() -> None:
    gentle = field(lobed)
    assert check_correction(scaled(gentle, 1.0), 7.5) == ((), ())
    [steep], _ = check_correction(scaled(gentle, 90.0), 1e-3)
    assert "steeper than 45 degrees" in steep.message
    round_one = turned(dome)
    [deep], _ = check_correction(Corrected(BASE, RadialCorrection(round_one.rho, -46.0 * round_one.dz)), 1e-3)
    assert "below its flange at rho = 40 mm" in deep.message
    hat = np.where(AXES < 90.0, np.exp(-((AXES / 15.0) ** 2)), 0.0)
    bumpy = Corrected(BASE, HeightField(AXES, AXES, 3.0 * np.outer(hat, hat)))
    errors, [tight] = check_correction(bumpy, 25.0)
    assert "hardly wider than the grid step of 25 mm" in tight.message
    assert not errors
    [sharp], doubts = check_correction(bumpy, 50.0)
    assert "at x = " in sharp.message
    assert "sharper than the grid step of 50 mm" in sharp.message
    assert (sharp.where, doubts) == ("punch.correction", ())


def test_a_correction_of_the_flange_is_told() -> None:
    errors, doubts = check_correction(CORRECTED["over the wall"], 7.5)
    assert not errors
    assert "the correction changes the flange by" in doubts[-1].message
    assert "beyond the rim at 300 mm" in doubts[-1].message
