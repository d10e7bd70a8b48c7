"""Small dishes whose punch is compensated: wires that yield and follow it, elastic ones that do not."""

from __future__ import annotations

from functools import cache

from stretched import DISH, KEPT

from punchform.case import Case
from punchform.case.reading import case_from_text
from punchform.optimise.compensated import Compensated, Wish, compensate_case
from punchform.optimise.compensation import Limits
from punchform.optimise.correction_space import Kind

TARGET = """
[target]
profile = { kind = "paraboloid", focal_length = "60 mm" }
aperture_radius = "50 mm"
tolerance = "0.02 mm"
"""


def text_of(*, elastic: bool = False) -> str:
    """The case file of a small dish of 120 mm."""
    rim = "" if elastic else 'rim = "clamp"'
    text = DISH.replace("HOLD", KEPT).replace("RIM", rim).replace("CROSSING", "") + TARGET
    if elastic:
        text = text.replace("strokes = 4", "").replace("[wire]", '[wire]\nhardening = "none"')
    return text


def case_of(*, elastic: bool = False) -> Case:
    return case_from_text(text_of(elastic=elastic))


@cache
def stretched(kind: Kind = "field", to: float = 0.02) -> Compensated:
    """The small dish of wires that yield, with its punch compensated."""
    return compensate_case(case_of(), Wish(kind, Limits(to)))


@cache
def elastic() -> Compensated:
    """The small dish of elastic wires, whose shape does not follow the punch."""
    return compensate_case(case_of(elastic=True), Wish(limits=Limits(0.02)))
