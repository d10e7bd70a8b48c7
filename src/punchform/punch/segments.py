"""Straight lines and circular arcs of a meridian: feet in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.punch.feet import Feet, rank

ROUNDING = 1e-12
"""How far beyond its end, relative to its size, a foot still counts as on the segment."""


@dataclass(frozen=True)
class Line:
    """A straight piece: start (rho, z), unit direction (rho, z), length; lengths in mm, may be infinite."""

    start: tuple[float, float]
    direction: tuple[float, float]
    length: float

    @property
    def closed_form(self) -> bool:
        return True

    @property
    def span(self) -> tuple[float, float]:
        along = self.direction[0]
        return self.start[0], self.start[0] + (self.length * along if along > 0 else 0.0)

    def nearest(self, rho: Floats, z: Floats) -> tuple[Floats, Feet]:
        (r0, z0), (tr, tz) = self.start, self.direction
        along = (rho - r0) * tr + (z - z0) * tz
        slack = ROUNDING * (abs(r0) + abs(z0) + (self.length if math.isfinite(self.length) else 0.0))
        clipped = (along < -slack) | (along > self.length + slack)
        feet = self._feet(np.clip(along, 0.0, self.length))
        return rank(rho, z, feet.rho, feet.z, clipped), feet

    def out_of_reach(self, rho: Floats, z: Floats, rank: Floats) -> Bools:
        return np.zeros(rho.shape, dtype=np.bool_)

    def height(self, rho: Floats) -> Floats:
        (r0, z0), (tr, tz) = self.start, self.direction
        if tr <= 0:
            return np.full_like(rho, z0 + tz * self.length / 2)
        return z0 + (rho - r0) * (tz / tr)

    def trace(self, count: int, radius: float) -> Feet:
        tr = self.direction[0]
        reach = (radius - self.start[0]) / tr if tr > 0 else math.inf
        return self._feet(np.linspace(0.0, max(0.0, min(self.length, reach)), count))

    def _feet(self, along: Floats) -> Feet:
        (r0, z0), (tr, tz) = self.start, self.direction
        one = np.ones_like(along)
        return Feet(r0 + along * tr, z0 + along * tz, -tz * one, tr * one, 0.0 * one)


@dataclass(frozen=True)
class Arc:
    """A circular piece: centre (rho, z), radius [mm] and the normal's angles at its start and end [rad].

    A convex arc (a dome) turns from `first` up to a larger `last` with its normal away from the centre; a
    concave one (the rim fillet) from `first` down to a smaller `last` with its normal towards the centre.
    """

    centre: tuple[float, float]
    radius: float
    first: float
    last: float

    @property
    def side(self) -> float:
        """+1 for a convex arc, -1 for a concave one."""
        return 1.0 if self.last > self.first else -1.0

    @property
    def closed_form(self) -> bool:
        return True

    @property
    def span(self) -> tuple[float, float]:
        rho, side = self.centre[0], self.side
        ends = [rho + side * self.radius * math.sin(min(a, 0.5 * math.pi)) for a in (self.first, self.last)]
        return ends[0], ends[1]

    def nearest(self, rho: Floats, z: Floats) -> tuple[Floats, Feet]:
        low, high = sorted((self.first, self.last))
        (sl, cl), (sh, ch) = (_sine_cosine(a) for a in (low, high))
        wr, wz = self.side * (rho - self.centre[0]), self.side * (z - self.centre[1])
        length = np.hypot(wr, wz)
        at_centre = length == 0.0
        length = np.where(at_centre, 1.0, length)
        nr, nz = np.where(at_centre, sl, wr / length), np.where(at_centre, cl, wz / length)
        before, beyond = nr * cl - nz * sl < -ROUNDING, nz * sh - nr * ch < -ROUNDING
        clipped = before | beyond
        to_high = clipped & (nr * sh + nz * ch > nr * sl + nz * cl)
        to_low = clipped & ~to_high
        nr = np.where(to_high, sh, np.where(to_low, sl, nr))
        nz = np.where(to_high, ch, np.where(to_low, cl, nz))
        feet = self._feet(nr, nz)
        return rank(rho, z, feet.rho, feet.z, clipped), feet

    def out_of_reach(self, rho: Floats, z: Floats, rank: Floats) -> Bools:
        return np.zeros(rho.shape, dtype=np.bool_)

    def height(self, rho: Floats) -> Floats:
        legs = np.sqrt(np.maximum(0.0, self.radius**2 - (rho - self.centre[0]) ** 2))
        return self.centre[1] + self.side * legs

    def trace(self, count: int, radius: float) -> Feet:
        angles = np.linspace(self.first, self.last, count)
        return self._feet(np.sin(angles), np.cos(angles))

    def _feet(self, nr: Floats, nz: Floats) -> Feet:
        offset = self.side * self.radius
        return Feet(
            self.centre[0] + offset * nr,
            self.centre[1] + offset * nz,
            nr,
            nz,
            np.full_like(nr, -1.0 / offset),
        )


def _sine_cosine(angle: float) -> tuple[float, float]:
    return math.sin(angle), math.cos(angle)
