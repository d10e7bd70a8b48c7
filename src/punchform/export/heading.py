"""What every exported file says of itself: what it shows, its units, its frame, and who wrote it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from punchform import __version__

if TYPE_CHECKING:
    from punchform.run import Run

UNITS = "lengths mm, forces N, stresses MPa, angles rad unless a name says deg"
FRAME = "origin on the axis of the punch in the plane of its rim; z up, towards the apex; x and y along the flat wires"


def heading(run: Run, what: str) -> tuple[str, ...]:
    """The lines at the head of a file that shows `what` of a run; no date, so that equal runs give equal files."""
    title = " ".join(run.case.title.split())
    return (f"{title}: {what}", f"units: {UNITS}", f"frame: {FRAME}", f"punchform {__version__}")
