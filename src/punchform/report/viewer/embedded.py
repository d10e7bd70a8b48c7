"""What a page needs for its viewers: the bundle that draws, their style, and their scenes."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from markupsafe import Markup

PROGRAM, STYLE = "viewer.js", "viewer.css"


@cache
def program() -> Markup:
    """The program of the viewer, to stand in a script element."""
    return Markup(_text(PROGRAM))


@cache
def style() -> Markup:
    """The style of the viewer, to stand in a style element."""
    return Markup(_text(STYLE))


def _text(name: str) -> str:
    return (files("punchform.report.viewer") / name).read_text(encoding="utf-8")
