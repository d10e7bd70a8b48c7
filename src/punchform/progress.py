"""What a run tells while it works: one kind of event, one hook, silent by default."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """One event of a run.

    stage: "press", ...; step: number of the iteration, -1 for a plain message;
    energy [mJ] and gradient (largest entry, N or N mm) after the step; message: words for a person.
    """

    stage: str
    step: int = -1
    energy: float = float("nan")
    gradient: float = float("nan")
    message: str = ""


Observer = Callable[[Progress], None]


def silent(event: Progress) -> None:
    """The observer that does nothing."""
