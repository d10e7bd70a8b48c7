"""How many cores a solve may use: those it can put to use, or one inside a worker that shares the machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

USEFUL = 2
"""More threads than this do not make the kernels faster."""
_most: ContextVar[int] = ContextVar("_most", default=USEFUL)


def cores() -> int:
    """How many threads the kernels may use here."""
    return _most.get()


@contextmanager
def at_most(count: int) -> Iterator[None]:
    """Let the solves inside use so many cores at most; each thread of a program has a limit of its own.

    No figure depends on it: what is added to a sum, and in which order, is settled by the grid alone.
    """
    token = _most.set(min(count, USEFUL))
    try:
        yield
    finally:
        _most.reset(token)
