"""Every page of docs/ is executed, block by block: `make docs` runs these beside building the site."""

from __future__ import annotations

from pathlib import Path

import pytest
from page_blocks import ROOT, Folder, blocks, pages

PAGES = [page for page in pages() if page.is_relative_to(ROOT / "docs")]


def executed(page: Path) -> bool:
    """Whether a page has a block that is run."""
    return any(block.language in ("console", "python", "toml") for block in blocks(page.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.xdist_group(page.stem)) for page in PAGES if executed(page)],
    ids=lambda page: str(page.relative_to(ROOT / "docs")),
)
def test_the_page_says_what_the_program_does(page: Path, tmp_path: Path) -> None:
    folder, place = Folder(tmp_path), str(page.relative_to(ROOT))
    for block in blocks(page.read_text(encoding="utf-8")):
        try:
            folder.run(block, place)
        except AssertionError as error:
            pytest.fail(f"{place}:{block.line}: {error}", pytrace=False)
