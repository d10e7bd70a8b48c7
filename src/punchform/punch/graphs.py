"""Profiles given as graphs z = f(rho): checked, and cut where the fillet takes over."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.errors import InputError
from punchform.punch.curves import Graph, HeightFunction
from punchform.punch.fillet import tangent_angle, touch

LOOK = 4096
AXIS_SLOPE = 1e-9


@dataclass(frozen=True)
class GraphProfile:
    """A height function; `dome` and `knots` as in `Graph`; `where` its place in the input."""

    function: HeightFunction
    where: str
    dome: bool = False
    knots: tuple[float, ...] = ()


def rimmed_graph(profile: GraphProfile, rim_radius: float, fillet: float) -> tuple[Graph, float]:
    """The graph from the axis to the fillet, at its height over the flange, and the angle there [rad].

    Raises InputError when the profile is not defined or not smooth up to there, when the fillet does not
    fit, or when the profile dips below the flange. Going down and up again above the flange is allowed.
    """
    end = _defined_to(profile, rim_radius)
    if not profile.dome:
        check_axis(profile)
    angle = tangent_angle(profile.function, rim_radius, fillet, defined_to=end)
    rho, z = touch(rim_radius, fillet, angle)
    if not profile.dome:
        check_smooth(profile, rho)
    f = profile.function(np.array([rho]))[0][0]
    graph = Graph(profile.function, rho, z - float(f), dome=profile.dome, knots=profile.knots)
    heights = graph.samples.z
    lowest = int(np.argmin(heights))
    if heights[lowest] < 0.0:
        raise InputError.of(
            f"the profile dips {-heights[lowest]:g} mm below the flange at rho = {graph.samples.rho[lowest]:g} mm",
            where=profile.where,
            hint="the punch must rise above the rim's plane everywhere inside the rim; is a sign wrong?",
        )
    return graph, angle


def bare_graph(profile: GraphProfile, radius: float) -> Graph:
    """The graph from the axis to `radius`, where its formula puts it. Raises InputError as `rimmed_graph`."""
    end = _defined_to(profile, radius)
    if end < radius:
        raise InputError.of(
            f"the profile ends at rho = {end:g} mm, inside the radius of {radius:g} mm", where=profile.where
        )
    if not profile.dome:
        check_axis(profile)
        check_smooth(profile, radius)
    return Graph(profile.function, radius, dome=profile.dome, knots=profile.knots)


def check_axis(profile: GraphProfile) -> None:
    """Raises InputError when the surface has a point, or no curvature, on the axis."""
    _, slope, bend = (float(part[0]) for part in profile.function(np.zeros(1)))
    if abs(slope) > AXIS_SLOPE:
        raise InputError.of(
            f"the profile has the slope {slope:g} on the axis, which makes a point there",
            where=profile.where,
            hint="the slope at rho = 0 must be 0; a cone needs a nose radius",
        )
    if not math.isfinite(bend):
        raise InputError.of("the profile's curvature on the axis is not finite", where=profile.where)


def check_smooth(profile: GraphProfile, radius: float) -> None:
    """Raises InputError when the profile jumps inside the radius: its heights do not follow its slopes."""
    rho = _look(profile, radius)
    f, f1, f2 = profile.function(rho)
    h = np.diff(rho)
    surprise = np.abs(np.diff(f) - 0.5 * h * (f1[1:] + f1[:-1]))
    # The error of the trapezium rule, with a margin that a simple pole still exceeds.
    allowed = h * h * (np.abs(np.diff(f2)) / 8 + (np.abs(f2[1:]) + np.abs(f2[:-1])) / 48)
    jumps = np.flatnonzero(surprise > allowed + 1e-9 * (np.ptp(f) + radius))
    if jumps.size:
        k = int(jumps[0])
        raise InputError.of(f"the profile jumps near rho = {rho[k]:g} mm", where=profile.where)


def _defined_to(profile: GraphProfile, radius: float) -> float:
    """The largest rho up to which f, f', f'' are finite, at most `radius`."""

    def finite(rho: Floats) -> Bools:
        f, f1, f2 = profile.function(rho)
        return np.isfinite(f) & np.isfinite(f1) & np.isfinite(f2)

    rho = _look(profile, radius)
    gaps = np.flatnonzero(~finite(rho))
    if not gaps.size:
        return radius
    if gaps[0] == 0:
        raise InputError.of(
            "the profile is not defined on the axis: its height, slope or curvature is not finite at rho = 0",
            where=profile.where,
            hint="write a formula that can be evaluated there, for example rho**3 for (rho**2)**1.5",
        )
    before, after = float(rho[gaps[0] - 1]), float(rho[gaps[0]])
    edge = _last_true(lambda r: bool(finite(np.array([r]))[0]), before, after)
    if edge < radius and finite(rho[gaps[0] :]).any():
        raise InputError.of(
            f"the profile is not defined at rho = {after:g} mm",
            where=profile.where,
            hint="a root or logarithm of a negative number, or a division by zero?",
        )
    return edge


def _last_true(holds: Callable[[float], bool], yes: float, no: float) -> float:
    """The last number between one that holds and one that does not, by bisection."""
    while (middle := 0.5 * (yes + no)) not in (yes, no):
        yes, no = (middle, no) if holds(middle) else (yes, middle)
    return yes


def _look(profile: GraphProfile, radius: float) -> Floats:
    inner = [knot for knot in profile.knots if 0 < knot < radius]
    return np.union1d(np.linspace(0.0, radius, LOOK), np.array(inner, dtype=np.float64))
