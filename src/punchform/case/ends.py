"""Where the ends of wires go: given one by one, or read from a table."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, ValidationInfo

from punchform.case.parts import Length, MisfitError, Part
from punchform.case.tables import lines_of
from punchform.errors import InputError, Problem
from punchform.units import LENGTH, UnitError, quantity

COLUMNS = ("family", "wire", "end", "x", "y", "z")


@dataclass(frozen=True)
class End:
    """Where one end of a wire goes: family 1 along x, 2 along y, and the wire's number in it; point (x, y, z) [mm]."""

    family: Literal[1, 2]
    wire: int
    end: Literal["low", "high"]
    point: tuple[float, float, float]


class EndCase(Part):
    """Where one end of a wire goes; the wire arches up between its two ends."""

    family: Literal[1, 2] = Field(description="1: a wire along x; 2: along y")
    wire: int = Field(strict=True, description="number of the wire in its family, 0 on the axis")
    end: Literal["low", "high"] = Field(description="the end at low or at high x, or y")
    point: tuple[Length, Length, Length] = Field(description="where it goes: x, y, z [mm]")

    @property
    def given(self) -> End:
        """The end without its place in a case."""
        return End(self.family, self.wire, self.end, self.point)


def ends_in_place_of_file(value: Any, info: ValidationInfo) -> Any:
    """The ends in the file that is named, from the folder in the validation context; a list of ends as it is.

    Raises MisfitError when the file cannot be used.
    """
    if not isinstance(value, str):
        return value
    path = (info.context or {}).get("folder", Path()) / value
    try:
        return [vars(end) for end in ends_in(lines_of(path, key=()), path.name)]
    except InputError as error:
        first, more = error.problems[0], len(error.problems) - 1
        also = f"; and {more} more of its rows cannot be used" if more else ""
        raise MisfitError(f"{first.where}: {first.message}{also}", hint=first.hint) from None


def read_ends(path: Path) -> tuple[End, ...]:
    """The ends of a CSV file with the columns family (1, 2), wire, end (low, high), x, y, z [mm, or with a unit].

    Raises InputError with every row that cannot be used, by its line, and OSError for a file that cannot be read.
    """
    return ends_in(path.read_text(encoding="utf-8-sig").splitlines(), path.name)


def ends_in(lines: Sequence[str], name: str) -> tuple[End, ...]:
    """The ends in the lines of a table; `name` stands for it in messages. Raises InputError as `read_ends` does."""
    rows = csv.DictReader(lines, skipinitialspace=True)
    missing = [column for column in COLUMNS if column not in (rows.fieldnames or ())]
    if missing:
        raise InputError.of(
            f"has no column {', '.join(missing)}", where=name, hint=f"its first line must be {','.join(COLUMNS)}"
        )
    problems, found = [], []
    for row in rows:
        try:
            found.append(_end(row))
        except (ValueError, UnitError) as error:
            problems.append(Problem(str(error), f"{name}:{rows.line_num}"))
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
