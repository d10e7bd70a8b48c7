"""Pieces of a meridian whose feet need an iteration: graphs z = f(rho) and ellipse arcs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.punch.feet import Feet, rank
from punchform.punch.foot import Samples, nearest_parameter, sampled

HeightFunction = Callable[[Floats], tuple[Floats, Floats, Floats]]
"""f, f', f'' at rho (n,): heights [mm], slopes, [1/mm]; NaN where f is not defined."""


class Jet(NamedTuple):
    """A parametrised point with its first and second derivatives in the parameter."""

    rho: Floats
    z: Floats
    rho1: Floats | float
    z1: Floats
    rho2: Floats | float
    z2: Floats


class Curve(Protocol):
    """A curve piece with parameter 0 <= t <= end, t = 0 on the axis."""

    @property
    def end(self) -> float: ...

    @property
    def samples(self) -> Samples: ...

    def at(self, t: Floats) -> Jet: ...

    def guess(self, rho: Floats, z: Floats) -> Floats: ...


@dataclass(frozen=True)
class Graph:
    """The piece 0 <= rho <= end of z = lift + f(rho).

    `dome` says that f is a parabola opening downwards: its foot with rho >= 0 is then unique for every point.
    `knots` are the rho where f is less smooth, worth sampling.
    """

    function: HeightFunction
    end: float
    lift: float = 0.0
    dome: bool = False
    knots: tuple[float, ...] = ()

    @property
    def closed_form(self) -> bool:
        return False

    @property
    def span(self) -> tuple[float, float]:
        return 0.0, self.end

    @cached_property
    def samples(self) -> Samples:
        return sampled(self, extra=self.knots, unique_foot=self.dome)

    def at(self, t: Floats) -> Jet:
        f, f1, f2 = self.function(t)
        return Jet(t, f + self.lift, 1.0, f1, 0.0, f2)

    def guess(self, rho: Floats, z: Floats) -> Floats:
        return np.minimum(rho, self.end)

    def nearest(self, rho: Floats, z: Floats) -> tuple[Floats, Feet]:
        return _nearest(self, rho, z)

    def out_of_reach(self, rho: Floats, z: Floats, rank: Floats) -> Bools:
        return self.samples.outside(rho, z, rank)

    def height(self, rho: Floats) -> Floats:
        return self.lift + self.function(rho)[0]

    def trace(self, count: int, radius: float) -> Feet:
        return feet(self, np.linspace(0.0, min(self.end, radius), count))


@dataclass(frozen=True)
class EllipseArc:
    """The piece 0 <= t <= end of the ellipse (radius sin t, centre + half_height cos t); end <= pi/2."""

    radius: float
    half_height: float
    centre: float
    end: float

    @property
    def closed_form(self) -> bool:
        return False

    @property
    def span(self) -> tuple[float, float]:
        return 0.0, self.radius * math.sin(self.end)

    @cached_property
    def samples(self) -> Samples:
        return sampled(self)

    def at(self, t: Floats) -> Jet:
        s, c = np.sin(t), np.cos(t)
        a, b = self.radius, self.half_height
        return Jet(a * s, self.centre + b * c, a * c, -b * s, -a * s, -b * c)

    def guess(self, rho: Floats, z: Floats) -> Floats:
        t = np.arctan2(rho / self.radius, (z - self.centre) / self.half_height)
        return np.minimum(t, self.end)

    def nearest(self, rho: Floats, z: Floats) -> tuple[Floats, Feet]:
        return _nearest(self, rho, z)

    def out_of_reach(self, rho: Floats, z: Floats, rank: Floats) -> Bools:
        return self.samples.outside(rho, z, rank)

    def height(self, rho: Floats) -> Floats:
        part = np.minimum(1.0, rho / self.radius)
        height: Floats = self.centre + self.half_height * np.sqrt((1 - part) * (1 + part))
        return height

    def trace(self, count: int, radius: float) -> Feet:
        return feet(self, np.linspace(0.0, self.end, count))


def feet(curve: Curve, t: Floats) -> Feet:
    """Points, normals and curvatures of a curve at parameters t (n,)."""
    p = curve.at(t)
    speed = np.hypot(p.rho1, p.z1)
    curvature = (p.rho1 * p.z2 - p.z1 * p.rho2) / speed**3
    return Feet(p.rho, p.z, -p.z1 / speed, p.rho1 / speed, curvature)


def _nearest(curve: Graph | EllipseArc, rho: Floats, z: Floats) -> tuple[Floats, Feet]:
    t, clipped = nearest_parameter(curve, rho, z)
    found = feet(curve, t)
    return rank(rho, z, found.rho, found.z, clipped), found
