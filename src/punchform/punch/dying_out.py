"""One axis of a correction: its points, its cells, and how it ends, Eq. (8.22)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.errors import InputError

FEWEST = 4
"""Points along an axis of a C² cubic spline that is worth one."""
NIL = 1e-6
"""What is nil at the edge of a correction [mm]: a nanometre."""
SAME = 1e-9
"""Coordinates that differ by less are the same [mm]."""


class Cells(NamedTuple):
    """Where numbers lie along an axis: cell (n,), place in it from its start [mm] (n,), sign (n,) by which an odd
    derivative is turned in the mirrored half, 0 on the mirror line."""

    number: Ints
    place: Floats
    sign: Floats


class Window(NamedTuple):
    """A factor (n,) and its first and second derivatives [1/mm, 1/mm²]."""

    value: Floats
    first: Floats
    second: Floats


@dataclass(frozen=True, eq=False)
class Axis:
    """Increasing coordinates (n,) [mm] of a correction; one that starts at 0 is mirrored there."""

    points: Floats

    @property
    def mirrored(self) -> bool:
        """Whether the correction goes on evenly on the other side of 0."""
        return bool(abs(self.points[0]) <= SAME)

    def cells(self, x: Floats) -> Cells:
        """The cells of x (n,); beyond the ends the end itself."""
        sign = np.sign(x) if self.mirrored else np.ones_like(x)
        inside = np.clip(sign * x, self.points[0], self.points[-1])
        number = np.clip(np.searchsorted(self.points, inside, side="right") - 1, 0, self.points.size - 2)
        return Cells(number, inside - self.points[number], sign)

    def window(self, x: Floats) -> Window:
        """1 between the outermost cells, 0 beyond the ends, and C² in between."""
        if self.mirrored:
            end = self._ending(np.abs(x))
            return Window(end.value, np.sign(x) * end.first, end.second)
        first = _fade((x - self.points[0]) / (self.points[1] - self.points[0]), self.points[1] - self.points[0])
        last = self._ending(x)
        return Window(
            first.value * last.value,
            first.first * last.value + first.value * last.first,
            first.second * last.value + 2.0 * first.first * last.first + first.value * last.second,
        )

    def _ending(self, x: Floats) -> Window:
        length = self.points[-1] - self.points[-2]
        return _fade((self.points[-1] - x) / length, -length)


def axis(name: str, points: Floats, *, where: str) -> Axis:
    """The axis of coordinates (n,) [mm]. Raises InputError when there are too few or they do not increase."""
    points = np.asarray(points, dtype=np.float64)
    if points.size < FEWEST:
        raise InputError.of(
            f"{points.size} different {name} are too few for a smooth correction; give at least {FEWEST}", where=where
        )
    if not np.isfinite(points).all() or (np.diff(points) <= SAME).any():
        raise InputError.of(f"{name} must be finite and increase from point to point", where=where)
    return Axis(points)


def _fade(share: Floats, length: float) -> Window:
    """The quintic that goes from 0 at share = 0 to 1 at share = 1, both with no slope and no bend; dx = length dt."""
    t = np.clip(share, 0.0, 1.0)
    u = 1.0 - t
    return Window(
        t**3 * (10.0 - 15.0 * t + 6.0 * t * t), 30.0 * (t * u) ** 2 / length, 60.0 * t * u * (u - t) / length**2
    )
