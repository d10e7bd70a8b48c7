"""Decks of beams: they hold the forces of the wires, and CalculiX finds our springback and our load in them."""

from __future__ import annotations

import re
import shutil
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import tiny_dish
from ccx import answer_to
from stretched import dish

from punchform.arrays import Floats
from punchform.case.reading import case_from_text
from punchform.errors import InputError
from punchform.export.beam_stress import KRONROD, POINTS, square, stresses
from punchform.export.beams import Beams, beams
from punchform.export.fe_deck import FORMED, NODES, RELEASED, SPRINGBACK, write_decks
from punchform.mechanics.end_loads import end_loads
from punchform.prepare import prepare
from punchform.release import Released
from punchform.run import Run, run
from punchform.solved import Shaped, bars_of
from punchform.store import load_run, write_run
from punchform.whole import unfold_loads
from punchform.wire import round_section

DISH = """
schema = 1
title = "Shallow"
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "42 mm" }
GRID
[wire]
diameter = "0.75 mm"
youngs_modulus = "210 GPa"
poisson = 0.3
[punch]
profile = { kind = "paraboloid", focal_length = "150 mm" }
rim_radius = "40 mm"
fillet = "40 mm"
[press]
frame = "chord"
[release]
symmetry = "full"
hold = HOLD
LOAD
"""
POINTS_HOLD = '{ points = 8, radius = "36 mm" }'
LOAD = """[load]
forces = [{ node = [2, 1], force = ["0 N", "0 N", "-2 N"] }, { node = [-2, -2], force = ["0.5 N", "0 N", "0 N"] }]
"""
needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not on the path")


@cache
def shallow(grid: str = "", hold: str = POINTS_HOLD, loads: str = LOAD) -> Run:
    """A dish of about 60 crossings whose wires bend little from one to the next."""
    return run(case_from_text(DISH.replace("GRID", grid).replace("HOLD", hold).replace("LOAD", loads)))


def loads_of(done: Run, stage: Shaped) -> Floats:
    bars = bars_of(prepare(done.case).elements, done.case.framed(done.case.press))
    solved = slice(stage.grid.elements)
    return unfold_loads(
        stage.grid, end_loads(stage.grid, stage.state, bars, stage.whole.D[solved], stage.whole.F[solved])
    )


def model_of(done: Run, stage: Shaped, count: int = 2) -> Beams:
    elements = prepare(done.case).elements
    bars = bars_of(elements, done.case.framed(done.case.press))
    clamped = np.zeros(len(stage.whole.positions), dtype=bool)
    return beams(stage.whole, elements, bars, count=count, welded=False, clamped=clamped)


@pytest.mark.parametrize("make", [shallow, lambda: run(tiny_dish.case()), dish], ids=["full", "quarter", "yields"])
def test_loads_on_the_ends_balance_and_add_up_to_what_holds_the_grid(make: object) -> None:
    assert callable(make)
    done = make()
    stage = done.released
    assert isinstance(stage, Released)
    loads, whole = loads_of(done, stage), stage.whole
    np.testing.assert_allclose(loads[:, 0, :3], -loads[:, 1, :3], atol=1e-10)
    lever = np.cross(whole.positions[whole.end] - whole.positions[whole.start], loads[:, 1, :3])
    np.testing.assert_allclose(loads[:, :, 3:].sum(axis=1) + lever, 0.0, atol=1e-9)
    held = np.zeros((len(whole.positions), 6))
    np.add.at(held, whole.start, loads[:, 0])
    np.add.at(held, whole.end, loads[:, 1])
    slack = 1e-3 * np.abs(loads[:, :, :3]).max()
    np.testing.assert_allclose(held[:, :3], stage.reactions, atol=slack)
    free = np.linalg.norm(stage.reactions, axis=1) == 0
    assert np.abs(held[free]).max() < slack


def test_tools_push_wires_that_have_flowed_as_the_press_says() -> None:
    """What they remember, which is not kept with a run, follows from their modes: else these forces were others."""
    done = dish()
    stage = done.formed
    bars = bars_of(prepare(done.case).elements, done.case.framed(done.case.press))
    solved = slice(stage.grid.elements)
    loads = end_loads(stage.grid, stage.state, bars, stage.whole.D[solved], stage.whole.F[solved])
    forces = np.zeros((stage.grid.nodes, 3))
    for end, nodes in enumerate((stage.grid.start, stage.grid.end)):
        np.add.at(forces, nodes, stage.grid.weight[:, None] * loads[:, end, :3])
    normal = np.sum(forces * stage.state.normals, axis=1) / stage.grid.node_weight
    whole = stage.whole
    inner = np.linalg.norm(whole.flat[:, :2], axis=1) < 30.0
    places = {tuple(flat): k for k, flat in enumerate(stage.grid.flat.tolist())}
    for k in np.flatnonzero(inner & (whole.flat[:, 0] >= 0) & (whole.flat[:, 1] >= 0)):
        here = places[tuple(whole.flat[k, :2].tolist())]
        assert normal[here] == pytest.approx(whole.contact[k], abs=2e-3 * np.abs(whole.contact).max())


def test_the_square_resists_as_the_round_wire() -> None:
    found = square(round_section(0.75, youngs_modulus=210e3, poisson=0.3, shear_factor=0.9))
    assert found.side == pytest.approx(np.sqrt(3) / 2 * 0.75)
    assert found.youngs_modulus == pytest.approx(np.pi / 3 * 210e3)
    assert found.shear_modulus == pytest.approx(found.youngs_modulus / 2.6)


def test_the_stresses_of_a_section_have_the_force_and_the_moment_of_its_wire() -> None:
    done = shallow()
    stage = done.released
    assert stage is not None
    loads, model, side = loads_of(done, stage), model_of(done, stage), 0.65
    stress = stresses(model, stage.whole, loads, side)
    nodes = model.places[model.wires]
    # The rule of Kronrod in the section: its weights on a line of length 2.
    line = {round(KRONROD, 9): 0.1979797979797980, round(1 / 3**0.5, 9): 0.4909090909090909, 0.0: 0.6222222222222222}
    weights = np.array([line[round(abs(a), 9)] * line[round(abs(b), 9)] / 4 for _, a, b in POINTS])
    assert weights[POINTS[:, 0] < 0].sum() == pytest.approx(1.0)
    for a in (-1, 1):
        own = np.flatnonzero(np.sign(POINTS[:, 0]) == a)
        z = a / np.sqrt(3.0)
        place = np.einsum("k,bkc->bc", (0.5 * z * (z - 1), 1 - z * z, 0.5 * z * (z + 1)), nodes)
        t = np.einsum("k,bkc->bc", (z - 0.5, -2 * z, z + 0.5), nodes)
        t /= np.linalg.norm(t, axis=1)[:, None]
        tensor = stress[:, own][:, :, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(len(t), len(own), 3, 3)
        traction = side**2 * np.einsum("g,bgij,bj->bgi", weights[own], tensor, t)
        force = loads[model.element, 1, :3]
        np.testing.assert_allclose(traction.sum(axis=1), force, atol=1e-9)
        first = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])[model.family - 1]
        first = first - t * np.sum(first * t, axis=1)[:, None]
        first /= np.linalg.norm(first, axis=1)[:, None]
        r = 0.5 * side * (POINTS[own, 1, None] * first[:, None] + POINTS[own, 2, None] * np.cross(t, first)[:, None])
        far = stage.whole.positions[stage.whole.end[model.element]]
        moment = loads[model.element, 1, 3:] + np.cross(far - place, force)
        np.testing.assert_allclose(np.cross(r, traction).sum(axis=1), moment, atol=1e-9)


def test_hinges_are_two_places_on_the_common_normal() -> None:
    done = shallow()
    stage = done.released
    assert stage is not None
    model = model_of(done, stage)
    np.testing.assert_allclose(model.places[model.ties[:, 0]], model.places[model.ties[:, 1]], atol=1e-12)
    crossed = (model.centres >= 0).all(axis=1)
    assert len(model.ties) == 2 * crossed.sum()
    # The wires run half a crimp above and below the crossings, and are a crimp apart.
    ends = np.unique(model.wires[np.isin(model.wires, model.arms[:, 1])])
    off = [np.linalg.norm(stage.whole.positions - model.places[end], axis=1).min() for end in ends]
    np.testing.assert_allclose(off, 0.375, rtol=1e-9)


def test_arms_are_made_once_and_every_node_has_its_use() -> None:
    done = shallow()
    stage = done.released
    assert stage is not None
    model = model_of(done, stage)
    assert len(np.unique(model.arms[:, 1])) == len(model.arms)
    ends = np.column_stack((model.arms[:, 0], np.round(model.places[model.arms[:, 1]], 9)))
    assert len(np.unique(ends, axis=0)) == len(model.arms)
    used = np.concatenate([part.ravel() for part in (model.wires, model.arms, model.ties, model.centres)])
    np.testing.assert_array_equal(np.unique(used[used >= 0]), np.arange(len(model.places)))


def test_beams_run_along_the_wire_that_the_element_knows() -> None:
    """Of a flat grid they are the unloaded centreline, and their lengths its length."""
    done = run(case_from_text(DISH.replace("GRID", "").replace("HOLD", '"nothing"').replace("LOAD", "")))
    stage = done.released
    assert stage is not None
    model = model_of(done, stage, count=16)
    nodes = model.places[model.wires]
    length = np.linalg.norm(np.diff(nodes, axis=1), axis=2).sum() / len(stage.whole.family)
    assert length == pytest.approx(prepare(done.case).elements[0].wire_length, rel=1e-4)
    assert np.abs(model.places[:, 2]).max() == pytest.approx(0.375, rel=1e-6)


def test_the_same_run_gives_the_same_bytes_and_a_head_that_tells_units(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        files = write_decks(shallow(), tmp_path / name)
        assert [file.name for file in files] == [SPRINGBACK, RELEASED, NODES]
    for file in files[:2]:
        text = file.read_text()
        assert text == (tmp_path / "one" / file.name).read_text()
        assert "** units: lengths mm" in text
        assert "** frame: " in text
        assert "nan" not in text


def test_a_run_read_back_has_the_same_decks(tmp_path: Path) -> None:
    done = dish()
    again = load_run(write_run(done, tmp_path / "run"))
    for name, one in (("first", done), ("again", again)):
        (tmp_path / name).mkdir()
        files = write_decks(one, tmp_path / name)
    for file in files:
        assert file.read_bytes() == (tmp_path / "first" / file.name).read_bytes()


def test_a_grid_that_is_not_let_go_is_held_in_its_tool(tmp_path: Path) -> None:
    done = run(tiny_dish.case().model_copy(update={"release": None, "target": None}))
    file, _ = write_decks(done, tmp_path)
    assert file.name == FORMED
    assert "*CLOAD" not in file.read_text()


@pytest.mark.parametrize("grid", ["", "subdivide = 2"])
def test_the_table_of_nodes_tells_which_crossing_a_node_is_after_a_trim(grid: str, tmp_path: Path) -> None:
    stages = 'stages = ["press", { trim = { radius = "38 mm" } }, "release"]'
    text = DISH.replace("schema = 1", f"schema = 1\n{stages}").replace("GRID", grid).replace("LOAD", "")
    done = run(case_from_text(text.replace("HOLD", '{ from_radius = "30 mm" }')))
    assert done.released is not None
    write_decks(done, tmp_path)
    listed = np.loadtxt(tmp_path / NODES, delimiter=",", skiprows=1)
    placed = re.search(r"\*NODE[^\n]*\n((?:\d+,[^\n]*\n)+)", (tmp_path / RELEASED).read_text())
    assert placed is not None
    deck = np.array([[float(cell) for cell in row.split(",")] for row in placed[1].splitlines()])
    whole = done.released.whole
    assert len(listed) == len(whole.index) < done.formed.whole.index.shape[0]
    at = {tuple(row): place for row, place in zip(whole.flat[:, :2].round(9).tolist(), whole.positions, strict=True)}
    for (number, _, _, _, x, y), row in zip(listed.tolist(), deck[: len(listed)], strict=True):
        assert row[0] == number
        np.testing.assert_allclose(row[1:], at[round(x, 9), round(y, 9)], atol=1e-6)


def test_wires_without_a_section_and_springs_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"wire\.stiffness"):
        write_decks(run(tiny_dish.case().model_copy(update={"wire": PAPER})), tmp_path)
    with pytest.raises(InputError, match=r"grid\.crossing"):
        write_decks(shallow('crossing = { stiffness = "20 N*mm/rad" }'), tmp_path)
    assert not list(tmp_path.iterdir())


PAPER = case_from_text(
    tiny_dish.TEXT.replace('step = "10 mm"', 'step = "7.5 mm"')
    .replace('diameter = "0.75 mm"', 'stiffness = "paper"')
    .replace('youngs_modulus = "210 GPa"', "")
    .replace("poisson = 0.3", "")
).wire


def moves(text: str, nodes: int) -> list[Floats]:
    """The printed displacements (N, 3) of the nodes of the grid after each step."""
    tables = re.split(r"^ *(?=displacements \(|forces \()", text, flags=re.M)[1:]
    rows = [re.findall(r"^\s*(\d+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$", one, re.M) for one in tables if one.startswith("d")]
    found = [np.array(table, dtype=np.float64) for table in rows]
    for table in found:
        np.testing.assert_array_equal(table[:, 0], np.arange(1, nodes + 1))
    return [table[:, 1:] for table in found]


def apart(found: Floats, expected: Floats) -> float:
    """The largest difference over the largest move."""
    return float(np.linalg.norm(found - expected, axis=1).max() / np.linalg.norm(expected, axis=1).max())


@needs_ccx
@pytest.mark.parametrize("grid", ["", 'crossing = "welded"'], ids=["pinned", "welded"])
def test_calculix_finds_the_released_grid_at_rest_and_our_deflections(grid: str, tmp_path: Path) -> None:
    done = shallow(grid)
    assert done.released is not None
    assert done.loaded is not None
    file = write_decks(done, tmp_path)[1]
    rest, loaded = moves(answer_to(file.read_text(), threads=1), len(done.released.whole.positions))
    # What moves without a load, against how far the grid sprang back, and against the load's deflections.
    assert np.abs(rest).max() < 2e-3 * np.linalg.norm(done.released.moved, axis=1).max()
    assert apart(loaded - rest, done.loaded.moved) < 0.01


@needs_ccx
def test_without_the_forces_in_the_wires_it_is_another_grid(tmp_path: Path) -> None:
    done = shallow()
    assert done.loaded is not None
    text = write_decks(done, tmp_path)[1].read_text()
    bare = re.sub(r"^\*INITIAL CONDITIONS.*?^(?=\*\* step)", "", text, flags=re.S | re.M)
    rest, loaded = moves(answer_to(bare, threads=1), len(done.loaded.moved))
    assert apart(loaded - rest, done.loaded.moved) > 0.15


@needs_ccx
def test_calculix_springs_back_as_we_do(tmp_path: Path) -> None:
    done = shallow()
    assert done.released is not None
    file = write_decks(done, tmp_path)[0]
    tool, free = moves(answer_to(file.read_text(), threads=1), len(done.released.whole.positions))
    expected = done.released.whole.positions - done.formed.whole.positions
    assert np.abs(tool).max() < 2e-3 * np.linalg.norm(expected, axis=1).max()
    assert apart(free, expected) < 0.02
