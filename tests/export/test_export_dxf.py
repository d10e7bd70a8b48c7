"""DXF drawings read back: wires where they are, lists that add up, nothing for an audit to mend, the same bytes."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from exported_runs import MADE, dish_of, made
from ezdxf import units
from ezdxf.document import Drawing
from ezdxf.entities import Line, LWPolyline, Polyline, Text
from ezdxf.lldxf.encoding import decode_dxf_unicode

from punchform.arrays import Floats
from punchform.export.blank import rim_lines
from punchform.export.cut_list import COLUMNS, cut_list
from punchform.export.dxf import dxf_files
from punchform.export.points import point_files
from punchform.export.shapes import shapes
from punchform.export.strands import strands
from punchform.run import Run
from punchform.trim import Trimmed

every_run = pytest.mark.parametrize("name", MADE)


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folders = {}
    for name in MADE:
        folders[name] = tmp_path_factory.mktemp("drawn")
        dxf_files(made(name), folders[name])
    return folders


def lines(document: Drawing, layer: str) -> Floats:
    """Both ends (n, 2, 2) of the lines of a layer."""
    found = [one for one in document.modelspace() if isinstance(one, Line) and one.dxf.layer == layer]
    return np.array([[tuple(one.dxf.start)[:2], tuple(one.dxf.end)[:2]] for one in found]).reshape(-1, 2, 2)


def texts(document: Drawing, layer: str) -> list[str]:
    return [one.dxf.text for one in document.modelspace() if isinstance(one, Text) and one.dxf.layer == layer]


def lengths(ends: Floats) -> Floats:
    return np.asarray(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))


@every_run
def test_every_drawing_is_in_mm_and_has_no_fault(name: str, drawn: dict[str, Path]) -> None:
    drawings = sorted(drawn[name].glob("*.dxf"))
    assert {"blank.dxf", "formed.dxf"} <= {path.name for path in drawings}
    assert (drawn[name] / "released.dxf").exists() == ("released" in shapes(made(name)))
    for path in drawings:
        document = ezdxf.readfile(path)
        audit = document.audit()
        assert not audit.errors
        assert not audit.fixes
        assert document.units == units.MM
        assert "units: lengths mm" in path.read_text(encoding=document.encoding).partition("SECTION")[0]


@every_run
def test_wires_in_space_run_through_their_nodes_in_order(name: str, drawn: dict[str, Path]) -> None:
    whole = made(name).formed.whole
    space = ezdxf.readfile(drawn[name] / "formed.dxf").modelspace()
    drawn_pieces, families = set(), []
    for line in space:
        assert isinstance(line, Polyline)
        assert line.is_3d_polyline
        points = np.array([tuple(place) for place in line.points()])
        nodes = [int(np.linalg.norm(whole.positions - point, axis=1).argmin()) for point in points]
        assert np.abs(whole.positions[nodes] - points).max() < 1e-9
        family = int(line.dxf.layer.removeprefix("WIRES_"))
        assert (np.diff(whole.flat[nodes, family - 1]) > 0).all()
        assert np.ptp(whole.flat[nodes, 2 - family]) == 0
        drawn_pieces |= {frozenset(pair) for pair in pairwise(nodes)}
        families += [family] * (len(nodes) - 1)
    assert drawn_pieces == {frozenset(pair) for pair in zip(whole.start.tolist(), whole.end.tolist(), strict=True)}
    assert sorted(families) == sorted(whole.family.tolist())


@every_run
def test_the_cut_list_is_drawn_and_tabled_alike(name: str, drawn: dict[str, Path]) -> None:
    document = ezdxf.readfile(drawn[name] / "blank.dxf")
    with (drawn[name] / "cut_list.csv").open(encoding="utf-8") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    assert tuple(head) == COLUMNS
    cells = texts(document, "CUT_LIST")
    assert [cells[k : k + len(COLUMNS)] for k in range(0, len(cells), len(COLUMNS))] == [head, *rows]
    assert texts(document, "NUMBERS") == [row[0] for row in rows]
    assert len({row[0] for row in rows}) == len(rows)
    for family in ("1", "2"):
        listed = np.array([[float(cell) for cell in row[3:]] for row in rows if row[1] == family])
        ends = lines(document, f"WIRES_{family}")
        np.testing.assert_allclose(ends.reshape(-1, 4), listed[:, 2:6], atol=5e-4)
        np.testing.assert_allclose(lengths(ends), listed[:, 0], atol=5e-4)


@every_run
def test_the_lengths_of_all_wires_make_their_pieces(name: str) -> None:
    run = made(name)
    whole = run.stages[0].done.whole
    step = np.asarray(run.case.grid.step)[whole.family - 1] / run.case.grid.subdivide
    assert sum(cut.length for cut in cut_list(run)) == pytest.approx(step.sum())


def test_wire_of_the_cut_list_has_the_mass_that_the_load_weighs() -> None:
    """The crimp makes wires longer than the flat grid."""
    run = made("loaded")
    assert run.loaded is not None
    cuts = cut_list(run)
    section = math.pi / 4 * run.case.wire.diameter**2
    assert sum(cut.wire_length for cut in cuts) * section * 7850e-9 == pytest.approx(run.loaded.mass, rel=1e-12)
    assert all(cut.wire_length > cut.length for cut in cuts)


@pytest.mark.parametrize("name", ["in stages", "let go whole", "trimmed last"])
def test_what_trims_cut_off_is_drawn_apart(name: str, drawn: dict[str, Path]) -> None:
    run = made(name)
    (trimmed,) = (stage.done for stage in run.stages if isinstance(stage.done, Trimmed))
    off = lengths(lines(ezdxf.readfile(drawn[name] / "blank.dxf"), "CUT_OFF"))
    assert trimmed.pieces_cut > 0
    assert off.sum() == pytest.approx(trimmed.pieces_cut * run.case.grid.step[0])
    assert sum(cut.cut_off for cut in cut_list(run)) == pytest.approx(off.sum())
    assert (drawn[name] / "trimmed.dxf").exists() == (name in ("let go whole", "trimmed last"))


def test_nothing_is_cut_off_without_a_trim() -> None:
    assert not any(cut.cut_off for cut in cut_list(made("elastic")))


def test_a_wire_with_a_gap_is_two_wires() -> None:
    """The blank sticks out beside its notch: between x = 65 and 85 mm only some wires of family 2 have two parts."""
    names = [strand.name for strand in strands(made("notched").formed.whole)]
    assert {"2w7", "2w7b"} <= set(names)
    assert "2w0" in names
    assert "2w0b" not in names
    parts = {strand.name: strand for strand in strands(made("notched").formed.whole)}
    flat = made("notched").formed.whole.flat
    assert flat[parts["2w7"].nodes, 1].tolist() == [-70.0, -60.0]
    assert flat[parts["2w7b"].nodes, 1].tolist() == [0.0, 10.0, 20.0]


def flattened(run: Run) -> Run:
    """As if the wires lay on the rim's plane as they did before."""
    whole = run.formed.whole
    return replace(run, formed=replace(run.formed, whole=replace(whole, positions=whole.flat)))


def test_the_line_that_lands_on_the_rim_of_a_flat_grid_is_the_rim() -> None:
    """Between nodes the distance from the axis is bilinear, which makes a circle to h²/8R."""
    ((line, closed),) = rim_lines(
        flattened(dish_of(blank='blank = { shape = "rectangle", size = ["140 mm", "140 mm"] }'))
    )
    assert closed
    assert np.abs(np.hypot(*line.T) - 60.0).max() < 10.0**2 / (8 * 60.0)


def test_where_the_blank_ends_before_the_rim_the_line_has_gaps(drawn: dict[str, Path]) -> None:
    """The wires of a round blank are drawn in: those at the diagonals reach beyond the rim, others end before."""
    pieces = list(rim_lines(made("elastic")))
    assert 0 < sum(len(line) for line, _ in pieces) < 360
    assert not any(closed for _, closed in pieces)
    whole = made("elastic").formed.whole
    for line, _ in pieces:
        assert (np.hypot(*line.T) > 60.0).all()
        assert (np.hypot(*line.T) < np.hypot(*whole.flat[:, :2].T).max()).all()
    space = ezdxf.readfile(drawn["elastic"] / "blank.dxf").modelspace()
    shown = [one for one in space if isinstance(one, LWPolyline) and one.dxf.layer == "LANDS_ON_RIM"]
    assert [len(one) for one in shown] == [len(line) for line, _ in pieces]


def test_letters_of_any_kind_survive(drawn: dict[str, Path]) -> None:
    title = made("loaded").case.title
    head = texts(ezdxf.readfile(drawn["loaded"] / "blank.dxf"), "HEADING")[0]
    assert "\\U+2713" in head, "what the code page lacks is written as its number"
    assert decode_dxf_unicode(head).startswith(title)
    assert (drawn["loaded"] / "cut_list.csv").read_text(encoding="utf-8").startswith(f"# {title}")


def test_a_title_of_two_lines_is_one_line_everywhere(tmp_path: Path) -> None:
    run = made("elastic")
    broken = replace(run, case=run.case.model_copy(update={"title": "one\n  two^2"}))
    for path in (*dxf_files(broken, tmp_path), *point_files(broken, tmp_path)):
        if path.suffix == ".dxf":
            assert not ezdxf.readfile(path).audit().errors
        else:
            assert path.read_text(encoding="utf-8").startswith("# one two^2: ")
    head = [one for one in ezdxf.readfile(tmp_path / "blank.dxf").modelspace() if one.dxf.layer == "HEADING"]
    assert isinstance(head[0], Text)
    assert head[0].plain_text() == "one two^2: the flat blank"


def test_the_same_run_gives_the_same_bytes(drawn: dict[str, Path], tmp_path: Path) -> None:
    for path in dxf_files(made("in stages"), tmp_path):
        assert path.read_bytes() == (drawn["in stages"] / path.name).read_bytes()
