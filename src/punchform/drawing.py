"""How a result finds the room that draws it, which lies above the room that it lives in.

The drawing room is looked up by its name when something is to be drawn, as plotting back-ends are: results stay free of
Matplotlib, and the directions of the house stay as they are.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

ROOM = "punchform.report.notebook"


def drawing_room() -> Any:
    """The module that draws results in notebooks."""
    return import_module(ROOM)
