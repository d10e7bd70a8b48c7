"""What the mesh itself adds between its nodes: the error of flat or bilinear cells, Eqs. (9.16) and (9.17)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.accuracy.deviation import deviations, feet
from punchform.accuracy.target import Target
from punchform.arrays import Floats, Ints

GAUSS = 3


@dataclass(frozen=True)
class Facets:
    """Deviation of the cells of a mesh whose nodes lie on the target [mm], weighted by projected area.

    mean: of the normal deviation, negative where the cells cut below a dome; sigma: rms about it; largest: its
    greatest size.
    """

    mean: float
    sigma: float
    largest: float


def facets(points: Floats, cells: Ints, target: Target) -> Facets | None:
    """The error of the cells (K, 4) when their nodes, points (n, 3) [mm], are put on the target.

    Each cell is the bilinear surface through its corners, Eq. (9.16); with the last corner given twice it is a flat
    triangle. None when no cell has a place for all its corners.
    """
    corners = points[cells]
    corners = corners[np.isfinite(corners).all(axis=(1, 2))]
    if not len(corners):
        return None
    corners = feet(corners.reshape(-1, 3), target).reshape(-1, 4, 3)
    at, weight = np.polynomial.legendre.leggauss(GAUSS)
    samples, areas = [], []
    for a, wa in zip(0.5 + 0.5 * at, weight, strict=True):
        for b, wb in zip(0.5 + 0.5 * at, weight, strict=True):
            samples.append(np.einsum("k,nka->na", _blend(a, b), corners))
            areas.append(wa * wb * _projected(corners, a, b))
    middle = np.einsum("k,nka->na", _blend(0.5, 0.5), corners)
    values = deviations(np.vstack(samples), target).normal
    share = np.concatenate(areas) / np.sum(areas)
    mean = float(share @ values)
    sigma = math.sqrt(float(share @ (values - mean) ** 2))
    highest = max(np.abs(deviations(middle, target).normal).max(), np.abs(values).max())
    return Facets(mean, sigma, float(highest))


def triangle_sigma(side: float, radius: float) -> float:
    """Rms about the mean [mm] of flat equilateral triangles on a sphere of this radius [mm], Eq. (9.17)."""
    return side**2 / (8 * math.sqrt(15) * radius)


def square_cell(step: float, radius: float) -> Facets:
    """Bilinear square cells of this step [mm] on a dome of this radius of curvature [mm], Eq. (9.17)."""
    return Facets(-(step**2) / (6 * radius), step**2 / (6 * math.sqrt(10) * radius), step**2 / (4 * radius))


def _blend(a: float, b: float) -> Floats:
    return np.array([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])


def _projected(corners: Floats, a: float, b: float) -> Floats:
    """Projected area per unit square of (a, b), (n,)."""
    p, q, r, s = (corners[:, k, :2] for k in range(4))
    along, across = (1 - b) * (q - p) + b * (r - s), (1 - a) * (s - p) + a * (r - q)
    return np.asarray(np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]))
