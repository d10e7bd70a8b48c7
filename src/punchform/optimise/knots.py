"""A setting near its value: the same grid, node by node, with a little more or less of one number, Eq. (13.20)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case, number, unit, varied
from punchform.grid import Grid, restepped
from punchform.mechanics.bars import Bars
from punchform.prepare import Prepared
from punchform.punch import Tool, surface
from punchform.solved import bars_of
from punchform.wire import Element, pieces, stiffness

FOUR, TWO = (-2, -1, 1, 2), (-1, 1)
"""Offsets of four values, from which a derivative is wrong only at the fourth power of their distance; and of two, for
values that cost a solve each: wrong at the square of it."""
SHARES = {4: (1 / 12, -8 / 12, 8 / 12, -1 / 12), 2: (-1 / 2, 1 / 2)}
"""What each of so many values counts."""
STEP, SHORT = 2e-4, 4e-5
"""The distance, relative to the number, of which square or fourth power is left out; the short one for what moves nodes
along the punch: at the edge of the fillet, where the curvature jumps, figures have a kink."""
MOVING = ("grid.step", "punch.")

CRIMP = "wire.centreline.height"
Family = Callable[[float], Case]
"""The case at a value of a setting, as a change of it from its own value."""


@dataclass(frozen=True)
class Knot:
    """What a run needs at one value of a setting: `offset` is its change; grid and wires are those of the base, node by
    node, even where the blank would now hold others; bars: the wires as an energy knows them."""

    offset: float
    case: Case
    grid: Grid
    elements: tuple[Element, ...]
    bars: Bars
    punch: Tool


def family(case: Case, place: str) -> Family:
    """The cases with other values of the number at a place. Raises InputError when there is none."""
    value = number(case, place)
    # A written case has the height of the crimp twice.
    twice = place == CRIMP and "height" in case.wire.model_fields_set
    return lambda change: varied(case, {place: value + change} | ({"wire.height": value + change} if twice else {}))


def knots(ready: Prepared, cases: Family, step: float) -> tuple[Knot, ...]:
    """The base around a value: at two of its neighbours where wires yield, else at four. Raises InputError where a
    setting cannot have such a value."""
    offsets = FOUR if ready.elements[0].hardening is None else TWO
    return tuple(_knot(ready, cases(step * offset), step * offset) for offset in offsets)


def between(knots: Sequence[Knot]) -> float:
    """The distance between neighbouring knots."""
    return abs(min((knot.offset for knot in knots), key=abs))


def _knot(ready: Prepared, case: Case, offset: float) -> Knot:
    elements = pieces(stiffness(case.wire, case.grid.step), case.grid.subdivide)
    bars = bars_of(elements, case.framed(case.press))
    return Knot(offset, case, restepped(ready.grid, case.grid.step), elements, bars, surface(case.tool))


def slope(values: Sequence[Floats | float], step: float) -> Floats:
    """The derivative from two or four values at the offsets, for the distance `step` of the nearest."""
    shares = SHARES[len(values)]
    return np.asarray(sum(share * np.asarray(value) for share, value in zip(shares, values, strict=True)) / step)


def step_of(case: Case, place: str) -> float:
    """How far to go from the value of a number: a part of it, or of what is usual in its unit where it is zero."""
    value = abs(number(case, place))
    share = SHORT if place.startswith(MOVING) else STEP
    return share * (value or _usual(case, unit(case, place)))


def _usual(case: Case, of: str) -> float:
    """What a number that is zero is measured by: a step of the grid for lengths, that of the rim for other powers."""
    if of == "mm":
        return min(case.grid.step)
    if of.startswith("mm^"):
        return float((case.rim_radius or 1.0) ** int(of.removeprefix("mm^")))
    return 1.0
