"""`--json`: every command that prints numbers has it, and then prints JSON and nothing else."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_lines import written
from tiny_dish import TEXT

from punchform.cli import COMMANDS, main
from punchform.cli.parser import parser

NO_NUMBERS = {"new", "schema", "completion"}
"""Commands whose result is no table of numbers: a file, a schema (JSON already), a script."""

ELSEWHERE = {
    "compare": "test_compare.py",
    "compensate": "optimise/test_compensate_dish.py",
    "sweep": "optimise/test_sweep_command.py",
    "tolerances": "optimise/test_tolerances.py",
    "optimise": "optimise/test_optimise_command.py",
}
"""Commands that take their time, whose JSON is read in other tests."""

LINES = {
    "form": ["form", "dish.toml", "-o", "run"],
    "report": ["report", "run"],
    "export": ["export", "run", "--to", "vtp", "-o", "files"],
    "drape": ["drape", "dish.toml", "-o", "net"],
    "sensitivity": ["sensitivity", "dish.toml", "--vary", "wire.diameter"],
    "punch": ["punch", "dish.toml", "-o", "tool"],
    "element": ["element", "dish.toml"],
    "materials": ["materials", "304 annealed"],
    "check": ["check", "dish.toml"],
    "about": ["about"],
    "examples": ["examples"],
}
"""A line of each command, in an order in which each finds what it needs."""


def test_every_command_that_prints_numbers_offers_it() -> None:
    offering = {name for name, command in parser().commands.items() if "--json" in command.option_names}
    assert offering == set(COMMANDS) - NO_NUMBERS
    assert offering == set(LINES) | set(ELSEWHERE), "each of them is run"
    assert not set(LINES) & set(ELSEWHERE)
    for name, file in ELSEWHERE.items():
        tested = (Path(__file__).parents[1] / file).read_text(encoding="utf-8")
        assert f'"{name}"' in tested
        assert '"--json"' in tested


def test_what_is_printed_is_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path)
    for name, line in LINES.items():
        code = main([*line, "--json", *(["--quiet"] if name != "about" else [])])
        printed = capsys.readouterr()
        assert code in (0, 1), (name, printed.err)
        assert printed.err == "", name
        content = json.loads(printed.out)
        assert content, name


def test_what_goes_wrong_is_told_in_words_and_by_the_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = written(tmp_path, TEXT.replace('step = "10 mm"', 'step = "10 kg"'))
    for line in (["check", case], ["form", case, "-o", str(tmp_path / "run")], ["element", case]):
        assert main([*line, "--json"]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert "dish.toml:4: grid.step: expected a length" in printed.err


def test_check_tells_in_json_what_it_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = written(tmp_path)
    assert main(["check", case]) == 0
    told = capsys.readouterr()
    assert main(["check", case, "--json", "--quiet"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert f"usable; {content['crossings']} crossings, a quarter" in told.out
    assert content["quarter_solved"] is True
    assert content["yield_strength_MPa"] is None
    assert [f"note: {note}" for note in content["notes"]] == told.err.splitlines()
