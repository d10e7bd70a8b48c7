"""Deviations, weights, statistics, the wire surface and the verdict."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import tiny_dish
from perfect_dishes import FOCAL_LENGTH, RADIUS, disc, dish, net, with_error

from punchform.accuracy import (
    Aperture,
    deviations,
    feet,
    measure,
    measure_case,
    offset,
    place,
    plain,
    statistics,
    tributary_areas,
    wire_surface,
)
from punchform.arrays import Floats
from punchform.case import ConeProfile, ParaboloidProfile, SphereProfile, TargetCase
from punchform.errors import InputError
from punchform.prepare import prepare
from punchform.run import run as form

DISC = disc()


def normal_rise(steepness: Floats) -> Floats:
    """n_z of a paraboloid whose slope is rho/2f."""
    return 1 / np.sqrt(1 + steepness**2)


# --- deviations --------------------------------------------------------------------------------------------


def test_a_parallel_surface_has_one_normal_deviation() -> None:
    target = dish(apex_height=25.0)
    points = offset(with_error(DISC, 0 * DISC.x) + np.array([0.0, 0.0, 25.0]), target, 0.375)
    found = deviations(points, target)
    assert found.normal == pytest.approx(np.full(len(points), 0.375), abs=1e-10)
    steepness = np.hypot(*feet(points, target)[:, :2].T) / (2 * FOCAL_LENGTH)
    assert found.half_path == pytest.approx(0.375 * normal_rise(steepness), abs=1e-10)
    assert (found.axial > found.normal - 1e-9).all()


def test_small_errors_keep_the_ratios_of_the_measures() -> None:
    """normal = axial cos psi, half-path = axial cos² psi, to first order; all are positive upwards."""
    points = with_error(DISC, np.full_like(DISC.x, -1e-5))
    found = deviations(points, dish())
    cosine = normal_rise(RADIUS * DISC.rho / (2 * FOCAL_LENGTH))
    assert found.axial == pytest.approx(np.full(len(points), 1e-5), rel=1e-6)
    assert found.normal == pytest.approx(1e-5 * cosine, rel=1e-6)
    assert found.half_path == pytest.approx(1e-5 * cosine**2, rel=1e-6)


def test_half_path_is_half_of_what_the_path_of_a_ray_grows_by() -> None:
    """Rays from the focus to the points and on to a plane below: exact lengths to second order in the error."""
    error = 1e-4
    points = with_error(DISC, np.full_like(DISC.x, -error))
    focus = dish().focus(dish().pose)

    def path(there: Floats) -> Floats:
        return np.asarray(np.linalg.norm(there - focus, axis=1) + there[:, 2])

    longer = path(points) - path(with_error(DISC, 0 * DISC.x))
    assert 2 * deviations(points, dish()).half_path == pytest.approx(longer, rel=1e-5, abs=1e-13)


def test_the_edge_of_a_nine_metre_dish_shows_the_published_difference() -> None:
    """T9: f = 3.42 m; axial and normal residuals differ by 16.46 % at the edge."""
    target = place(ParaboloidProfile(focal_length=3420.0), 4500.0, apex_height=0.0)
    found = deviations(np.array([[4500.0, 0.0, -(4500.0**2) / (4 * 3420.0) + 1e-3]]), target)
    assert 1 - found.normal[0] / found.axial[0] == pytest.approx(0.1646, abs=5e-5)


def test_axial_deviation_goes_straight_on_beyond_the_end_of_a_profile() -> None:
    target = place(SphereProfile(radius=100.0), 100.0 / 1.05, apex_height=0.0)
    points = np.array([[0.0, 0.0, 1.0], [120.0, 0.0, 0.0]])
    found = deviations(points, target)
    assert found.axial[0] == pytest.approx(1.0, abs=1e-12)
    assert np.isfinite(found.axial).all()


def test_the_apex_of_any_profile_is_where_it_is_put() -> None:
    for profile in (SphereProfile(radius=400.0), ConeProfile(half_angle=1.2, nose_radius=50.0)):
        target = place(profile, 250.0, apex_height=33.0)
        assert deviations(np.array([[0.0, 0.0, 33.5]]), target).normal == pytest.approx([0.5], abs=1e-12)


# --- weights and statistics --------------------------------------------------------------------------------


def test_weights_add_up_to_the_area_of_the_aperture() -> None:
    """To the first order in the step, as nodes are in or out; and the areas of all cells exactly."""
    for step in (20.0, 10.0, 5.0):
        points, cells = net(step)
        areas = tributary_areas(points, cells)
        assert areas.sum() == pytest.approx(len(cells) * step**2, rel=1e-12)
        inside = Aperture(RADIUS).mask(points)
        assert areas[inside].sum() == pytest.approx(math.pi * RADIUS**2, rel=step / RADIUS)


@pytest.mark.parametrize(
    ("ratio", "from_normal", "from_axial"),
    [
        (0.25, 0.8326, 0.7071),
        (0.3, 0.8714, 0.7682),
        (0.4, 0.9188, 0.8480),
        (0.5, 0.9448, 0.8944),
        (1.0, 0.9849, 0.9701),
    ],
)
def test_conversion_factors_of_uniform_errors(ratio: float, from_normal: float, from_axial: float) -> None:
    """Random normal (axial) errors of equal size everywhere: A_n² = ln(1+x²)/x², A_z² = 1/(1+x²), x = a/2f."""
    x = 1 / (4 * ratio)
    steepness = x * DISC.rho
    rise = normal_rise(steepness)
    closed = math.sqrt(math.log(1 + x**2) / x**2), 1 / math.sqrt(1 + x**2)
    assert closed == pytest.approx((from_normal, from_axial), abs=5e-5)
    assert statistics(rise, DISC.weights).rms == pytest.approx(closed[0], rel=1e-9)
    assert statistics(rise**2, DISC.weights).rms == pytest.approx(closed[1], rel=1e-9)
    points, cells = net(10.0)
    inside = Aperture(RADIUS).mask(points)
    area = tributary_areas(points, cells)[inside]
    on_grid = normal_rise(x * np.hypot(*points[inside, :2].T) / RADIUS)
    assert statistics(on_grid, area).rms == pytest.approx(closed[0], rel=5e-3)
    assert statistics(on_grid**2, area).rms == pytest.approx(closed[1], rel=5e-3)


def test_an_aperture_may_be_a_ring_and_its_edge_weakly_lit() -> None:
    ring = Aperture(RADIUS, inner_radius=100.0, taper=12.0)
    points = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 300.0, 0.0], [301.0, 0.0, 0.0], [math.nan, 0.0, 0.0]])
    assert ring.mask(points).tolist() == [False, True, True, False, False]
    light = ring.illumination(points[:3])
    assert light[0] == 1.0
    assert 20 * math.log10(light[2]) == pytest.approx(-12.0)
    assert Aperture(RADIUS).illumination(points[:4]) == pytest.approx(np.ones(4))
    for wrong in ({"inner_radius": 300.0}, {"taper": -1.0}):
        with pytest.raises(InputError, match="must be at least 0"):
            Aperture(RADIUS, **wrong)


def test_statistics_of_weighted_values() -> None:
    found = statistics(np.array([-2.0, 1.0, 4.0]), np.array([1.0, 2.0, 1.0]))
    assert (found.mean, found.rms) == pytest.approx((1.0, math.sqrt(22 / 4)))
    assert found.sigma**2 == pytest.approx(found.rms**2 - found.mean**2)
    assert (found.lowest, found.highest, found.peak_to_valley, found.p95) == (-2.0, 4.0, 6.0, 4.0)
    even = statistics(np.linspace(-1, 1, 2001), np.ones(2001))
    assert even.p95 == pytest.approx(0.95, abs=1e-3)
    with pytest.raises(ValueError, match="weight"):
        statistics(np.ones(2), np.zeros(2))


def test_doubled_nodes_count_like_doubled_weights() -> None:
    values, weights = np.random.default_rng(0).normal(size=(2, 40))
    weights = np.rint(3 * np.abs(weights)) + 1
    copies = np.repeat(values, weights.astype(int))
    one, many = statistics(values, weights), statistics(copies, np.ones(len(copies)))
    assert (one.rms, one.mean, one.sigma) == pytest.approx((many.rms, many.mean, many.sigma), rel=1e-12)
    assert (one.lowest, one.highest, one.p95) == (many.lowest, many.highest, many.p95)


# --- the wire surface and the verdict ----------------------------------------------------------------------


def test_the_crowns_of_a_woven_wire() -> None:
    outer = wire_surface("outer crown", height=0.75, diameter=0.75)
    inner = wire_surface("inner crown", height=0.75, diameter=0.75)
    assert (outer.offset, inner.offset) == (0.75, -0.75)
    assert wire_surface("middle", height=0.75, diameter=0.75).offset == 0.0
    lower = [wire_surface(which, height=0.6, diameter=0.8, convention="lower").offset for which in ("middle",)]
    assert lower == pytest.approx([0.3])
    points, cells = net(20.0)
    accuracy = measure(points, dish(), Aperture(RADIUS), cells=cells, surface=outer)
    assert accuracy.as_held.statistics["normal"].mean == pytest.approx(0.75, abs=1e-9)
    assert accuracy.surface is outer


CASE = TargetCase(profile=ParaboloidProfile(focal_length=FOCAL_LENGTH), aperture_radius=RADIUS, tolerance=0.3)


def lobed(height: float = 0.0) -> Floats:
    points, _ = net(15.0)
    rho, phi = np.hypot(*points[:, :2].T) / RADIUS, np.arctan2(points[:, 1], points[:, 0])
    return np.asarray(points + np.column_stack((0 * rho, 0 * rho, height + rho**4 * np.cos(4 * phi))))


def test_the_verdict_follows_measure_and_alignment() -> None:
    _, cells = net(15.0)
    points = lobed(height=0.5)
    held = measure_case(points, cells, CASE, apex_height=0.0)
    assert held.judged == held.as_held.statistics["normal"]
    assert held.within is False
    best = measure_case(points, cells, CASE.model_copy(update={"alignment": "best fit"}), apex_height=0.0)
    assert best.judged == best.named("4-parameter").statistics["normal"]
    assert (held.aligned, best.aligned) == (held.as_held, best.fitted)
    assert held.aligned_for(best.judge) is held.fitted, "as another run is judged"
    assert best.judged.rms < held.judged.rms
    assert best.within is True
    raised = measure_case(points, cells, CASE, apex_height=0.5)
    assert held.as_held.statistics["axial"].mean == pytest.approx(
        raised.as_held.statistics["axial"].mean + 0.5, rel=1e-9
    )
    assert measure(points, dish(), Aperture(RADIUS), cells=cells).within is None
    with pytest.raises(KeyError):
        held.named("5-parameter")


def test_four_lobes_are_told() -> None:
    points, (_, cells) = lobed(), net(15.0)
    accuracy = measure_case(points, cells, CASE, apex_height=0.0)
    for aligned in (accuracy.as_held, accuracy.fitted):
        assert aligned.harmonics is not None
        assert max(aligned.harmonics.parts, key=lambda part: part.share).m == 4
        assert aligned.harmonics.parts[4].share > 0.98


def test_a_taper_lets_the_edge_count_less() -> None:
    points, (_, cells) = lobed(), net(15.0)
    even = measure_case(points, cells, CASE, apex_height=0.0)
    tapered = measure_case(points, cells, CASE.model_copy(update={"taper": 12.0}), apex_height=0.0)
    assert tapered.judged.rms < even.judged.rms
    assert "12 dB" in tapered.weighting


def test_nodes_without_a_place_or_a_cell_are_said() -> None:
    points, cells = net(30.0)
    points[0] = math.nan
    lost = int(np.argmin(np.hypot(points[1:, 0], points[1:, 1]))) + 1
    accuracy = measure(points, dish(), Aperture(RADIUS), cells=cells[(cells != lost).all(axis=1)])
    assert any("1 nodes of the aperture belong to no cell" in warning for warning in accuracy.warnings)
    assert np.isnan(accuracy.as_held.deviations.normal[0])
    assert accuracy.weights[lost] == 0
    with pytest.raises(InputError, match="no node of the grid"):
        measure(points, dish(), Aperture(RADIUS), cells=np.empty((0, 4), dtype=np.int64))


def test_too_small_an_aperture_is_told() -> None:
    points, cells = net(30.0)
    with pytest.raises(InputError, match="too few to fit"):
        measure(points, dish(), Aperture(20.0), cells=cells)


@pytest.mark.parametrize("profile", [CASE.profile, ConeProfile(half_angle=1.1, nose_radius=40.0)])
def test_the_plain_figures_are_strict_json(profile: ParaboloidProfile | ConeProfile) -> None:
    points, cells = net(30.0)
    case = CASE.model_copy(update={"profile": profile})
    accuracy = measure_case(points, cells, case, apex_height=0.0)
    figures = json.loads(json.dumps(plain(accuracy), allow_nan=False))
    assert figures["judged_on"]["rms_mm"] == accuracy.judged.rms
    assert figures["judged_on"]["within"] is accuracy.within
    assert list(figures["alignments"]) == [aligned.name for aligned in accuracy.alignments]
    for aligned in figures["alignments"].values():
        assert set(aligned["deviations"]) == {"axial", "normal", "half-path"}


def test_the_inner_radius_of_a_case_must_be_inside() -> None:
    with pytest.raises(ValueError, match="leaves nothing"):
        TargetCase(profile=CASE.profile, aperture_radius=100.0, tolerance=1.0, inner_radius=100.0)


def test_a_run_whose_nodes_lie_on_the_lower_wire_is_judged_by_the_middle_above_them() -> None:
    lower = tiny_dish.case('[press]\noffset = "lower"\n')
    centred = form(tiny_dish.case())
    found = form(lower)
    assert found.accuracy is not None
    assert centred.accuracy is not None
    half = 0.5 * prepare(lower).elements[0].height
    assert found.accuracy.surface.offset == pytest.approx(half)
    assert centred.accuracy.surface.offset == 0.0
    again = measure_case(
        found.final.whole.positions,
        found.final.whole.cells,
        lower.target or CASE,
        apex_height=prepare(lower).punch.height_at_axis,
    )
    shift = found.accuracy.as_held.statistics["normal"].mean - again.as_held.statistics["normal"].mean
    assert shift == pytest.approx(half, rel=1e-6)
