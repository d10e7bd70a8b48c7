"""Tables, result.json and the VTK file hold exactly what the run holds, and other programs can read them."""

from __future__ import annotations

import base64
import json
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_run import FakeOutcome, fake_run, let_go
from stretched import dish

from punchform.accuracy import MEASURES
from punchform.arrays import Floats
from punchform.export.result import result_json
from punchform.export.tables import NODE_COLUMNS, WIRE_COLUMNS, nodes_csv, wires_csv
from punchform.export.vtp import poly_lines, write_vtp
from punchform.store import read_run, write_run
from punchform.whole import node_shear


def table(text: str) -> tuple[list[str], Floats]:
    head, *rows = text.splitlines()
    cells = [[float(cell) if cell else np.nan for cell in row.split(",")] for row in rows]
    return head.split(","), np.array(cells)


def test_the_headers_are_those_of_the_contract() -> None:
    formed = fake_run().formed
    assert nodes_csv(formed).splitlines()[0] == "i,j,x0,y0,x,y,z,xr,yr,zr,contact_force"
    assert wires_csv(formed).splitlines()[0] == (
        "family,i,j,D1,D2,D3,D4,D5,D6,F1,F2,F3,F4,F5,F6,energy_mJ,axial_strain,stress_ratio"
    )


def test_nodes_are_sorted_by_i_then_j_and_exact() -> None:
    whole = fake_run().formed.whole
    shuffled = np.random.default_rng(1).permutation(len(whole.index))
    mixed = replace(
        whole,
        index=whole.index[shuffled],
        flat=whole.flat[shuffled],
        positions=whole.positions[shuffled],
        contact=whole.contact[shuffled],
    )
    formed = replace(fake_run().formed, whole=mixed)
    names, values = table(nodes_csv(formed))
    assert names == list(NODE_COLUMNS)
    assert [tuple(pair) for pair in values[:, :2]] == sorted(tuple(pair) for pair in whole.index)
    columns = np.column_stack((whole.index, whole.flat[:, :2], whole.positions))
    np.testing.assert_allclose(values[:, :7], columns[np.lexsort((whole.index[:, 1], whole.index[:, 0]))], atol=1e-11)
    assert np.isnan(values[:, 7:10]).all()
    assert "nan" not in nodes_csv(formed)


def test_released_positions_fill_their_columns() -> None:
    formed = fake_run().formed
    released = formed.whole.positions + np.array([0.0, 0.0, 1.5])
    _, values = table(nodes_csv(formed, released))
    np.testing.assert_allclose(values[:, 7:10] - values[:, 4:7], [[0, 0, 1.5]] * len(values), atol=1e-10)


def test_no_negative_zero_in_a_table() -> None:
    formed = fake_run().formed
    whole = replace(formed.whole, contact=np.full(len(formed.whole.contact), -0.0))
    assert all(row.endswith(",0") for row in nodes_csv(replace(formed, whole=whole)).splitlines()[1:])


def test_energy_of_the_wires_table_is_half_the_work_of_its_forces() -> None:
    formed = fake_run(yield_strength=250.0).formed
    names, values = table(wires_csv(formed))
    assert names == list(WIRE_COLUMNS)
    np.testing.assert_allclose(values[:, 15], 0.5 * (values[:, 3:9] * values[:, 9:15]).sum(axis=1), rtol=1e-11)
    assert values[:, 15].sum() == pytest.approx(formed.energy, rel=1e-12)
    assert np.isfinite(values[:, 17]).all()


def test_an_unknown_stress_is_an_empty_cell() -> None:
    rows = wires_csv(fake_run().formed).splitlines()[1:]
    assert all(row.endswith(",") and "nan" not in row for row in rows)


def test_wires_are_sorted_by_family_and_start() -> None:
    _, values = table(wires_csv(fake_run().formed))
    keys = [tuple(row) for row in values[:, :3]]
    assert keys == sorted(keys)


def strict(text: str) -> Any:
    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_result_json_follows_the_contract() -> None:
    run = fake_run(outcome=FakeOutcome.STEP_LIMIT, notes=("a note", "a note"))
    content = strict(result_json(run))
    assert content["schema"] == 1
    assert content["case_title"] == run.case.title
    assert content["grid"] == {
        "nodes": len(run.formed.whole.positions),
        "elements": len(run.formed.whole.family),
        "solved_nodes": run.formed.solved_nodes,
    }
    formed = content["formed"]
    assert formed["energy_mJ"] == run.formed.energy
    assert formed["outcome"] == "step_limit"
    assert formed["advice"] == FakeOutcome.STEP_LIMIT.value
    assert formed["max_shear_deg"] == pytest.approx(np.degrees(run.formed.max_shear))
    assert formed["contact"]["push_N"] == run.formed.push
    assert [step["energy_mJ"] for step in formed["history"]] == [step.energy for step in run.formed.history]
    assert content["notes"] == ["a note", *run.formed.notes]


def test_what_is_not_finite_is_null_in_result_json() -> None:
    run = fake_run()
    whole = replace(run.formed.whole, stress=np.full(len(run.formed.whole.stress), np.nan))
    history = (replace(run.formed.history[0], decrement=float("nan"), energy=float("inf")),)
    formed = strict(result_json(replace(run, formed=replace(run.formed, whole=whole, history=history))))["formed"]
    assert formed["max_stress_MPa"] is None
    assert formed["max_stress_ratio"] is None
    assert formed["history"][0]["decrement"] is None
    assert formed["history"][0]["energy_mJ"] is None


def test_node_shear_is_the_mean_of_the_cells_around() -> None:
    cells = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    shear = node_shear(7, cells, np.array([0.1, 0.3]))
    np.testing.assert_allclose(shear, [0.1, 0.2, 0.3, 0.1, 0.2, 0.3, np.nan])


def test_vtk_reads_back_every_array(tmp_path: Path) -> None:
    pytest.importorskip("vtkmodules")
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    to_numpy: Any = numpy_support.vtk_to_numpy
    formed = fake_run().formed
    whole = formed.whole
    released = whole.positions - 0.5
    write_vtp(tmp_path / "shape.vtp", formed, released)
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "shape.vtp"))
    reader.Update()
    read = reader.GetOutput()
    np.testing.assert_array_equal(to_numpy(read.GetPoints().GetData()), whole.positions)
    lines = to_numpy(read.GetLines().GetConnectivityArray()).reshape(-1, 2)
    np.testing.assert_array_equal(lines, np.column_stack((whole.start, whole.end)))
    assert read.GetNumberOfCells() == len(whole.family)
    points = {
        "i": whole.index[:, 0],
        "j": whole.index[:, 1],
        "flat": whole.flat,
        "displacement": whole.positions - whole.flat,
        "normal": whole.normals,
        "contact_force": whole.contact,
        "shear": node_shear(len(whole.flat), whole.cells, whole.cell_shear),
        "released": released,
        "springback": released - whole.positions,
    }
    wires = {
        "family": whole.family,
        "axial_force": whole.F[:, 0],
        "axial_strain": whole.axial_strain,
        "energy": whole.energy,
    }
    for data, expected in ((read.GetPointData(), points), (read.GetCellData(), wires)):
        assert {data.GetArrayName(k) for k in range(data.GetNumberOfArrays())} == set(expected)
        for name, values in expected.items():
            np.testing.assert_array_equal(to_numpy(data.GetArray(name)), values)


def test_the_vtk_file_holds_the_deviations_that_are_judged(tmp_path: Path) -> None:
    run = let_go(
        fake_run(),
        lambda rho, angle: 2 + 0 * rho,
        release={"hold": "rim"},
        target={
            "profile": {"kind": "paraboloid", "focal_length": 250.0},
            "aperture_radius": 200.0,
            "tolerance": 1.0,
            "alignment": "best fit",
        },
    )
    assert run.accuracy is not None
    write_vtp(tmp_path / "shape.vtp", run.formed, None, run.accuracy)
    found = ET.fromstring((tmp_path / "shape.vtp").read_text("ascii")).findall(".//PointData/DataArray")
    arrays = {array.get("Name"): base64.b64decode(array.text or "")[8:] for array in found}
    for measure, values in ((one, run.accuracy.fitted.deviations.of(one)) for one in MEASURES):
        read = np.frombuffer(arrays[f"deviation_{measure.replace('-', '_')}"])
        np.testing.assert_array_equal(read, values)


def test_the_wires_of_the_released_stage_have_the_same_table() -> None:
    run = let_go(fake_run(), lambda rho, angle: 0 * rho, release={"hold": "rim"})
    assert run.released is not None
    assert wires_csv(run.released) == wires_csv(run.formed)


def test_the_vtk_file_is_valid_xml_whatever_the_names() -> None:
    text = poly_lines(np.zeros((2, 3)), np.array([[0, 1]]), {'a "b" <c>': np.zeros(2)}, {})
    assert ET.fromstring(text).find(".//PointData/DataArray").get("Name") == 'a "b" <c>'  # type: ignore[union-attr]


# --- wires that yield ---------------------------------------------------------------------------------------


def test_elastic_wires_have_the_files_they_had(tmp_path: Path) -> None:
    run = let_go(fake_run(), lambda rho, angle: 0 * rho, release={"hold": "rim"})
    content = strict(result_json(run))
    assert not {"plastic", "springback"} & (content["formed"].keys() | content["released"].keys())
    assert wires_csv(run.formed).splitlines()[0] == ",".join(WIRE_COLUMNS)
    write_vtp(tmp_path / "shape.vtp", run.formed)
    assert "plastic" not in (tmp_path / "shape.vtp").read_text("ascii")


def test_every_stage_of_wires_that_yield_says_what_flowed() -> None:
    run = dish()
    content = strict(result_json(run))
    assert run.released is not None
    for name, stage in (("formed", run.formed), ("released", run.released)):
        told, whole = content[name]["plastic"], stage.whole
        assert told["max_plastic_strain"] == whole.plastic_strain.max() > 0
        assert told["max_elongation"] == content[name]["max_axial_strain"]
        assert told["max_thinning"] == pytest.approx(1 - whole.stretch.max() ** -0.5)
        assert told["yielded_share"] == np.mean(whole.plastic_strain > 0)
        assert told["flow_work_mJ"] > content[name]["energy_mJ"]
        breaks_at = stage.hardening.breaks_at if stage.hardening else None
        assert breaks_at is not None
        assert told["strain_to_break"] == pytest.approx(np.log1p(whole.axial_strain.max()) / breaks_at)
    assert content["released"]["plastic"]["flow_work_mJ"] >= content["formed"]["plastic"]["flow_work_mJ"]


def test_a_law_that_does_not_say_where_the_wire_breaks_is_null() -> None:
    formed = dish().formed
    assert formed.hardening is not None
    silent = replace(formed, hardening=replace(formed.hardening, breaks_at=None))
    assert strict(result_json(replace(dish(), formed=silent)))["formed"]["plastic"]["strain_to_break"] is None


def test_the_springback_is_written_in_its_parts() -> None:
    run = dish()
    told = strict(result_json(run))["released"]["springback"]
    assert list(told) == ["membrane", "bending", "rim", "remainder", "total"]
    parts = [told[name]["apex_mm"] for name in ("membrane", "bending", "rim", "remainder")]
    assert sum(parts) == pytest.approx(told["total"]["apex_mm"], abs=1e-12)
    assert run.released is not None
    assert told["total"]["apex_mm"] == pytest.approx(run.released.apex, abs=1e-12)


def test_tables_and_shape_have_stretch_and_plastic_strain_at_their_end(tmp_path: Path) -> None:
    run = dish()
    whole = run.formed.whole
    names, values = table(wires_csv(run.formed))
    assert names == [*WIRE_COLUMNS, "stretch", "plastic_strain"]
    assert sorted(values[:, -1]) == pytest.approx(sorted(whole.plastic_strain), rel=1e-12)
    stored = read_run(write_run(run, tmp_path / "dish"))
    assert stored.wires["stretch"].max() == pytest.approx(whole.stretch.max(), rel=1e-14)
    assert stored.wires_released is not None
    assert run.released is not None
    assert stored.wires_released["plastic_strain"].max() == pytest.approx(
        run.released.whole.plastic_strain.max(), rel=1e-14
    )
    found = ET.fromstring((stored.folder / "shape.vtp").read_text("ascii")).findall(".//CellData/DataArray")
    arrays = {one.get("Name"): np.frombuffer(base64.b64decode(one.text or "")[8:]) for one in found}
    np.testing.assert_array_equal(arrays["stretch"], whole.stretch)
    np.testing.assert_array_equal(arrays["plastic_strain"], whole.plastic_strain)
