"""The wires of a whole grid one by one: which nodes each runs through, in order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.whole import Whole


@dataclass(frozen=True)
class Strand:
    """One wire without a gap.

    family: 1 along x, 2 along y; number: its j or i; part: 1, and on from there where the blank has gaps along the
    wire; nodes (n,): numbers of its nodes, by rising x or y in the flat; elements (n - 1,): those between them.
    """

    family: int
    number: int
    part: int
    nodes: Ints
    elements: Ints

    @property
    def name(self) -> str:
        """What it is called in lists, such as "1w-3", or "1w-3b" for its second part: no date to a spreadsheet."""
        return f"{self.family}w{self.number}" + ("" if self.part == 1 else _letters(self.part))


def strands(whole: Whole) -> tuple[Strand, ...]:
    """All wires of a whole grid, by family, number and part."""
    along = whole.family - 1
    low, high = _upwards(whole.flat, along, whole.start, whole.end)
    number = whole.index[whole.start, 1 - along]
    order = np.lexsort((whole.flat[low, along], number, whole.family))
    before, here = order[:-1], order[1:]
    goes_on = (whole.family[before] == whole.family[here]) & (high[before] == low[here])
    found: list[Strand] = []
    for elements in np.split(order, 1 + np.flatnonzero(~goes_on)):
        first = elements[0]
        family, count = int(whole.family[first]), int(number[first])
        same = bool(found) and (found[-1].family, found[-1].number) == (family, count)
        part = found[-1].part + 1 if same else 1
        found.append(Strand(family, count, part, np.append(low[elements], high[elements[-1]]), elements))
    return tuple(found)


def _upwards(flat: Floats, along: Ints, start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """The ends (M,) of elements at lower and at higher x or y in the flat."""
    turned = flat[start, along] > flat[end, along]
    return np.where(turned, end, start), np.where(turned, start, end)


def _letters(part: int) -> str:
    """b for 2, c for 3, ..., and the number itself beyond z."""
    return chr(ord("a") + part - 1) if part <= 26 else f".{part}"
