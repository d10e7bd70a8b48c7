"""The start of the nodes that one wire has between its crossings, from the start of the crossings, Eq. (7.5)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.grid import Grid, undivided
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, lone_tangents
from punchform.punch import Surface, laid_onto


def between(grid: Grid, crossings: State, surface: Surface) -> State:
    """The state of a grid with nodes between its crossings, from the state of `undivided(grid)` on the surface.

    A wire runs from crossing to crossing as the cubic with its tangents there, and is then laid onto the surface.
    """
    if grid.subdivide == 1:
        return crossings
    kept = np.flatnonzero(grid.crossings)
    positions, normals = np.empty((grid.nodes, 3)), np.empty((grid.nodes, 3))
    tangents = np.empty((grid.nodes, 2, 3))
    positions[kept], normals[kept], tangents[kept] = crossings.positions, crossings.normals, crossings.tangents
    for node, family, near, along in _cubics(undivided(grid), grid, kept, crossings):
        positions[node] = laid_onto(surface, near)
        normals[node] = normals_of(surface.gap(positions[node]))
        tangents[node] = lone_tangents(family, along, normals[node])
    return State(positions, normals, tangents)


def _cubics(whole: Grid, grid: Grid, kept: Ints, crossings: State) -> Iterator[tuple[Ints, Ints, Floats, Floats]]:
    """For k = 1 ... n - 1 the k-th node of all wires from their ends O: numbers, families, points and directions."""
    o, b, family = whole.start, whole.end, whole.family
    x, y = crossings.positions[o], crossings.positions[b]
    size = np.linalg.norm(y - x, axis=1)[:, None]
    outwards = whole.direction[:, None]
    t, u = (outwards * size * crossings.tangents[end, family] for end in (o, b))
    side = (whole.direction > 0).astype(np.int64)
    node = kept[o]
    for k in range(1, grid.subdivide):
        node = grid.neighbours[node, family, side]
        s = k / grid.subdivide
        rest = 1 - s
        near = rest**2 * (1 + 2 * s) * x + s**2 * (3 - 2 * s) * y + s * rest * (rest * t - s * u)
        along = 6 * s * rest * (y - x) + rest * (1 - 3 * s) * t + s * (3 * s - 2) * u
        yield node, family, near, outwards * along
