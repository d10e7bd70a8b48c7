"""The distance to the zero set of any smooth function, to first order: Eq. (8.20)."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.punch.protocol import Gap


def distance_of(value: Floats, gradient: Floats) -> tuple[Floats, Floats]:
    """F/|∇F| (n,) and the unit normals ∇F/|∇F| (n, 3) from F (n,) and ∇F (n, 3)."""
    steep = np.linalg.norm(gradient, axis=1)
    return value / steep, gradient / steep[:, None]


def gap_of(value: Floats, gradient: Floats, hessian: Floats) -> Gap:
    """The gap to the zero set of F from F (n,), ∇F (n, 3) and ∇²F (n, 3, 3), Eq. (8.20).

    value = F/|∇F|,  gradient = N = ∇F/|∇F|,  Hessian = (I - N Nᵀ) ∇²F (I - N Nᵀ)/|∇F|.

    The zero set is exact, and on it these are value, gradient and Hessian of the signed distance. Off it the value is
    the distance to first order, of the right sign, which is what a projection wants.
    """
    distance, normal = distance_of(value, gradient)
    across = np.eye(3) - normal[:, :, None] * normal[:, None]
    steep = np.linalg.norm(gradient, axis=1)
    return Gap(distance, normal, across @ hessian @ across / steep[:, None, None])
