"""GRASP files: read again as their format is described, they are the surfaces of the run in the frame of the vertex."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import tiny_dish

from punchform.accuracy import ALIGNMENTS, Pose, best_fit, place
from punchform.arrays import Floats
from punchform.case import ParaboloidProfile
from punchform.case.reading import case_from_text
from punchform.errors import InputError
from punchform.export.grasp import Surface, objects, sfc, write_grasp
from punchform.export.heading import Heading
from punchform.export.smooth_heights import heights
from punchform.run import Run, run

RADIUS = 100.0


@dataclass(frozen=True)
class Read:
    """A .sfc file: words, lines along x and y [mm], z (nx, ny) [mm]."""

    words: str
    x: Floats
    y: Floats
    z: Floats


def read_sfc(text: str) -> Read:
    """By the description: words; xs ys xe ye; nx ny; then nx blocks of ny heights, broken anywhere."""
    words, corners, counts, *rest = text.split("\n")
    xs, ys, xe, ye = map(float, corners.split())
    nx, ny = map(int, counts.split())
    values = [float(one) for one in " ".join(rest).split()]
    assert len(values) == nx * ny
    blocks = [values[k * ny : (k + 1) * ny] for k in range(nx)]
    return Read(words, np.linspace(xs, xe, nx), np.linspace(ys, ye, ny), np.array(blocks))


def read_tor(text: str) -> dict[str, tuple[str, dict[str, str]]]:
    """Objects by name: their class and members."""
    bare = "\n".join(line for line in text.splitlines() if not line.startswith("//"))
    found = {}
    for name, kind, body in re.findall(r"^(\S+)\s+(\S+)\s*^\(\s*$(.*?)^\)\s*$", bare, re.S | re.M):
        members = dict(re.findall(r"^\s*(\w+)\s*:\s*(.*?),?\s*$", body, re.M))
        found[name] = (kind, members)
    return found


def numbers(struct: str) -> Floats:
    return np.array([float(one) for one in re.findall(r"[xyz]: (\S+?)(?: mm)?[,)]", struct)])


@cache
def released(grid: str = "", more: str = "") -> Run:
    return run(case_from_text(tiny_dish.TEXT.replace("[grid]", f"[grid]\n{grid}") + more))


@cache
def written(folder: Path, grid: str = "") -> dict[str, str]:
    return {file.name: file.read_text() for file in write_grasp(released(grid), folder)}


def test_heights_are_written_with_y_fastest() -> None:
    line = np.linspace(-2.0, 2.0, 3)
    z = 10.0 * line[:, None] + line
    text = sfc("words", Surface("bump", z, 2.0))
    assert text.split() == [
        "words",
        *("-2", "-2", "2", "2", "3", "3"),
        *(f"{one:.7f}" for one in (-22, -20, -18, -2, 0, 2, 18, 20, 22)),
    ]
    again = read_sfc(text)
    np.testing.assert_allclose(again.z, z, atol=1e-7)
    assert again.z[2, 0] == pytest.approx(18.0)


def crossings(step: float) -> Floats:
    """Places (n, 2) of a sheared net that reaches beyond the radius."""
    line = step * np.arange(-int(1.15 * RADIUS / step), int(1.15 * RADIUS / step) + 1)
    x, y = (part.ravel() for part in np.meshgrid(line, line, indexing="ij"))
    near = np.hypot(x, y) <= 1.15 * RADIUS
    places: Floats = np.column_stack((x + 0.2 * step * np.sin(y / 17.0), y))[near]
    return places


def paraboloid(places: Floats) -> Floats:
    x, y = places.T
    return np.asarray((x * x + y * y) / 400.0)


def lobes(places: Floats) -> Floats:
    """A dish that has sunk by 1 mm in four patches, as grids do."""
    x, y = places.T
    sunk = np.cos(4 * np.arctan2(y, x)) * (np.hypot(x, y) / RADIUS) ** 4 * np.cos(x / 40.0)
    return np.asarray(paraboloid(places) + sunk, dtype=np.float64)


def error(step: float) -> float:
    places = np.random.default_rng(5).uniform(-RADIUS, RADIUS, (3000, 2))
    places = places[np.linalg.norm(places, axis=1) <= RADIUS]
    net = crossings(step)
    found = heights(np.column_stack((net, lobes(net))), places, radius=RADIUS, step=step)
    return float(np.sqrt(np.mean((found - lobes(places)) ** 2)))


def test_a_paraboloid_is_met_exactly_also_in_the_corners() -> None:
    net = crossings(10.0)
    corners = RADIUS * np.array([[1.0, 1.0], [-1.0, 1.0], [0.3, -0.7]])
    found = heights(np.column_stack((net, paraboloid(net))), corners, radius=RADIUS, step=10.0)
    np.testing.assert_allclose(found, paraboloid(corners), atol=1e-10)


def test_other_surfaces_are_approached_faster_than_by_the_square_of_the_step() -> None:
    coarse, fine = error(10.0), error(5.0)
    assert coarse < 2e-3
    assert np.log2(coarse / fine) > 2.5


def test_crossings_lie_on_the_surface() -> None:
    net = crossings(10.0)
    inside = net[np.linalg.norm(net, axis=1) <= RADIUS]
    found = heights(np.column_stack((net, lobes(net))), inside, radius=RADIUS, step=10.0)
    np.testing.assert_allclose(found, lobes(inside), atol=1e-9)


def test_the_files_are_surfaces_rim_and_objects_that_name_them(tmp_path: Path) -> None:
    texts = written(tmp_path)
    assert list(texts) == ["formed.sfc", "released.sfc", "target.sfc", "dish.rim", "dish.tor"]
    named = read_tor(texts["dish.tor"])
    assert set(named) >= {"vertex_frame", "fitted_frame", "dish_rim", "released_surface", "released_reflector"}
    for name in ("formed", "released", "target"):
        kind, members = named[f"{name}_surface"]
        assert kind == "regular_xy_grid"
        assert members == {"file_name": f"{name}.sfc", "xy_unit": "mm", "z_unit": "mm"}
        assert named[f"{name}_reflector"][1]["surfaces"] == f"sequence(ref({name}_surface))"
        words = read_sfc(texts[f"{name}.sfc"]).words
        assert "mm" in words
        assert "vertex frame" in words
    words, count, *points = texts["dish.rim"].splitlines()
    assert named["dish_rim"] == ("tabulated_rim_xy", {"file_name": "dish.rim", "unit": "mm", "number_of_points": count})
    edge = np.array([[float(one) for one in point.split()] for point in points])
    assert edge.shape == (int(count), 2)
    np.testing.assert_allclose(np.linalg.norm(edge, axis=1), 40.0, atol=1e-6)


@pytest.mark.parametrize("grid", ["", "subdivide = 2", 'centre = "cell"'], ids=["quarter", "cut", "whole"])
def test_read_again_the_shape_has_the_deviations_that_it_was_judged_by(grid: str, tmp_path: Path) -> None:
    done = released(grid)
    read = read_sfc(written(tmp_path, grid)["released.sfc"])
    assert done.accuracy is not None
    apex = done.accuracy.target.apex_height
    whole = done.final.whole
    near = np.linalg.norm(whole.positions[:, :2], axis=1) <= 40.0
    judged = whole.positions[(whole.between == 0) & near]
    again = judged.copy()
    again[:, 2] = apex - spline_of(read)(judged[:, 0], -judged[:, 1])
    np.testing.assert_allclose(again, judged, rtol=0, atol=0.02)
    f = [
        best_fit(points, np.ones(len(points)), done.accuracy.target, ALIGNMENTS["4-parameter"], "axial").pose.f
        for points in (again, judged)
    ]
    assert f[0] == pytest.approx(f[1], rel=1e-3)


def spline_of(read: Read) -> Callable[[Floats, Floats], Floats]:
    from scipy.interpolate import RectBivariateSpline

    ev: Callable[[Floats, Floats], Floats] = RectBivariateSpline(read.x, read.y, read.z).ev
    return ev


def test_the_focal_length_of_the_formed_dish_is_that_of_the_punch(tmp_path: Path) -> None:
    read = read_sfc(written(tmp_path)["formed.sfc"])
    x, y = np.meshgrid(read.x, read.y, indexing="ij")
    near = np.hypot(x, y) <= 40.0
    terms = np.column_stack((np.ones(near.sum()), (x**2 + y**2)[near]))
    curvature = np.linalg.lstsq(terms, read.z[near], rcond=None)[0][1]
    assert 0.25 / curvature == pytest.approx(60.0, rel=2e-3)


def test_the_fitted_frame_sees_a_leaning_dish_upright() -> None:
    pose = Pose(u=1.0, v=-2.0, w=3.0, alpha=0.02, beta=-0.03, f=55.0)
    target = place(ParaboloidProfile(focal_length=60.0), 40.0, apex_height=20.0)
    x, y = np.random.default_rng(2).uniform(-30, 30, (2, 50))
    own = np.column_stack((x, y, -(x**2 + y**2) / (4 * 55.0)))
    points = own @ pose.rotation.T + pose.shift + (0.0, 0.0, target.apex_height)
    seen = (points - (0.0, 0.0, target.apex_height)) * (1.0, -1.0, -1.0)
    _, members = read_tor(objects(Heading("title", "objects", "units", "frame", "version"), [], pose))["fitted_frame"]
    first, second = numbers(members["x_axis"]), numbers(members["y_axis"])
    local = (seen - numbers(members["origin"])) @ np.column_stack((first, second, np.cross(first, second)))
    np.testing.assert_allclose(local[:, 2], (local[:, :2] ** 2).sum(axis=1) / (4 * 55.0), atol=1e-9)


def test_a_run_without_release_and_target_has_the_formed_surface_to_the_rim_of_the_punch(tmp_path: Path) -> None:
    done = run(tiny_dish.case().model_copy(update={"release": None, "target": None}))
    assert [file.name for file in write_grasp(done, tmp_path)] == ["formed.sfc", "dish.rim", "dish.tor"]
    assert read_sfc((tmp_path / "formed.sfc").read_text()).x[-1] == pytest.approx(60.0)


def test_a_rim_with_too_few_crossings_is_refused(tmp_path: Path) -> None:
    done = released()
    assert done.case.target is not None
    small = done.case.target.model_copy(update={"aperture_radius": 9.0})
    with pytest.raises(InputError, match="too few for a surface"):
        write_grasp(replace(done, case=done.case.model_copy(update={"target": small})), tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_shape_that_heights_cannot_show_is_refused(tmp_path: Path) -> None:
    done = released()
    whole = done.formed.whole
    cliff = whole.positions + np.where(whole.positions[:, :1] > 1.0, 300.0, 0.0) * (0.0, 0.0, 1.0)
    formed = replace(done.formed, whole=replace(whole, positions=cliff))
    with pytest.raises(InputError, match="too steep or too rough"):
        write_grasp(replace(done, formed=formed), tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_target_has_heights_in_the_corners_too(tmp_path: Path) -> None:
    """A cone ends at its base; beyond the rim it is written as if it went on."""
    cone = 'profile = { kind = "cone", half_angle = "70 deg", nose_radius = "20 mm" }\naperture_radius'
    text = tiny_dish.TEXT.replace('profile = { kind = "paraboloid", focal_length = "60 mm" }\naperture_radius', cone)
    done = run(case_from_text(text))
    assert done.accuracy is not None
    target = done.accuracy.target
    assert not np.isfinite(target.shape(target.pose).height(np.array([[60.0, 60.0]]))).all()
    write_grasp(done, tmp_path)
    read = read_sfc((tmp_path / "target.sfc").read_text())
    assert np.isfinite(read.z).all()
    # Along the diagonal the flank of the cone goes on as a straight line to the corner.
    diagonal = np.diag(read.z)
    np.testing.assert_allclose(np.diff(diagonal[-6:], 2), 0.0, atol=1e-5)
