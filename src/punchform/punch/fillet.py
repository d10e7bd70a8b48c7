"""Where the rim fillet touches a profile, Eq. (8.2).

The fillet is a concave circle with centre (R0, r_f): it touches z = 0 at rho = R0, and the point whose
normal makes the angle a with the axis is (R0 - r_f sin a, r_f (1 - cos a)). A profile of slope f' is touched
where f' = -tan a; its height follows.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.punch.curves import HeightFunction
from punchform.punch.segments import Arc

SEARCH = 2048


def rim_arc(rim_radius: float, fillet: float, angle: float) -> Arc:
    """The fillet from its tangent point, where the normal has the given angle [rad], to the flange."""
    return Arc((rim_radius, fillet), fillet, angle, 0.0)


def touch(rim_radius: float, fillet: float, angle: float) -> tuple[float, float]:
    """The point (rho, z) [mm] of the fillet whose normal has the given angle [rad]."""
    return rim_radius - fillet * math.sin(angle), 2 * fillet * math.sin(0.5 * angle) ** 2


def tangent_angle(function: HeightFunction, rim_radius: float, fillet: float, *, defined_to: float) -> float:
    """Angle [rad] at which the fillet touches z = f(rho), f being defined for rho <= defined_to.

    Raises InputError when there is no such point, or more than one.
    """

    def slope_excess(angles: Floats) -> Floats:
        return function(rim_radius - fillet * np.sin(angles))[1] * np.cos(angles) + np.sin(angles)

    first = math.asin(max(0.0, min(1.0, (rim_radius - defined_to) / fillet)))
    last = math.asin(min(1.0, rim_radius / fillet))
    angles = np.linspace(first, last, SEARCH)
    with np.errstate(invalid="ignore"):
        excess = slope_excess(angles)
    angles, excess = angles[np.isfinite(excess)], excess[np.isfinite(excess)]
    turns = np.flatnonzero((excess[:-1] < 0) != (excess[1:] < 0))
    if turns.size == 0:
        raise _no_tangent(rim_radius, fillet, defined_to)
    if turns.size > 1:
        raise InputError.of(
            f"the fillet of radius {fillet:g} mm touches the profile at {turns.size} places between "
            f"rho = {rim_radius - fillet * math.sin(last):g} mm and the rim",
            where="punch.fillet",
            hint="take a smaller fillet, or a profile without a wave near the rim",
        )
    k = int(turns[0])
    return bisect(lambda angle: float(slope_excess(np.array([angle]))[0]), float(angles[k]), float(angles[k + 1]))


def bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """The root between two arguments of opposite sign, to rounding."""
    rising = function(high) > 0
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        if (function(middle) > 0) == rising:
            high = middle
        else:
            low = middle


def _no_tangent(rim_radius: float, fillet: float, defined_to: float) -> InputError:
    if defined_to < rim_radius:
        return InputError.of(
            f"the profile ends at rho = {defined_to:g} mm, before the fillet of radius {fillet:g} mm "
            f"at the rim of radius {rim_radius:g} mm can touch it",
            where="punch.profile",
            hint="extend the profile to the rim, or lower the rim radius",
        )
    return InputError.of(
        f"the fillet of radius {fillet:g} mm touches the profile nowhere: "
        f"the profile does not fall towards the rim at rho = {rim_radius:g} mm",
        where="punch.profile",
        hint="z is measured upwards from the rim's plane, so a dome has a falling slope; is a sign wrong?",
    )
