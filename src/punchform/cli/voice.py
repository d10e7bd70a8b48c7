"""How much a command says on stderr, beside its results and its errors."""

from __future__ import annotations

from enum import Enum


class Voice(Enum):
    """How much is said: errors alone; notes and progress too; every step with its seconds as well."""

    QUIET = "quiet"
    PLAIN = "plain"
    VERBOSE = "verbose"

    @classmethod
    def of(cls, *, quiet: bool, verbose: bool) -> Voice:
        """What the options ask for; the parser lets only one of them through."""
        return cls.QUIET if quiet else cls.VERBOSE if verbose else cls.PLAIN
