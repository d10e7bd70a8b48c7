"""The net as a start of the press: positions, normals and tangents of all nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.net.ground import ground
from punchform.net.laying import Net, lay_net
from punchform.punch import Surface


@dataclass(frozen=True)
class NetStart:
    """Positions (N, 3) [mm], unit normals (N, 3) and unit tangents (N, 2, 3) of the nodes, and the net they are of.

    The tangents point along +x and +y of the flat grid. Rows of nodes that the net does not reach are NaN.
    """

    positions: Floats
    normals: Floats
    tangents: Floats
    net: Net


def start_state(grid: Grid, surface: Surface, *, shear_limit: float = 0.5 * math.pi) -> NetStart:
    """The net of a grid with the frames of its nodes; look at `net.complete` before starting a press from it."""
    net = lay_net(grid, surface, shear_limit=shear_limit)
    return frames(grid, surface, net)


def frames(grid: Grid, surface: Surface, net: Net) -> NetStart:
    """Normals from the surface, tangents along the wires of the net."""
    normals = np.full_like(net.positions, np.nan)
    normals[net.reached] = ground(surface).normals(net.positions[net.reached])
    tangents = np.stack([_tangents(grid, net, normals, family) for family in range(2)], axis=1)
    for family, turn in ((0, -1.0), (1, 1.0)):
        alone = np.isnan(tangents[:, family, 0]) & net.reached
        tangents[alone, family] = turn * np.cross(normals[alone], tangents[alone, 1 - family])
    return NetStart(net.positions, normals, tangents, net)


def _tangents(grid: Grid, net: Net, normals: Floats, family: int) -> Floats:
    """Tangents of one family, (N, 3): the mean of the edges before and after a node, across the normal.

    At a wire end the edge is carried on by half of its turn from the edge before. NaN where no wire passes.
    """
    x = net.positions
    before, after = (_edges(grid, x, family, side) for side in range(2))
    mirrored = grid.on_mirror[:, family]
    before[mirrored] = -after[mirrored]
    before[mirrored, family] *= -1.0
    ends_after, ends_before = np.isnan(after[:, 0]), np.isnan(before[:, 0])
    along = np.where(ends_after[:, None], before, np.where(ends_before[:, None], after, before + after))
    for ends, edge, inner in ((ends_after, before, 0), (ends_before, after, 1)):
        nodes = np.flatnonzero(ends & (grid.neighbours[:, family, inner] >= 0))
        further = edge[grid.neighbours[nodes, family, inner]]
        carried = 1.5 * edge[nodes] - 0.5 * further
        known = np.isfinite(carried[:, 0])
        along[nodes[known]] = carried[known]
    along -= normals * np.sum(along * normals, axis=1)[:, None]
    return np.asarray(along / np.linalg.norm(along, axis=1)[:, None])


def _edges(grid: Grid, x: Floats, family: int, side: int) -> Floats:
    """Edges (N, 3) along the wire to the node after (side 1) or from the node before (side 0); NaN for none."""
    neighbour = grid.neighbours[:, family, side]
    edge = x[neighbour] - x
    edge[neighbour < 0] = np.nan
    return edge if side else -edge
