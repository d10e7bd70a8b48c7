"""The cases that come with the program."""

from __future__ import annotations

import re
from difflib import get_close_matches
from importlib.resources import files

from punchform.errors import InputError

PREFIX = "packaged:"
"""What turns a name into that of a packaged case on the command line."""

TEMPLATE = "new"
"""The packaged case that `punchform new` writes."""


def packaged_cases() -> tuple[str, ...]:
    """Names of the packaged cases."""
    names = (entry.name for entry in files("punchform").joinpath("cases").iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def packaged_text(name: str) -> str:
    """The text of a packaged case. Raises InputError for an unknown name."""
    known = packaged_cases()
    if name not in known:
        near = get_close_matches(name, known, n=1)
        meant = f"did you mean `{PREFIX}{near[0]}`? " if near else ""
        raise InputError.of(
            f"there is no packaged case '{name}'",
            hint=meant + "there are: " + ", ".join(PREFIX + case for case in known),
        )
    return files("punchform").joinpath("cases", f"{name}.toml").read_text(encoding="utf-8")


def introduction(text: str) -> str:
    """What a case shows: the first sentence of the comment that it begins with, empty without one.

    >>> introduction("# A dish of 0.8 mm\\n# wire. It runs.\\nschema = 1")
    'A dish of 0.8 mm wire.'
    """
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("# ").rstrip())
    return re.split(r"(?<=[.!?])\s", " ".join(lines).strip(), maxsplit=1)[0]
