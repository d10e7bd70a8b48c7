"""Files of a punch for the workshop: a closed solid, a drawing that reads back, tables for cases; no time stamps."""

from __future__ import annotations

import math
import os
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf import units
from ezdxf.entities import LWPolyline
from scipy.integrate import quad

from punchform.arrays import Floats
from punchform.case import (
    FlatProfile,
    ParaboloidProfile,
    Profile,
    PunchCase,
    RadialPoints,
    SphereProfile,
)
from punchform.case.reading import case_from_text
from punchform.errors import InputError
from punchform.export.punch_files import CORRECTION, DRAWING, FIELD, PROFILE, SOLID, write_punch
from punchform.export.punch_mesh import Mesh, punch_mesh, stl
from punchform.measured.solids import read_stl
from punchform.punch import Corrected, HeightField, RadialCorrection, Tool, surface, uncorrected

RADIUS = 75.0


def punch(profile: Profile) -> PunchCase:
    return PunchCase(profile=profile, rim_radius=60.0, fillet=20.0)


BASE = uncorrected(punch(ParaboloidProfile(focal_length=60.0)))
PLACES = np.linspace(0.0, 50.0, 11)


def with_lobes() -> HeightField:
    x, y = np.meshgrid(PLACES, PLACES, indexing="ij")
    rho = np.hypot(x, y)
    fading = np.clip(1.0 - (rho / 50.0) ** 2, 0.0, None) ** 4
    return HeightField(PLACES, PLACES, fading * (1.0 + np.cos(4 * np.arctan2(y, x)) * (rho / 50.0) ** 4))


TOOLS: dict[str, Tool] = {
    "paraboloid": BASE,
    "hemisphere": uncorrected(punch(SphereProfile(radius=40.0))),
    "cup": uncorrected(PunchCase(profile=FlatProfile(height=30.0, edge_radius=12.0), rim_radius=60.0, fillet=10.0)),
    "turned": Corrected(BASE, RadialCorrection(PLACES, 1.5 * (1.0 - (PLACES / 50.0) ** 2) ** 3)),
    "lobes": Corrected(BASE, with_lobes()),
}
every_tool = pytest.mark.parametrize("tool", TOOLS.values(), ids=TOOLS.keys())


def solid(tool: Tool) -> Mesh:
    return punch_mesh(tool, radius=RADIUS, plate=5.0, tolerance=0.02)


def volume(corners: Floats) -> float:
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)


@every_tool
def test_the_solid_is_closed_and_its_normals_point_outwards(tool: Tool) -> None:
    """Every edge belongs to two triangles, which run along it in opposite directions."""
    mesh = solid(tool)
    edges = np.concatenate([mesh.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    there, back = (np.unique(way, axis=0) for way in (edges, edges[:, ::-1]))
    assert len(there) == len(edges)
    np.testing.assert_array_equal(there, back)
    corners = mesh.corners
    assert np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).min() > 0
    assert len(mesh.vertices) - len(edges) // 2 + len(mesh.triangles) == 2


@every_tool
def test_the_file_of_the_solid_is_closed_too(tool: Tool) -> None:
    """Also in single precision; and its corners lie on the punch, within the tolerance between them."""
    content = stl(solid(tool))
    face = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    faces = np.frombuffer(content, face, offset=84)
    places, number = np.unique(faces["corners"].reshape(-1, 3), axis=0, return_inverse=True)
    triangles = number.reshape(-1, 3)
    edges = np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    np.testing.assert_array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))
    assert len(np.unique(edges, axis=0)) == len(edges)
    on_top = places[places[:, 2] > -4.9].astype(np.float64)
    assert np.abs(tool.distance(on_top)).max() < 1e-5
    corners = faces["corners"].astype(np.float64)
    middles = corners.mean(axis=1)[(corners[:, :, 2] > -4.9).all(axis=1)]
    assert np.abs(tool.distance(middles)).max() < 0.02
    outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", outwards, faces["normal"]) > 0).all()
    found = read_stl(content, where="punch.stl")
    assert len(found.points) == len(places)


@pytest.mark.parametrize("name", ["paraboloid", "hemisphere", "cup", "turned"])
def expected_volume(tool: Tool) -> float:
    """Of a punch of revolution with its plate [mm³], by integration over the radius."""

    def ring(rho: float) -> float:
        return 2 * math.pi * rho * float(tool.height(np.array([[rho, 0.0]]))[0])

    punch = quad(ring, 0.0, RADIUS, points=[30.0, 40.0, 48.0, 50.0, 58.0, 60.0], limit=400, epsrel=1e-9)[0]
    return float(punch) + math.pi * RADIUS**2 * 5.0


@pytest.mark.parametrize("name", ["paraboloid", "hemisphere", "cup", "turned"])
def test_the_volume_is_that_of_the_punch_and_its_plate(name: str) -> None:
    tool = TOOLS[name]
    assert volume(solid(tool).corners) == pytest.approx(expected_volume(tool), rel=2e-3)


def test_finer_facets_come_nearer_to_the_volume() -> None:
    exact = expected_volume(BASE)
    errors = [
        1.0 - volume(punch_mesh(BASE, radius=RADIUS, plate=5.0, tolerance=tolerance).corners) / exact
        for tolerance in (0.2, 0.02, 2e-3)
    ]
    assert 0.0 < errors[2] < 0.6 * errors[1] < 0.36 * errors[0]
    assert errors[2] < 3e-4


@every_tool
def test_the_drawing_reads_back_without_a_fault(tool: Tool, tmp_path: Path) -> None:
    write_punch(tmp_path, tool, radius=RADIUS)
    document = ezdxf.readfile(tmp_path / DRAWING)
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    assert document.units == units.MM
    lines = {
        line.dxf.layer: np.array(line.get_points("xy"))
        for line in document.modelspace()
        if isinstance(line, LWPolyline)
    }
    lobed = tool is TOOLS["lobes"]
    assert set(lines) == ({"SECTION_0", "SECTION_22_5", "SECTION_45"} if lobed else {"PROFILE"})
    for layer, line in lines.items():
        angle = math.radians(float(layer.partition("_")[2].replace("_", ".") or 0.0))
        points = np.column_stack((line[:, 0] * math.cos(angle), line[:, 0] * math.sin(angle), line[:, 1]))
        assert np.abs(tool.distance(points)).max() < 1e-9
        assert line[0, 0] == pytest.approx(0.0, abs=1e-12)
        assert line[-1, 0] == pytest.approx(RADIUS)


@every_tool
def test_the_tables_are_of_the_punch(tool: Tool, tmp_path: Path) -> None:
    write_punch(tmp_path, tool, radius=RADIUS, step=7.5)
    profile = np.loadtxt(tmp_path / PROFILE, delimiter=",", skiprows=3)
    for z, degrees in zip(profile[:, 1:].T, (0.0, 22.5, 45.0), strict=False):
        angle = math.radians(degrees)
        points = np.column_stack((profile[:, 0] * math.cos(angle), profile[:, 0] * math.sin(angle), z))
        assert np.abs(tool.distance(points)).max() < 1e-6
    field = np.loadtxt(tmp_path / FIELD, delimiter=",", skiprows=3)
    assert len(field) == 21**2
    np.testing.assert_allclose(field[:, 2], tool.height(field[:, :2]), atol=1e-6)
    for name in (PROFILE, FIELD):
        assert "lengths in mm" in (tmp_path / name).read_text(encoding="utf-8").splitlines()[1]


@pytest.mark.parametrize("name", ["turned", "lobes"])
def test_a_case_can_use_the_file_of_a_correction(name: str, tmp_path: Path) -> None:
    """To the last digit: the punch of the file is the punch."""
    tool = TOOLS[name]
    assert isinstance(tool, Corrected)
    write_punch(tmp_path, tool, radius=RADIUS)
    kind = "radial" if name == "turned" else "field"
    text = f"""
schema = 1
[grid]
step = "10 mm"
blank = {{ shape = "circle", radius = "70 mm" }}
[wire]
diameter = "0.5 mm"
material = "304 spring"
[punch]
profile = {{ kind = "paraboloid", focal_length = "60 mm" }}
rim_radius = "60 mm"
fillet = "20 mm"
correction = {{ kind = "{kind}", file = "{CORRECTION}" }}
"""
    case = case_from_text(text, folder=tmp_path)
    assert isinstance(case.tool.correction, RadialPoints) == (kind == "radial")
    again = surface(case.tool)
    assert isinstance(again, Corrected)
    np.testing.assert_array_equal(again.correction.points, tool.correction.points)


def test_the_same_punch_gives_the_same_bytes(tmp_path: Path) -> None:
    files = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        written = write_punch(tmp_path / name, TOOLS["lobes"], radius=RADIUS)
        assert {path.name for path in written} == {PROFILE, FIELD, CORRECTION, DRAWING, SOLID}
        assert {path.name for path in written} == set(os.listdir(tmp_path / name))
        files.append([path.read_bytes() for path in written])
    assert files[0] == files[1]
    assert not ezdxf.options.write_fixed_meta_data_for_testing
    assert len(files[0][-1]) < 5_000_000


@pytest.mark.parametrize(
    ("sizes", "words"),
    [
        ({"radius": -1.0}, "radius: must be a length of more than 0, not -1 mm"),
        ({"radius": math.inf}, "radius: must be a length"),
        ({"radius": 70.0, "step": 0.0}, "step: must be a length"),
        ({"radius": 70.0, "tolerance": math.nan}, "tolerance: must be a length"),
        ({"radius": 70.0, "plate": -3.0}, "plate: must be a length"),
    ],
)
def test_sizes_that_cannot_be_leave_nothing_behind(sizes: dict[str, float], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        write_punch(tmp_path, BASE, **sizes)
    assert not os.listdir(tmp_path)
