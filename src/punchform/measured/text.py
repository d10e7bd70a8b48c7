"""Points from text: CSV, TXT, XYZ, ASC. Every bad row is told with its line."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from punchform.errors import Problem
from punchform.measured.columns import Columns, find_columns
from punchform.measured.rows import Row, Rows, split_rows

Node = tuple[int, int]
_NODE = re.compile(r"\(?\s*([+-]?\d+)\s*[,:;/ ]\s*([+-]?\d+)\s*\)?")
_UNIT = re.compile(r"\bunits?\b\W*(?:(?:are|is|in)\W+)*([A-Za-z]+)", re.IGNORECASE)


@dataclass(frozen=True)
class Found:
    """What a file says, in its own unit: points with names, nodes, sigmas and lines, row by row.

    unit: as the file writes it, None when it does not; problems: the bad rows, which are not among the points.
    """

    points: tuple[tuple[float, float, float], ...]
    names: tuple[str, ...]
    nodes: tuple[Node | None, ...]
    sigma: tuple[float, ...] | None
    lines: tuple[int, ...]
    unit: str | None
    problems: tuple[Problem, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Point:
    line: int
    name: str
    node: Node | None
    place: tuple[float, float, float]
    sigma: float


class _BadRow(Exception):
    """Why a row cannot be used."""


def read_text_points(text: str, *, where: str) -> Found:
    """The points of a text. Raises InputError when its columns cannot be told apart."""
    rows = split_rows(text)
    columns, data = find_columns(rows, where=where)
    points: list[_Point] = []
    problems: list[Problem] = []
    seen: dict[str, int] = {}
    for row in data:
        try:
            point = _point(rows, columns, row)
            if point.name in seen:
                raise _BadRow(f"the id {point.name} was there already, on line {seen[point.name]}")
        except _BadRow as problem:
            problems.append(Problem(str(problem), f"{where}:{row.line}"))
            continue
        if point.name:
            seen[point.name] = row.line
        points.append(point)
    return Found(
        points=tuple(point.place for point in points),
        names=tuple(point.name or str(number) for number, point in enumerate(points, 1)),
        nodes=tuple(point.node for point in points),
        sigma=None if columns.sigma is None else tuple(point.sigma for point in points),
        lines=tuple(point.line for point in points),
        unit=columns.unit or unit_in(rows.comments),
        problems=tuple(problems),
        notes=(columns.note,) if columns.note else (),
    )


def unit_in(comments: tuple[str, ...]) -> str | None:
    """The unit that a comment states, as in "# units: mm".

    >>> unit_in(("# measured on Monday", "# Units are in m")), unit_in(("# units: in",))
    ('m', 'in')
    """
    return next((match[1].lower() for comment in comments if (match := _UNIT.search(comment))), None)


def node_of(name: str) -> Node | None:
    """The node that a name spells.

    >>> node_of("3:-4"), node_of("(3, -4)"), node_of("P17")
    ((3, -4), (3, -4), None)
    """
    match = _NODE.fullmatch(name.strip())
    return (int(match[1]), int(match[2])) if match else None


def _point(rows: Rows, columns: Columns, row: Row) -> _Point:
    if len(row.cells) <= columns.last:
        raise _BadRow(f"{len(row.cells)} columns, {columns.last + 1} are needed")
    x, y, z = (_finite(rows, row.cells[place], axis) for place, axis in zip(columns.xyz, "xyz", strict=True))
    sigma = math.nan
    if columns.sigma is not None and columns.sigma < len(row.cells):
        sigma = _finite(rows, row.cells[columns.sigma], "sigma")
        if sigma <= 0:
            raise _BadRow(f"sigma is {sigma:g}; it must be above zero")
    if columns.node is not None:
        return _Point(row.line, *_labelled(row, columns.node), (x, y, z), sigma)
    name = "" if columns.name is None else row.cells[columns.name].strip()
    return _Point(row.line, name, node_of(name), (x, y, z), sigma)


def _labelled(row: Row, columns: tuple[int, int]) -> tuple[str, Node]:
    try:
        i, j = (int(row.cells[place]) for place in columns)
    except ValueError:
        raise _BadRow(f"{row.cells[columns[0]]}, {row.cells[columns[1]]} are not the whole numbers i, j") from None
    return f"{i}:{j}", (i, j)


def _finite(rows: Rows, cell: str, axis: str) -> float:
    try:
        value = rows.number(cell)
    except ValueError:
        raise _BadRow(f"{axis} is {cell!r}, not a number" if cell else f"{axis} is empty") from None
    if not math.isfinite(value):
        raise _BadRow(f"{axis} is {cell.strip()}, not a finite number")
    return value
