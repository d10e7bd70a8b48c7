"""Which numbers of a case can vary: those that a workshop could turn, and that have a slope."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from punchform.case import Case, setting

VARIED = ("grid", "wire", "punch", "press", "release", "load")
HOLDS, RIB = "release.hold.", re.compile(r"release\.ribs\[\d+\]\.radius")
"""What decides which crossings are held: these come and go one by one."""


def numbers(case: Case) -> tuple[str, ...]:
    """The places of all numbers of a case that can vary without bound to whole ones: what could matter."""
    content = case.model_dump(by_alias=True)
    found = (place for name in VARIED for place in _leaves(content.get(name), name))
    pair = len(set(case.grid.step)) == 1
    places = (("grid.step" if pair and place.startswith("grid.step[") else place) for place in found)
    return tuple(place for place in dict.fromkeys(places) if not _left_out(case, place))


def crossing_by_crossing(place: str) -> bool:
    """Whether a number decides which crossings are held, so that no figure has a slope by it."""
    return place.startswith(HOLDS) or RIB.fullmatch(place) is not None


def _leaves(value: Any, place: str) -> Iterator[str]:
    """The places of the floats in tables and lists."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{place}.{key}")
    elif isinstance(value, list | tuple):
        for count, inner in enumerate(value):
            yield from _leaves(inner, f"{place}[{count}]")
    elif isinstance(value, float):
        yield place


def _left_out(case: Case, place: str) -> bool:
    """What is no number of the workshop: outlines, whose crossings come and go; points along an axis; matrices."""
    follows = place == "wire.height" and case.wire.stiffness is None
    along = place.endswith("][0]") and "points[" in place
    outline = place.startswith(("grid.blank", "press.ends", "press.descent", "punch.correction", "wire.stiffness"))
    bare = setting(case, place) is None
    return follows or along or outline or bare
