"""`drape`: from a case to nodes, shear, flat pattern and wire lengths without a solve."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from punchform.arrays import Floats
from punchform.case import (
    Case,
    CircleBlank,
    ParaboloidProfile,
    PunchCase,
    RectangleBlank,
    SphereProfile,
    read_case,
    write_case,
)
from punchform.cli.drape import drape_case
from punchform.cli.exits import Exit
from punchform.cli.voice import Voice
from punchform.drape import drape
from punchform.errors import InputError
from punchform.net import length_within
from punchform.progress import Progress

CHECK = read_case("packaged:check")


def changed(case: Case, *, grid: dict[str, Any] | None = None, punch: PunchCase | None = None) -> Case:
    return case.model_copy(
        update={"grid": case.grid.model_copy(update=grid or {}), **({} if punch is None else {"punch": punch})}
    )


def hemisphere(tmp_path: Path) -> Path:
    """A case file with a hemisphere; from one side of it a square blank cannot be laid over the other."""
    punch = PunchCase(profile=SphereProfile(radius=90.0), rim_radius=100.0, fillet=12.0)
    path = tmp_path / "hemisphere.toml"
    alone = CHECK.model_copy(update={"release": None, "target": None})
    path.write_text(write_case(changed(alone, grid={"blank": RectangleBlank(size=(300.0, 300.0))}, punch=punch)))
    return path


def rows(path: Path) -> tuple[list[str], Floats]:
    """Names and numbers of a CSV file; an empty cell is NaN."""
    head, *lines = csv.reader(path.read_text().splitlines())
    return head, np.array([[float(cell) if cell else math.nan for cell in line] for line in lines])


def test_the_check_case_drapes_as_a_whole_grid_with_right_edges() -> None:
    done = drape(CHECK)
    whole = done.formed.whole
    assert done.net.complete
    assert done.notes == ()
    assert done.grid.quarter
    assert len(whole.index) == 6625
    length = np.linalg.norm(whole.positions[whole.end] - whole.positions[whole.start], axis=1)
    assert np.abs(length / 7.5 - 1).max() < 1e-13
    assert np.isnan(whole.contact).all()
    assert np.isnan(whole.F).all()


def test_quarter_and_whole_grid_drape_alike() -> None:
    quarter, full = drape(CHECK), drape(changed(CHECK, grid={"symmetry": "full"}))
    assert np.array_equal(quarter.formed.whole.positions, full.formed.whole.positions)
    assert quarter.net.max_shear == full.net.max_shear
    assert quarter.draw_in == full.draw_in
    assert np.allclose(quarter.rim.flat, full.rim.flat, rtol=0, atol=1e-12)
    assert np.array_equal(quarter.wires.length, full.wires.length)


def test_the_wires_of_the_blank_add_up() -> None:
    done = drape(CHECK)
    wires = done.wires
    assert wires.pieces.sum() == len(done.formed.whole.family)
    assert wires.length.sum() == pytest.approx(7.5 * wires.pieces.sum())
    assert np.array_equal(wires.offset, 7.5 * wires.number)
    middle = (wires.number == 0).nonzero()[0]
    assert np.array_equal(wires.family[middle], [1, 2])
    # Along the axes the wire lies on the meridian: within the rim it is as long as the outline is wide.
    assert wires.inside[middle] == pytest.approx(2 * done.rim.radius[0], abs=1e-6)
    assert (wires.inside <= wires.length + 1e-9).all()
    assert (wires.inside[np.abs(wires.offset) > 330.0] == 0.0).all()


def test_the_part_of_an_edge_within_a_line_is_cut_at_the_line() -> None:
    level = np.array([-3.0, 1.0, -1.0, np.nan, 2.0])
    start, end = np.array([0, 1, 0, 0, 1]), np.array([1, 0, 2, 3, 4])
    found = length_within(start, end, level, np.full(5, 4.0))
    assert found == pytest.approx([3.0, 3.0, 4.0, math.nan, 0.0], nan_ok=True)


def test_a_blank_that_ends_before_the_rim_says_so() -> None:
    done = drape(changed(CHECK, grid={"blank": CircleBlank(radius=318.0)}))
    missing = np.isnan(done.rim.radius)
    assert missing.any()
    assert not missing.all()
    assert f"in {missing.sum()} of 360 directions the blank" in done.notes[0]


def test_all_that_is_wrong_beside_the_case_is_told_at_once() -> None:
    with pytest.raises(InputError) as refused:
        drape(CHECK, origin=(180.0, -240.0), shear_limit=0.5 * math.pi)
    assert [problem.where for problem in refused.value.problems] == ["origin", "shear_limit"]


def test_a_grid_that_is_moved_off_the_axis_is_drawn_in_as_where_it_lies() -> None:
    """A dish cut from another place of a sphere is the same dish."""
    punch = PunchCase(profile=SphereProfile(radius=900.0), rim_radius=300.0, fillet=30.0)
    case = changed(CHECK, grid={"blank": CircleBlank(radius=305.0)}, punch=punch)
    middle, aside = drape(case, direction=0.1), drape(case, origin=(2.0, 0.0), direction=0.1)
    assert aside.origin == (2.0, 0.0)
    assert aside.direction == 0.1
    assert aside.draw_in == pytest.approx(middle.draw_in, abs=0.5)
    assert any("nearer to the axis" in note for note in aside.notes) == bool(np.isnan(aside.rim.radius).any())


def test_a_sharp_punch_is_refused_as_for_the_press() -> None:
    punch = PunchCase(profile=ParaboloidProfile(focal_length=250.0), rim_radius=300.0, fillet=3.0)
    with pytest.raises(InputError, match="sharper than the grid step"):
        drape(changed(CHECK, punch=punch))


def test_an_observer_hears_of_compiling_once() -> None:
    heard: list[Progress] = []
    drape(CHECK, observe=heard.append)
    assert [event.step for event in heard] in ([], [-1])
    heard.clear()
    drape(CHECK, observe=heard.append)
    assert heard == []


def test_the_command_writes_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "net"
    assert drape_case("packaged:check", str(folder), overwrite=False, voice=Voice.PLAIN, as_json=True) is Exit.DONE
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((folder / "result.json").read_text())
    assert printed["grid"] == {"nodes": 6625, "elements": 13064, "solved_nodes": 1703}
    assert printed["drape"]["complete"] is True
    head, nodes = rows(folder / "nodes.csv")
    assert head == ["i", "j", "x0", "y0", "x", "y", "z", "xr", "yr", "zr", "contact_force"]
    assert np.isfinite(nodes[:, :7]).all()
    assert np.isnan(nodes[:, 7:]).all()
    head, outline = rows(folder / "outline.csv")
    assert head == ["direction_deg", "x0", "y0", "x", "y", "z"]
    assert np.hypot(outline[:, 3], outline[:, 4]) == pytest.approx(300.0, abs=0.05)
    head, wires = rows(folder / "wire_lengths.csv")
    assert head == ["family", "number", "offset", "pieces", "length", "inside_rim"]
    assert wires[:, 4].sum() == pytest.approx(printed["drape"]["wire_length_mm"])
    assert "All 6625 crossings have a place" in (folder / "report.html").read_text(encoding="utf-8")
    for name in ("case.toml", "shape.vtp", "figures/shape.png", "figures/shear.png", "figures/sections.png"):
        assert (folder / name).stat().st_size > 0


def test_the_command_refuses_and_replaces_folders(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "net"
    drape_case("packaged:check", str(folder), overwrite=False, voice=Voice.QUIET, as_json=False)
    assert str(folder) in capsys.readouterr().out
    with pytest.raises(InputError, match="already holds a run"):
        drape_case("packaged:check", str(folder), overwrite=False, voice=Voice.QUIET, as_json=False)
    turned = drape_case(
        "packaged:check",
        str(folder),
        overwrite=True,
        voice=Voice.QUIET,
        as_json=True,
        origin="10 mm, 5",
        direction="20 deg",
    )
    assert turned is Exit.DONE
    assert json.loads((folder / "result.json").read_text())["grid"]["solved_nodes"] == 6625
    assert [path.name for path in tmp_path.iterdir()] == ["net"]


def test_a_net_that_locks_is_written_and_not_within_tolerance(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(tmp_path / "net")
    code = drape_case("packaged:check", folder, overwrite=False, voice=Voice.PLAIN, as_json=False, shear_limit="5 deg")
    assert code is Exit.OUT_OF_TOLERANCE
    assert "note: the net locks" in capsys.readouterr().err


def test_a_net_that_ends_is_written_as_far_as_it_goes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "net"
    case = str(hemisphere(tmp_path))
    code = drape_case(case, str(folder), overwrite=False, voice=Voice.PLAIN, as_json=False, origin="70 mm, 0 mm")
    assert code is Exit.OUT_OF_TOLERANCE
    assert "note: the net ends" in capsys.readouterr().err
    content = json.loads((folder / "result.json").read_text())
    _, nodes = rows(folder / "nodes.csv")
    reached = np.isfinite(nodes[:, 4])
    assert content["drape"]["complete"] is False
    assert reached.sum() == content["drape"]["reached_nodes"] < len(nodes)
    assert (folder / "figures" / "shape.png").stat().st_size > 0


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"origin": "10 mm"}, "two lengths with a comma"),
        ({"origin": "10 mm, 3 deg"}, "two lengths with a comma"),
        ({"direction": "3 mm"}, "expected an angle"),
        ({"shear_limit": "much"}, "expected an angle"),
        ({"shear_limit": "200 deg"}, "error: --shear-limit 200 deg: must be less than 90 deg"),
        ({"shear_limit": "0 deg"}, "must be more than 0 deg.*\n  hint: left out, it is where neighbouring wires touch"),
        ({"shear_limit": "60"}, "a bare number is in rad: write '60 deg'"),
        ({"direction": "30"}, "error: --direction 30: must be at most 360 deg.*\n.*write '30 deg'"),
        (
            {"origin": "0.4 m, 0"},
            "error: --origin 0.4 m, 0: 400 mm from the axis, but the rim of the punch is at 300 mm",
        ),
    ],
)
def test_quantities_that_cannot_be_used_are_refused(tmp_path: Path, given: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        drape_case("packaged:check", str(tmp_path / "net"), overwrite=False, voice=Voice.QUIET, as_json=False, **given)
    assert not (tmp_path / "net").exists()
