"""A punch on its way down: the surface with all its heights scaled, as a stroke of the press sees it, Eq. (12.20)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.punch.first_order import distance_of, gap_of
from punchform.punch.protocol import Gap, Surface


@dataclass(frozen=True)
class Lowered:
    """A surface with its heights times `share`; a `Surface`.

    With g the signed distance to the surface itself, A = diag(1, 1, 1/share) and F(x) = share g(A x), so that the
    gradient of F stays between share and 1 however small the share is; gap and distance are those of F by Eq. (8.20).
    """

    whole: Surface
    share: float

    @property
    def rim_radius(self) -> float:
        """Radius of the rim's axis [mm]: that of the whole surface."""
        return self.whole.rim_radius

    @property
    def mirror_planes(self) -> bool:
        """Whether x = 0 and y = 0 are mirror planes: as of the whole surface."""
        return self.whole.mirror_planes

    def gap(self, points: Floats) -> Gap:
        """Distance to first order, its gradient and Hessian as on the surface, at points (n, 3) [mm]."""
        gap = self.whole.gap(self._stretched(points))
        bent = self.share * gap.hessian * np.outer(self._scale, self._scale)
        return gap_of(self.share * gap.value, self._slope(gap.gradient), bent)

    def distance(self, points: Floats) -> Floats:
        """Distance (n,) [mm] of points (n, 3) [mm], to first order; its sign is exact."""
        return self.distance_gradient(points)[0]

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Distance (n,) [mm] to first order and its unit gradient (n, 3) as on the surface."""
        value, gradient = self.whole.distance_gradient(self._stretched(points))
        return distance_of(self.share * value, self._slope(gradient))

    def height(self, xy: Floats) -> Floats:
        """Height z (n,) [mm] over points (n, 2) [mm] of the flat plane."""
        return np.asarray(self.share * self.whole.height(xy))

    @property
    def _scale(self) -> Floats:
        return np.array([1.0, 1.0, 1.0 / self.share])

    def _stretched(self, points: Floats) -> Floats:
        """The points as the whole surface sees them."""
        return np.asarray(points * self._scale)

    def _slope(self, gradient: Floats) -> Floats:
        """∇F (n, 3) from the gradients of the whole distance."""
        return np.asarray(self.share * gradient * self._scale)


def lowered(surface: Surface, share: float) -> Surface:
    """The surface when the punch has gone down by a share of its depth, more than 0; the surface itself at 1."""
    return surface if share == 1.0 else Lowered(surface, share)
