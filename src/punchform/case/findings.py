"""What is found where sections of a case contradict each other."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One contradiction: the path of the key that is best changed, what is wrong, what to do."""

    key: tuple[str | int, ...]
    message: str
    hint: str = ""
