"""A formed grid as beams: wires along their centrelines, crossings as hinges about the common normal.

A crossing is a centre node for either wire, both at the place of the crossing, with stiff arms along the normal: one to
where its wire really is, half a crimp height above or below, and one to the tip of the hinge::

        tip of both    o-----------o--- wire of one family
                       |
        centres of both o  crossing
                       |
                       o--- wire of the other family

Centres and tips of a pinned crossing move alike, in pairs; that leaves the two wires one rotation apart, about the line
through both. Welded wires share the centre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.mechanics.bars import Bars
from punchform.whole import Whole
from punchform.wire import Element

ARM = 0.3
"""Length of a hinge's arm where wires have no distance, as a part of the step."""
AT_NODE = 1e-6
"""A wire this near to its node, as a part of the step, has no arm."""


@dataclass(frozen=True)
class Beams:
    """Wires of beams with three nodes each, end, middle, end.

    Nodes count from 0, the first are those of the whole grid in its order.
    places (P, 3) [mm]; wires (B, 3): beams of wires, `count` after each other from O to B of every element of the
    whole grid; family (B,): 1 or 2; element (B,): of the whole grid; arms (A, 2): stiff beams from a centre outwards;
    ties (T, 2): nodes that move alike; centres (N, 2): of both wires of each node of the whole grid, -1 where none
    passes.
    """

    places: Floats
    wires: Ints
    family: Ints
    element: Ints
    arms: Ints
    ties: Ints
    centres: Ints
    count: int


def beams(
    whole: Whole, elements: tuple[Element, ...], bars: Bars, *, count: int, welded: bool, clamped: Bools
) -> Beams:
    """The beams of a whole grid, `count` for each of its elements.

    elements, bars: one for each kind of piece; clamped (N,): nodes whose wires are held each for itself.
    """
    passes = np.zeros((len(whole.positions), 2), dtype=bool)
    for ends in (whole.start, whole.end):
        passes[ends, whole.family - 1] = True
    work = _Growing(whole.positions)
    centres = _centres(work, passes, welded)
    off_o = whole.sigma * (bars.offset - bars.rise)[whole.kind]
    off_b = whole.sigma * bars.offset[whole.kind]
    step = float(bars.length.max())
    arms = _Arms(work, whole, centres, AT_NODE * step)
    at_o, at_b = arms.to(whole.start, whole.family, off_o), arms.to(whole.end, whole.family, off_b)
    hinged = np.flatnonzero(passes.all(axis=1) & (not welded) & ~clamped)
    reach = max(float(np.abs(off_b).max()), float(np.abs(off_o).max()))
    reach = reach if reach > AT_NODE * step else ARM * step
    tips = [arms.to(hinged, np.full(len(hinged), w), np.full(len(hinged), reach)) for w in (1, 2)]
    ties = np.concatenate((centres[hinged], np.column_stack(tips)))
    inner = _between(whole, elements, work.places, at_o, at_b, 2 * count)
    first = work.add(inner.reshape(-1, 3)).reshape(len(inner), -1)
    chains = np.column_stack((at_o, first, at_b))
    return Beams(
        places=work.places,
        wires=np.stack((chains[:, :-2:2], chains[:, 1::2], chains[:, 2::2]), axis=2).reshape(-1, 3),
        family=np.repeat(whole.family, count),
        element=np.repeat(np.arange(len(whole.family)), count),
        arms=np.array(arms.made, dtype=np.int64).reshape(-1, 2),
        ties=ties,
        centres=centres,
        count=count,
    )


class _Growing:
    """Nodes that are added one group after the other."""

    def __init__(self, places: Floats) -> None:
        self.places = places

    def add(self, places: Floats) -> Ints:
        """The numbers of new nodes at these places (n, 3)."""
        first = len(self.places)
        self.places = np.concatenate((self.places, places))
        return np.arange(first, len(self.places))


class _Arms:
    """The stiff arms along the normals, each made once."""

    def __init__(self, nodes: _Growing, whole: Whole, centres: Ints, nothing: float) -> None:
        self.nodes, self.whole, self.centres, self.nothing = nodes, whole, centres, nothing
        self.made: list[tuple[int, int]] = []
        self.known: dict[tuple[int, int], int] = {}

    def to(self, at: Ints, family: Ints, off: Floats) -> Ints:
        """The nodes (n,) of wires of a family (1 or 2) so far off [mm] the nodes `at` along their normals."""
        found = np.empty(len(at), dtype=np.int64)
        for m, (node, w, far) in enumerate(zip(at.tolist(), family.tolist(), off.tolist(), strict=True)):
            centre = int(self.centres[node, w - 1])
            key = centre, round(far / self.nothing)
            if key[1] and key not in self.known:
                place = self.whole.positions[node] + far * self.whole.normals[node]
                self.known[key] = int(self.nodes.add(place[None])[0])
                self.made.append((centre, self.known[key]))
            found[m] = self.known[key] if key[1] else centre
        return found


def _centres(nodes: _Growing, passes: Bools, welded: bool) -> Ints:
    """The centre nodes (N, 2): the first wire that passes has the node of the grid."""
    numbers = np.arange(len(passes))
    centres = np.where(passes, numbers[:, None], -1)
    both = np.flatnonzero(passes.all(axis=1))
    if not welded:
        centres[both, 1] = nodes.add(nodes.places[both])
    return np.asarray(centres)


def _between(whole: Whole, elements: tuple[Element, ...], places: Floats, at_o: Ints, at_b: Ints, count: int) -> Floats:
    """Places (M, count - 1, 3) [mm] at equal parts of the bent centrelines, between their ends.

    The unloaded centreline stands in the frame at O; a cubic carries its far end to where it is, turned as it is.
    """
    forward = np.where((whole.flat[whole.end] - whole.flat[whole.start]).sum(axis=1) > 0, 1.0, -1.0)
    frames = [_frame(whole, ends, forward) for ends in (whole.start, whole.end)]
    inner = np.empty((len(at_o), count - 1, 3))
    for kind, element in enumerate(elements):
        own = whole.kind == kind
        line, last = _stations(element, count)
        bent = np.einsum("pk,mkc->mpc", line, frames[0][own])
        missed = places[at_b[own]] - places[at_o[own]] - np.einsum("k,mkc->mc", line[-1], frames[0][own])
        turned = np.einsum("k,mkc->mc", last, (frames[1] - frames[0])[own]) * element.length
        t = line[:, 0] / element.length
        cubic = (t**2 * (3 - 2 * t))[:, None] * missed[:, None] + (t**2 * (t - 1))[:, None] * turned[:, None]
        inner[own] = (places[at_o[own]][:, None] + bent + cubic)[:, 1:-1]
    return inner


def _frame(whole: Whole, node: Ints, forward: Floats) -> Floats:
    """The axes t, n x t, sigma n of the elements at these nodes, as rows, (M, 3, 3): those of the wire as it rises."""
    n = whole.normals[node]
    t = forward[:, None] * whole.tangents[node, whole.family - 1]
    return np.stack((t, np.cross(n, t), whole.sigma[:, None] * n), axis=1)


def _stations(element: Element, count: int) -> tuple[Floats, Floats]:
    """Points (count + 1, 3) [mm] of the centreline at equal steps, from its own ends, and its last direction (3,)."""
    line = element.centreline
    if line is None:
        raise ValueError("a wire that is only known by its matrix has no centreline")
    along = np.concatenate(([0.0], np.cumsum(line.lengths)))
    points = np.column_stack([np.interp(np.linspace(0.0, along[-1], count + 1), along, axis) for axis in line.points.T])
    # Of a straight line the direction at its end is that of the line; a curve ends along the surface.
    return points, np.asarray(line.tangents[-1])
