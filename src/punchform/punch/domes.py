"""From the case's profiles to the segments of a dome and the angle at which the rim fillet takes over.

Spheres, cones and cups are lines and arcs whose heights follow from the fillet in closed form; paraboloids,
polynomials, tables and expressions are graphs. Lengths in mm, angles in rad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from punchform.case import (
    ConeProfile,
    EllipsoidProfile,
    ExpressionProfile,
    FlatProfile,
    ParaboloidProfile,
    PolynomialProfile,
    Profile,
    SphereProfile,
    TableProfile,
)
from punchform.errors import InputError
from punchform.punch.curves import EllipseArc
from punchform.punch.expression import expression
from punchform.punch.feet import Segment
from punchform.punch.fillet import bisect, touch
from punchform.punch.functions import Parabola, polynomial, spline
from punchform.punch.graphs import GraphProfile, rimmed_graph
from punchform.punch.segments import Arc, Line

SAME = 1e-12
"""Lengths that differ by less, relatively, are the same: a wall of no length, a hemisphere to its equator."""


@dataclass(frozen=True)
class Dome:
    """Segments from the axis to the fillet, and the angle of the normal there [rad]."""

    segments: tuple[Segment, ...]
    angle: float


GraphCase = ParaboloidProfile | PolynomialProfile | TableProfile | ExpressionProfile


def dome(profile: Profile, rim_radius: float, fillet: float) -> Dome:
    """The dome of a profile inside a rim, at its height over the flange; InputError if it does not fit."""
    match profile:
        case SphereProfile(radius=radius):
            return _sphere(radius, rim_radius, fillet)
        case EllipsoidProfile(radius=radius, height=height):
            return _ellipsoid(radius, height, rim_radius, fillet)
        case ConeProfile(half_angle=half_angle, nose_radius=nose):
            return _cone(half_angle, nose, rim_radius, fillet)
        case FlatProfile(height=height, edge_radius=edge):
            return _cup(height, edge, rim_radius, fillet)
        case _:
            graph, angle = rimmed_graph(graph_profile(profile, where="punch.profile"), rim_radius, fillet)
            return Dome((graph,), angle)


def graph_profile(profile: GraphCase, *, where: str) -> GraphProfile:
    """The height function of a profile that is a graph. Raises InputError for what cannot be one."""
    match profile:
        case ParaboloidProfile(focal_length=focal_length):
            return GraphProfile(Parabola(focal_length), where, dome=True)
        case PolynomialProfile(coefficients=coefficients):
            return GraphProfile(polynomial(coefficients, where=where), f"{where}.coefficients")
        case TableProfile(points=points):
            knots = tuple(rho for rho, _ in points)
            return GraphProfile(spline(points, where=where), f"{where}.points", knots=knots)
        case ExpressionProfile(z=text):
            return GraphProfile(expression(text, where=f"{where}.z"), f"{where}.z")


def _sphere(radius: float, rim_radius: float, fillet: float) -> Dome:
    """Circle on circle: the centres are radius + fillet apart."""
    reach = radius + fillet
    if rim_radius > reach * (1 + SAME):
        raise _too_small("sphere", radius, rim_radius, fillet)
    angle = math.asin(min(1.0, rim_radius / reach))
    return Dome((Arc((0.0, fillet - reach * math.cos(angle)), radius, 0.0, angle),), angle)


def _ellipsoid(radius: float, height: float, rim_radius: float, fillet: float) -> Dome:
    """The ellipse's point whose normal, of length fillet, ends under the fillet's centre."""
    if rim_radius > (radius + fillet) * (1 + SAME):
        raise _too_small("ellipsoid", radius, rim_radius, fillet)

    def normal_angle(t: float) -> float:
        return math.atan2(height * math.sin(t), radius * math.cos(t))

    def excess(t: float) -> float:
        return radius * math.sin(t) + fillet * math.sin(normal_angle(t)) - rim_radius

    equator = 0.5 * math.pi
    end = equator if excess(equator) <= SAME * rim_radius else bisect(excess, 0.0, equator)
    angle = equator if end == equator else normal_angle(end)
    centre = touch(rim_radius, fillet, angle)[1] - height * math.cos(end)
    return Dome((EllipseArc(radius, height, centre, end),), angle)


def _cone(half_angle: float, nose: float, rim_radius: float, fillet: float) -> Dome:
    angle = 0.5 * math.pi - half_angle
    s, c = math.sin(angle), math.cos(angle)
    wall = (rim_radius - (nose + fillet) * s) / c
    if wall < -SAME * rim_radius:
        raise InputError.of(
            f"the nose ({nose:g} mm) and the fillet ({fillet:g} mm) leave no straight wall between them: "
            f"together they may be {rim_radius / s:g} mm at this angle",
            where="punch.profile.nose_radius",
            hint="make one of them smaller, or take a sphere",
        )
    rho, z = touch(rim_radius, fillet, angle)
    corner = (rho - wall * c, z + wall * s)
    arc = Arc((0.0, corner[1] - nose * c), nose, 0.0, angle)
    if wall <= SAME * rim_radius:
        return Dome((arc,), angle)
    return Dome((arc, Line(corner, (c, -s), wall)), angle)


def _cup(height: float, edge: float, rim_radius: float, fillet: float) -> Dome:
    """Flat disc, edge arc and, when the height exceeds edge + fillet, a vertical wall."""
    both = edge + fillet
    wall = height - both
    angle = 0.5 * math.pi if wall >= 0 else math.acos(1.0 - height / both)
    disc = rim_radius - both * math.sin(angle)
    if disc < -SAME * rim_radius:
        raise InputError.of(
            f"edge radius ({edge:g} mm) and fillet ({fillet:g} mm) need {both * math.sin(angle):g} mm, "
            f"more than the rim radius of {rim_radius:g} mm",
            where="punch.profile.edge_radius",
            hint="make one of them smaller",
        )
    segments: list[Segment] = []
    if disc > SAME * rim_radius:
        segments.append(Line((0.0, height), (1.0, 0.0), disc))
    segments.append(Arc((max(0.0, disc), height - edge), edge, 0.0, angle))
    if wall > SAME * height:
        segments.append(Line((rim_radius - fillet, height - edge), (0.0, -1.0), wall))
    return Dome(tuple(segments), angle)


def _too_small(what: str, radius: float, rim_radius: float, fillet: float) -> InputError:
    return InputError.of(
        f"the {what} of radius {radius:g} mm does not reach the fillet of the rim: "
        f"fillet {fillet:g} mm and rim radius {rim_radius:g} mm need at least {rim_radius - fillet:g} mm",
        where="punch.profile.radius",
    )
