"""Nodes on a surface: their normals, their shifts along it, and the force that holds them there."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.punch import Gap, Surface, project


def normals_of(gap: Gap) -> Floats:
    """Unit normals of the surface, (n, 3), P(12)."""
    return np.asarray(gap.gradient / np.linalg.norm(gap.gradient, axis=1)[:, None])


def shifted(surface: Surface, positions: Floats, shift: Floats, normals: Floats, held: Bools) -> Floats:
    """Positions (n, 3) after shifts along the tangent plane, returned to the surface along the normals they left."""
    after = positions + shift
    moving = ~held
    after[moving] = project(surface, after[moving], normals[moving])
    return after


def bending(gap: Gap, tangents: Floats, contact: Floats) -> Floats:
    """Curvature term lambda Bᵀ ∇²gap B of Eq. (4.4), (n, 2, 2), from B (n, 3, 2) and the contact forces (n,)."""
    multiplier = -contact / np.linalg.norm(gap.gradient, axis=1)
    bent = tangents.transpose(0, 2, 1) @ gap.hessian @ tangents
    return np.asarray(multiplier[:, None, None] * bent)
