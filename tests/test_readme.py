"""The README is executed: its commands and Python blocks run in order in one empty folder."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from page_blocks import ROOT, Block, Folder, blocks

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    return Folder(tmp_path_factory.mktemp("readme"))


@pytest.mark.parametrize("block", blocks(TEXT), ids=lambda block: f"line {block.line} {block.language}")
def test_the_block_runs(block: Block, folder: Folder) -> None:
    folder.run(block, "README.md")


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
    assert {"python", "console"} <= {block.language for block in blocks(TEXT)}
    assert "make demo" in TEXT
    assert "make test" in TEXT
