"""What every exported file says of itself: what it shows, its units, its frame, and who wrote it."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING

from punchform import __version__

if TYPE_CHECKING:
    from punchform.case import Case
    from punchform.run import Run
    from punchform.shell import Shell

BREAKS = {"Cc", "Zl", "Zp"}
"""Kinds of characters that end a line somewhere, or are none."""
UNITS = "lengths mm, forces N, stresses MPa, angles rad unless a name says deg"
SHELL_FRAME = "that of the case: in it press.ends says where the wires end; flat: x and y along the wires"
FRAME = "origin on the axis of the punch in the plane of its rim; z up, towards the apex; x and y along the flat wires"


@dataclass(frozen=True)
class Heading:
    """What a file says of itself: the title of its case, what it shows, units, frame, and the program that wrote it.

    title and what are one line, whatever the case has in them.
    """

    title: str
    what: str
    units: str
    frame: str
    version: str

    def __post_init__(self) -> None:
        for name in ("title", "what"):
            object.__setattr__(self, name, one_line(getattr(self, name)))

    @property
    def first(self) -> str:
        """The line for formats with a single one for words, and the first of the others."""
        return f"{self.title}: {self.what}"

    @property
    def lines(self) -> tuple[str, ...]:
        """All of it, four lines."""
        return (self.first, f"units: {self.units}", f"frame: {self.frame}", self.version)


def heading(run: Run | Shell, what: str) -> Heading:
    """The head of a file that shows `what` of a run; no date, so that equal runs give equal files."""
    return Heading(run.case.title, what, UNITS, frame_of(run.case), f"punchform {__version__}")


def one_line(text: str) -> str:
    """The text with a single space for all blanks, line breaks and control characters in a row."""
    return " ".join("".join(" " if unicodedata.category(one) in BREAKS else one for one in text).split())


def frame_of(case: Case) -> str:
    """The frame of all coordinates of a case, in words."""
    return SHELL_FRAME if case.punch is None else FRAME
