"""Figures of one shape of the grid, and how they find their places in the grid as it was laid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.export.told import spread
from punchform.report.viewer.scene import Figure, Mark, Quantity
from punchform.whole import node_shear, places_in

if TYPE_CHECKING:
    from punchform.whole import Whole

SHEAR = Quantity(
    "shear",
    "shear angle",
    "°",
    "node",
    signed=True,
    note="mean of the cells around a node, + where the corner of +x and +y closes",
)
CONTACT = Quantity("contact_force", "contact force", "N", "node", signed=True, note="+ punch pushes, − held down")
AXIAL = Quantity("axial_force", "axial force F1", "N", "wire", signed=True, note="+ tension")
MOMENT = Quantity("moment", "bending moment F5, out of the surface", "N mm", "wire", signed=True)
ELONGATION = Quantity(
    "elongation", "elongation of the wire", "%", "wire", signed=True, note="+ longer than in the blank"
)
PLASTIC = Quantity("plastic_strain", "largest plastic strain in the wire", "%", "wire")


def stress_quantity(yield_strength: float | None) -> Quantity:
    """The largest stress in a wire piece, also over the yield strength [MPa] where that is known."""
    if yield_strength is None:
        return Quantity("stress", "largest stress in the wire", "MPa", "wire")
    return Quantity(
        "stress",
        "largest stress in the wire",
        "MPa",
        "wire",
        marks=(Mark(yield_strength, "yield strength"),),
        shown_over=(yield_strength, "largest stress / yield strength"),
    )


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


def figures_of(whole: Whole, at: Places, quantities: tuple[Quantity, ...]) -> tuple[Figure, ...]:
    """The figures of a shape that these quantities ask for, of those that are known of any shape."""
    known = {
        "shear": lambda: at.of_nodes(np.degrees(node_shear(len(whole.flat), whole.cells, whole.cell_shear))),
        "axial_force": lambda: at.of_pieces(whole.F[:, 0]),
        "moment": lambda: at.of_pieces(whole.F[:, 4]),
        "stress": lambda: at.of_pieces(whole.stress),
        "elongation": lambda: at.of_pieces(100.0 * whole.axial_strain),
        "plastic_strain": lambda: at.of_pieces(100.0 * whole.plastic_strain),
    }
    return tuple(Figure(one.key, known[one.key]()) for one in quantities if one.key in known)


def _pairs(ends: Ints, count: int) -> Ints:
    """One number for each pair (M, 2) of node numbers, whichever comes first."""
    return np.asarray(np.minimum(ends[:, 0], ends[:, 1]) * (count + 1) + np.maximum(ends[:, 0], ends[:, 1]))
