"""How long something will still take, judged by what is done of it."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter


class Remaining:
    """The remaining time: the mean pace so far times what is left, counting down between two tellings.

    Not known before `at_once` things are done (so many are worked on at the same time), since the first of them say
    nothing of the pace of all. clock: seconds, from any beginning.
    """

    def __init__(self, *, at_once: int = 1, clock: Callable[[], float] = perf_counter) -> None:
        self._clock = clock
        self._at_once = max(at_once, 1)
        self._begun = self._told = clock()
        self._first: float | None = None
        self._pace: float | None = None
        self._open = 0.0

    def tell(self, done: float, total: float, *, known: float = 0.0) -> None:
        """So much is done; `known` of it took no time. The first telling begins the time."""
        self._told, self._open = self._clock(), total - done
        if self._first is None:
            self._begun, self._first = self._told, done - known
        worked = done - known - self._first
        if worked >= self._at_once:
            self._pace = (self._told - self._begun) / worked

    @property
    def seconds(self) -> float | None:
        """The seconds that are left, None while that is not known. What is worked on may end at any moment, so they do
        not fall below the time of what follows it."""
        if self._pace is None:
            return None
        since = self._clock() - self._told
        return max(self._pace * self._open - since, self._pace * (self._open - 1.0), 0.0)


def duration(seconds: float) -> str:
    """A time as a person says it.

    >>> duration(4.2), duration(140), duration(7260)
    ('5 s', '2 min 20 s', '2 h 1 min')
    """
    whole = -int(-seconds // 1)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def left(seconds: float | None, *, limit: bool = False) -> str:
    """The remaining time as the ending of a sentence; nothing where it is not known.

    >>> left(61.0), left(3.0, limit=True), left(None)
    (', about 1 min 1 s left', ', at most about 3 s left', '')
    """
    if seconds is None:
        return ""
    return f", {'at most ' if limit else ''}about {duration(seconds)} left"
