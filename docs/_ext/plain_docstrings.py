"""Docstrings as they are written: prose with `names`, indented formulas and examples, read as plain text.

autodoc takes docstrings for reStructuredText, in which |k|, a* and _ mean something. Here they mean themselves.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sphinx.application import Sphinx

CODE = re.compile(r"`+([^`]+)`+")
SIGNS = re.compile(r"([\\*|_])")
BULLET = re.compile(r"^(\s*)[-*] ")


def plain(lines: list[str]) -> list[str]:
    """The lines of a docstring as reStructuredText that shows them as they are."""
    return list(_translated(lines))


def _translated(lines: list[str]) -> Iterator[str]:
    block, example, bullet = False, False, False
    for number, line in enumerate(lines):
        blank, indented = not line.strip(), line.startswith((" ", "\t"))
        before_blank = number == 0 or not lines[number - 1].strip()
        if blank:
            example = False
            yield ""
            continue
        if line.lstrip().startswith(">>>") and before_blank:
            example, block = True, False
        if BULLET.match(line):
            bullet, block = True, False
        elif not indented:
            block, bullet = False, False
        elif not block and not bullet and not example:
            if not before_blank:
                yield ""
            yield from ("::", "")
            block = True
        yield line if block or example else _prose(line)


def _prose(line: str) -> str:
    """A line with its names in code and all other signs as themselves."""
    parts = CODE.split(line)
    mark = BULLET.match(line)
    told = "".join(f"``{part}``" if odd % 2 else SIGNS.sub(r"\\\1", part) for odd, part in enumerate(parts))
    return re.sub(r"^(\s*)\\?[-*] ", r"\1- ", told) if mark else told


def _process(_app: Sphinx, _what: str, _name: str, _obj: object, _options: object, lines: list[str]) -> None:
    lines[:] = plain(lines)


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.connect("autodoc-process-docstring", _process)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
