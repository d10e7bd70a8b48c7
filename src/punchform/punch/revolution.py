"""Surfaces of revolution about the z axis: signed distance with exact derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.punch.feet import Feet
from punchform.punch.meridian import Meridian
from punchform.punch.protocol import Gap

NEAR_AXIS = 1e-7
"""Below this rho, relative to |x|, the curvature of the parallel circle is taken from its limit."""


@dataclass(frozen=True)
class Revolution:
    """The surface swept by a meridian; a `Surface`.

    With d the signed distance, (c, s) = (x, y)/rho, the meridian's normal (n_rho, n_z) and curvature kappa
    at the foot:

    gradient = (n_rho c, n_rho s, n_z),
    Hessian  = -kappa/(1 - kappa d) T T' + (n_rho/rho) P P',  T = (n_z c, n_z s, -n_rho),  P = (-s, c, 0)

    At rho = 0 the second factor tends to the first. Where the foot is not unique (deep inside the punch)
    the value is right and the derivatives are those of one of the feet.
    """

    chain: Meridian
    rim_radius: float = math.inf

    @property
    def mirror_planes(self) -> bool:
        """Always true for a surface of revolution."""
        return True

    @property
    def height_at_axis(self) -> float:
        """Height z [mm] of the surface on the axis."""
        return float(self.chain.height(np.zeros(1))[0])

    def gap(self, points: Floats) -> Gap:
        """Signed distance, gradient and Hessian at points (n, 3) [mm]."""
        rho, c, s = _polar(points)
        z = points[:, 2]
        feet = self.chain.foot(rho, z)
        value = _offset(rho, z, feet)
        meridional = _compliant(feet.curvature, value)
        near_axis = rho <= NEAR_AXIS * np.abs(points).max(initial=0.0)
        circle = np.where(near_axis, meridional, feet.normal_rho / np.where(near_axis, 1.0, rho))
        return Gap(value, _gradient(feet, c, s), _hessian(feet, c, s, meridional, circle))

    def distance(self, points: Floats) -> Floats:
        """Signed distance (n,) [mm] of points (n, 3) [mm]."""
        rho, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
        return _offset(rho, z, self.chain.foot(rho, z))

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Signed distance (n,) [mm] and its gradient (n, 3) at points (n, 3) [mm]."""
        rho, c, s = _polar(points)
        feet = self.chain.foot(rho, points[:, 2])
        return _offset(rho, points[:, 2], feet), _gradient(feet, c, s)

    def height(self, xy: Floats) -> Floats:
        """Height z (n,) [mm] over points (n, 2) [mm] of the flat plane; NaN beyond the end of the surface."""
        return self.chain.height(np.hypot(xy[:, 0], xy[:, 1]))

    def meridian(self, count: int, *, radius: float | None = None) -> Floats:
        """Polyline (count, 2) of (rho, z) [mm] for drawing, out to `radius`.

        Without a radius it ends a fifth beyond the rim, or where a surface without a rim ends.
        """
        end = min(1.2 * self.rim_radius, self.chain.segments[-1].span[1])
        return self.chain.points(count, end if radius is None else radius)


def _polar(points: Floats) -> tuple[Floats, Floats, Floats]:
    """rho and the unit vector (c, s) along it; along x on the axis."""
    x, y = points[:, 0], points[:, 1]
    rho = np.hypot(x, y)
    on_axis = rho == 0.0
    length = np.where(on_axis, 1.0, rho)
    return rho, np.where(on_axis, 1.0, x / length), y / length


def _offset(rho: Floats, z: Floats, feet: Feet) -> Floats:
    return (rho - feet.rho) * feet.normal_rho + (z - feet.z) * feet.normal_z


def _compliant(curvature: Floats, value: Floats) -> Floats:
    """-kappa/(1 - kappa d), kept finite at the centre of curvature."""
    shrink = 1.0 - curvature * value
    return -curvature / np.where(np.abs(shrink) < 1e-12, 1e-12, shrink)


def _gradient(feet: Feet, c: Floats, s: Floats) -> Floats:
    gradient = np.empty((c.size, 3))
    np.multiply(feet.normal_rho, c, out=gradient[:, 0])
    np.multiply(feet.normal_rho, s, out=gradient[:, 1])
    gradient[:, 2] = feet.normal_z
    return gradient


def _hessian(feet: Feet, c: Floats, s: Floats, meridional: Floats, circle: Floats) -> Floats:
    hessian = np.empty((c.size, 3, 3))
    nr, nz = feet.normal_rho, feet.normal_z
    flat, cross = meridional * nz * nz, -meridional * nr * nz
    hessian[:, 0, 0] = flat * c * c + circle * s * s
    hessian[:, 1, 1] = flat * s * s + circle * c * c
    hessian[:, 2, 2] = meridional * nr * nr
    hessian[:, 0, 1] = hessian[:, 1, 0] = (flat - circle) * c * s
    hessian[:, 0, 2] = hessian[:, 2, 0] = cross * c
    hessian[:, 1, 2] = hessian[:, 2, 1] = cross * s
    return hessian
