"""Profiles without a rim, where their formulas put them: for targets, for tests, and for Python users."""

from __future__ import annotations

import math

from punchform.case import (
    ConeProfile,
    EllipsoidProfile,
    FlatProfile,
    Profile,
    SphereProfile,
)
from punchform.errors import InputError
from punchform.punch.curves import EllipseArc, Graph
from punchform.punch.domes import graph_profile
from punchform.punch.feet import Segment
from punchform.punch.functions import Parabola
from punchform.punch.graphs import bare_graph
from punchform.punch.meridian import Meridian
from punchform.punch.revolution import Revolution
from punchform.punch.segments import Arc, Line

ENDLESS = 1e6
"""Where a paraboloid ends, in focal lengths."""


def Sphere(radius: float) -> Revolution:
    """The whole sphere of the given radius [mm] about the origin; its height is that of the upper half."""
    return Revolution(Meridian((Arc((0.0, 0.0), radius, 0.0, math.pi),)))


def Paraboloid(focal_length: float) -> Revolution:
    """The paraboloid z = -rho^2 / 4f, focal length f [mm], with its apex at the origin."""
    return Revolution(Meridian((Graph(Parabola(focal_length), ENDLESS * focal_length, dome=True),)))


def bare(profile: Profile, radius: float, *, where: str = "profile") -> Revolution:
    """A profile without rim and fillet, from the axis to `radius` [mm]; `rim_radius` is infinite.

    Its height is that of its formula: apex of the paraboloid, nose of the cone and flat of the cup at z = 0,
    centre of sphere and ellipsoid at the origin, the others as written. Beyond its end the surface goes on
    straight, as a cone. Raises InputError, whose place starts with `where`, for a profile that ends before.
    """
    return Revolution(profile_curve(profile, radius, where=where))


def profile_curve(profile: Profile, radius: float, *, where: str = "target.profile") -> Meridian:
    """The meridian of `bare`: `height(rho)` and `foot(rho, z)` of the wanted shape, inside `radius` [mm]."""
    match profile:
        case SphereProfile(radius=sphere):
            _reaches(sphere, radius, where)
            return Meridian((Arc((0.0, 0.0), sphere, 0.0, math.asin(radius / sphere)),))
        case EllipsoidProfile(radius=width, height=height):
            _reaches(width, radius, where)
            return Meridian((EllipseArc(width, height, 0.0, math.asin(radius / width)),))
        case ConeProfile(half_angle=half_angle, nose_radius=nose):
            return Meridian(_cone(0.5 * math.pi - half_angle, nose, radius))
        case FlatProfile():
            return Meridian((Line((0.0, 0.0), (1.0, 0.0), radius),))
        case _:
            return Meridian((bare_graph(graph_profile(profile, where=where), radius),))


def _cone(angle: float, nose: float, radius: float) -> tuple[Segment, ...]:
    s, c = math.sin(angle), math.cos(angle)
    if radius <= nose * s:
        return (Arc((0.0, -nose), nose, 0.0, math.asin(radius / nose)),)
    wall = Line((nose * s, nose * (c - 1.0)), (c, -s), (radius - nose * s) / c)
    return Arc((0.0, -nose), nose, 0.0, angle), wall


def _reaches(profile_radius: float, radius: float, where: str) -> None:
    if profile_radius < radius:
        raise InputError.of(
            f"the profile ends at rho = {profile_radius:g} mm, inside the radius of {radius:g} mm",
            where=f"{where}.radius",
        )
