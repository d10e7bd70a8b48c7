"""Foot points on a meridian: what every segment of it can say.

A meridian runs in the half plane (rho, z) from the axis outwards. Its unit normal N points to the grid's
side; a is the angle of N from +z towards +rho, so the slope downwards is tan a:

        N = (sin a, cos a),   T = (cos a, -sin a),   dT/ds = kappa N    (a dome has kappa < 0)
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from punchform.arrays import Bools, Floats


class Feet(NamedTuple):
    """Points (rho, z) [mm] of a meridian, unit normals (normal_rho, normal_z), curvature [1/mm], all (n,)."""

    rho: Floats
    z: Floats
    normal_rho: Floats
    normal_z: Floats
    curvature: Floats


class Segment(Protocol):
    """A smooth piece of a meridian between two values of rho."""

    @property
    def closed_form(self) -> bool:
        """Whether feet cost no iteration."""
        ...

    @property
    def span(self) -> tuple[float, float]:
        """First and last rho [mm]."""
        ...

    def nearest(self, rho: Floats, z: Floats) -> tuple[Floats, Feet]:
        """Rank (n,), see `rank`, and feet of points (rho, z), both (n,)."""
        ...

    def out_of_reach(self, rho: Floats, z: Floats, rank: Floats) -> Bools:
        """Where a foot of the given rank (n,) surely beats all on this segment; may say False too often."""
        ...

    def height(self, rho: Floats) -> Floats:
        """Height z (n,) over rho (n,) within the span."""
        ...

    def trace(self, count: int, radius: float) -> Feet:
        """`count` >= 2 points from start to end; straight pieces and graphs stop at `radius`."""
        ...


def rank(rho: Floats, z: Floats, foot_rho: Floats, foot_z: Floats, clipped: Bools) -> Floats:
    """Square of the distance to a foot, by which the segments of a chain compete.

    In a chain with a continuous tangent the nearest point is never the end of a segment with the point off
    its normal; such clipped feet are set back a little, so that rounding at a joint does not choose them.
    """
    return ((rho - foot_rho) ** 2 + (z - foot_z) ** 2) * np.where(clipped, 1 + 1e-9, 1.0)
