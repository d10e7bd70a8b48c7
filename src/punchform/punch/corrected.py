"""A punch whose profile has a correction added to it, as a `Surface`: Eq. (8.23)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.punch.correction import Correction
from punchform.punch.first_order import distance_of, gap_of
from punchform.punch.protocol import Gap
from punchform.punch.revolution import Revolution


@dataclass(frozen=True)
class Corrected:
    """The surface of revolution `base` with its heights changed by c(x, y); a `Surface`.

    With g the signed distance to the base and F(x, y, z) = g(x, y, z - c(x, y)), gap and distance are those of F by
    Eq. (8.20): exact on the surface with their derivatives, the distance to first order off it. Where the correction is
    nil this is the base. A shear along the axis keeps walls upright that are, and makes none overhang.
    """

    base: Revolution
    correction: Correction

    @property
    def rim_radius(self) -> float:
        """Radius of the rim's axis [mm]: that of the base."""
        return self.base.rim_radius

    @property
    def mirror_planes(self) -> bool:
        """Whether x = 0 and y = 0 are mirror planes: as of the correction."""
        return self.correction.mirror_planes

    @property
    def height_at_axis(self) -> float:
        """Height z [mm] of the BASE on the axis: the vertex of the profile, at which a target stands.

        What the correction adds there is apart, so that a target does not follow the correction that is to reach it.
        """
        return self.base.height_at_axis

    def gap(self, points: Floats) -> Gap:
        """Distance to first order, its gradient and Hessian as on the surface, at points (n, 3) [mm]."""
        rise = self.correction.rise(points[:, :2])
        gap = self.base.gap(_below(points, rise.value))
        up, bent = gap.gradient[:, 2], gap.hessian.copy()
        slope = np.column_stack((rise.gradient, np.zeros(len(points))))
        mixed = slope[:, :, None] * gap.hessian[:, None, 2]
        bent -= mixed + mixed.transpose(0, 2, 1)
        bent += gap.hessian[:, 2, 2, None, None] * slope[:, :, None] * slope[:, None]
        bent[:, :2, :2] -= up[:, None, None] * rise.hessian
        return gap_of(gap.value, gap.gradient - up[:, None] * slope, bent)

    def distance(self, points: Floats) -> Floats:
        """Distance (n,) [mm] of points (n, 3) [mm], to first order; its sign is exact."""
        return self.distance_gradient(points)[0]

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Distance (n,) [mm] to first order and its unit gradient (n, 3) as on the surface."""
        rise = self.correction.rise(points[:, :2])
        value, gradient = self.base.distance_gradient(_below(points, rise.value))
        gradient = gradient.copy()
        gradient[:, :2] -= gradient[:, 2:] * rise.gradient
        return distance_of(value, gradient)

    def height(self, xy: Floats) -> Floats:
        """Height z (n,) [mm] over points (n, 2) [mm] of the flat plane."""
        return np.asarray(self.base.height(xy) + self.correction.rise(xy).value)


def _below(points: Floats, rise: Floats) -> Floats:
    """Where points (n, 3) lie on the base that lie as here on the corrected surface."""
    moved = points.copy()
    moved[:, 2] -= rise
    return moved


Tool = Revolution | Corrected
"""The surface of a punch: of revolution, or with a correction."""


def corrected(base: Revolution, added: Correction | None) -> Tool:
    """The punch with a correction; the punch itself without one."""
    return base if added is None else Corrected(base, added)
