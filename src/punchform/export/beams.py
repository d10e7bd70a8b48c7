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
    centres, doubled = _centres(passes, welded)
    off_o = whole.sigma * (bars.offset - bars.rise)[whole.kind]
    off_b = whole.sigma * bars.offset[whole.kind]
    step = float(bars.length.max())
    hinged = np.flatnonzero(passes.all(axis=1) & (not welded) & ~clamped)
    reach = max(float(np.abs(off_b).max()), float(np.abs(off_o).max()))
    tips = np.full(len(hinged), reach if reach > AT_NODE * step else ARM * step)
    one = np.ones(len(hinged), dtype=np.int64)
    places = np.concatenate((whole.positions, whole.positions[doubled]))
    arms, outer, ends = _arms(
        whole,
        centres,
        at=np.concatenate((whole.start, whole.end, hinged, hinged)),
        family=np.concatenate((whole.family, whole.family, one, 2 * one)),
        off=np.concatenate((off_o, off_b, tips, tips)),
        nothing=AT_NODE * step,
        first=len(places),
    )
    places = np.concatenate((places, outer))
    at_o, at_b, *tied = np.split(ends, np.cumsum([len(off_o), len(off_b), len(hinged)]))
    inner = _between(whole, elements, places, at_o, at_b, 2 * count)
    between = np.arange(inner.size // 3).reshape(inner.shape[:2]) + len(places)
    chains = np.column_stack((at_o, between, at_b))
    return Beams(
        places=np.concatenate((places, inner.reshape(-1, 3))),
        wires=np.stack((chains[:, :-2:2], chains[:, 1::2], chains[:, 2::2]), axis=2).reshape(-1, 3),
        family=np.repeat(whole.family, count),
        element=np.repeat(np.arange(len(whole.family)), count),
        arms=arms,
        ties=np.concatenate((centres[hinged], np.column_stack(tied))),
        centres=centres,
        count=count,
    )


def _centres(passes: Bools, welded: bool) -> tuple[Ints, Ints]:
    """The centre nodes (N, 2), and the nodes of the grid whose second wire has a centre of its own: those come next
    after the nodes of the grid. The first wire that passes has the node of the grid."""
    count = len(passes)
    centres = np.where(passes, np.arange(count)[:, None], -1)
    doubled = np.flatnonzero(passes.all(axis=1) & (not welded))
    centres[doubled, 1] = count + np.arange(len(doubled))
    return centres, doubled


def _arms(
    whole: Whole, centres: Ints, *, at: Ints, family: Ints, off: Floats, nothing: float, first: int
) -> tuple[Ints, Floats, Ints]:
    """The stiff arms (A, 2) to wires of a family (1 or 2) so far off [mm] the nodes `at` (n,) along their normals.

    Further: places (A, 3) [mm] of their outer nodes, numbered from `first` as they are first asked for, and the nodes
    (n,) of the wires: the centre itself where they are nearer than `nothing` [mm].
    """
    ends = centres[at, family - 1]
    steps = np.rint(off / nothing).astype(np.int64)
    away = np.flatnonzero(steps)
    _, asked, which = np.unique(np.column_stack((ends, steps))[away], axis=0, return_index=True, return_inverse=True)
    order = np.argsort(asked)
    chosen = away[asked[order]]
    outer = whole.positions[at[chosen]] + off[chosen, None] * whole.normals[at[chosen]]
    arms = np.column_stack((ends[chosen], first + np.arange(len(chosen))))
    ends[away] = first + np.argsort(order)[which.ravel()]
    return arms, outer, ends


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
