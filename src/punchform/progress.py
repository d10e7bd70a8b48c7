"""What a run tells while it works: one kind of event, one hook, silent by default."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """One event of a run: a step of an iteration, a message, or how far something is; an event can be several of them.

    stage: "press", ...; step: number of the iteration, -1 where the event is not one of its steps;
    energy [mJ] and gradient (largest entry, N or N mm) after the step; message: words for a person;
    done of total: how far the stage is, in strokes, designs, ...; total is None where that is not known;
    limit: the total is one that need not be reached.
    """

    stage: str
    step: int = -1
    energy: float = float("nan")
    gradient: float = float("nan")
    message: str = ""
    done: float = 0.0
    total: float | None = None
    limit: bool = False


Observer = Callable[[Progress], None]


def silent(event: Progress) -> None:
    """The observer that does nothing."""
