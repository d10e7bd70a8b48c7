"""Whatever a file of points looks like, its numbers arrive; whatever is wrong with it is told with its line."""

from __future__ import annotations

import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.measured import Cloud, read_cloud
from punchform.measured.reading import check_size

NUMBERS = some.floats(-1e4, 1e4, allow_nan=False).map(lambda value: round(value, 6) + 0.0)
POINTS = some.lists(some.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=4, max_size=30)
FOUR = "0,0,0\n1,0,0\n0,1,0\n0,0,1\n"
anywhere = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def read(folder: Path, text: str, name: str = "cloud.csv", **wishes: object) -> Cloud:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return read_cloud(path, **wishes)  # type: ignore[arg-type]


def told(folder: Path, text: str, name: str = "cloud.csv") -> str:
    with pytest.raises(InputError) as caught:
        read(folder, text, name)
    return str(caught.value)


@anywhere
@given(POINTS, some.sampled_from([",", ";", "\t", " ", ", ", "  "]), some.booleans(), some.booleans())
def test_every_separator_gives_the_same_points(
    tmp_path: Path, points: list[tuple[float, float, float]], mark: str, named: bool, headed: bool
) -> None:
    head = mark.join((["id"] if named else []) + ["x", "y", "z"]) + "\n" if headed else ""
    rows = [mark.join((*([f"P{k}"] if named else []), *map(repr, row))) for k, row in enumerate(points)]
    cloud = read(tmp_path, head + "\n".join(rows) + "\n")
    np.testing.assert_array_equal(cloud.points, np.array(points))
    assert cloud.names == tuple(f"P{k}" if named else str(k + 1) for k in range(len(points)))


@anywhere
@given(POINTS, some.sampled_from([";", "\t", " "]))
def test_a_decimal_comma_is_read_where_it_can_be_nothing_else(
    tmp_path: Path, points: list[tuple[float, float, float]], mark: str
) -> None:
    rows = [mark.join(f"{value:.6f}".replace(".", ",") for value in row) for row in points]
    np.testing.assert_allclose(read(tmp_path, "\n".join(rows)).points, np.array(points), atol=1e-6)


@anywhere
@given(POINTS, some.sampled_from(["ascii", "little", "big"]), some.booleans())
def test_ply_and_stl_hold_the_same_vertices(
    tmp_path: Path, points: list[tuple[float, float, float]], kind: str, double: bool
) -> None:
    wanted = np.array(points, dtype=np.float64 if double else np.float32).astype(np.float64)
    ply = tmp_path / "cloud.ply"
    ply.write_bytes(ply_of(wanted, kind, double=double))
    np.testing.assert_array_equal(read_cloud(ply).points, wanted)


@pytest.mark.parametrize("binary", [True, False])
def test_stl_gives_each_vertex_once(tmp_path: Path, binary: bool) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.5, 1]], dtype=np.float64)
    faces = corners[[[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]]
    path = tmp_path / "cloud.STL"
    path.write_bytes(stl_of(faces, binary=binary))
    found = read_cloud(path).points
    np.testing.assert_array_equal(found, np.unique(corners, axis=0))


def test_names_that_spell_nodes_are_nodes(tmp_path: Path) -> None:
    cloud = read(tmp_path, 'id,x,y,z\n"1,2",0,0,0\n3:-4,1,0,0\n"(5, 6)",0,1,0\nP7,0,0,1\n')
    assert cloud.nodes[:3].tolist() == [[1, 2], [3, -4], [5, 6]]
    assert cloud.named.tolist() == [True, True, True, False]


def test_two_columns_i_and_j_are_nodes_with_and_without_a_header(tmp_path: Path) -> None:
    rows = "0,0,0,0,5.5\n0,1,0,1,5\n1,0,1,0,5\n1,1,1,1,4\n"
    for text in (rows, "i,j,x,y,z\n" + rows):
        cloud = read(tmp_path, text)
        assert cloud.nodes.tolist() == [[0, 0], [0, 1], [1, 0], [1, 1]]
        assert cloud.points[0].tolist() == [0, 0, 5.5]


def test_four_columns_are_a_name_or_a_sigma(tmp_path: Path) -> None:
    assert read(tmp_path, "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n").names == ("1", "2", "3", "4")
    cloud = read(tmp_path, "0.5 0 0 0.1\n0.5 1 0 0.2\n0 1 0 0.1\n0 0 1 0.1\n")
    assert cloud.sigma is not None
    assert cloud.sigma.tolist() == [0.1, 0.2, 0.1, 0.1]


@pytest.mark.parametrize(
    "text",
    ["# units: m\n" + FOUR, "x [m],y [m],z [m]\n" + FOUR, "x_m,y_m,z_m\n" + FOUR, "# Units are in metres\n" + FOUR],
)
def test_a_stated_unit_is_taken(tmp_path: Path, text: str) -> None:
    cloud = read(tmp_path, text)
    assert (cloud.unit, cloud.stated) == ("m", True)
    assert cloud.points.max() == 1000.0


def test_the_users_unit_counts_more_than_the_files(tmp_path: Path) -> None:
    assert read(tmp_path, "# units: m\n" + FOUR, unit="in").points.max() == 25.4


def test_all_bad_rows_are_told_with_their_lines(tmp_path: Path) -> None:
    text = "id,x,y,z\nA,1,2,3\nB,1,2\nC,1,two,3\nA,4,5,6\nD,nan,0,0\nE,,0,0\n"
    message = told(tmp_path, text)
    assert [line for line in message.splitlines() if line.startswith("error")] == [
        f"error: {tmp_path}/cloud.csv:3: 3 columns, 4 are needed",
        f"error: {tmp_path}/cloud.csv:4: y is 'two', not a number",
        f"error: {tmp_path}/cloud.csv:5: the id A was there already, on line 2",
        f"error: {tmp_path}/cloud.csv:6: x is nan, not a finite number",
        f"error: {tmp_path}/cloud.csv:7: x is empty",
    ]
    assert "--skip-bad-rows" in message


def test_beyond_twenty_bad_rows_are_counted(tmp_path: Path) -> None:
    message = told(tmp_path, FOUR + "1,2,x\n" * 33)
    assert message.count("not a number") == 20
    assert "and 13 more bad rows" in message


def test_bad_rows_are_left_out_on_request_and_said(tmp_path: Path) -> None:
    cloud = read(tmp_path, FOUR + "1,2,x\n", skip_bad_rows=True)
    assert (len(cloud.points), cloud.skipped) == (4, 1)
    assert "1 bad row left out (line 5)" in cloud.notes[-1]


@pytest.mark.parametrize(
    ("text", "name", "said"),
    [
        ("", "cloud.csv", "no points"),
        ("0 0 0\n1 1 1\n", "cloud.xyz", "at least 4"),
        ("1,5,2,5,3,5\n" * 4, "cloud.csv", "decimal comma"),
        ("# units: furlong\n" + FOUR, "cloud.csv", "furlong"),
        (FOUR, "cloud.dwg", ".csv"),
        ("no ply", "cloud.ply", "no header"),
        ("ply\nformat ascii 1.0\nelement vertex 9\nend_header\n", "cloud.ply", "no vertices with x, y and z"),
        ("facet", "cloud.stl", "neither text nor"),
        ("solid x\nvertex 1 2\nendsolid", "cloud.stl", "three numbers"),
        ("x,y,z,sigma\n" + "0,0,0,-1\n" * 4, "cloud.csv", "above zero"),
    ],
)
def test_what_cannot_be_read_is_said(tmp_path: Path, text: str, name: str, said: str) -> None:
    assert said in told(tmp_path, text, name)


def test_a_missing_file_and_a_short_ply_are_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read_cloud(tmp_path / "none.csv")
    path = tmp_path / "short.ply"
    path.write_bytes(ply_of(np.zeros((5, 3)), "little", double=True)[:-20])
    with pytest.raises(InputError, match="ends before its 5 vertices"):
        read_cloud(path)


@anywhere
@given(some.binary(max_size=300), some.sampled_from(["a.csv", "a.xyz", "a.ply", "a.stl"]))
def test_no_file_ends_in_a_traceback(tmp_path: Path, content: bytes, name: str) -> None:
    path = tmp_path / name
    path.write_bytes((b"ply\n" if name == "a.ply" else b"") + content)
    with suppress(InputError):
        read_cloud(path)


@pytest.mark.parametrize(("factor", "unit"), [(1e-3, "m"), (1 / 25.4, "in"), (0.1, "cm")])
def test_a_size_that_another_unit_explains_is_refused_until_stated(tmp_path: Path, factor: float, unit: str) -> None:
    grid = 300 * factor * np.array([[x, y, 0.1 * x * y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)])
    text = "\n".join(" ".join(f"{value:.9g}" for value in row) for row in grid)
    reach = float(np.sqrt((grid**2).sum(axis=1).mean())) / factor
    with pytest.raises(InputError, match=f"--units {unit}"):
        check_size(read(tmp_path, text), reach)
    assert not check_size(read(tmp_path, text, unit=unit), reach)
    assert "part of it" in check_size(read(tmp_path, text, unit="mm"), reach)[0]


def ply_of(points: Floats, kind: str, *, double: bool) -> bytes:
    """A PLY file with a flag before x, y, z and one face after the vertices."""
    form = "ascii" if kind == "ascii" else f"binary_{kind}_endian"
    word = "double" if double else "float"
    head = (
        f"ply\nformat {form} 1.0\ncomment made for a test\nelement vertex {len(points)}\nproperty uchar flag\n"
        + "".join(f"property {word} {axis}\n" for axis in "xyz")
        + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if kind == "ascii":
        rows = "\n".join("7 " + " ".join(repr(float(value)) for value in row) for row in points)
        return head + rows.encode() + b"\n3 0 1 2\n"
    order, letter = "<" if kind == "little" else ">", "d" if double else "f"
    rows_of = b"".join(struct.pack(f"{order}B3{letter}", 7, *row) for row in points)
    return head + rows_of + struct.pack(f"{order}B3i", 3, 0, 1, 2)


def stl_of(faces: Floats, *, binary: bool) -> bytes:
    if binary:
        body = b"".join(struct.pack("<12fH", 0, 0, 1, *face.ravel(), 0) for face in faces)
        return b"made for a test".ljust(80) + struct.pack("<I", len(faces)) + body
    rows = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join(f"  vertex {x:g} {y:g} {z:g}\n" for x, y, z in face)
        + "endloop\nendfacet\n"
        for face in faces
    )
    return f"solid test\n{rows}endsolid test\n".encode()
