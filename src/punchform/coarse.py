"""The same grid with every second wire, and its answer as a start for the fine one.

The displacement of a grid is a field u(x, y) over the flat plane, P(2), whatever its step: where no net tells where the
nodes go, as behind a clamped rim, the answer of a coarser grid does, and the number of steps stays what it is there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator, NearestNDInterpolator

from punchform.arrays import Bools, Floats, Ints
from punchform.grid import Grid
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, perpendicular
from punchform.punch import Surface, project
from punchform.wire import Element

COARSEST = 600
"""Grids of fewer nodes start by themselves."""


def coarsened(grid: Grid) -> Grid | None:
    """The grid of every second wire of both families; None when the grid is small already."""
    if grid.nodes < COARSEST:
        return None
    kept = np.flatnonzero((grid.index % 2 == 0).all(axis=1))
    number = np.full(grid.nodes + 1, -1, dtype=np.int64)
    number[kept] = np.arange(len(kept))
    once = np.concatenate((grid.neighbours, np.full((1, 2, 2), -1)))
    twice = np.stack([np.stack([once[once[kept, w, k], w, k] for k in range(2)], axis=1) for w in range(2)], axis=1)
    neighbours = number[twice]
    index = grid.index[kept] // 2
    family, lower = np.nonzero(neighbours[:, :, 1].T >= 0)
    upper = neighbours[lower, family, 1]
    outwards = index[lower, family] >= 0
    start, end = np.where(outwards, lower, upper), np.where(outwards, upper, lower)
    on_mirror = grid.on_mirror[kept]
    return Grid(
        step=(2 * grid.step[0], 2 * grid.step[1]),
        index=index,
        flat=grid.flat[kept],
        family=family,
        start=start,
        end=end,
        direction=np.where(outwards, 1, -1),
        sigma=np.ones(len(family), dtype=np.int64),
        weight=np.where(on_mirror[start, 1 - family] & on_mirror[end, 1 - family], 0.5, 1.0),
        neighbours=neighbours,
        on_mirror=on_mirror,
        quarter=grid.quarter,
    )


def doubled(element: Element) -> Element:
    """An elastic wire of twice the length, as flexible per length: its deflections scale like those of beams."""
    length = np.array([1.0, 2.0, 2.0, 1.0, 1.0, 1.0])
    B = 2 * np.linalg.inv(element.C) * np.outer(length, length)
    return replace(element, C=np.linalg.inv(B), height=0.0, length=2 * element.length, centreline=None, hardening=None)


def refined(grid: Grid, flat: State, coarse: Grid, answer: State, surface: Surface, held: Bools) -> State:
    """The start (N, ...) on the fine grid from the answer on the coarse one; held nodes stay as in the flat start."""
    shift = answer.positions.copy()
    shift[:, :2] -= coarse.flat
    smooth = CloughTocher2DInterpolator(coarse.flat, shift)(grid.flat)
    outside = np.isnan(smooth).any(axis=1)
    smooth[outside] = NearestNDInterpolator(coarse.flat, shift)(grid.flat[outside])
    # What lies in a mirror plane stays in it.
    smooth[:, :2][grid.on_mirror] = 0.0
    near = np.column_stack((grid.flat, np.zeros(grid.nodes))) + smooth
    positions = project(surface, near, normals_of(surface.gap(near)))
    lost = held | ~np.isfinite(positions).all(axis=1)
    positions[lost] = flat.positions[lost]
    normals = np.where(held[:, None], flat.normals, normals_of(surface.gap(positions)))
    along = np.stack([perpendicular(_along(grid, positions, w), normals) for w in range(2)], axis=1)
    return State(positions, normals, np.where(held[:, None, None], flat.tangents, along))


def _along(grid: Grid, positions: Floats, family: int) -> Floats:
    """Directions (N, 3) from the node before to the node after along a wire, P(17); its own axis for no wire."""
    before, after = grid.neighbours[:, family].T
    mirror = np.ones(3)
    mirror[family] = -1.0
    behind = np.where(grid.on_mirror[:, family, None], positions[after] * mirror, _at(positions, before))
    along = _at(positions, after) - behind
    alone = (before < 0) & (after < 0)
    along[alone] = np.eye(3)[family]
    return along


def _at(positions: Floats, place: Ints) -> Floats:
    """Positions at places (N,), a node's own where there is none."""
    return np.asarray(np.where(place[:, None] < 0, positions, positions[place]))
