"""What goes wrong, said to a person: the errors that reach the command line."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with an input: what, where and what to do about it."""

    message: str
    where: str = ""
    hint: str = ""

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        advice = f"\n  hint: {self.hint}" if self.hint else ""
        return f"error: {place}{self.message}{advice}"


class PunchformError(Exception):
    """Every error that punchform raises on purpose."""


class InputError(PunchformError):
    """The input cannot be used; `problems` holds all that was found, not only the first."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__(self.problems)

    @classmethod
    def of(cls, message: str, *, where: str = "", hint: str = "") -> InputError:
        """An input error with a single problem."""
        return cls((Problem(message, where, hint),))

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


class NoEquilibrium(PunchformError):
    """The solve ended without an equilibrium; the message says how and what to try."""
