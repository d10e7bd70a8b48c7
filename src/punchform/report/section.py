"""What a page of the report is made of, without HTML."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from punchform.report.figures.picture import Picture

Rows = tuple[tuple[str, str], ...]
Tables = tuple[tuple[str, Rows], ...]
Images = tuple[tuple[Picture, Path], ...]


@dataclass(frozen=True)
class Matrix:
    """A table with several columns: its caption, the head of each column (the first is that of the row names), its
    rows, of which those numbered in `marked` stand out, what to know of them, whether it needs the whole width, and
    whether its cells hold words, which may be broken into lines."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marked: tuple[int, ...] = ()
    note: str = ""
    wide: bool = False
    words: bool = False


@dataclass(frozen=True)
class Section:
    """One part of the page: its id, heading, what to beware of, tables of more and of two columns, and a shorter name
    for the list of parts."""

    name: str
    title: str
    warnings: tuple[str, ...] = ()
    matrices: tuple[Matrix, ...] = ()
    tables: Tables = ()
    short: str = ""
