"""`punchform optimise`: its folder, its words, and that it goes on."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from tiny_dish import TEXT

from punchform.case import read_case
from punchform.cli import main
from punchform.optimise.evaluations import Record

FOCAL = '"punch.profile.focal_length" = { from = "50 mm", to = "75 mm" }'
SMOOTH = f"[optimise]\nvariables = {{ {FOCAL} }}\n"
SEVERAL = (
    f'[optimise]\nvariables = {{ {FOCAL}, "grid.crossing" = {{ among = ["pinned", "welded"] }} }}\n'
    'objectives = ["rms", "push"]\nevaluations = 12\n'
)


def file_of(tmp_path: Path, more: str, name: str = "dish.toml") -> str:
    """The tiny dish with further lines, as a file."""
    path = tmp_path / name
    path.write_text(TEXT + more, encoding="utf-8")
    return str(path)


def test_one_objective_gives_one_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "found"
    assert main(["optimise", file_of(tmp_path, SMOOTH), "-o", str(folder), "--quiet"]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "Best of" in told.out
    content = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    assert content["search"]["way"] == "gradient"
    assert content["best"]["allowed"] is True
    assert content["front"] == []
    best = read_case(folder / "best.toml")
    assert best.optimise is None
    assert main(["form", str(folder / "best.toml"), "-o", str(tmp_path / "run"), "--quiet"]) in (0, 1)
    formed = json.loads((tmp_path / "run" / "result.json").read_text(encoding="utf-8"))
    assert formed["accuracy"]["judged_on"]["rms_mm"] == pytest.approx(content["best"]["figures"]["rms"])
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "The best design" in page
    assert (folder / "figures" / "search.png").is_file()
    assert not (folder / "front").exists()


def test_several_objectives_give_a_front_and_the_folder_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "found"
    command = ["-o", str(folder), "--workers", "1", "--json", "--quiet"]
    assert main(["optimise", file_of(tmp_path, SEVERAL), *command]) == 0
    content = json.loads(capsys.readouterr().out)
    with (folder / "table.csv").open(encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert len(rows) == 12
    assert sum(int(row["front"]) for row in rows) == len(content["front"]) >= 2
    cases = sorted((folder / "front").iterdir())
    assert [path.name for path in cases] == [f"front_{k:03d}.toml" for k in range(1, len(content["front"]) + 1)]
    for path, one in zip(cases, content["front"], strict=True):
        assert read_case(path).grid.crossing == one["changes"]["grid.crossing"]
    record = (folder / "record.jsonl").read_bytes()

    assert main(["optimise", file_of(tmp_path, SEVERAL), *command]) == 0
    assert json.loads(capsys.readouterr().out) == content
    assert (folder / "record.jsonl").read_bytes() == record

    assert main(["optimise", file_of(tmp_path, SEVERAL + "seed = 2\n"), *command]) == 0
    assert (folder / "record.jsonl").read_bytes().startswith(record)
    with Record(folder / "record.jsonl") as both:
        assert len(both) > 12

    other = file_of(tmp_path, SEVERAL.replace("[optimise]", "[press]\nrim = 'clamp'\n[optimise]"), "other.toml")
    assert main(["optimise", other, *command]) == 2
    assert "a search in another case" in capsys.readouterr().err
    assert (folder / "record.jsonl").read_bytes().startswith(record)


def test_a_constraint_that_nothing_keeps_ends_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    more = SMOOTH + "constraints = { rms = { most = 0.0001 } }\nevaluations = 6\n"
    assert main(["optimise", file_of(tmp_path, more), "-o", str(tmp_path / "found"), "--workers", "2"]) == 1
    told = capsys.readouterr()
    assert "note: downhill goes one design after the other" in told.err
    assert "keeps all constraints" in told.out
    assert "It misses rms at most 0.0001 mm by" in told.out
    assert "note: method gradient: all variables are continuous" in told.err


def test_what_cannot_be_searched_leaves_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "found"
    assert main(["optimise", file_of(tmp_path, ""), "-o", str(folder)]) == 2
    assert "optimise: this section is missing" in capsys.readouterr().err
    bad = file_of(tmp_path, SMOOTH + 'cost = "rho"\n')
    assert main(["optimise", bad, "-o", str(folder)]) == 2
    assert "dish.toml:" in capsys.readouterr().err
    assert not folder.exists()
    folder.mkdir()
    (folder / "letter.txt").write_text("mine", encoding="utf-8")
    assert main(["optimise", file_of(tmp_path, SMOOTH), "-o", str(folder)]) == 2
    assert "left as it is" in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == ["letter.txt"]


def test_where_no_design_has_figures_it_ends_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    more = '[optimise]\nvariables = { "solver.max_steps" = { from = 1, to = 2 } }\n'
    assert main(["optimise", file_of(tmp_path, more), "-o", str(tmp_path / "found"), "--workers", "1"]) == 3
    assert "not one of 2 designs has figures" in capsys.readouterr().err
