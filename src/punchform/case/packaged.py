"""The cases that come with the program."""

from __future__ import annotations

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
        raise InputError.of(
            f"there is no packaged case '{name}'",
            hint="there are: " + ", ".join(PREFIX + case for case in known),
        )
    return files("punchform").joinpath("cases", f"{name}.toml").read_text(encoding="utf-8")
