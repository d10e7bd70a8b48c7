"""Exit codes of the command."""

from __future__ import annotations

from enum import IntEnum


class Exit(IntEnum):
    """How the command ended, for scripts; the sentences stand in `punchform --help`."""

    DONE = 0
    OUT_OF_TOLERANCE = 1
    UNUSABLE_INPUT = 2
    NO_EQUILIBRIUM = 3
    FAULT = 70
    INTERRUPTED = 130
    TERMINATED = 143

    @property
    def sentence(self) -> str:
        """What the code says."""
        return _SENTENCES[self]


_SENTENCES = {
    Exit.DONE: "done, and within the tolerance where the case has one",
    Exit.OUT_OF_TOLERANCE: "done, but the shape is out of tolerance",
    Exit.UNUSABLE_INPUT: "the input cannot be used",
    Exit.NO_EQUILIBRIUM: "no equilibrium was found",
    Exit.FAULT: "a fault of the program itself; please report it",
    Exit.INTERRUPTED: "interrupted with Ctrl-C",
    Exit.TERMINATED: "terminated by the system (SIGTERM)",
}
