"""docs/reference/files.md names every column and every key that a run writes."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from page_blocks import ROOT, blocks

from punchform.cli import main
from punchform.export.tables import NODE_COLUMNS, PLASTIC_COLUMNS, WIRE_COLUMNS

PAGE = (ROOT / "docs" / "reference" / "files.md").read_text(encoding="utf-8")
NAMES = {part for name in re.findall(r"`([^`]+)`", PAGE) for part in (name, *name.split("."))}


def keys(result: Mapping[str, Any]) -> Iterator[str]:
    """All keys of nested tables; the names of alignments are no keys."""
    for key, value in result.items():
        if not key.endswith("-parameter"):
            yield key
        if isinstance(value, dict):
            yield from keys(value)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run of a dish that yields, is released, loaded and judged."""
    path = tmp_path_factory.mktemp("files")
    (dish,) = (block.text for block in blocks((ROOT / "docs/how_to/index.md").read_text("utf-8")) if block.remarks)
    (path / "dish.toml").write_text(dish + "\n[load]\ngravity = [0, 0, -1]\n", encoding="utf-8")
    main(["form", str(path / "dish.toml"), "-o", str(path / "run"), "--quiet"])
    return path / "run"


def test_every_key_of_a_result_is_told(folder: Path) -> None:
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    assert not set(keys(result)) - NAMES


def test_every_key_of_a_gridshell_is_told(tmp_path: Path) -> None:
    assert main(["form", "packaged:gridshell", "-o", str(tmp_path / "run"), "--quiet"]) == 0
    result = json.loads((tmp_path / "run" / "result.json").read_text(encoding="utf-8"))
    assert not set(keys(result)) - NAMES


def test_every_column_and_every_file_is_told(folder: Path) -> None:
    assert set(NODE_COLUMNS) | set(WIRE_COLUMNS) | set(PLASTIC_COLUMNS) <= NAMES
    assert {path.name + ("/" if path.is_dir() else "") for path in folder.iterdir()} <= NAMES
