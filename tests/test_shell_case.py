"""Gridshells from a case file: the numbers are those of the Python API, the files are there, faults are told."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from punchform import drape, form_shell, read_case, run
from punchform.case import COLUMNS, Case, End, WiresBlank, case_from_text, packaged_text, write_case
from punchform.cli import main
from punchform.errors import InputError
from punchform.gridshell import Gridshell, gridshell, straight_elements
from punchform.shell import prepare_shell
from punchform.store import read_run
from punchform.wire import round_section
from punchform.wires import FlatWire, lay_wires

PACKAGED = "packaged:gridshell"
OFFSET = 1000.0 / 3.0
HALF_LENGTH = (1000.0, 874.1667, 580.8333)
ENDS = ((0.0, 636.6667), (291.6667, 565.8333), (469.1667, 430.0))
"""Of the wires at 0, 1 and 2 offsets: half its length; where it ends, across and along itself [mm]."""

CROSS = """\
schema = 1

[grid]
step = "100 mm"
subdivide = 4

[grid.blank]
shape = "wires"
wires = [
    { family = 1, wire = 0, low = "-500 mm", high = "500 mm" },
    { family = 2, wire = 0, low = "-500 mm", high = "500 mm" },
]

[wire]
diameter = "5 mm"
youngs_modulus = "10 GPa"
centreline = { kind = "straight" }

[press]
ends = [
    { family = 1, wire = 0, end = "low", point = ["-450 mm", "0 mm", "0 mm"] },
    { family = 1, wire = 0, end = "high", point = ["450 mm", "0 mm", "0 mm"] },
    { family = 2, wire = 0, end = "low", point = ["0 mm", "-45 cm", "0 mm"] },
    { family = 2, wire = 0, end = "high", point = ["0 mm", "0.45 m", "0 mm"] },
]
"""
LIST = CROSS[CROSS.index("ends = [") :]
PUNCH = '[punch]\nprofile = { kind = "sphere", radius = "400 mm" }\nrim_radius = "300 mm"\n\n'
TABLE = """\
family, wire, end, x, y, z
1, 0, low, -450, 0, 0
1, 0, high, 45 cm, 0, 0
2, 0, low, 0, -450, 0
2, 0, high, 0, 450, 0
"""


def by_hand() -> Gridshell:
    """The packaged case by the Python API."""
    wires = [FlatWire(k * OFFSET, -HALF_LENGTH[abs(k)], HALF_LENGTH[abs(k)]) for k in range(-2, 3)]
    laid = lay_wires(wires, wires, subdivide=4)
    rod = round_section(20.0, youngs_modulus=100.0, poisson=0.5, shear_factor=0.9)
    ends = []
    for k in range(-2, 3):
        across, along = np.sign(k) * ENDS[abs(k)][0], ENDS[abs(k)][1]
        ends += [End(1, k, "low", (-along, across, 0.0)), End(1, k, "high", (along, across, 0.0))]
        ends += [End(2, k, "low", (across, -along, 0.0)), End(2, k, "high", (across, along, 0.0))]
    return gridshell(laid, straight_elements(laid, rod), ends)


def test_the_packaged_case_gives_the_numbers_of_the_api() -> None:
    case, other = form_shell(read_case(PACKAGED)), by_hand()
    assert case.formed.energy == pytest.approx(other.energy, rel=1e-9)
    assert case.formed.height == pytest.approx(other.height, rel=1e-9)
    np.testing.assert_allclose(case.formed.whole.positions, other.whole.positions, atol=1e-6)
    places = case.formed.whole.positions[case.formed.ends]
    np.testing.assert_allclose(places, [end.point for end in case.ends], atol=1e-12)


def test_the_folder_is_a_run_that_is_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "shell"
    assert main(["form", PACKAGED, "-o", str(folder), "--quiet"]) == 0
    assert "630.6" in capsys.readouterr().out
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "case.toml",
        "result.json",
        "nodes.csv",
        "wires.csv",
        "shape.vtp",
        "run.npz",
        "figures",
        "report.html",
    }
    figures = {path.name for path in (folder / "figures").iterdir()}
    assert figures == {
        f"{name}.{kind}" for name in ("shape", "axial_x", "axial_y", "stress") for kind in ("png", "svg")
    }
    assert read_case(folder / "case.toml") == read_case(PACKAGED)
    stored, formed = read_run(folder), by_hand()
    told = stored.result["formed"]
    assert told["energy_mJ"] == pytest.approx(formed.energy)
    assert told["height_mm"] == pytest.approx(formed.height) == pytest.approx(stored.nodes["z"].max())
    reactions = np.array([end["reaction_N"] for end in told["ends"]])
    assert len(stored.nodes) == 41
    assert reactions.shape == (20, 3)
    np.testing.assert_allclose(reactions.sum(axis=0), 0, atol=1e-6 * np.abs(reactions).max())
    page = (folder / "report.html").read_text(encoding="utf-8")
    page = re.sub(r"<(style|script)\b.*?</\1>", "", page, flags=re.DOTALL)
    assert "elastic gridshell" in page
    assert "punch" not in page.partition("<section")[2].partition('<section id="case">')[0].replace("punchform", "")
    assert main(["form", PACKAGED, "-o", str(folder), "--quiet"]) == 2
    assert main(["form", PACKAGED, "-o", str(folder), "--quiet", "--overwrite", "--json"]) == 0
    printed = capsys.readouterr().out
    assert json.loads(printed)["formed"]["outcome"] == "converged"


def test_the_ends_may_stand_in_a_table(tmp_path: Path) -> None:
    (tmp_path / "ends.csv").write_text(TABLE, encoding="utf-8")
    case = case_from_text(CROSS.replace(LIST, 'ends = "ends.csv"\n'), folder=tmp_path)
    assert case == case_from_text(CROSS)
    assert case_from_text(write_case(case)) == case
    assert TABLE.split("\n", 1)[0].split(", ") == list(COLUMNS)


def test_an_outline_makes_the_same_gridshell_as_its_wires() -> None:
    wires = "\n".join(
        f'    {{ family = {family}, wire = {wire}, low = "-100 mm", high = "100 mm" }},'
        for family in (1, 2)
        for wire in (-1, 0, 1)
    )
    single = CROSS[: CROSS.index("    {")] + wires + CROSS[CROSS.index("\n]\n\n[wire]") :]
    ends = "".join(
        f'    {{ family = 1, wire = {wire}, end = "{end}", point = [{x}, {90 * wire}, 0] }},\n'
        for wire in (-1, 0, 1)
        for end, x in (("low", -90), ("high", 90))
    )
    single = single.replace(LIST, f"ends = [\n{ends}]\n")
    blank = single[single.index("[grid.blank]") : single.index("[wire]")]
    outlined = single.replace(blank, '[grid.blank]\nshape = "rectangle"\nsize = ["200 mm", "200 mm"]\n\n')
    one, other = (form_shell(case_from_text(text)).formed for text in (single, outlined))
    assert one.energy == pytest.approx(other.energy, rel=1e-8)
    np.testing.assert_allclose(one.height, other.height, rtol=1e-8)


def test_the_frame_and_the_crossings_are_those_of_the_case() -> None:
    plain = read_case(PACKAGED)
    assert plain.press.chord
    paper = form_shell(plain.model_copy(update={"press": plain.press.model_copy(update={"frame": "O"})}))
    stiff = form_shell(plain.model_copy(update={"grid": plain.grid.model_copy(update={"crossing": "welded"})}))
    energy = form_shell(plain).formed.energy
    assert paper.formed.energy != pytest.approx(energy, rel=1e-6)
    assert stiff.formed.energy > 1.001 * energy


def test_check_counts_wires_and_ends(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", PACKAGED]) == 0
    assert "a gridshell of 10 wires, 20 ends held" in capsys.readouterr().out


def test_no_equilibrium_is_told_by_the_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "shell.toml"
    case.write_text(packaged_text("gridshell") + "\n[solver]\nmax_steps = 1\n", encoding="utf-8")
    assert main(["form", str(case), "-o", str(tmp_path / "out"), "--quiet"]) == 3
    assert "gridshell" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_what_needs_a_punch_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = read_case(PACKAGED)
    for verb in (run, drape):
        with pytest.raises(InputError, match="there is no punch"):
            verb(case)
    with pytest.raises(InputError, match="nobody says where"):
        prepare_shell(read_case("packaged:check"))
    with pytest.raises(InputError, match="section is missing"):
        Case(grid=case.grid, wire=case.wire)
    path = tmp_path / "shell.toml"
    path.write_text(CROSS, encoding="utf-8")
    assert main(["drape", str(path), "-o", str(tmp_path / "net"), "--quiet"]) == 2
    assert capsys.readouterr().err.startswith(f"error: {path}:20: press.ends: there is no punch")


TWO = '{ family = 2, wire = 0, low = "-500 mm", high = "500 mm" }'

# what is replaced, by what, the place and the beginning of the message
FAULTS: list[tuple[str, str, str]] = [
    ("family = 1, wire = 0, end", "family = 1, wire = 7, end", "21: press.ends[0]: family 1 has no wire 7"),
    ('2, wire = 0, end = "low"', '2, wire = 0, end = "high"', "24: press.ends[3]: this end is given twice"),
    (LIST, "".join(LIST.splitlines(True)[:3]) + "]\n", "20: press.ends: 2 ends do not hold a grid in space"),
    (LIST, "ends = []\n", "20: press.ends: 0 ends do not hold"),
    ("[press]", f"{PUNCH}[press]", "24: press.ends: the wire ends are to go to given points, but there is a [punch]"),
    (LIST, "", "1: punch: this section is missing"),
    (LIST, 'ends = "none.csv"', "20: press.ends: cannot read "),
    (
        LIST,
        'ends = "bad.csv"',
        "20: press.ends: bad.csv:2: the family is 1 (along x) or 2 (along y), not '3'; and 1 more",
    ),
    (LIST, 'ends = "short.csv"', "20: press.ends: short.csv: has no column end, x, y, z"),
    (LIST, "ends = 3", "20: press.ends: expected "),
    ('end = "low", point = ["-450', 'end = "first", point = ["-450', "21: press.ends[0].end: expected 'low' or 'high'"),
    ('["-450 mm", "0 mm", "0 mm"]', '["-450 mm", "0 mm"]', "21: press.ends[0].point: has too few entries"),
    ('"-45 cm"', '"-45 kg"', "23: press.ends[2].point[1]: expected a length such as '0.75 mm', not '-45 kg'"),
    ("[press]\n", '[press]\nrim = "clamp"\n', "20: press.rim: has no effect where wire ends go to given points"),
    ("[press]\n", "[release]\n[press]\n", "19: release: a gridshell stays as its wire ends hold it"),
    (TWO, TWO.replace("500", "50").replace("-", ""), "11: grid.blank.wires[1].high: from 50 mm to 50 mm a wire has no"),
    (TWO, TWO.replace("wire = 0", "wire = 1"), "9: grid.blank.wires: the wires of family 2 are numbered without a gap"),
    (TWO, TWO.replace("-500", "400"), "9: grid.blank.wires: the wire at 0 mm crosses no other"),
    ('\ncentreline = { kind = "straight" }', "", "14: wire.centreline: single wires are straight"),
    ('centreline = { kind = "straight" }', "", "14: wire.centreline: single wires are straight"),
    ("subdivide = 4", 'centre = "cell"', "5: grid.centre: wire 0 lies on the axis"),
]


@pytest.mark.parametrize(("old", "new", "message"), FAULTS, ids=[row[2] for row in FAULTS])
def test_one_fault_one_message(
    old: str, new: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad.csv").write_text("family,wire,end,x,y,z\n3,0,low,0,0,0\n1,0,low,0,0,far\n", encoding="utf-8")
    (tmp_path / "short.csv").write_text("family,wire\n", encoding="utf-8")
    path = tmp_path / "shell.toml"
    assert old in CROSS
    path.write_text(CROSS.replace(old, new, 1), encoding="utf-8")
    assert main(["check", str(path)]) == 2
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith(f"error: {path}:{message}"), told
    assert sum(line.startswith("error: ") for line in told) == 1, told


def test_single_wires_are_not_pressed_over_a_punch() -> None:
    with pytest.raises(InputError, match="single wires are for a gridshell"):
        case_from_text(CROSS.replace("[press]\n" + LIST, PUNCH))
    assert isinstance(case_from_text(CROSS).grid.blank, WiresBlank)
