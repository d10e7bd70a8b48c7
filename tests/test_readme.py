"""The README is executed: its commands and Python blocks run in order in one empty folder."""

from __future__ import annotations

import json
import os
import re
import runpy
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
COMMAND = Path(sys.executable).with_name("punchform")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A fenced block of the README: its language, its text and the line it starts on."""

    language: str
    text: str
    line: int


def blocks() -> list[Block]:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return [Block(found[1], found[2], text[: found.start()].count("\n") + 1) for found in BLOCK.finditer(text)]


def commands(block: Block) -> list[tuple[str, list[str]]]:
    """The lines after "$ ", each with the output that the README shows under it; "..." leaves lines out."""
    found: list[tuple[str, list[str]]] = []
    for line in block.text.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif line.strip() not in ("", "..."):
            found[-1][1].append(line)
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("readme")


@pytest.mark.parametrize("block", blocks(), ids=lambda block: f"line {block.line} {block.language}")
def test_the_block_runs(block: Block, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    if block.language == "python":
        script = folder / f"line_{block.line}.py"
        script.write_text(block.text, encoding="utf-8")
        runpy.run_path(str(script))
    elif block.language == "console":
        for command, output in commands(block):
            run_command(command, output)
    elif block.language == "toml":
        case = f"line_{block.line}.toml"
        Path(case).write_text(block.text, encoding="utf-8")
        run_command(f"punchform check {case}", [])
    else:
        pytest.fail(f"README.md:{block.line}: nothing executes a `{block.language}` block")


def run_command(command: str, output: list[str]) -> None:
    """Run one line of a console block; the output that the README shows must be in what is printed."""
    words = shlex.split(command, comments=True)
    if words[0] == "make":
        targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
        assert words[1] in targets
        assert not output, "make is not run here, so its output would be prose"
        return
    assert words[0].endswith("punchform"), f"nothing executes `{command}`"
    environment = {**os.environ, "NO_COLOR": "1", "COLUMNS": "200"}
    done = subprocess.run([str(COMMAND), *words[1:]], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, f"{command}\n{done.stderr}"
    for line in output:
        assert line.strip() in done.stdout + done.stderr


def rows_of_holds() -> dict[str, list[str]]:
    """The rows of the table of holds by their first cell."""
    page = (ROOT / "docs" / "release_and_accuracy.md").read_text(encoding="utf-8")
    table = page.partition("| `[release]` |")[2].partition("\n\n")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    return {row[0]: row[1:] for row in rows}


@pytest.mark.parametrize("row", [0, 2, 4])
def test_the_table_of_holds_is_what_the_check_case_gives(row: int, tmp_path: Path) -> None:
    from punchform.cli import main

    told, cells = list(rows_of_holds().items())[row]
    packaged = (ROOT / "src" / "punchform" / "cases" / "check.toml").read_text(encoding="utf-8")
    lines = "\n".join(re.findall("`([^`]+)`", told))
    case = tmp_path / "case.toml"
    case.write_text(packaged.replace('hold = { from_radius = "300 mm" }', lines, 1), encoding="utf-8")
    main(["form", str(case), "-o", str(tmp_path / "out"), "--quiet"])
    result = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    released, alignments = result["released"], result["accuracy"]["alignments"]
    figures = [
        released["energy_mJ"],
        released["apex_mm"],
        released["max_sag_mm"],
        *(alignments[name]["deviations"]["normal"]["rms_mm"] for name in ("as held", "4-parameter")),
        released["negative_eigenvalues_of_whole"],
    ]
    for figure, cell in zip(figures, cells, strict=True):
        text = cell.split()[0].replace("−", "-")
        last = 10.0 ** -len(text.partition(".")[2])
        assert figure == pytest.approx(float(text), abs=0.51 * last), cell


def test_the_readme_shows_both_ways_in() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert {"python", "console"} <= {block.language for block in blocks()}
    assert "make demo" in text
    assert "make test" in text
