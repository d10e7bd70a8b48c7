"""A gridshell is exported too: its rods as they are cut, where they lie, and the forces at their ends."""

from __future__ import annotations

import csv
import json
from functools import cache
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.entities import Line, Polyline
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from punchform import form_shell, read_case
from punchform.case import WiresBlank
from punchform.cli import main
from punchform.cli.shell import write_shell
from punchform.shell import Shell


@cache
def shell() -> Shell:
    return form_shell(read_case("packaged:gridshell"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All formats of the gridshell of ten rods."""
    place = tmp_path_factory.mktemp("shell")
    write_shell(shell(), place / "shell")
    assert main(["export", str(place / "shell"), "--to", "all", "-o", str(place / "files")]) == 0
    return place / "files"


def test_all_that_show_a_gridshell_are_written_and_the_others_named(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    assert {file["format"] for file in told["files"]} == {"csv", "dxf", "vtp", "vtu"}
    assert {file["name"] for file in told["files"]} | {"case.toml", "result.json"} == {
        path.name for path in folder.iterdir()
    }
    assert "press.ends" in told["frame"]
    assert main(["export", str(folder.parent / "shell"), "--to", "stl", "-o", str(tmp_path / "files")]) == 2
    assert "the folder holds a gridshell" in capsys.readouterr().err


def test_the_rods_are_cut_as_the_case_says(folder: Path) -> None:
    rows = [line for line in (folder / "cut_list.csv").read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    cuts = list(csv.DictReader(rows))
    blank = shell().case.grid.blank
    assert isinstance(blank, WiresBlank)
    wanted = {(wire.family, wire.wire): wire.high - wire.low for wire in blank.wires}
    found = {(int(cut["family"]), int(cut["number"])): float(cut["wire_length"]) for cut in cuts}
    assert found == pytest.approx(wanted, abs=1e-3)


def test_the_drawings_have_every_rod_flat_and_arched(folder: Path) -> None:
    flat, formed = (ezdxf.readfile(folder / name) for name in ("blank.dxf", "formed.dxf"))
    for drawing in (flat, formed):
        assert not drawing.audit().has_issues
    lines = [one for one in flat.modelspace() if isinstance(one, Line)]
    assert len(lines) == 10
    arched = [one for one in formed.modelspace() if isinstance(one, Polyline)]
    held = np.array([end.point for end in shell().ends])
    for rod in arched:
        points = np.array([tuple(vertex.dxf.location) for vertex in rod.vertices])
        for end in (points[0], points[-1]):
            assert np.linalg.norm(held - end, axis=1).min() < 1e-6
    assert len(arched) == 10


def test_the_forces_at_the_ends_balance(folder: Path) -> None:
    ends = list(csv.DictReader((folder / "ends.csv").read_text(encoding="utf-8").splitlines()))
    forces = np.array([[float(row[name]) for name in ("Fx", "Fy", "Fz")] for row in ends])
    assert len(ends) == 20
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-6 * np.abs(forces).max())


def test_vtk_reads_its_cells(folder: Path) -> None:
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(folder / "formed.vtu"))
    reader.Update()
    read = reader.GetOutput()
    whole = shell().formed.whole
    points = np.array([read.GetPoint(node) for node in range(read.GetNumberOfPoints())])
    np.testing.assert_allclose(points, whole.positions, atol=1e-9)
    assert read.GetNumberOfCells() == len(whole.family) + len(whole.cells)
