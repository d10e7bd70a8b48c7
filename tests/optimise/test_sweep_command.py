"""`punchform sweep`: the folder grows, goes on, and is not mixed up with anything else."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import tiny_dish

from punchform.case.scattering import scattered
from punchform.cli import main
from punchform.errors import InputError
from punchform.optimise import sweep as sweep_module
from punchform.optimise.designs import variation
from punchform.optimise.evaluations import Evaluation, Record, Task, designed
from punchform.optimise.figures import FIGURES

CASE = tiny_dish.case()
OVER = ["--over", "wire.diameter=0.6 mm:0.8 mm:3", "--over", "grid.crossing=pinned,welded"]


def quick(task: Task) -> Evaluation:
    """An evaluation at no cost; a welded grid of the thickest wire fails."""
    design = designed(CASE, task.changes)
    if task.changes == {"wire.diameter": 0.8, "grid.crossing": "welded"}:
        return Evaluation(design.key, design.changes, failure="no equilibrium: it leaves\nus")
    return Evaluation(design.key, design.changes, {"rms": 1 / 3 + task.changes["wire.diameter"], "mass": None}, 0.25)


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Runs the sweep of the tiny dish in one loop at no cost."""
    monkeypatch.setattr(sweep_module, "work", quick)
    path = tmp_path / "dish.toml"
    path.write_text(tiny_dish.TEXT, encoding="utf-8")
    return lambda *more: main(["sweep", str(path), "-o", str(tmp_path / "out"), "--workers", "1", *more])


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "table.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_table_has_a_row_for_each_design(
    tmp_path: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(*OVER) == 0
    said = capsys.readouterr()
    assert "5 done, 1 failed" in said.out
    assert "largest rms" in said.out
    assert "1 of 6 designs failed" in said.err
    table = rows(tmp_path / "out")
    assert list(table[0])[:3] == ["wire.diameter [mm]", "grid.crossing", "rms [mm]"]
    assert [row["grid.crossing"] for row in table] == ["pinned", "welded"] * 3
    assert float(table[0]["rms [mm]"]) == 1 / 3 + 0.6
    assert table[0]["mass [kg]"] == ""
    assert [row["outcome"] for row in table] == ["done"] * 5 + ["failed"]
    assert table[5]["message"] == "no equilibrium: it leaves\nus"
    assert table[5]["rms [mm]"] == ""
    assert len(table[0]) == 2 + len(FIGURES) + 4


def test_parquet_holds_the_same_table(tmp_path: Path, command: Callable[..., int]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    assert command(*OVER, "--format", "parquet", "--quiet") == 0
    found = parquet.read_table(tmp_path / "out" / "table.parquet").to_pylist()
    for one, other in zip(found, rows(tmp_path / "out"), strict=True):
        assert list(one) == list(other)
        assert {name: "" if value is None else str(value) for name, value in one.items()} == other


def test_without_pyarrow_nothing_begins(
    tmp_path: Path, command: Callable[..., int], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("punchform.optimise.tabulating.find_spec", lambda name: None)
    assert command(*OVER, "--format", "parquet") == 2
    assert "pip install 'punchform[parquet]'" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_an_interrupted_sweep_goes_on(
    tmp_path: Path, command: Callable[..., int], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Ctrl-C after four designs leaves four rows and says how to go on; the same command computes the other two."""
    made: list[Task] = []

    def interrupted(task: Task) -> Evaluation:
        if len(made) == 4:
            raise KeyboardInterrupt
        made.append(task)
        return quick(task)

    monkeypatch.setattr(sweep_module, "work", interrupted)
    assert command(*OVER) == 130
    said = capsys.readouterr().err
    assert "note: 4 of 6 designs are done\ninterrupted; what was done is kept in " in said
    assert "hint: give the same command again to go on from there" in said
    assert len(rows(tmp_path / "out")) == 4
    made.clear()
    assert command(*OVER, "--json") == 0
    assert len(made) == 2
    assert json.loads(capsys.readouterr().out)["designs"] == 6
    assert [row["grid.crossing"] for row in rows(tmp_path / "out")] == ["pinned", "welded"] * 3
    made.clear()
    assert command(*OVER, "--overwrite") == 130
    assert len(made) == 4


def test_another_sweep_or_another_case_needs_overwrite(
    tmp_path: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(*OVER) == 0
    before = (tmp_path / "out" / "table.csv").read_bytes()
    assert command("--over", "wire.diameter=0.6") == 2
    assert "holds a sweep over other settings" in capsys.readouterr().err
    (tmp_path / "dish.toml").write_text(tiny_dish.TEXT.replace("0.3\n", "0.29\n"), encoding="utf-8")
    assert command(*OVER) == 2
    assert "holds a sweep over another case" in capsys.readouterr().err
    (tmp_path / "out" / "sweep.json").write_text("{}", encoding="utf-8")
    assert command(*OVER) == 2
    assert "is damaged" in capsys.readouterr().err
    assert (tmp_path / "out" / "table.csv").read_bytes() == before


def test_a_folder_of_something_else_is_left_alone(
    tmp_path: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "letter.txt").write_text("dear", encoding="utf-8")
    for more in ([], ["--overwrite"]):
        assert command(*OVER, *more) == 2
        assert "not a punchform run" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["letter.txt"]
    (tmp_path / "out" / "result.json").write_text('{"schema": 1, "version": "0"}', encoding="utf-8")
    for more in ([], ["--overwrite"]):
        assert command(*OVER, *more) == 2
        assert "the folder holds a single run" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--over", "wire.diameter=1 kg"], "error: wire.diameter: expected a length"),
        (["--over", "wire.diameter=-1 mm,-2 mm"], "dish.toml:7: wire.diameter: must be more than 0"),
        (["--over", "wire.diameter=1:2", "--samples", "0"], "0 samples are asked for"),
        (["--over", "wire.diameter=1:2", "--samples", "2", "--seed", "-1"], "the seed is -1"),
        ([], "the following arguments are required: --over"),
    ],
)
def test_bad_input_leaves_nothing(
    more: list[str], words: str, tmp_path: Path, command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(*more) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert said.out == ""
    assert not (tmp_path / "out").exists()


def test_a_sweep_of_failures_alone_ends_with_no_equilibrium(command: Callable[..., int]) -> None:
    assert command("--over", "wire.diameter=0.8", "--over", "grid.crossing=welded") == 3


def test_a_gridshell_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "out")
    assert main(["sweep", "packaged:gridshell", "--over", "wire.diameter=1 mm,2 mm", "-o", out]) == 2
    assert "there is no punch" in capsys.readouterr().err


def test_two_programs_do_not_write_one_record(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    path = tmp_path / "record.jsonl"
    with Record(path), pytest.raises(InputError, match="another punchform is writing here"):
        Record(path)
    Record(path).close()


def test_the_page_of_sweeps_says_what_can_be_asked() -> None:
    """Every --over of the page is understood, and its [scatter] belongs to the dish of these tests."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "sweeps.md").read_text(encoding="utf-8")
    texts = re.findall(r'"([a-z_.]+=[^"]+)"', page)
    assert len(texts) >= 7
    for text in texts:
        assert variation(CASE, text).place == text.partition("=")[0]
    _, scatter = re.findall(r"^```toml\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    assert len(scattered(tiny_dish.case(scatter))) == scatter.count("=") - 1


def test_samples_fill_the_ranges(tmp_path: Path, command: Callable[..., int]) -> None:
    assert command("--over", "wire.diameter=0.6 mm:0.7 mm", "--samples", "10", "--seed", "3", "--quiet") == 0
    values = sorted(float(row["wire.diameter [mm]"]) for row in rows(tmp_path / "out"))
    assert [int((value - 0.6) / 0.01) for value in values] == list(range(10))
