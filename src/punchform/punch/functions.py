"""Height functions f(rho) of profiles that are graphs, with exact first and second derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline


@dataclass(frozen=True)
class Parabola:
    """f = -rho^2 / 4F with focal length F [mm]."""

    focal_length: float

    def __call__(self, rho: Floats) -> tuple[Floats, Floats, Floats]:
        slope = rho * (-0.5 / self.focal_length)
        return 0.5 * slope * rho, slope, np.full_like(rho, -0.5 / self.focal_length)


@dataclass(frozen=True)
class Polynomial:
    """f = sum c_k rho^k with c_k in mm^(1-k)."""

    coefficients: tuple[float, ...]

    def __call__(self, rho: Floats) -> tuple[Floats, Floats, Floats]:
        f, f1, f2 = (np.zeros_like(rho) for _ in range(3))
        for c in reversed(self.coefficients):
            f2 = f2 * rho + 2 * f1
            f1 = f1 * rho + f
            f = f * rho + c
        return f, f1, f2


@dataclass(frozen=True)
class Spline:
    """A C2 cubic spline through points (rho, z), of zero slope on the axis; NaN beyond its last point."""

    cubic: CubicSpline
    end: float

    def __call__(self, rho: Floats) -> tuple[Floats, Floats, Floats]:
        f, f1, f2 = (self.cubic(rho, order) for order in range(3))
        return f, f1, f2


def polynomial(coefficients: tuple[float, ...], *, where: str) -> Polynomial:
    """The polynomial of a profile; raises InputError when it has a slope on the axis."""
    if len(coefficients) > 1 and coefficients[1] != 0.0:
        raise InputError.of(
            f"the term {coefficients[1]:g}*rho makes a point on the axis",
            where=f"{where}.coefficients",
            hint="set the second coefficient to 0; the first is a height and does not matter",
        )
    return Polynomial(coefficients)


def spline(points: tuple[tuple[float, float], ...], *, where: str) -> Spline:
    """The spline of a table profile, rho increasing: slope 0 on the axis, not-a-knot at the outer end.

    Raises InputError for fewer than four points and for rho that does not start at 0.
    """
    from scipy.interpolate import CubicSpline

    table = np.array(points, dtype=np.float64)
    place = f"{where}.points"
    if len(points) < 4:
        raise InputError.of(f"{len(points)} points are too few for a spline; give at least 4", where=place)
    rho = table[:, 0]
    if rho[0] != 0.0:
        raise InputError.of(
            f"the table starts at rho = {rho[0]:g} mm, not on the axis",
            where=place,
            hint="add the point at rho = 0; points at negative rho are not needed, the profile is even",
        )
    cubic = CubicSpline(rho, table[:, 1], bc_type=((1, 0.0), "not-a-knot"), extrapolate=False)
    return Spline(cubic, float(rho[-1]))
