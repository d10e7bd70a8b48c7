"""Figures of one shape of the grid, and how they find their places in the grid as it was laid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.export.told import spread
from punchform.report.quantities import RATIO, STRESS, Reading, readings
from punchform.report.viewer.scene import Figure, Mark, Quantity
from punchform.whole import node_shear, places_in

if TYPE_CHECKING:
    from punchform.whole import Whole

NEAR = "mean of the cells around a node, "


def coloured(read: Reading) -> Quantity:
    """A quantity of a shape as the viewer shows it: that of cells at the nodes."""
    cells = read.place == "cell"
    return Quantity(
        read.key,
        read.label,
        read.unit,
        "wire" if read.place == "wire" else "node",
        signed=read.signed,
        note=(NEAR if cells else "") + read.signs,
    )


def stress_quantity(yield_strength: float | None) -> Quantity:
    """The largest stress in a wire piece, also over the yield strength [MPa] where that is known."""
    stress = coloured(STRESS)
    if yield_strength is None:
        return stress
    over = (yield_strength, RATIO.label)
    return replace(stress, marks=(Mark(yield_strength, "yield strength"),), shown_over=over)


@dataclass(frozen=True)
class Places:
    """Where the nodes (N,) and wire pieces (M,) of the laid grid are in a later one; -1 for what was cut off."""

    nodes: Ints
    pieces: Ints

    def of_nodes(self, values: Floats) -> Floats:
        """Values of the later grid's nodes (n, ...) for those of the laid grid (N, ...), NaN for what was cut off."""
        return spread(np.asarray(values, dtype=np.float64), self.nodes)

    def of_pieces(self, values: Floats) -> Floats:
        """Values of the later grid's pieces (m,) for those of the laid grid (M,), NaN for what was cut off."""
        return spread(np.asarray(values, dtype=np.float64), self.pieces)


def wires_in_order(whole: Whole) -> Ints:
    """The numbers (M,) of all wire pieces, wire by wire and along each, so that neighbours are alike."""
    middle = 0.5 * (whole.flat[whole.start] + whole.flat[whole.end])
    second = whole.family == 2
    along, across = np.where(second, middle[:, 1], middle[:, 0]), np.where(second, middle[:, 0], middle[:, 1])
    return np.lexsort((along, across.round(6), whole.family))


def places(laid: Whole, ends: Ints, later: Whole) -> Places:
    """Where what was laid, its wire pieces between nodes `ends` (M, 2), is in a later shape of it."""
    nodes = np.arange(len(laid.flat)) if later is laid else places_in(later.flat, laid.flat)
    count = len(later.flat)
    own = _pairs(np.column_stack((later.start, later.end)), count)
    order = np.argsort(own)
    wanted = _pairs(nodes[ends], count)
    found = order[np.searchsorted(own[order], wanted).clip(max=max(len(own) - 1, 0))]
    there = (nodes[ends] >= 0).all(axis=1) & (own[found] == wanted)
    return Places(nodes, np.where(there, found, -1))


def figures_of(whole: Whole, at: Places, asked: tuple[Quantity, ...], *, yields: bool) -> tuple[Figure, ...]:
    """The figures of a shape that these quantities ask for, of those that are known of any shape."""
    known = {one.key: one for one in readings(yields=yields) if not one.in_tool}
    return tuple(Figure(one.key, values_of(known[one.key], whole, at)) for one in asked if one.key in known)


def values_of(read: Reading, whole: Whole, at: Places) -> Floats:
    """The values of a quantity of a later shape for the nodes (N,) or wire pieces (M,) of the laid grid."""
    values = read.of(whole)
    if read.place == "wire":
        return at.of_pieces(values)
    return at.of_nodes(node_shear(len(whole.flat), whole.cells, values) if read.place == "cell" else values)


def _pairs(ends: Ints, count: int) -> Ints:
    """One number for each pair (M, 2) of node numbers, whichever comes first."""
    return np.asarray(np.minimum(ends[:, 0], ends[:, 1]) * (count + 1) + np.maximum(ends[:, 0], ends[:, 1]))
