"""VTU, CSV and lists of points: every number comes back through readers that are not ours, or through `compare`."""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_runs import MADE, made
from vtkmodules.util import numpy_support
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

from punchform.arrays import Floats
from punchform.cli import main
from punchform.export.csv_tables import STAGE_COLUMNS, csv_files
from punchform.export.points import COLUMNS, normals, point_files, points_csv
from punchform.export.shapes import shapes
from punchform.export.vtp import vtp_files
from punchform.export.vtu import vtu_files
from punchform.measured import Predicted, Wish, compare, read_cloud, sheet
from punchform.run import Run
from punchform.store import write_run

every_run = pytest.mark.parametrize("name", MADE)
to_numpy: Any = numpy_support.vtk_to_numpy


def read(path: Path) -> Any:
    reader = vtkXMLPolyDataReader() if path.suffix == ".vtp" else vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def arrays(data: Any) -> dict[str, Floats]:
    return {data.GetArrayName(k): to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}


def head_of(data: Any) -> list[str]:
    lines = data.GetFieldData().GetAbstractArray("heading")
    return [lines.GetValue(k) for k in range(lines.GetNumberOfTuples())]


# --- VTK ----------------------------------------------------------------------------------------------------


@every_run
def test_vtk_reads_every_field_of_every_shape(name: str, tmp_path: Path) -> None:
    run = made(name)
    written = vtu_files(run, tmp_path)
    assert [path.stem for path in written] == list(shapes(run))
    for path, stage in zip(written, shapes(run).values(), strict=True):
        data, whole = read(path), stage.whole
        wires = len(whole.family)
        np.testing.assert_array_equal(to_numpy(data.GetPoints().GetData()), whole.positions)
        kinds = [data.GetCellType(k) for k in range(data.GetNumberOfCells())]
        assert kinds == [3] * wires + [9] * len(whole.cells)
        for number, corners in ((0, (whole.start[0], whole.end[0])), (wires, whole.cells[0])):
            ids = data.GetCell(number).GetPointIds()
            assert [ids.GetId(k) for k in range(ids.GetNumberOfIds())] == list(corners)
        points, cells = arrays(data.GetPointData()), arrays(data.GetCellData())
        np.testing.assert_array_equal(
            points["flat"] + points["displacement"], whole.flat + (whole.positions - whole.flat)
        )
        np.testing.assert_array_equal(points["contact_force"], whole.contact)
        assert ("moved" in points) == hasattr(stage, "moved")
        for field in (
            "D",
            "F",
            "energy",
            "axial_strain",
            "stress",
            "stress_ratio",
            "stretch",
            "plastic_strain",
            "sigma",
        ):
            np.testing.assert_array_equal(cells[field][:wires], getattr(whole, field), err_msg=field)
            assert np.isnan(cells[field][wires:]).all()
        np.testing.assert_array_equal(cells["family"][:wires], whole.family)
        np.testing.assert_array_equal(cells["shear"][wires:], whole.cell_shear)
        assert np.isnan(cells["shear"][:wires]).all()
        judged = run.accuracy is not None and stage.whole is run.final.whole
        assert ("deviation_normal" in points) == judged


def test_deviations_are_of_the_shape_that_is_judged(tmp_path: Path) -> None:
    run = made("loaded")
    formed, released, loaded = (arrays(read(path).GetPointData()) for path in vtu_files(run, tmp_path))
    assert run.accuracy is not None
    np.testing.assert_array_equal(released["deviation_normal"], run.accuracy.as_held.deviations.normal)
    assert not {"deviation_normal"} & (formed.keys() | loaded.keys())


def test_vtk_files_say_their_units_and_frame(tmp_path: Path) -> None:
    run = made("loaded")
    for path in (*vtp_files(run, tmp_path), *vtu_files(run, tmp_path)):
        title, units, frame, version = head_of(read(path))
        assert title.startswith(run.case.title)
        assert "mm" in units
        assert "axis of the punch" in frame
        assert version.startswith("punchform ")


# --- CSV ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["elastic", "only pressed", "in stages"])
def test_tables_of_the_run_folder_are_exported_as_they_are(name: str, tmp_path: Path) -> None:
    folder = write_run(made(name), tmp_path / "run")
    files = tmp_path / "files"
    files.mkdir()
    csv_files(made(name), files)
    tables = ["nodes.csv", "wires.csv", *(["wires_released.csv"] if name != "only pressed" else [])]
    assert [path.name for path in sorted(folder.glob("*.csv"))] == tables
    for table in tables:
        assert (files / table).read_bytes() == (folder / table).read_bytes()
    told = (files / "tables.txt").read_text(encoding="utf-8")
    assert all(table in told for table in tables)
    assert "units: lengths mm" in told


@every_run
def test_every_stage_has_its_nodes_and_wires(name: str, tmp_path: Path) -> None:
    run = made(name)
    csv_files(run, tmp_path)
    for number, stage in enumerate(run.stages, 1):
        whole = stage.done.whole
        with (tmp_path / f"nodes_{number}_{stage.kind}.csv").open(encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        assert tuple(head) == STAGE_COLUMNS
        values = np.array(rows, dtype=np.float64)
        expected = np.column_stack(
            (whole.index, whole.between, whole.flat[:, :2], whole.positions, whole.normals, whole.contact)
        )
        by_place = [np.lexsort(table[:, 4:2:-1].T) for table in (values, expected)]
        np.testing.assert_allclose(values[by_place[0]], expected[by_place[1]], rtol=1e-14, atol=1e-15)
        with (tmp_path / f"wires_{number}_{stage.kind}.csv").open(encoding="utf-8") as file:
            wires = list(csv.DictReader(file))
        assert sum(float(row["energy_mJ"]) for row in wires) == pytest.approx(whole.energy.sum(), rel=1e-10)


# --- points ---------------------------------------------------------------------------------------------------


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def predicted(run: Run) -> Predicted:
    whole = run.final.whole
    kept = slice(0, whole.crossings)
    return Predicted(whole.index[kept], whole.flat[kept, :2], whole.positions[kept], "released")


@every_run
def test_lists_of_points_are_read_by_compare_as_what_they_are(name: str, tmp_path: Path) -> None:
    run = made(name)
    written = point_files(run, tmp_path)
    assert [path.stem for path in written] == [
        *(f"points_{shape}" for shape in shapes(run)),
        *(["points_target"] if run.case.target is not None else []),
    ]
    for path, stage in zip(written, shapes(run).values(), strict=False):
        cloud, whole = read_cloud(path), stage.whole
        assert (cloud.unit, cloud.stated, cloud.skipped) == ("mm", True, 0)
        assert cloud.named.all()
        assert sorted(map(tuple, cloud.nodes.tolist())) == sorted(map(tuple, whole.index[: whole.crossings].tolist()))
        order = {tuple(node): k for k, node in enumerate(whole.index[: whole.crossings].tolist())}
        at = [order[tuple(node)] for node in cloud.nodes.tolist()]
        np.testing.assert_allclose(cloud.points, whole.positions[at], atol=5.1e-7)
        found = np.array([[float(row[c]) for c in COLUMNS[4:7]] for row in rows(path)])
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=2e-6)
        assert (found[:, 2] > 0).all()


def test_a_perfect_measurement_of_the_list_has_no_deviation(tmp_path: Path) -> None:
    run = made("elastic")
    point_files(run, tmp_path)
    cloud = read_cloud(tmp_path / "points_released.csv")
    done = compare(run.case, predicted(run), cloud, Wish("best-fit", "nodes", None, None, False))
    assert done.prediction.table is not None
    assert done.prediction.table.rms < 1e-6
    assert np.abs(done.alignment.fit.pose.shift).max() < 1e-6


def test_the_command_compares_what_the_command_exports(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_run(made("elastic"), tmp_path / "run")
    assert main(["export", str(folder), "--to", "points", "-o", str(tmp_path / "files"), "--quiet"]) == 0
    target = str(tmp_path / "files" / "points_target.csv")
    command = ["compare", str(folder), target, "-o", str(tmp_path / "held"), "--align", "as-given", "--json", "--quiet"]
    assert main(command) == 0
    capsys.readouterr()


def test_points_of_the_target_lie_on_it_below_the_crossings(tmp_path: Path) -> None:
    run = made("elastic")
    point_files(run, tmp_path)
    table = np.array([[float(row[c]) for c in COLUMNS[1:7]] for row in rows(tmp_path / "points_target.csv")])
    x, y, z, *_ = table.T
    top = run.formed.surface.height(np.zeros((1, 2)))[0]
    np.testing.assert_allclose(z, top - (x**2 + y**2) / 240.0, atol=2e-6)
    exact = np.column_stack((x / 120.0, y / 120.0, np.ones(len(x))))
    np.testing.assert_allclose(table[:, 3:], exact / np.linalg.norm(exact, axis=1)[:, None], atol=2e-6)
    assert run.accuracy is not None
    assert len(table) == run.accuracy.nodes
    assert {row["tolerance"] for row in rows(tmp_path / "points_target.csv")} == {"0.5"}


def test_normals_of_the_surface_through_crossings_are_near_those_of_the_punch() -> None:
    """Where the punch is smooth: what stands for it after the release may be a degree off at this coarse step."""
    formed = made("elastic").formed
    whole = formed.whole
    kept = slice(0, whole.crossings)
    exact = normals(formed)
    found = sheet(whole.index[kept], whole.flat[kept, :2], whole.positions[kept]).distance_gradient(
        whole.positions[kept]
    )[1]
    inside = np.hypot(*whole.positions[kept, :2].T) < 35.0
    assert inside.sum() > 30
    turned = np.degrees(np.arccos(np.clip((exact * found).sum(axis=1), -1, 1)))
    assert turned[inside].max() < 1.0


def test_points_without_a_target_have_no_tolerance(tmp_path: Path) -> None:
    (path,) = point_files(made("only pressed"), tmp_path)
    assert {row["tolerance"] for row in rows(path)} == {""}


def test_cells_of_points_are_rounded_as_decimals_and_zero_has_no_sign() -> None:
    rng = np.random.default_rng(4)
    places = rng.normal(scale=10.0 ** rng.integers(-8, 3, (500, 3)))
    places[:4] = [[-5e-7, 5e-7, 5.000000000000001e-7], [-0.0, 1.5e-6, 2.5e-6], [-4e-7, -6e-7, 0.5], [0.1, 1e3, 1e-9]]
    index = np.column_stack((np.arange(500), -np.arange(500)))
    written = points_csv(index, places, places, 0.25, ("head",)).splitlines()
    assert written[:2] == ["# head", ",".join(COLUMNS)]
    for line, (i, j), place in zip(written[2:], index.tolist(), places.tolist(), strict=True):
        cells = [f"{round(cell, 6) + 0.0:.6f}" for cell in place]
        assert line == ",".join((f"({i}:{j})", *cells, *cells, "0.25"))


# --- all of them ------------------------------------------------------------------------------------------------


def test_all_leaves_out_what_needs_an_extra_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write_run(made("elastic"), tmp_path / "run")
    monkeypatch.setitem(sys.modules, "OCP.collections", None)
    assert main(["export", str(folder), "--to", "all", "-o", str(tmp_path / "files")]) == 0
    said = capsys.readouterr().err
    assert "note: step is left out: STEP files need cadquery-ocp-novtk" in said
    assert said.count("is left out") == 1
    assert main(["export", str(folder), "--to", "step", "dxf", "-o", str(tmp_path / "others")]) == 2
    assert "pip install 'punchform[step]'" in capsys.readouterr().err
    assert not (tmp_path / "others").exists()
    assert not list((tmp_path / "files").glob("*.step"))
    assert (tmp_path / "files" / "blank.dxf").exists()
