"""The line a wire follows between two crossings, as a polyline in element axes.

Element axes, Eq. (2.1): x along the wire, z along the surface normal, y = z × x. The wire starts at
O = (0, 0, 0) and ends at A = (s, 0, h).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError

if TYPE_CHECKING:
    from punchform.case import CosineLine, PointsLine, StraightLine

WHERE = "wire.centreline"

END_TOLERANCE = 1e-6
"""How far from x = 0, x = s and from the plane y = 0 an end may lie, as a part of the step."""


@dataclass(frozen=True, eq=False)
class Centreline:
    """A polyline of n straight chords from O to A.

    points (n + 1, 3) [mm] in element axes; points[0] is O = 0. Of a part of a wire that leaves its plane points[0] may
    lie beside O, and its last point beside A, by `aside` along y: O and A are fixed to it there.
    """

    points: Floats
    aside: float = 0.0

    @property
    def chords(self) -> Floats:
        """Vectors from point to point, (n, 3) [mm]."""
        chords: Floats = self.points[1:] - self.points[:-1]
        return chords

    @property
    def lengths(self) -> Floats:
        """Lengths of the chords, (n,) [mm]."""
        return np.asarray(np.linalg.norm(self.chords, axis=1), dtype=np.float64)

    @property
    def tangents(self) -> Floats:
        """Unit tangents of the chords, (n, 3)."""
        tangents: Floats = self.chords / self.lengths[:, None]
        return tangents

    @property
    def tip(self) -> Floats:
        """The free end A, (3,) [mm]."""
        return np.asarray(self.points[-1] - (0.0, self.aside, 0.0))

    @property
    def rise(self) -> float:
        """Height of A above O [mm]."""
        return float(self.points[-1, 2])


def cosine_line(height: float, step: float, *, segments: int) -> Centreline:
    """The woven wire of Eq. (2.3): x = s t, z = h (1 − cos πt)/2, in `segments` chords of equal t.

    height h and step s [mm]. Raises InputError for fewer than one segment.
    """
    if segments < 1:
        raise InputError.of(f"segments must be at least 1, not {segments}", where=f"{WHERE}.segments")
    t = np.linspace(0.0, 1.0, segments + 1)
    # sin² keeps the small heights next to O that 1 − cos would cancel away.
    return _frozen(np.column_stack([step * t, np.zeros_like(t), height * np.sin(np.pi * t / 2) ** 2]))


def straight_line(step: float) -> Centreline:
    """A straight wire of length s = step [mm]: one chord, since the polyline is exact."""
    return _frozen(np.array([[0.0, 0.0, 0.0], [step, 0.0, 0.0]]))


def line_through(points: Sequence[Sequence[float]], step: float) -> Centreline:
    """The polyline through given points: rows (x, z) or (x, y, z) [mm].

    It must start at x = 0 and end at x = step, with both ends at the same y, and must not fall: the
    element rises from O to A (the weave sign σ mirrors it where the wire goes down). The first point
    is moved to O = (0, 0, 0). Raises InputError, one problem at a time.
    """
    where = f"{WHERE}.points"
    columns = {len(row) for row in points}
    if len(points) < 2:
        raise InputError.of(f"a centreline needs at least 2 points, not {len(points)}", where=where)
    if columns not in ({2}, {3}):
        raise InputError.of(
            f"every point needs the same 2 or 3 numbers, found rows of {sorted(columns)}",
            where=where,
            hint="(x, z) for a crimp in the plane of the normal, (x, y, z) otherwise",
        )
    table = np.array([[float(value) for value in row] for row in points])
    if columns == {2}:
        table = np.insert(table, 1, 0.0, axis=1)
    if not np.isfinite(table).all():
        row = int(np.flatnonzero(~np.isfinite(table).all(axis=1))[0]) + 1
        raise InputError.of(f"point {row} is not a finite number", where=where)
    _check_ends(table, step, where)
    line = _frozen(table - table[0])
    short = np.flatnonzero(line.lengths <= 1e-12 * step)
    if short.size:
        raise InputError.of(
            f"points {short[0] + 1} and {short[0] + 2} are the same", where=where, hint="remove one of them"
        )
    return line


def centreline(line: CosineLine | StraightLine | PointsLine, step: float) -> Centreline:
    """The centreline that a case asks for, for one step [mm]. Raises InputError."""
    if line.kind == "cosine":
        return cosine_line(line.height, step, segments=line.segments)
    if line.kind == "straight":
        return straight_line(step)
    return line_through(line.points, step)


def _check_ends(table: Floats, step: float, where: str) -> None:
    """The two ends are where the crossings are. Raises InputError."""
    slack = END_TOLERANCE * step
    start, end = table[0], table[-1]
    if abs(start[0]) > slack:
        raise InputError.of(
            f"the first point must be at x = 0, not {start[0]:.6g} mm",
            where=where,
            hint="x is measured along the wire from the crossing at O",
        )
    if abs(end[0] - step) > slack:
        raise InputError.of(
            f"the last point must be at x = {step:.6g} mm, the step, not {end[0]:.6g} mm",
            where=where,
            hint="scale the x column to the step; with two different steps use kind = 'cosine' or 'straight'",
        )
    if abs(end[1] - start[1]) > slack:
        raise InputError.of(
            f"both ends must have the same y, not {start[1]:.6g} and {end[1]:.6g} mm",
            where=where,
            hint="crossings lie on a straight line of the flat grid",
        )
    if end[2] - start[2] < -slack:
        raise InputError.of(
            f"the wire must rise from the first point to the last, not fall by {start[2] - end[2]:.6g} mm",
            where=where,
            hint="change the sign of z; the weave makes every second wire fall",
        )


def _frozen(points: Floats) -> Centreline:
    points.setflags(write=False)
    return Centreline(points)
