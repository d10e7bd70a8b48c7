"""The rows of a text file of points: comments, separator, cells, and numbers with a point or a comma."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

COMMENT = ("#", "//", "%", "!")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
_COMMA_NUMBER = re.compile(r"[+-]?\d+(?:,\d+)?(?:[eE][+-]?\d+)?")
_POINT = re.compile(r"\d\.\d")


@dataclass(frozen=True)
class Row:
    """One line of the file that is neither blank nor a comment: its number, from 1, and its cells."""

    line: int
    cells: tuple[str, ...]


@dataclass(frozen=True)
class Rows:
    """All rows of a file, its comments, and whether a comma in a number is its decimal sign."""

    rows: tuple[Row, ...]
    comments: tuple[str, ...]
    decimal_comma: bool

    def number(self, cell: str) -> float:
        """The value of a cell, NaN for one that is written as not finite. Raises ValueError for other text."""
        text = cell.strip()
        if self.decimal_comma and _COMMA_NUMBER.fullmatch(text):
            text = text.replace(",", ".")
        if _NUMBER.fullmatch(text):
            return float(text)
        if _NOT_FINITE.fullmatch(text):
            return float("nan")
        raise ValueError(text)

    def is_number(self, cell: str) -> bool:
        """Whether `number` can read the cell."""
        try:
            self.number(cell)
        except ValueError:
            return False
        return True


def split_rows(text: str) -> Rows:
    """The rows of a text whose cells are apart by semicolons, tabs, commas or blanks, the same in all of it.

    A comma is a decimal sign when something else separates the cells and no number has a decimal point.
    """
    lines = [(number, line.strip(" \r\n")) for number, line in enumerate(text.splitlines(), 1)]
    comments = tuple(line for _, line in lines if line.startswith(COMMENT))
    full = [(number, line) for number, line in lines if line.strip() and not line.startswith(COMMENT)]
    separator = _separator([line for _, line in full])
    rows = tuple(Row(number, _cells(line, separator)) for number, line in full)
    return Rows(rows, comments, separator != "," and not any(_POINT.search(line) for _, line in full))


def _separator(lines: Sequence[str]) -> str:
    for mark in (";", "\t"):
        if lines and sum(mark in line for line in lines) > 0.5 * len(lines):
            return mark
    if not any("," in line for line in lines):
        return " "
    # The first line may be a header, so it has no say.
    return " " if all(_blanks_and_commas(line) for line in lines[1:] or lines) else ","


def _blanks_and_commas(line: str) -> bool:
    """Whether a line reads as numbers with decimal commas between blanks: "1,5 2,25 -3"."""
    cells = line.split()
    return len(cells) >= 3 and all(_COMMA_NUMBER.fullmatch(cell) for cell in cells[-3:])


def _cells(line: str, separator: str) -> tuple[str, ...]:
    if separator == " ":
        return tuple(next(csv.reader([" ".join(line.split())], delimiter=" ", skipinitialspace=True)))
    cells = [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
    while cells and not cells[-1]:
        cells.pop()
    return tuple(cells)
