"""What the report needs to know of a figure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

if TYPE_CHECKING:
    from punchform.run import Run


@dataclass(frozen=True)
class Picture:
    """One figure: its file name without ending, its heading, how to read it, what draws it, half or whole
    width, the section of the report that it belongs to, and what to conclude from it, with its numbers."""

    name: str
    title: str
    caption: str
    draw: Callable[[Run], Figure]
    wide: bool = False
    section: str = "formed"
    found: str = ""
