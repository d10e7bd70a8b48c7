"""The flat pattern: which points of the flat blank land on a given line of the surface, such as the rim.

The line is where a level, known at the nodes (for the rim: rho - R0), is zero. Between the nodes the level is
bilinear, so that the answer is right to the second order in the step, like the net itself.
"""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats, Ints

BISECTIONS = 60


def outline(index: Ints, flat: Floats, level: Floats, directions: Floats) -> Floats:
    """Flat points (d, 2) [mm] along directions (d,) [rad] where the level first changes its sign.

    index (N, 2), flat (N, 2) [mm], level (N,): the nodes of a whole grid, NaN levels where it is not known.
    A row is NaN where the blank ends, or the net does, before the line is reached.
    """
    table, origin, step = _table(index, flat, level)
    along = np.column_stack((np.cos(directions), np.sin(directions)))

    def at(radius: Floats) -> Floats:
        return _bilinear(table, (radius[..., None] * along - origin) / step)

    reach = float(np.hypot(*flat.T).max())
    radii = np.linspace(0.0, reach, 2 + int(2 * reach / step.min()))
    levels = np.stack([at(np.full(len(along), radius)) for radius in radii])
    first_sign = np.sign(levels[0])
    changed = np.isfinite(levels) & (np.sign(levels) != first_sign)
    # A gap in what is known before the change hides where the line is.
    gone = np.logical_or.accumulate(np.isnan(levels), axis=0)
    crossed = changed & ~gone
    found = crossed.any(axis=0)
    n = np.argmax(crossed, axis=0)
    far, near = radii[n], radii[np.maximum(n - 1, 0)]
    for _ in range(BISECTIONS):
        middle = 0.5 * (near + far)
        before = np.sign(at(middle)) == first_sign
        near, far = np.where(before, middle, near), np.where(before, far, middle)
    radius = np.where(found, far, np.nan)
    return np.asarray(radius[:, None] * along)


def length_within(start: Ints, end: Ints, level: Floats, length: Floats) -> Floats:
    """How much of each element (M,) [mm] lies where the level is negative; NaN where it is not known.

    start, end (M,): its nodes; level (N,); length (M,) [mm].
    """
    a, b = level[start], level[end]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where((a < 0) == (b < 0), np.where(a < 0, 1.0, 0.0), np.minimum(a, b) / -np.abs(a - b))
    return np.where(np.isfinite(a) & np.isfinite(b), share * length, np.nan)


def interpolated(index: Ints, flat: Floats, values: Floats, points: Floats) -> Floats:
    """Values (N, ...) given at the nodes of a whole grid, at flat points (n, 2) [mm]; NaN where not known."""
    table, origin, step = _table(index, flat, values)
    return _bilinear(table, (points - origin) / step)


def _table(index: Ints, flat: Floats, values: Floats) -> tuple[Floats, Floats, Floats]:
    """The values over (i, j), NaN where there is no node, the flat point of its corner, and the steps, (2,)."""
    low, high = index.min(axis=0), index.max(axis=0)
    table = np.full((*(high - low + 1), *values.shape[1:]), np.nan)
    table[tuple((index - low).T)] = values
    step = np.ptp(flat, axis=0) / (high - low)
    return table, flat.min(axis=0), step


def _bilinear(table: Floats, at: Floats) -> Floats:
    """Values at places (n, 2) of the table; NaN outside and next to what is not known."""
    size = np.array(table.shape[:2])
    known = np.all((at >= 0) & (at <= size - 1), axis=1)
    at = np.where(known[:, None], at, 0.0)
    cell = np.clip(np.floor(at).astype(np.int64), 0, size - 2)
    shape = (-1,) + (1,) * (table.ndim - 2)
    u, v = ((at - cell)[:, axis].reshape(shape) for axis in (0, 1))
    corner = [[table[cell[:, 0] + a, cell[:, 1] + b] for b in (0, 1)] for a in (0, 1)]
    found = (1 - u) * ((1 - v) * corner[0][0] + v * corner[0][1]) + u * ((1 - v) * corner[1][0] + v * corner[1][1])
    found[~known] = np.nan
    return np.asarray(found)
