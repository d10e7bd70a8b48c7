"""Which nodes of a grid the ends of its wires are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from punchform.arrays import Ints
from punchform.case import End
from punchform.errors import InputError, Problem
from punchform.wires import LaidWires

FEWEST_ENDS = 3


def nodes_of(laid: LaidWires, ends: Sequence[End]) -> Ints:
    """The nodes of the ends, (K,). Raises InputError with all that do not exist, or are given twice."""
    known = {
        (family + 1, int(laid.grid.index[nodes[0], 1 - family]) // laid.grid.subdivide, end): int(nodes[place])
        for family, wires in enumerate(laid.nodes)
        for nodes in wires
        for end, place in (("low", 0), ("high", -1))
    }
    problems, found = [], []
    for place, end in enumerate(ends):
        node, where = known.get((end.family, end.wire, end.end)), f"press.ends[{place}]"
        if node is None:
            numbers = [wire for family, wire, _ in known if family == end.family]
            told = f"family {end.family} has no wire {end.wire}"
            problems.append(Problem(told, where, f"its wires are {min(numbers)} to {max(numbers)}"))
        elif node in found:
            problems.append(Problem("this end is given twice", where, "wires that end at one node have one end there"))
        else:
            found.append(node)
    if not problems and len(found) < FEWEST_ENDS:
        problems.append(Problem(f"{len(found)} ends do not hold a grid in space", "press.ends", "give at least three"))
    if problems:
        raise InputError(problems)
    return np.array(found)
