"""Links that leave the folder of pages: a repository viewer follows them, the site must not lose them.

`../CHANGELOG.md` and its neighbours at the top of the repository are pages of the site too (docs/about/); other files
are named without a link.
"""

from __future__ import annotations

import os
import re
from pathlib import PurePosixPath
from typing import Any

from sphinx.application import Sphinx

LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
PAGES = {"README.md": "index.md", "CHANGELOG.md": "about/changelog.md", "CONTRIBUTING.md": "about/contributing.md"}


def rewritten(text: str, place: str) -> str:
    """The text of a page with such links mended.

    Parameters: the Markdown text; the page's place in the repository, such as "docs/how_to/wire.md".
    """
    folder = PurePosixPath(place).parent

    def mended(found: re.Match[str]) -> str:
        label, target, anchor = found[1], found[2], found[3] or ""
        if re.match(r"[a-z]+:", target):
            return found[0]
        path = os.path.normpath(folder / target)
        if path.startswith("docs" + os.sep) and str(folder).split("/")[0] == "docs":
            return found[0]
        if path in PAGES:
            path = "docs/" + PAGES[path]
        elif not path.startswith("docs" + os.sep):
            return label
        return f"[{label}](/{PurePosixPath(path).relative_to('docs')}{anchor})"

    fences = re.split(r"(^```.*?^```$)", text, flags=re.DOTALL | re.MULTILINE)
    return "".join(part if part.startswith("```") else LINK.sub(mended, part) for part in fences)


def _mend(app: Sphinx, docname: str, source: list[str]) -> None:
    source[0] = rewritten(source[0], f"docs/{docname}.md")


def _mend_included(app: Sphinx, path: Any, docname: str, source: list[str]) -> None:
    source[0] = rewritten(source[0], os.path.relpath(app.srcdir / path, app.srcdir.parent))


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.connect("source-read", _mend)
    app.connect("include-read", _mend_included)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
