"""The predicted shape as a smooth surface through the nodes, with signed distances: Eq. (10.3).

Around every node a quadric goes through the node and, by least squares, near its neighbours in the flat grid:
w = g.p + p'Kp/2 in axes (a, b, n) of the node. The distance of a point is a mean of its distances to the quadrics of
the four nearest nodes, so that it does not jump from one to the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from punchform.arrays import Bools, Floats, Ints

AROUND = 9
"""Neighbours of a quadric: the 3 x 3 block inside the grid."""
BLENDED = 4
FOOT_STEPS, SMALL_STEP = 8, 1e-9
BESIDE = 1.1
"""How far beside its nodes the sheet goes, in half diagonals of a cell."""


@dataclass(frozen=True)
class Sheet:
    """Nodes (N, 3) [mm], axes (N, 3, 3) with rows a, b, n, slopes g (N, 2), bends K (N, 2, 2) [1/mm].

    cells (K, 4): corners of the grid's cells; reach (N,) [mm]: half a diagonal of the largest cell at each node.
    """

    nodes: Floats
    axes: Floats
    slopes: Floats
    bends: Floats
    cells: Ints
    reach: Floats

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self.nodes)

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Signed distance (n,) [mm] and unit gradient (n, 3); positive above, where z was up before forming."""
        away, nearest = self._nearest(points, BLENDED + 1)
        edge = np.maximum(away[:, -1:], 1e-300)
        # Falls to zero where a node leaves the four nearest; grows without end at a node.
        share = (np.maximum(1 - away[:, :-1] / edge, 0.0) + 1e-12) ** 2 / (away[:, :-1] ** 2 + 1e-24 * edge**2)
        share /= share.sum(axis=1, keepdims=True)
        value, gradient = np.zeros(len(points)), np.zeros((len(points), 3))
        for k in range(nearest.shape[1] - 1):
            part, normal = self._to_quadric(points, nearest[:, k])
            value += share[:, k] * part
            gradient += share[:, k, None] * normal
        return value, gradient / np.linalg.norm(gradient, axis=1, keepdims=True)

    def covers(self, points: Floats) -> Bools:
        """Points (n, 3) whose foot lies on the grid, or beside its last nodes by less than half a cell."""
        value, gradient = self.distance_gradient(points)
        away, nearest = self._nearest(points - value[:, None] * gradient, 1)
        return np.asarray(away[:, 0] <= BESIDE * self.reach[nearest[:, 0]])

    @cached_property
    def facet_error(self) -> tuple[float, float]:
        """How far the middles of flat-cornered cells lie from the sheet: rms and largest [mm]; 0 without cells."""
        if not len(self.cells):
            return 0.0, 0.0
        value, _ = self.distance_gradient(self.nodes[self.cells].mean(axis=1))
        return float(np.sqrt(np.mean(value**2))), float(np.abs(value).max())

    @cached_property
    def own_error(self) -> tuple[float, float]:
        """How far nodes lie from the quadrics of the nodes along the wires beside them: rms and P95 [mm].

        A step away from their middle, where a quadric is several times less exact than in the cells it is used for.
        """
        if not len(self.cells):
            return 0.0, 0.0
        here = self.cells.ravel()
        beside = np.roll(self.cells, 1, axis=1).ravel()
        value, _ = self._to_quadric(self.nodes[here], beside)
        return float(np.sqrt(np.mean(value**2))), float(np.quantile(np.abs(value), 0.95))

    def _nearest(self, points: Floats, count: int) -> tuple[Floats, Ints]:
        away, nearest = self._tree.query(points, k=np.arange(1, min(count, len(self.nodes)) + 1))
        return np.asarray(away, dtype=np.float64), np.asarray(nearest, dtype=np.int64)

    def _to_quadric(self, points: Floats, node: Ints) -> tuple[Floats, Floats]:
        """Signed distance (n,) and normal (n, 3) of points to the quadric of one node each."""
        axes, g, K = self.axes[node], self.slopes[node], self.bends[node]
        local = np.einsum("nab,nb->na", axes, points - self.nodes[node])
        start, height = local[:, :2], local[:, 2]
        most = 2.0 * self.reach[node][:, None]
        foot = _within(start, most)
        for _ in range(FOOT_STEPS):
            slope = g + np.einsum("nab,nb->na", K, foot)
            off = np.einsum("na,na->n", g + 0.5 * (slope - g), foot) - height
            step = _foot_step(foot - start + off[:, None] * slope, slope, off, K)
            foot = _within(foot - step, most)
            if float(np.abs(step).max(initial=0.0)) < SMALL_STEP * float(most.max(initial=1.0)):
                break
        slope = g + np.einsum("nab,nb->na", K, foot)
        off = np.einsum("na,na->n", g + 0.5 * (slope - g), foot) - height
        normal = np.column_stack((-slope, np.ones(len(slope))))
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        value = np.einsum("na,na->n", np.column_stack((start - foot, -off)), normal)
        return value, np.einsum("nab,na->nb", axes, normal)


def sheet(index: Ints, flat: Floats, nodes: Floats) -> Sheet:
    """The sheet through nodes (N, 3) [mm] with grid numbers (N, 2) and flat places (N, 2) [mm]."""
    from scipy.spatial import cKDTree

    cells = cells_of(index)
    _, near = cKDTree(flat).query(flat, k=min(AROUND, len(flat)))
    near = np.asarray(near, dtype=np.int64)[:, 1:]
    across = flat[near] - flat[:, None]
    apart = nodes[near] - nodes[:, None]
    axes = _axes(across, apart)
    local = np.einsum("nab,nkb->nka", axes, apart)
    size = np.linalg.norm(local, axis=2).max(axis=1)
    p, q = (local[:, :, k] / size[:, None] for k in (0, 1))
    terms = np.stack((p, q, 0.5 * p * p, p * q, 0.5 * q * q), axis=2)
    fitted = np.einsum("nak,nk->na", np.linalg.pinv(terms), local[:, :, 2])
    bends = fitted[:, [2, 3, 3, 4]].reshape(-1, 2, 2) / size[:, None, None] ** 2
    return Sheet(nodes, axes, fitted[:, :2] / size[:, None], bends, cells, _reach(nodes, cells, apart))


def cells_of(index: Ints) -> Ints:
    """Corners (K, 4) of the cells of a grid whose nodes have the numbers (N, 2), in the order of a walk around."""
    low = index.min(axis=0)
    table = np.full(index.max(axis=0) - low + 2, -1, dtype=np.int64)
    at = index - low
    table[at[:, 0], at[:, 1]] = np.arange(len(index))
    i, j = at.T
    corners = np.column_stack((table[i, j], table[i + 1, j], table[i + 1, j + 1], table[i, j + 1]))
    return np.asarray(corners[(corners >= 0).all(axis=1)])


def _axes(across: Floats, apart: Floats) -> Floats:
    """Orthonormal axes (N, 3, 3) from the linear map of flat to formed differences; the third along +x cross +y."""
    tangents = np.einsum("nak,nkb->nab", np.linalg.pinv(across), apart)
    normal = np.cross(tangents[:, 0], tangents[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    first = tangents[:, 0] / np.maximum(np.linalg.norm(tangents[:, 0], axis=1, keepdims=True), 1e-300)
    return np.stack((first, np.cross(normal, first), normal), axis=1)


def _reach(nodes: Floats, cells: Ints, apart: Floats) -> Floats:
    """Half a diagonal of the largest cell at each node; where there is none, of a square on its nearest wires."""
    reach = 0.5 * np.sqrt(2.0) * np.linalg.norm(apart, axis=2).min(axis=1)
    corners = nodes[cells]
    half = 0.5 * np.linalg.norm(corners[:, :2] - corners[:, 2:], axis=2).max(axis=1)
    np.maximum.at(reach, cells.ravel(), np.repeat(half, 4))
    return np.asarray(reach)


def _foot_step(residual: Floats, slope: Floats, off: Floats, K: Floats) -> Floats:
    """Newton's step (n, 2) to the foot; Gauss-Newton's where the Hessian is not safely positive."""
    a, b, c = (slope[:, 0] ** 2 + 1, slope[:, 0] * slope[:, 1], slope[:, 1] ** 2 + 1)
    full = (a + off * K[:, 0, 0], b + off * K[:, 0, 1], c + off * K[:, 1, 1])
    positive = (full[0] * full[2] - full[1] ** 2 > 0.05) & (full[0] + full[2] > 0.2)
    a, b, c = (np.where(positive, new, old) for new, old in zip(full, (a, b, c), strict=True))
    r, s = residual.T
    return np.column_stack((c * r - b * s, a * s - b * r)) / (a * c - b * b)[:, None]


def _within(points: Floats, most: Floats) -> Floats:
    """Points (n, 2) drawn in to at most the given length (n, 1)."""
    size = np.linalg.norm(points, axis=1, keepdims=True)
    return np.asarray(points * np.minimum(1.0, most / np.maximum(size, 1e-300)))
