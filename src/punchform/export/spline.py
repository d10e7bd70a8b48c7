"""The shape of a grid as one B-spline surface over the flat: through every crossing, to the hull of all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.errors import InputError
from punchform.whole import Whole

DEGREE = 3
FEWEST = 2
"""Wires of a family without which there is no surface."""
STRAIGHT = 0.01
"""How much less straight lines beyond the grid are wanted than lines whose bend goes on."""


@dataclass(frozen=True)
class Spline:
    """A tensor-product B-spline S(u, v) [mm] with u, v the flat x and y [mm].

    poles (m, n, 3) [mm]; knots: those of u and of v, each with its ends repeated degree + 1 times; outline (k, 2): the
    corners, counter-clockwise, of the convex part of the (u, v) plane that the crossings fill.
    """

    poles: Floats
    degrees: tuple[int, int]
    knots: tuple[Floats, Floats]
    outline: Floats

    def at(self, flat: Floats) -> Floats:
        """Points (n, 3) [mm] of the surface at flat places (n, 2) [mm] between its first and last knots."""
        from scipy.interpolate import NdBSpline

        found: Floats = NdBSpline(self.knots, self.poles, self.degrees)(np.asarray(flat, dtype=np.float64))
        return found

    def missed(self, whole: Whole) -> float:
        """Largest distance [mm] of a crossing from the place of the surface that is meant for it."""
        crossings = slice(0, whole.crossings)
        apart = self.at(whole.flat[crossings, :2]) - whole.positions[crossings]
        return float(np.linalg.norm(apart, axis=1).max())


def spline_of(whole: Whole) -> Spline:
    """The surface through the crossings of a grid; cubic, of lower degree where a direction has too few wires.

    The table of crossings (i, j) need not be full: what a round blank lacks of it goes on from what is there, with
    least third differences along both families, and lies outside the outline unless the blank has a notch. Raises
    InputError for wires of which there is only one.
    """
    from scipy.interpolate import make_interp_spline
    from scipy.spatial import ConvexHull

    crossings = slice(0, whole.crossings)
    index, flat = whole.index[crossings], whole.flat[crossings, :2]
    low = index.min(axis=0)
    shape = index.max(axis=0) - low + 1
    if shape.min() < FEWEST:
        raise InputError.of(
            f"a surface needs {FEWEST} wires of each family; this grid has {shape.min()} of one",
            where="--to step",
            hint="leave step out",
        )
    known = np.zeros(shape, dtype=bool)
    table = np.zeros((*shape, 3))
    at = tuple((index - low).T)
    known[at], table[at] = True, whole.positions[crossings]
    poles, degrees, knots = filled(table, known), [], []
    for axis in (0, 1):
        first, last = flat[:, axis].min(), flat[:, axis].max()
        places = np.linspace(first, last, int(shape[axis]))
        along = make_interp_spline(places, poles, k=min(DEGREE, len(places) - 1), axis=axis)
        # SciPy puts the axis that it has worked on first.
        poles = np.moveaxis(along.c, 0, axis)
        degrees.append(int(along.k))
        knots.append(np.asarray(along.t))
    outline: Floats = flat[ConvexHull(flat).vertices]
    return Spline(poles, (degrees[0], degrees[1]), (knots[0], knots[1]), outline)


def filled(table: Floats, known: Bools) -> Floats:
    """A table (m, n, d) whose unknown entries make the sum of the squares of its third differences along both of its
    directions least, and with less weight that of its second differences."""
    from scipy.sparse import csc_array, vstack
    from scipy.sparse.linalg import spsolve

    if known.all():
        return table
    number = np.arange(known.size).reshape(known.shape)
    rows = []
    for weight, stencil in ((1.0, (-1.0, 3.0, -3.0, 1.0)), (STRAIGHT, (1.0, -2.0, 1.0))):
        for lines in (number, number.T):
            places = np.lib.stride_tricks.sliding_window_view(lines, len(stencil), axis=0).reshape(-1, len(stencil))
            row = np.repeat(np.arange(len(places)), len(stencil))
            values = np.tile(weight * np.array(stencil), len(places))
            rows.append(csc_array((values, (row, places.ravel())), shape=(len(places), known.size)))
    differences = csc_array(vstack(rows))
    free = np.flatnonzero(~known.ravel())
    there = np.flatnonzero(known.ravel())
    asked, given = differences[:, free], differences[:, there]
    right = -(asked.T @ (given @ table.reshape(known.size, -1)[there]))
    found = table.copy().reshape(known.size, -1)
    found[free] = spsolve(csc_array(asked.T @ asked), right).reshape(len(free), -1)
    return found.reshape(table.shape)
