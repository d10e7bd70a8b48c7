"""The library of materials: what a name in [wire] stands for."""

from __future__ import annotations

import tomllib
from difflib import get_close_matches
from importlib.resources import files
from typing import Any

FACTS = ("tensile_strength", "source", "remark")
"""What the library knows of a material beside its settings of [wire]."""


def library() -> dict[str, dict[str, Any]]:
    """Every material by its name: its settings of [wire] as in a case file, and its `FACTS`."""
    return tomllib.loads(files("punchform").joinpath("materials.toml").read_text(encoding="utf-8"))


def settings_of(material: dict[str, Any]) -> dict[str, Any]:
    """The settings of [wire] that a material of the library gives."""
    return {key: value for key, value in material.items() if key not in FACTS}


def likely(name: str, known: dict[str, dict[str, Any]]) -> str:
    """A hint with the materials that an unknown name may mean."""
    close = [one for one in known if name and name.lower() in one.lower()] or get_close_matches(name, known, 1, 0.5)
    meant = f"did you mean {' or '.join(f'`{one}`' for one in close)}? " if close else ""
    return f"{meant}`punchform materials` lists all"
