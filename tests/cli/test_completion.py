"""Completion, asked of real shells: what they offer is what the parser takes."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from punchform.case import packaged_cases
from punchform.cli import COMMANDS, main
from punchform.cli.parser import parser

SHELLS = ("bash", "zsh", "fish")
PACKAGED = {f"packaged:{name}" for name in packaged_cases()}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder to complete in: two case files, one with a blank in its name, and a run."""
    for name in ("tiny.toml", "my dish.toml", "points.csv"):
        (tmp_path / name).write_text("", encoding="utf-8")
    (tmp_path / "runs").mkdir()
    return tmp_path


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["completion", shell]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out


def ran(shell: str, text: str, folder: Path) -> str:
    options = {"bash": ["--norc", "--noprofile"], "zsh": ["-f"], "fish": ["--no-config"]}[shell]
    command = shutil.which(shell)
    if command is None:
        pytest.skip(f"{shell} is not installed")
    done = subprocess.run(
        [command, *options, "-c", text], cwd=folder, capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stderr == ""
    return done.stdout


def offered_by_bash(line: str, folder: Path, text: str) -> list[str]:
    """What bash offers for a line: the function of the script is called as readline calls it."""
    (folder / ".script").write_text(text, encoding="utf-8")
    ask = f"""
source ./.script
[[ $(complete -p punchform) == "complete -F _punchform punchform" ]] || exit 1
compopt() {{ :; }}
COMP_LINE='{line}'; COMP_POINT=${{#COMP_LINE}}
_punchform
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
    return [one for one in ran("bash", ask, folder).split("\n") if one]


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("punchform ", {*COMMANDS, "--help", "--version"}),
        ("punchform co", {"compare", "compensate", "completion"}),
        ("punchform form pack", PACKAGED),
        ("punchform form packaged:ch", {"check"}),
        ("punchform form ti", {"tiny.toml"}),
        ("punchform form my", {"my dish.toml"}),
        ("punchform form tiny.toml -o ", {"runs"}),
        ("punchform form tiny.toml -o r", {"runs"}),
        ("punchform form tiny.toml --q", {"--quiet"}),
        ("punchform form --quiet -o runs packaged:gri", {"gridshell"}),
        ("punchform sweep tiny.toml --format ", {"csv", "parquet"}),
        ("punchform compare r", {"runs"}),
        ("punchform compare runs po", {"points.csv"}),
        ("punchform report runs r", {"runs"}),
        ("punchform export runs --to vt", {"vtp", "vtu"}),
        ("punchform completion ", set(SHELLS)),
        ("punchform about x", set()),
        ("punchform nonsense ", set()),
    ],
)
def test_bash_completes(line: str, offered: set[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert set(offered_by_bash(line, folder, script("bash", capsys))) - {".script"} == offered


@pytest.mark.parametrize("command", COMMANDS)
def test_bash_offers_all_options(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    offered = offered_by_bash(f"punchform {command} -", tmp_path, script("bash", capsys))
    assert offered == parser().commands[command].option_names


def test_bash_leaves_colons_that_are_no_word_breaks(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = script("bash", capsys) + "\nCOMP_WORDBREAKS=${COMP_WORDBREAKS//:}"
    assert offered_by_bash("punchform form packaged:ch", folder, text) == ["packaged:check"]


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("punchform co", {"compare", "compensate", "completion"}),
        ("punchform form pack", PACKAGED),
        ("punchform form ti", {"tiny.toml"}),
        ("punchform form tiny.toml -o r", {"runs/"}),
        ("punchform form tiny.toml --q", {"--quiet"}),
        ("punchform sweep tiny.toml --format ", {"csv", "parquet"}),
        ("punchform completion ", set(SHELLS)),
    ],
)
def test_fish_completes(line: str, offered: set[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / ".script").write_text(script("fish", capsys), encoding="utf-8")
    told = ran("fish", f"source ./.script; complete -C '{line}'", folder)
    assert {one.partition("\t")[0] for one in told.splitlines()} == offered


def test_zsh_takes_the_script(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = script("zsh", capsys)
    (folder / ".script").write_text(text, encoding="utf-8")
    ran("zsh", "zsh -n ./.script", folder)
    ask = "autoload -U compinit; compinit -u -D; source ./.script; print $_comps[punchform]"
    assert ran("zsh", ask, folder) == "_punchform\n"
    assert all(f"\n        {name})\n" in text for name in COMMANDS)
    assert text.startswith("#compdef punchform\n"), "zsh finds it in its folder of functions by this line"
