"""What every exported file says of itself: what it shows, its units, its frame, and who wrote it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from punchform import __version__

if TYPE_CHECKING:
    from punchform.case import Case
    from punchform.run import Run
    from punchform.shell import Shell

UNITS = "lengths mm, forces N, stresses MPa, angles rad unless a name says deg"
SHELL_FRAME = "that of the case: in it press.ends says where the wires end; flat: x and y along the wires"
FRAME = "origin on the axis of the punch in the plane of its rim; z up, towards the apex; x and y along the flat wires"


def heading(run: Run | Shell, what: str) -> tuple[str, ...]:
    """The lines at the head of a file that shows `what` of a run; no date, so that equal runs give equal files."""
    title = " ".join(run.case.title.split())
    return (f"{title}: {what}", f"units: {UNITS}", f"frame: {frame_of(run.case)}", f"punchform {__version__}")


def frame_of(case: Case) -> str:
    """The frame of all coordinates of a case, in words."""
    return SHELL_FRAME if case.punch is None else FRAME
