"""Parts of pages that are made from the program, or from the folder, when the site is built.

A comment `<!-- generated: case_keys -->` in a page is replaced by the Markdown of the writer of that name.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import case_keys
import commands
from sphinx.application import Sphinx

MARK = re.compile(r"^<!-- generated: (\w+) -->$", re.MULTILINE)
DOCS = Path(__file__).resolve().parents[1]


def pages_here(docname: str) -> str:
    """The other pages of a page's folder as a table of contents in the side bar."""
    folder = (DOCS / docname).parent
    return _contents(sorted(page.stem for page in folder.glob("*.md") if page != DOCS / f"{docname}.md"))


def other_pages(docname: str) -> str:
    """The pages of the top folder that no other part of the start page lists."""
    listed = set(re.findall(r"^([\w/]+)$", (DOCS / f"{docname}.md").read_text(encoding="utf-8"), re.MULTILINE))
    pages = sorted(page.stem for page in DOCS.glob("*.md") if page.stem not in listed | {docname})
    return _contents([*(("examples/index",) if (DOCS / "examples" / "index.md").is_file() else ()), *pages])


def _contents(pages: list[str], caption: str = "") -> str:
    return "\n".join(["```{toctree}", ":hidden:", "", *pages, "```"])


WRITERS: dict[str, Callable[[str], str]] = {
    "case_keys": lambda _: case_keys.markdown(),
    "commands": lambda _: commands.markdown(),
    "pages_here": pages_here,
    "other_pages": other_pages,
}


def fill(_app: Sphinx, docname: str, source: list[str]) -> None:
    """Put the generated parts into a page."""
    source[0] = MARK.sub(lambda found: WRITERS[found[1]](docname), source[0])


def changed(app: Sphinx, _env: object, _added: set[str], _changed: set[str], _removed: set[str]) -> list[str]:
    """The pages with generated parts are read again in every build: what they are made from is not a page."""
    return [name for name in app.env.found_docs if MARK.search((DOCS / f"{name}.md").read_text(encoding="utf-8"))]


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.connect("source-read", fill)
    app.connect("env-get-outdated", changed)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
