"""A setting near its value: the same grid, node by node, with a little more or less of one number, Eq. (13.20)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case, number, unit, varied
from punchform.grid import Grid, restepped
from punchform.prepare import Prepared
from punchform.punch import Revolution, surface
from punchform.wire import Element, pieces, stiffness

OFFSETS = (-2, -1, 1, 2)
SHARES = (1 / 12, -8 / 12, 8 / 12, -1 / 12)
"""The first derivative from four values at equal distances, wrong only at the fourth power of the distance."""
STEP = 2e-4
"""The distance, relative to the number: what is left out is of its fourth power."""

Family = Callable[[float], Case]
"""The case at a value of a setting, as a change of it from its own value."""


@dataclass(frozen=True)
class Knot:
    """What a run needs at one value of a setting: `offset` is its change; grid and wires are those of the base, node by
    node, even where the blank would now hold others."""

    offset: float
    case: Case
    grid: Grid
    elements: tuple[Element, ...]
    punch: Revolution


def family(case: Case, place: str) -> Family:
    """The cases with other values of the number at a place. Raises InputError when there is none."""
    value = number(case, place)
    return lambda change: varied(case, {place: value + change})


def knots(ready: Prepared, cases: Family, step: float) -> tuple[Knot, ...]:
    """The base at the offsets of the stencil. Raises InputError where a setting cannot have such a value."""
    return tuple(_knot(ready, cases(step * offset), step * offset) for offset in OFFSETS)


def _knot(ready: Prepared, case: Case, offset: float) -> Knot:
    elements = pieces(stiffness(case.wire, case.grid.step), case.grid.subdivide)
    return Knot(offset, case, restepped(ready.grid, case.grid.step), elements, surface(case.tool))


def slope(values: Sequence[Floats | float], step: float) -> Floats:
    """The derivative from the values at the offsets, for the distance `step` between them."""
    return np.asarray(sum(share * np.asarray(value) for share, value in zip(SHARES, values, strict=True)) / step)


def step_of(case: Case, place: str) -> float:
    """How far to go from the value of a number: a part of it, or of what is usual in its unit where it is zero."""
    value = abs(number(case, place))
    return STEP * (value or _usual(case, unit(case, place)))


def _usual(case: Case, of: str) -> float:
    """What a number that is zero is measured by: a step of the grid for lengths, that of the rim for other powers."""
    if of == "mm":
        return min(case.grid.step)
    if of.startswith("mm^"):
        return float((case.rim_radius or 1.0) ** int(of.removeprefix("mm^")))
    return 1.0
