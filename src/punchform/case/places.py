"""On which line of a case file each key stands.

The scanner reads text that a TOML parser has accepted already, so it only has to find the ends of things.
"""

from __future__ import annotations

import json
import re
import tomllib
from bisect import bisect_right

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'',
    re.DOTALL,
)
_BARE_VALUE = re.compile(r"[^,\]}#\r\n]+")


def key_lines(text: str) -> dict[Path, int]:
    """The line, from 1, of every table, key and list entry of a valid TOML text.

    >>> key_lines('[grid]\\nstep = 1\\nblank = { radius = 2 }')[("grid", "blank", "radius")]
    3
    """
    scanner = _Scanner(text)
    scanner.document()
    return scanner.lines


def dotted(path: Path) -> str:
    """The path as a person writes it, list entries counted from 0 as in Python.

    >>> dotted(("grid", "step", 1))
    'grid.step[1]'
    >>> dotted(("optimise", "variables", "wire.diameter"))
    'optimise.variables."wire.diameter"'
    """
    return "".join(f"[{part}]" if isinstance(part, int) else f".{quoted(part)}" for part in path).lstrip(".")


def undotted(text: str) -> Path:
    """The path that `dotted` would write so.

    >>> undotted("grid.step[1]")
    ('grid', 'step', 1)
    """
    keys = re.findall(r"""("[^"]*")|([^.\[\]"]+)""", text)
    return tuple(inside[1:-1] if inside else int(key) if key.isdecimal() else key for inside, key in keys)


def quoted(key: str) -> str:
    """A key as TOML writes it: in quotes where it is more than letters, digits, - and _."""
    # JSON escapes all that TOML wants escaped, but for one control character.
    return key if _BARE_KEY.fullmatch(key) else json.dumps(key, ensure_ascii=False).replace("\x7f", "\\u007F")


def line_of(lines: dict[Path, int], path: Path) -> int:
    """The line of a path, or of the nearest table around it; 1 when there is none."""
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return 1


def repeated(text: str) -> tuple[Path, int, int] | None:
    """The last key or table that stands twice in a TOML text, with both its lines; None when there is none.

    The text is valid but for that, and may end right behind the second one, even inside a table or a list.

    >>> repeated('[grid]\\nstep = 1\\nstep = 2')
    (('grid', 'step'), 2, 3)
    """
    scanner = _Scanner(text)
    scanner.document()
    return scanner.repeats[-1] if scanner.repeats else None


class _Scanner:
    """Walks through the text once and notes where each path begins."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.lines: dict[Path, int] = {}
        self.repeats: list[tuple[Path, int, int]] = []
        self._opened: dict[Path, int] = {}
        self._breaks = [found.start() for found in re.finditer("\n", text)]
        self._counts: dict[Path, int] = {}

    def document(self) -> None:
        """Headers and assignments to the end of the text."""
        table: Path = ()
        self._skip(_BLANK)
        while self.at < len(self.text):
            if self.text[self.at] == "[":
                table = self._header()
            else:
                self._assignment(table)
            self._skip(_BLANK)

    def _header(self) -> Path:
        many = self.text.startswith("[[", self.at)
        start = self.at
        self.at += 2 if many else 1
        table = self._resolved(self._key())
        self.at += 2 if many else 1
        if many:
            self._counts[table] = self._counts.get(table, -1) + 1
            table = (*table, self._counts[table])
        self._note(table, start)
        self._open(table, start)
        return table

    def _resolved(self, key: Path) -> Path:
        """The path of a header; below a list of tables it means the last of them."""
        path: Path = ()
        for part in key[:-1]:
            path = (*path, part)
            if path in self._counts:
                path = (*path, self._counts[path])
        return (*path, key[-1])

    def _assignment(self, table: Path) -> None:
        start = self.at
        path = (*table, *self._key())
        for length in range(len(table) + 1, len(path) + 1):
            self._note(path[:length], start)
        self._open(path, start)
        self.at += 1  # the equals sign
        self._skip(_SPACE)
        self._value(path)

    def _key(self) -> Path:
        parts: list[str | int] = []
        while True:
            self._skip(_SPACE)
            quoted = self.text[self.at] in "\"'"
            found = (_STRING if quoted else _BARE_KEY).match(self.text, self.at)
            assert found is not None, "only valid TOML is scanned"
            parts.append(_unquoted(found.group()) if quoted else found.group())
            self.at = found.end()
            self._skip(_SPACE)
            if not self.text.startswith(".", self.at):
                return tuple(parts)
            self.at += 1

    def _value(self, path: Path) -> None:
        first = self.text[self.at]
        if first == "[":
            self._list(path)
        elif first == "{":
            self._inline_table(path)
        else:
            self._skip(_STRING if first in "\"'" else _BARE_VALUE)

    def _list(self, path: Path) -> None:
        self.at += 1
        self._skip(_BLANK)
        count = 0
        while self._before("]"):
            self._note((*path, count), self.at)
            self._value((*path, count))
            count += 1
            self._skip_comma()
        self.at += 1

    def _inline_table(self, path: Path) -> None:
        self.at += 1
        self._skip(_BLANK)
        while self._before("}"):
            self._assignment(path)
            self._skip_comma()
        self.at += 1

    def _before(self, end: str) -> bool:
        """Whether a list or an inline table goes on here; it also ends with the text."""
        return self.at < len(self.text) and self.text[self.at] != end

    def _skip_comma(self) -> None:
        self._skip(_BLANK)
        if self.text.startswith(",", self.at):
            self.at += 1
            self._skip(_BLANK)

    def _skip(self, pattern: re.Pattern[str]) -> None:
        found = pattern.match(self.text, self.at)
        assert found is not None, "only valid TOML is scanned"
        self.at = found.end()

    def _note(self, path: Path, position: int) -> None:
        self.lines.setdefault(path, self._line(position))

    def _open(self, path: Path, position: int) -> None:
        """Note a key or a table that is given a value here: it may only be given one."""
        first = self._opened.setdefault(path, position)
        if first != position:
            self.repeats.append((path, self._line(first), self._line(position)))

    def _line(self, position: int) -> int:
        return bisect_right(self._breaks, position - 1) + 1


def _unquoted(key: str) -> str:
    return str(tomllib.loads(f"key = {key}")["key"])
