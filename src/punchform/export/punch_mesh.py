"""A punch as a closed solid of triangles, and as the binary STL file of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.punch import Corrected, Tool, points_needed

FEWEST, MOST = 64, 1440
"""Triangles around the axis."""
GROWTH = 1.25
HEAD = b"punchform: a punch, units: mm, axis z upwards, its flange is z = 0"
"""Eighty bytes of a binary STL are free; they must not begin with the word `solid`."""


@dataclass(frozen=True)
class Mesh:
    """Vertices (n, 3) [mm] and triangles (m, 3) of their numbers, counter-clockwise seen from outside."""

    vertices: Floats
    triangles: Ints

    @property
    def corners(self) -> Floats:
        """The corners (m, 3, 3) [mm] of the triangles."""
        return np.asarray(self.vertices[self.triangles])


def punch_mesh(surface: Tool, *, radius: float, plate: float, tolerance: float) -> Mesh:
    """The solid under a punch: its surface out to `radius`, a skirt, and a flat bottom at z = -plate, all in mm.

    Edges stay within `tolerance` [mm] of the surface. Every edge belongs to two triangles.
    """
    count, around = points_needed(surface, radius, tolerance), FEWEST
    while around < MOST and _worst(surface, count, around, radius) > tolerance:
        around = 8 * math.ceil(GROWTH * around / 8)
    rings = _rings(surface, count, around, radius)
    floor = rings[-1] * (1.0, 1.0, 0.0) - (0.0, 0.0, plate)
    middle = np.array([0.0, 0.0, surface.height(np.zeros((1, 2)))[0]]), np.array([0.0, 0.0, -plate])
    vertices = np.vstack([middle[0], rings.reshape(-1, 3), floor, middle[1]])
    first = 1 + around * np.arange(len(rings) + 1)
    here = np.arange(around)
    beside = (here + 1) % around
    top = np.column_stack((np.zeros_like(here), 1 + here, 1 + beside))
    bottom = np.column_stack((np.full_like(here, len(vertices) - 1), first[-1] + beside, first[-1] + here))
    walls = [
        triangle
        for inner, outer in pairwise(first)
        for triangle in (
            np.column_stack((inner + here, outer + here, outer + beside)),
            np.column_stack((inner + here, outer + beside, inner + beside)),
        )
    ]
    return Mesh(vertices, np.vstack([top, *walls, bottom]))


def stl(mesh: Mesh) -> bytes:
    """The binary STL file of a mesh: little-endian, single precision, one normal per triangle."""
    corners = mesh.corners
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    rows["normal"] = normals / np.where(length == 0.0, 1.0, length)[:, None]
    rows["corners"] = corners + 0.0
    return HEAD.ljust(80) + len(rows).to_bytes(4, "little") + rows.tobytes()


def _rings(surface: Tool, count: int, around: int, radius: float) -> Floats:
    """Points (count - 1, around, 3) of the surface on circles from the axis outwards, without the axis itself."""
    angle = 2.0 * math.pi * np.arange(around) / around
    base, added = (surface.base, surface.correction) if isinstance(surface, Corrected) else (surface, None)
    line = base.meridian(count, radius=radius)[1:]
    points = np.empty((len(line), around, 3))
    points[:, :, :2] = line[:, 0, None, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    points[:, :, 2] = line[:, 1, None]
    if added is not None:
        points[:, :, 2] += added.value(points[:, :, :2].reshape(-1, 2)).reshape(points.shape[:2])
    return points


def _worst(surface: Tool, count: int, around: int, radius: float) -> float:
    """Largest distance [mm] from the surface of the middles of edges around the axis, and of diagonals."""
    rings = _rings(surface, count, around, radius)
    beside = np.roll(rings, -1, axis=1)
    middles = np.concatenate((0.5 * (rings + beside), 0.5 * (rings[:-1] + beside[1:])))
    return float(np.abs(surface.distance(middles.reshape(-1, 3))).max())
