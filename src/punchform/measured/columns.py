"""Which column of a text file is what: by its header, or by how many there are and what they look like."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from punchform.errors import InputError
from punchform.measured.rows import Row, Rows

_NAMES = {
    "name": ("id", "name", "point", "label", "no", "nr", "number", "target"),
    "sigma": ("sigma", "s", "std", "stdev", "unc", "uncertainty"),
    "x": ("x",),
    "y": ("y",),
    "z": ("z",),
    "i": ("i",),
    "j": ("j",),
}
_HEADING = re.compile(r"\s*([A-Za-z]+)\.?\s*(?:[\[(]\s*([A-Za-z]+)\s*[\])]|_([A-Za-z]+))?\s*")
_WHOLE = re.compile(r"[+-]?\d+")
HEADER_HINT = "begin the file with a header line that names the columns, such as: id,x,y,z,sigma"


@dataclass(frozen=True)
class Columns:
    """Column numbers of x, y, z, of the name, of the node's (i, j) and of sigma; None for what is not there.

    unit: what the header writes behind x, such as mm in "x [mm]". note: what was taken for granted.
    """

    xyz: tuple[int, int, int]
    name: int | None = None
    node: tuple[int, int] | None = None
    sigma: int | None = None
    unit: str | None = None
    note: str = ""

    @property
    def last(self) -> int:
        """The highest column that every row must have."""
        return max(*self.xyz, self.name or 0, *(self.node or ()))


def find_columns(rows: Rows, *, where: str) -> tuple[Columns, tuple[Row, ...]]:
    """The columns and the rows below the header. Raises InputError when the columns cannot be told apart."""
    if not rows.rows:
        raise InputError.of("the file holds no points", where=where)
    first, *rest = rows.rows
    headed = _headed(first)
    if headed is not None:
        return headed, tuple(rest)
    if not any(map(rows.is_number, first.cells)) and rest:
        return _by_place(rows, rest, where), tuple(rest)
    return _by_place(rows, rows.rows, where), rows.rows


def _headed(row: Row) -> Columns | None:
    """The columns that a header names, None when it does not name x, y and z."""
    found: dict[str, int] = {}
    units: dict[str, str] = {}
    for place, cell in enumerate(row.cells):
        match = _HEADING.fullmatch(cell)
        kind = _kind(match[1]) if match else None
        if match and kind and kind not in found:
            found[kind] = place
            units[kind] = (match[2] or match[3] or "").lower()
    if not {"x", "y", "z"} <= found.keys():
        return None
    node = (found["i"], found["j"]) if {"i", "j"} <= found.keys() else None
    xyz = (found["x"], found["y"], found["z"])
    return Columns(xyz, found.get("name"), node, found.get("sigma"), units["x"] or None)


def _kind(word: str) -> str | None:
    return next((kind for kind, words in _NAMES.items() if word.lower() in words), None)


def _by_place(rows: Rows, data: Sequence[Row], where: str) -> Columns:
    count = Counter(len(row.cells) for row in data).most_common(1)[0][0]
    usual = [row.cells for row in data if len(row.cells) == count]
    whole = [all(_WHOLE.fullmatch(cells[k]) for cells in usual) for k in range(count)]
    if count == 3:
        return Columns((0, 1, 2))
    if count == 4:
        return _four(rows, usual, whole[0])
    if count in (5, 6) and whole[0] and whole[1] and _are_nodes(usual):
        note = "without a header the first two columns, whole numbers, are taken for the node (i, j)"
        return Columns((2, 3, 4), node=(0, 1), sigma=5 if count == 6 else None, note=note)
    if count == 5:
        return Columns((1, 2, 3), name=0, sigma=4, note="without a header the columns are taken for id, x, y, z, sigma")
    comma = "; a decimal comma needs semicolons or blanks between the numbers" if count >= 6 else ""
    raise InputError.of(
        f"cannot tell which of {count} columns are x, y and z{comma}",
        where=where,
        hint=HEADER_HINT,
    )


def _four(rows: Rows, usual: Sequence[Sequence[str]], whole: bool) -> Columns:
    """id, x, y, z or x, y, z, sigma: names are words, or whole numbers that do not repeat."""
    first = [cells[0] for cells in usual]
    if not all(map(rows.is_number, first)) or (whole and len(set(first)) == len(first)):
        return Columns((1, 2, 3), name=0, note="without a header the columns are taken for id, x, y, z")
    return Columns((0, 1, 2), sigma=3, note="without a header the columns are taken for x, y, z, sigma")


def _are_nodes(usual: Sequence[Sequence[str]]) -> bool:
    """Whether pairs name each row once and the first column alone does not."""
    pairs = [tuple(cells[:2]) for cells in usual]
    return len(set(pairs)) == len(pairs) > len({first for first, _ in pairs})
