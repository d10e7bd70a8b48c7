"""`punchform punch`: the folder it writes, what it prints, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from punchform.cli import main
from punchform.export.punch_files import CORRECTION, DRAWING, FIELD, PROFILE, SOLID

CASE = """
schema = 1
title = "Corrected"
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "70 mm" }
[wire]
diameter = "0.5 mm"
material = "304 spring"
[punch]
profile = { kind = "paraboloid", focal_length = "60 mm" }
rim_radius = "60 mm"
fillet = "20 mm"
correction = { kind = "radial", points = [[0, 1.5], [15, 1.2], [30, 0.5], [45, 0]] }
"""


@pytest.fixture
def case(tmp_path: Path) -> str:
    (tmp_path / "dish.toml").write_text(CASE, encoding="utf-8")
    return str(tmp_path / "dish.toml")


def test_it_writes_the_files_of_the_punch(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "punch"
    assert main(["punch", case, "-o", str(folder)]) == 0
    printed = capsys.readouterr()
    assert "at most 1.5 mm" in printed.out
    assert "note: punch.fillet" in printed.err
    names = {PROFILE, FIELD, CORRECTION, DRAWING, SOLID, "case.toml", "result.json"}
    assert {path.name for path in folder.iterdir()} == names
    assert main(["punch", case, "-o", str(folder)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert main(["punch", case, "-o", str(folder), "--overwrite", "--quiet", "--json", "--radius", "9 cm"]) == 0
    printed = capsys.readouterr()
    told = json.loads(printed.out)
    assert printed.err == ""
    assert told["punch"]["radius_of_files_mm"] == 90.0
    assert told["punch"]["height_on_axis_mm"] == pytest.approx(told["punch"]["height_of_profile_mm"] + 1.5)
    assert set(told["files"]) == names - {"case.toml", "result.json"}
    assert main(["check", str(folder / "case.toml")]) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--radius", "9 kg"], "error: --radius 9 kg: expected a length"),
        (["--step", "0 mm"], "error: --step 0 mm: must be more than 0"),
        (["--tolerance=-1 mm"], "error: --tolerance -1 mm: must be more than 0"),
    ],
)
def test_lengths_that_cannot_be(
    arguments: list[str], words: str, case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["punch", case, "-o", str(tmp_path / "punch"), *arguments]) == 2
    assert capsys.readouterr().err.startswith(words)
    assert not (tmp_path / "punch").exists()


def test_a_gridshell_has_no_punch(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["punch", "packaged:gridshell", "-o", str(tmp_path / "punch")]) == 2
    assert "there is no punch" in capsys.readouterr().err
