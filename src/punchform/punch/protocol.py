"""What the press asks of a punch, whatever its shape: Eq. (8.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from punchform.arrays import Floats


@dataclass(frozen=True)
class Gap:
    """Signed distance to the surface and its derivatives at n points.

    Attributes: value (n,) [mm], positive on the grid's side, negative inside the punch;
    gradient (n, 3), of length 1; hessian (n, 3, 3) [1/mm], symmetric, zero along the gradient.
    """

    value: Floats
    gradient: Floats
    hessian: Floats


class Surface(Protocol):
    """A surface on which a grid can lie. Points are rows (x, y, z) [mm]; the flange is z = 0."""

    @property
    def rim_radius(self) -> float:
        """Radius of the rim's axis [mm]; infinite when the surface has no rim."""
        ...

    @property
    def mirror_planes(self) -> bool:
        """Whether x = 0 and y = 0 are mirror planes of the surface."""
        ...

    def gap(self, points: Floats) -> Gap:
        """Signed distance, gradient and Hessian at points (n, 3)."""
        ...

    def distance(self, points: Floats) -> Floats:
        """Signed distance (n,) alone, for a line search."""
        ...

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Signed distance (n,) and its gradient (n, 3), for a projection."""
        ...

    def height(self, xy: Floats) -> Floats:
        """Height z (n,) of the surface over points (n, 2) of the flat plane."""
        ...
