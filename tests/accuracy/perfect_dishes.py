"""The reference dish of the fit tests, D = 600 mm and f = 300 mm, sampled by a quadrature; grids of square cells.

Published tests are written in the vertex frame, +z towards the focus. Ours is a dome: `turned` carries the one into
the other by half a turn about x, so that u and alpha keep their signs and v, w and beta change theirs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.accuracy import Target, place
from punchform.arrays import Floats, Ints
from punchform.case import ParaboloidProfile

RADIUS, FOCAL_LENGTH = 300.0, 300.0
TURN = np.array([1.0, -1.0, -1.0])


def dish(focal_length: float = FOCAL_LENGTH, apex_height: float = 0.0) -> Target:
    return place(ParaboloidProfile(focal_length=focal_length), RADIUS, apex_height=apex_height)


@dataclass(frozen=True)
class Disc:
    """Gauss-Legendre in rho, trapezoid in phi: exact for the polynomials of the tests."""

    x: Floats
    y: Floats
    weights: Floats

    @property
    def rho(self) -> Floats:
        return np.hypot(self.x, self.y) / RADIUS

    @property
    def phi(self) -> Floats:
        return np.arctan2(self.y, self.x)


def disc(rings: int = 16, spokes: int = 40) -> Disc:
    node, weight = np.polynomial.legendre.leggauss(rings)
    rho = 0.5 * RADIUS * (node + 1)
    r, phi = np.meshgrid(rho, 2 * math.pi * np.arange(spokes) / spokes, indexing="ij")
    area = np.repeat(0.5 * RADIUS * weight * rho * 2 * math.pi / spokes, spokes)
    return Disc((r * np.cos(phi)).ravel(), (r * np.sin(phi)).ravel(), area)


def turned(x: Floats, y: Floats, z: Floats) -> Floats:
    """Points of the vertex frame in ours."""
    return np.asarray(np.column_stack((x, y, z)) * TURN)


def with_error(where: Disc, error: Floats, focal_length: float = FOCAL_LENGTH) -> Floats:
    """The dish with an axial error [mm], positive towards the focus, in our frame."""
    return turned(where.x, where.y, (where.x**2 + where.y**2) / (4 * focal_length) + error)


def net(step: float, focal_length: float = FOCAL_LENGTH, reach: float = 330.0) -> tuple[Floats, Ints]:
    """Nodes of a grid that is square in projection, on the dome, and its cells; corners beyond `reach` are cut."""
    half = int(reach / step)
    i, j = np.meshgrid(np.arange(-half, half + 1), np.arange(-half, half + 1), indexing="ij")
    x, y = step * i.ravel(), step * j.ravel()
    points = np.column_stack((x, y, -(x**2 + y**2) / (4 * focal_length)))
    size = 2 * half + 1
    first = (np.arange(size - 1)[:, None] * size + np.arange(size - 1)).ravel()
    cells = np.column_stack((first, first + size, first + size + 1, first + 1))
    inside = (np.hypot(x, y) <= reach)[cells].all(axis=1)
    return points, cells[inside].astype(np.int64)
