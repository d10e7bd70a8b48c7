"""Upright sections of a punch through its axis, as polylines for drawings and files."""

from __future__ import annotations

import math

import numpy as np

from punchform.arrays import Floats
from punchform.punch.corrected import Corrected, Tool
from punchform.punch.correction import HeightField
from punchform.punch.dying_out import SAME

COARSEST, FINEST = 33, 8193
"""Points of a section."""
GROWTH = 1.4
"""By how much more points there are in the next trial."""


def is_turned(surface: Tool) -> bool:
    """Whether a punch is a surface of revolution, which a lathe can make."""
    return not (isinstance(surface, Corrected) and isinstance(surface.correction, HeightField))


def section_angles(surface: Tool) -> tuple[float, ...]:
    """The directions [degrees] whose sections tell a punch: one of a surface of revolution, else every 22.5 degrees as
    far as the mirror planes leave anything new."""
    if is_turned(surface) or not isinstance(surface, Corrected):
        return (0.0,)
    if not surface.mirror_planes:
        return tuple(22.5 * number for number in range(16))
    return tuple(22.5 * number for number in range(3 if _diagonal(surface) else 5))


def section(surface: Tool, degrees: float, *, count: int, radius: float) -> Floats:
    """Polyline (count, 2) of (rho, z) [mm] from the axis to `radius` in the direction at so many degrees to x."""
    if not isinstance(surface, Corrected):
        return surface.meridian(count, radius=radius)
    line = surface.base.meridian(count, radius=radius)
    angle = math.radians(degrees)
    line[:, 1] += surface.correction.value(line[:, :1] * (math.cos(angle), math.sin(angle)))
    return line


def points_needed(surface: Tool, radius: float, tolerance: float) -> int:
    """How many points a section needs for its chords to stay within a tolerance [mm] of the punch."""
    count = COARSEST
    while count < FINEST and _worst(surface, count, radius) > tolerance:
        count = int(GROWTH * count)
    return count


def _worst(surface: Tool, count: int, radius: float) -> float:
    """Largest distance [mm] of the middles of chords from the punch, over all sections that tell it."""
    distances = []
    for degrees in section_angles(surface):
        line = section(surface, degrees, count=count, radius=radius)
        middle = 0.5 * (line[1:] + line[:-1])
        angle = math.radians(degrees)
        points = np.column_stack((middle[:, 0] * math.cos(angle), middle[:, 0] * math.sin(angle), middle[:, 1]))
        distances.append(float(np.abs(surface.distance(points)).max()))
    return max(distances)


def _diagonal(surface: Corrected) -> bool:
    """Whether x = y is a mirror plane of the correction."""
    match surface.correction:
        case HeightField(x=x, y=y, dz=dz):
            alike = x.shape == y.shape and np.abs(x - y).max() <= SAME
            return bool(alike and np.abs(dz - dz.T).max() <= SAME)
    return True
