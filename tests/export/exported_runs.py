"""Runs of every kind that the export formats must know, of a tenth of a second each, made once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import tiny_dish
from stretched import dish

from punchform.case.reading import case_from_text
from punchform.run import Run
from punchform.run import run as form

LOAD = "[load]\ngravity = [0, 0, -1]\n"
STAGES = 'stages = ["press", { trim = { radius = "65 mm" } }, "release", "press", "release"]'
TRIMMED_LAST = 'stages = ["press", "release", { trim = { radius = "55 mm" } }]'
PRESSED_AGAIN = 'stages = ["press", "release", { trim = { radius = "65 mm" } }, "press"]'
CIRCLE = 'blank = { shape = "circle", radius = "70 mm" }'
FILLET = 'fillet = "20 mm"'
NOTCHED = """blank = { shape = "polygon", points = [[-90, -70], [90, -70], [90, -55], [65, -55], [65, 0], [85, 0],
    [85, 20], [65, 20], [65, 70], [-90, 70]] }"""
CORRECTION = FILLET + '\ncorrection = { kind = "radial", points = [[0, 1.5], [20, 0.8], [40, 0.1], [50, 0]] }'


def dish_of(
    first: str = "",
    *,
    grid: str = "",
    punch: str = FILLET,
    release: str = "",
    more: str = "",
    blank: str = CIRCLE,
) -> Run:
    """The tiny dish with other lines before its tables, in [grid], [punch] and [release], and after all."""
    text = tiny_dish.TEXT.replace("schema = 1", f"schema = 1\n{first}")
    text = text.replace("[wire]", f"{grid}\n[wire]\ndensity = 7850").replace(CIRCLE, blank)
    text = text.replace(FILLET, punch).replace("[release]", f"[release]\n{release}")
    return form(case_from_text(text + more))


def pressed() -> Run:
    """Without a release, and without a target."""
    case = dish_of().case
    return form(case.model_copy(update={"release": None, "target": None}))


MADE: Mapping[str, Callable[[], Run]] = {
    "elastic": dish_of,
    "only pressed": pressed,
    "whole": lambda: dish_of(grid='symmetry = "full"'),
    "cut between crossings": lambda: dish_of(grid="subdivide = 2"),
    "loaded": lambda: dish_of(first="title = \"Schüssel ✓ '1'\"", more=LOAD),
    "in stages": lambda: dish_of(first=STAGES),
    "pressed again": lambda: dish_of(first=PRESSED_AGAIN),
    "let go whole": lambda: dish_of(release='symmetry = "full"', first=TRIMMED_LAST),
    "trimmed last": lambda: dish_of(first=TRIMMED_LAST),
    "notched": lambda: dish_of(blank=NOTCHED),
    "corrected": lambda: dish_of(punch=CORRECTION),
    "yielding": dish,
}


@cache
def made(name: str) -> Run:
    """The run of a name."""
    return MADE[name]()
