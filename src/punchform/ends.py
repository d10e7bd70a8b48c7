"""Where the ends of wires go: given one by one, or read from a table."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from punchform.arrays import Ints
from punchform.errors import InputError, Problem
from punchform.units import LENGTH, UnitError, quantity
from punchform.wires import LaidWires

COLUMNS = ("family", "wire", "end", "x", "y", "z")
FEWEST_ENDS = 3


@dataclass(frozen=True)
class End:
    """Where one end of a wire goes: family 1 along x, 2 along y, and the wire's number in it; point (x, y, z) [mm]."""

    family: Literal[1, 2]
    wire: int
    end: Literal["low", "high"]
    point: tuple[float, float, float]


def read_ends(path: Path) -> tuple[End, ...]:
    """The ends of a CSV file with the columns family (1, 2), wire, end (low, high), x, y, z [mm, or with a unit].

    Raises InputError with every row that cannot be used, by its line, and OSError for a file that cannot be read.
    """
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = csv.DictReader(file, skipinitialspace=True)
        missing = [column for column in COLUMNS if column not in (rows.fieldnames or ())]
        if missing:
            raise InputError.of(
                f"{path.name} has no column {', '.join(missing)}",
                where="ends",
                hint=f"its first line must be {','.join(COLUMNS)}",
            )
        problems, found = [], []
        for row in rows:
            try:
                found.append(_end(row))
            except (ValueError, UnitError) as error:
                problems.append(Problem(str(error), f"{path.name}:{rows.line_num}"))
    if problems:
        raise InputError(problems)
    return tuple(found)


def _end(row: dict[str, str | None]) -> End:
    """The end of one row. Raises ValueError and UnitError with what is wrong with it."""
    family, wire, end = (str(row[column] or "").strip() for column in COLUMNS[:3])
    if family not in ("1", "2"):
        raise ValueError(f"the family is 1 (along x) or 2 (along y), not '{family}'")
    if not wire.lstrip("+-").isdecimal():
        raise ValueError(f"the wire is a whole number, not '{wire}'")
    if end not in ("low", "high"):
        raise ValueError(f"the end is low or high, not '{end}'")
    x, y, z = (_length(column, str(row[column] or "").strip()) for column in "xyz")
    return End(1 if family == "1" else 2, int(wire), "low" if end == "low" else "high", (x, y, z))


def _length(column: str, text: str) -> float:
    try:
        plain = float(text)
    except ValueError:
        return quantity(text, LENGTH)
    if not np.isfinite(plain):
        raise ValueError(f"{column} is not a number: '{text}'")
    return plain


def nodes_of(laid: LaidWires, ends: Sequence[End]) -> Ints:
    """The nodes of the ends, (K,). Raises InputError with all that do not exist, or are given twice."""
    known = {
        (family + 1, int(laid.grid.index[nodes[0], 1 - family]) // laid.grid.subdivide, end): int(nodes[place])
        for family, wires in enumerate(laid.nodes)
        for nodes in wires
        for end, place in (("low", 0), ("high", -1))
    }
    problems, found = [], []
    for place, end in enumerate(ends):
        node = known.get((end.family, end.wire, end.end))
        if node is None:
            problems.append(Problem(f"family {end.family} has no wire {end.wire}", f"ends[{place}]"))
        elif node in found:
            problems.append(Problem("this end is given twice", f"ends[{place}]"))
        else:
            found.append(node)
    if not problems and len(found) < FEWEST_ENDS:
        problems.append(Problem(f"{len(found)} ends do not hold a grid in space", "ends", "give at least three"))
    if problems:
        raise InputError(problems)
    return np.array(found)
