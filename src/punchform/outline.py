"""The outline of the blank: which points of the plane belong to it, and how far it reaches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Bools, Floats

if TYPE_CHECKING:
    from punchform.case import Blank

ON_THE_OUTLINE = 1e-9
"""A point this near to the outline, relative to its size, belongs to the blank."""


def inside(blank: Blank, points: Floats) -> Bools:
    """Which of the points (n, 2) belong to the blank; points on its outline do."""
    from punchform.case import CircleBlank, PolygonBlank, RectangleBlank

    match blank:
        case CircleBlank(radius=radius):
            return np.asarray(np.hypot(points[:, 0], points[:, 1]) <= radius * (1 + ON_THE_OUTLINE))
        case RectangleBlank(size=size):
            return np.asarray((np.abs(points) <= 0.5 * np.asarray(size) * (1 + ON_THE_OUTLINE)).all(axis=1))
        case PolygonBlank(points=corners):
            return _inside_polygon(np.asarray(corners), points)
    raise TypeError(f"unknown blank {blank!r}")


def reach(blank: Blank) -> tuple[float, float, float]:
    """How far the blank reaches from the axis along x, along y, and in its nearest direction [mm].

    The nearest distance is 0 when the axis does not lie inside the blank.
    """
    from punchform.case import CircleBlank, PolygonBlank, RectangleBlank

    match blank:
        case CircleBlank(radius=radius):
            return radius, radius, radius
        case RectangleBlank(size=size):
            return 0.5 * size[0], 0.5 * size[1], 0.5 * min(size)
        case PolygonBlank(points=corners):
            polygon = np.asarray(corners)
            far = np.abs(polygon).max(axis=0)
            axis = np.zeros((1, 2))
            nearest = float(_distance_to_sides(polygon, axis)[0]) if _inside_polygon(polygon, axis)[0] else 0.0
            return float(far[0]), float(far[1]), nearest
    raise TypeError(f"unknown blank {blank!r}")


def _inside_polygon(corners: Floats, points: Floats) -> Bools:
    """Even-odd rule, with the sides themselves inside."""
    odd = np.zeros(len(points), dtype=bool)
    x, y = points.T
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        odd ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    size = float(np.ptp(corners, axis=0).max())
    return np.asarray(odd | (_distance_to_sides(corners, points) <= ON_THE_OUTLINE * size))


def _distance_to_sides(corners: Floats, points: Floats) -> Floats:
    nearest = np.full(len(points), np.inf)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side = end - start
        t = np.clip((points - start) @ side / max(float(side @ side), 1e-300), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(points - start - t[:, None] * side, axis=1))
    return nearest
