"""Punch and shapes as solids and surfaces: closed, of the right volume, through every crossing; read by others."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from exported_runs import MADE, made
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from scipy.integrate import quad
from scipy.interpolate import NdBSpline
from scipy.spatial import Delaunay

from punchform.arrays import Floats
from punchform.case import FlatProfile, ParaboloidProfile, PunchCase, SphereProfile, packaged_cases, read_case
from punchform.errors import InputError
from punchform.export.occt import demand_occt, trimmed_face
from punchform.export.punch_files import EDGE, PLATE, TOLERANCE
from punchform.export.punch_mesh import punch_mesh, stl
from punchform.export.shapes import shapes
from punchform.export.spline import filled, spline_of
from punchform.export.step import no_more_than, step_bytes, step_files
from punchform.export.step_punch import NEAR, NEAR_FIELD, punch_solid
from punchform.export.stl import punches, stl_files
from punchform.punch import (
    Corrected,
    HeightField,
    Paraboloid,
    RadialCorrection,
    Revolution,
    Tool,
    is_turned,
    surface,
    uncorrected,
)
from punchform.whole import Whole

RIM = 60.0
RADIUS = EDGE * RIM
WITH_A_PUNCH = [name for name in packaged_cases() if read_case(f"packaged:{name}").punch is not None]


def read(content: bytes) -> Any:
    """The shape of a STEP file."""
    reader = STEPControl_Reader()
    assert reader.ReadStream("file.step", BytesIO(content)) == IFSelect_ReturnStatus.IFSelect_RetDone
    reader.TransferRoots()
    return reader.OneShape()


def away(shape: Any, points: Floats) -> Floats:
    """Distances (n,) of points (n, 3) from the faces of a shape."""
    faces = part(shape, TopAbs_ShapeEnum.TopAbs_SHELL)
    return np.array(
        [
            BRepExtrema_DistShapeShape(faces, BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex()).Value()
            for point in points.tolist()
        ]
    )


def part(shape: Any, kind: Any) -> Any:
    found = TopExp_Explorer(shape, kind)
    assert found.More()
    return found.Current()


def volume(shape: Any, within: float = 1e-8) -> float:
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, within)
    return float(found.Mass())


def turned_volume(tool: Tool, radius: float, plate: float) -> float:
    """Of a punch of revolution with its plate [mm³], by integration over the radius."""

    def ring(rho: float) -> float:
        return 2 * math.pi * rho * float(tool.height(np.array([[rho, 0.0]]))[0])

    punch = quad(ring, 0.0, radius, points=[20.0, 30.0, 40.0, 45.0, 50.0, 60.0], limit=400, epsrel=1e-9)[0]
    return float(punch) + math.pi * radius**2 * plate


# --- STL ----------------------------------------------------------------------------------------------------


def test_the_punch_is_a_closed_solid_for_trimesh(tmp_path: Path) -> None:
    run = made("corrected")
    assert [path.name for path in stl_files(run, tmp_path)] == ["punch.stl", "punch_designed.stl"]
    for name, tool in punches(run).items():
        mesh = trimesh.load_mesh(tmp_path / f"{name}.stl")
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.is_volume
        exact = turned_volume(tool, RADIUS, PLATE)
        assert exact - TOLERANCE * math.pi * RADIUS**2 < mesh.volume < exact
        assert mesh.bounds[0].tolist() == pytest.approx([-RADIUS, -RADIUS, -PLATE], abs=1e-5)
        on_top = mesh.triangles_center[(mesh.triangles[:, :, 2] > -0.5 * PLATE).all(axis=1)]
        assert np.abs(tool.distance(on_top)).max() < TOLERANCE


def test_a_paraboloid_has_the_corners_of_its_formula(tmp_path: Path) -> None:
    """Inside the fillet corners stand at z = top - rho² / 4f."""
    (path,) = stl_files(made("elastic"), tmp_path)
    mesh = trimesh.load_mesh(path)
    top = mesh.bounds[1, 2]
    corners = mesh.triangles
    tip = corners[(corners[:, :, 2] > top - 3.0).all(axis=1)]
    assert len(tip) > 500
    rho = np.hypot(tip[..., 0], tip[..., 1])
    assert np.abs(tip[..., 2] - (top - rho**2 / 240.0)).max() < 1e-5


def test_without_a_correction_there_is_one_punch(tmp_path: Path) -> None:
    assert [path.name for path in stl_files(made("only pressed"), tmp_path)] == ["punch.stl"]


# --- the surface through the crossings ------------------------------------------------------------------------


def laid_on(surface: Any, step: float, radius: float) -> Whole:
    """A round grid whose crossings stand above their flat places on a surface."""
    whole = made("elastic").formed.whole
    count = int(radius / step)
    i, j = (part.ravel() for part in np.meshgrid(*2 * [np.arange(-count, count + 1)], indexing="ij"))
    inside = np.hypot(i, j) * step <= radius * (1 + 1e-9)
    flat = step * np.column_stack((i, j, 0 * i))[inside].astype(np.float64)
    high = flat + np.column_stack((0 * flat[:, :2], surface.height(flat[:, :2])))
    index = np.column_stack((i, j))[inside]
    return replace(whole, index=index, between=np.zeros(len(flat), dtype=np.int64), flat=flat, positions=high)


def test_the_surface_between_crossings_is_of_the_fourth_order() -> None:
    worst = []
    for step in (10.0, 5.0, 2.5):
        whole = laid_on(Paraboloid(60.0), step, 60.0)
        # A surface that is no polynomial, or every step would be exact.
        bent = whole.positions.copy()
        bent[:, 2] = 20 * np.cos(bent[:, 0] / 30) * np.cos(bent[:, 1] / 40)
        spline = spline_of(replace(whole, positions=bent))
        places = np.random.default_rng(1).uniform(-30, 30, (200, 2))
        exact = 20 * np.cos(places[:, 0] / 30) * np.cos(places[:, 1] / 40)
        worst.append(np.abs(spline.at(places)[:, 2] - exact).max())
    assert worst[0] < 0.02
    np.testing.assert_array_less(np.array(worst[1:]), np.array(worst[:-1]) / 12)


def test_a_paraboloid_is_met_between_its_crossings_up_to_the_hull() -> None:
    """Cubics hold it exactly, and what a round blank lacks goes on bent as it is."""
    surface = Paraboloid(60.0)
    spline = spline_of(laid_on(surface, 5.0, 60.0))
    places = np.random.default_rng(1).uniform(-60, 60, (2000, 2))
    places = places[Delaunay(spline.outline).find_simplex(places) >= 0]
    assert np.hypot(*places.T).max() > 58
    np.testing.assert_allclose(spline.at(places)[:, 2], surface.height(places), atol=2e-5)


def test_a_single_wire_is_no_surface() -> None:
    whole = laid_on(Paraboloid(60.0), 5.0, 60.0)
    line = whole.index[:, 1] == 0
    one = replace(whole, **{name: getattr(whole, name)[line] for name in ("index", "between", "flat", "positions")})
    with pytest.raises(InputError, match="2 wires of each family"):
        spline_of(one)


def test_what_a_table_lacks_goes_on_straight_where_it_is_straight() -> None:
    i, j = np.meshgrid(np.arange(12.0), np.arange(9.0), indexing="ij")
    plane = np.stack((2 * i, 3 * j, 0.5 * i - 0.25 * j + 7), axis=-1)
    known = np.hypot(i - 5, j - 4) < 5
    found = filled(np.where(known[..., None], plane, 99.0), known)
    np.testing.assert_allclose(found, plane, atol=1e-9)


@pytest.mark.parametrize("name", MADE)
def test_the_surface_of_every_shape_goes_through_its_crossings(name: str) -> None:
    for stage in shapes(made(name)).values():
        assert spline_of(stage.whole).missed(stage.whole) < 1e-10


# --- STEP ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["elastic", "cut between crossings", "trimmed last", "notched", "yielding"])
def test_a_step_file_holds_every_crossing(name: str, tmp_path: Path) -> None:
    run = made(name)
    written = step_files(run, tmp_path)
    assert [path.stem for path in written] == [*shapes(run), "punch"]
    for path, stage in zip(written, shapes(run).values(), strict=False):
        shape = read(path.read_bytes())
        assert BRepCheck_Analyzer(shape).IsValid()
        nodes = stage.whole.positions[: stage.whole.crossings]
        assert away(shape, nodes[:: max(1, len(nodes) // 60)]).max() < 1e-6
        text = path.read_text(encoding="ascii")
        assert "SI_UNIT(.MILLI.,.METRE.)" in text
        assert "within 1e-09 mm of every crossing" in text
        assert "'units: lengths mm" in text


def written_spline(text: str) -> NdBSpline:
    """The B-spline surface of a STEP file, read from its text without a kernel."""
    joined = re.sub(r"\s+", "", text)
    points = {
        int(number): [float(cell) for cell in cells.split(",")]
        for number, cells in re.findall(r"#(\d+)=CARTESIAN_POINT\('',\(([^)]*)\)\)", joined)
    }
    found = re.search(
        r"B_SPLINE_SURFACE_WITH_KNOTS\('',(\d+),(\d+),\((\(.*?\))\),\.UNSPECIFIED\.,\.F\.,\.F\.,\.F\.,"
        r"\(([\d,]+)\),\(([\d,]+)\),\(([^)]*)\),\(([^)]*)\)",
        joined,
    )
    assert found is not None
    rows = re.findall(r"\(([^)]*)\)", found[3])
    poles = np.array([[points[int(name.removeprefix("#"))] for name in row.split(",")] for row in rows])
    times = [[int(one) for one in found[k].split(",")] for k in (4, 5)]
    knots = [[float(one) for one in found[k].split(",")] for k in (6, 7)]
    full = tuple(np.repeat(each, count) for each, count in zip(knots, times, strict=True))
    return NdBSpline(full, poles, (int(found[1]), int(found[2])))


def test_the_text_of_a_step_file_is_the_surface_over_the_flat(tmp_path: Path) -> None:
    """Read without the kernel that wrote it: u and v are the flat x and y."""
    run = made("let go whole")
    step_files(run, tmp_path)
    for name, stage in shapes(run).items():
        kept = slice(0, stage.whole.crossings)
        surface = written_spline((tmp_path / f"{name}.step").read_text(encoding="ascii"))
        np.testing.assert_allclose(surface(stage.whole.flat[kept, :2]), stage.whole.positions[kept], atol=1e-9)


def test_a_face_ends_at_the_hull_of_the_crossings(tmp_path: Path) -> None:
    """Of a round blank of 7 steps: a point half a step beyond the last crossing is as far from the face."""
    whole = made("elastic").formed.whole
    flat = replace(whole, positions=whole.flat)
    spline = spline_of(flat)
    face = trimmed_face(spline.poles, spline.degrees, spline.knots, spline.outline)
    shape = read(step_bytes(face, "flat", ("flat",)))
    np.testing.assert_allclose(
        away(shape, np.array([[75.0, 0, 0], [0, -72.0, 0], [3.0, 5.0, 1.5]])), [5, 2, 1.5], atol=1e-7
    )
    area = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, area)
    x, y = spline.outline.T
    assert area.Mass() == pytest.approx(0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)), rel=1e-9)


def turned(profile: Any, fillet: float = 20.0) -> Revolution:
    return uncorrected(PunchCase(profile=profile, rim_radius=RIM, fillet=fillet))


def risen() -> Corrected:
    """A paraboloid with a correction of revolution."""
    rise = RadialCorrection(np.array([0.0, 20.0, 40.0, 50.0]), np.array([1.5, 0.8, 0.1, 0.0]))
    return Corrected(turned(ParaboloidProfile(focal_length=60.0)), rise)


def lobed() -> Corrected:
    """A paraboloid with a correction of four lobes, no surface of revolution."""
    places = np.linspace(0.0, 50.0, 11)
    x, y = np.meshgrid(places, places, indexing="ij")
    rho = np.hypot(x, y)
    fading = np.clip(1.0 - (rho / 50.0) ** 2, 0.0, None) ** 4
    dz = fading * (1.0 + np.cos(4 * np.arctan2(y, x)) * (rho / 50.0) ** 4)
    return Corrected(turned(ParaboloidProfile(focal_length=60.0)), HeightField(places, places, dz))


@pytest.mark.parametrize(
    ("tool", "near"),
    [
        (turned(ParaboloidProfile(focal_length=60.0)), 1e-9),
        (turned(SphereProfile(radius=40.0)), 0.0),
        (turned(FlatProfile(height=30.0, edge_radius=12.0), 10.0), 0.0),
        (risen(), NEAR),
    ],
    ids=["paraboloid", "hemisphere", "cup", "corrected"],
)
def test_a_punch_of_revolution_is_a_solid_of_its_volume(tool: Tool, near: float) -> None:
    solid, missed = punch_solid(tool, radius=RADIUS, plate=PLATE)
    assert missed <= near
    shape = read(step_bytes(solid, "punch", ("punch",)))
    assert shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    assert BRepCheck_Analyzer(shape).IsValid()
    # The kernel integrates to a part in a few millions.
    assert volume(shape) == pytest.approx(
        turned_volume(tool, RADIUS, PLATE), rel=5e-7, abs=2 * math.pi * RADIUS**2 * near
    )
    points = np.random.default_rng(3).uniform(-40, 40, (25, 2))
    points = np.column_stack((points, tool.height(points)))
    assert away(shape, points).max() < max(1.5 * near, 1e-6)


def test_a_punch_that_is_not_turned_is_a_solid_too() -> None:
    tool = lobed()
    solid, missed = punch_solid(tool, radius=RADIUS, plate=PLATE)
    assert 0 < missed <= NEAR_FIELD
    shape = read(step_bytes(solid, "punch", ("punch",)))
    assert part(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    assert BRepCheck_Analyzer(shape).IsValid()
    rho, turn = np.linspace(0, RADIUS, 2001), np.linspace(0, 2 * math.pi, 181)[:-1]
    middle = 0.5 * (rho[1:] + rho[:-1])
    places = np.stack((np.outer(middle, np.cos(turn)), np.outer(middle, np.sin(turn))), axis=-1)
    heights = tool.height(places.reshape(-1, 2)).reshape(places.shape[:2])
    rings = 2 * math.pi * (middle * np.diff(rho)) @ heights.mean(axis=1)
    assert volume(shape) == pytest.approx(rings + math.pi * RADIUS**2 * PLATE, rel=2e-6)
    points = np.random.default_rng(3).uniform(-40, 40, (25, 2))
    assert away(shape, np.column_stack((points, tool.height(points)))).max() < 1.5 * max(missed, 1e-4)


@pytest.mark.parametrize("name", WITH_A_PUNCH)
def test_the_punch_of_every_packaged_case_is_one_solid_in_both_formats(name: str, tmp_path: Path) -> None:
    """As trimesh and OCCT see them: closed, and of the same volume but for the facets."""
    tool = surface(read_case(f"packaged:{name}").tool)
    radius = EDGE * tool.rim_radius
    (tmp_path / "punch.stl").write_bytes(stl(punch_mesh(tool, radius=radius, plate=PLATE, tolerance=5 * TOLERANCE)))
    mesh = trimesh.load_mesh(tmp_path / "punch.stl")
    assert mesh.is_volume
    solid, missed = punch_solid(tool, radius=radius, plate=PLATE)
    assert missed <= (NEAR if is_turned(tool) else NEAR_FIELD)
    shape = read(step_bytes(solid, "punch", ("punch",)))
    assert part(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    assert BRepCheck_Analyzer(shape).IsValid()
    corners = np.random.default_rng(5).choice(mesh.vertices, 20)
    assert away(shape, corners).max() < max(2 * missed, 1e-4)
    assert abs(volume(shape, 1e-5) - mesh.volume) < 5 * TOLERANCE * mesh.area


def test_the_corners_of_the_solid_are_where_punch_and_plate_end() -> None:
    solid, _ = punch_solid(turned(SphereProfile(radius=40.0)), radius=RADIUS, plate=PLATE)
    found = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_VERTEX)
    corners = set()
    while found.More():
        place = BRep_Tool.Pnt_s(TopoDS.Vertex(found.Current()))
        corners.add((round(math.hypot(place.X(), place.Y()), 6), round(place.Z(), 6)))
        found.Next()
    assert {(round(RADIUS, 6), -PLATE), (round(RADIUS, 6), 0.0), (RIM, 0.0)} <= corners


def test_the_kernel_says_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    step_files(made("elastic"), tmp_path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("size", "told"), [(0.0, "1e-09"), (0.041, "5e-02"), (0.04, "4e-02"), (0.95, "1e+00"), (1e-3, "1e-03")]
)
def test_what_is_said_to_be_within_is_never_rounded_down(size: float, told: str) -> None:
    assert no_more_than(size) == told


def test_step_files_are_the_same_every_time(tmp_path: Path) -> None:
    run = made("corrected")
    (tmp_path / "one").mkdir()
    (tmp_path / "other").mkdir()
    for path in step_files(run, tmp_path / "one"):
        (tmp_path / "other" / path.name).touch()
    names = [path.name for path in step_files(run, tmp_path / "other")]
    assert names == ["formed.step", "released.step", "punch.step", "punch_designed.step"]
    for name in names:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "other" / name).read_bytes()


def test_a_title_of_any_letters_reads_back() -> None:
    run = made("loaded")
    face_of = spline_of(run.formed.whole)
    face = trimmed_face(face_of.poles, face_of.degrees, face_of.knots, face_of.outline)
    content = step_bytes(face, "formed", (run.case.title,))
    assert rb"Sch\X4\000000FC\X0\ssel \X4\00002713\X0\ ''1''" in content
    assert BRepCheck_Analyzer(read(content)).IsValid()


def test_without_the_extra_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "OCP.collections", None)
    with pytest.raises(InputError, match=r"pip install 'punchform\[step\]'"):
        step_files(made("elastic"), tmp_path)
    assert not list(tmp_path.iterdir())
    monkeypatch.undo()
    demand_occt()
