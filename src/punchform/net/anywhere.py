"""Marching on any surface, Eq. (6.5): the kernel's method on whole anti-diagonals, by signed distances."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.net.fate import BEYOND, COLLAPSED, NO_INTERSECTION, PLACED
from punchform.punch import Surface

CLOSE = 1e-8
"""A Newton step in tan(θ/2) below this leaves an error below rounding."""
NEWTON_STEPS = 12
WIDEST = 0.6
"""Largest |tan(θ/2)| at which Newton is trusted to have found the root nearest to θ = 0."""
SCAN = np.repeat(0.05 * np.arange(57), 2)[1:] * np.resize([1.0, -1.0], 113)
BISECTIONS = 60


class Circles(NamedTuple):
    """Circles m + a cos θ + b sin θ, each (n, 3); θ = 0 is where the flat cell closes."""

    m: Floats
    a: Floats
    b: Floats

    def at(self, theta: Floats) -> Floats:
        """Points (n, 3) at angles (n,)."""
        return self.m + np.cos(theta)[:, None] * self.a + np.sin(theta)[:, None] * self.b

    def chosen(self, rows: Bools | Ints) -> Circles:
        """Some of the circles."""
        return Circles(self.m[rows], self.a[rows], self.b[rows])


def follow(surface: Surface, start: Floats, ahead: Floats, across: Floats, step: float, count: int) -> Floats:
    """Nodes (count, 3) at equal chords along a plane section; see `Ground.follow`."""
    nodes = np.full((count, 3), np.nan)
    nodes[0] = start
    a = ahead * step
    for n in range(1, count):
        nodes[n] = meet(surface, Circles(nodes[n - 1 : n], a[None], np.cross(a, across)[None]))[0]
        if np.isnan(nodes[n, 0]):
            break
        a = nodes[n] - nodes[n - 1]
        a *= step / np.linalg.norm(a)
    return nodes


def march(
    surface: Surface,
    x: Floats,
    shear: Floats,
    fate: Ints,
    wanted: Bools,
    steps: tuple[float, float],
    side: float,
) -> None:
    """Fill a quadrant; the arguments are those of `kernel.march`."""
    n, m = wanted.shape
    for diagonal in range(n + m - 3):
        i = np.arange(max(0, diagonal - m + 2), min(n - 1, diagonal + 1))
        j = diagonal - i
        asked = wanted[i + 1, j + 1]
        i, j = i[asked], j[asked]
        known = (fate[i, j] == PLACED) & (fate[i + 1, j] == PLACED) & (fate[i, j + 1] == PLACED)
        fate[i[~known] + 1, j[~known] + 1] = BEYOND
        i, j = i[known], j[known]
        C, A, B = x[i, j], x[i + 1, j], x[i, j + 1]
        circles, exists = _circles(C, A, B, steps, side)
        X = np.full(C.shape, np.nan)
        X[exists] = meet(surface, circles.chosen(exists))
        met = np.isfinite(X[:, 0])
        open_cell = met.copy()
        open_cell[met] = np.sum(normals(surface, X[met]) * circles.b[met], axis=1) > 0.0
        fate[i + 1, j + 1] = np.where(open_cell, PLACED, np.where(met, COLLAPSED, NO_INTERSECTION))
        x[i[open_cell] + 1, j[open_cell] + 1] = X[open_cell]
        shear[i[open_cell], j[open_cell]] = _shear(*(part[open_cell] for part in (C, A, X, B)))


def normals(surface: Surface, points: Floats) -> Floats:
    """Unit normals (n, 3) towards the grid's side."""
    gradient = surface.distance_gradient(points)[1]
    return np.asarray(gradient / np.linalg.norm(gradient, axis=1)[:, None])


def meet(surface: Surface, circles: Circles) -> Floats:
    """The points (n, 3) of the circles on the surface that are nearest to θ = 0; NaN where there is none."""
    tau = np.zeros(len(circles.m))
    found = np.full(circles.m.shape, np.nan)
    index = np.arange(len(tau))
    lost: list[Ints] = []
    for _ in range(NEWTON_STEPS):
        if not index.size:
            break
        here = circles.chosen(index)
        theta = 2.0 * np.arctan(tau[index])
        value, gradient = surface.distance_gradient(here.at(theta))
        turn = np.cos(theta)[:, None] * here.b - np.sin(theta)[:, None] * here.a
        slope = np.sum(gradient * turn, axis=1) * 2.0 / (1.0 + tau[index] ** 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = value / slope
        tau[index] -= step
        trusted = np.abs(tau[index]) < WIDEST
        done = trusted & (np.abs(step) < CLOSE)
        found[index[done]] = here.chosen(done).at(2.0 * np.arctan(tau[index[done]]))
        lost.append(index[~trusted])
        index = index[trusted & ~done]
    rest = np.concatenate((index, *lost)) if lost else index
    if rest.size:
        found[rest] = _search(surface, circles.chosen(rest))
    return found


def _search(surface: Surface, circles: Circles) -> Floats:
    """The same by scanning outwards from θ = 0 and bisecting."""
    count = len(circles.m)
    sign = np.where(surface.distance(circles.at(np.zeros(count))) > 0.0, 1.0, -1.0)
    near, far = np.full(count, np.nan), np.full(count, np.nan)
    waiting = np.arange(count)
    for theta in SCAN[1:]:
        value = surface.distance(circles.chosen(waiting).at(np.full(len(waiting), theta)))
        across = value * sign[waiting] <= 0.0
        far[waiting[across]] = theta
        near[waiting[across]] = theta - np.copysign(SCAN[1], theta)
        waiting = waiting[~across]
        if not waiting.size:
            break
    points = np.full((count, 3), np.nan)
    met = np.flatnonzero(np.isfinite(far))
    circles, sign, near, far = circles.chosen(met), sign[met], near[met], far[met]
    for _ in range(BISECTIONS if met.size else 0):
        middle = 0.5 * (near + far)
        before = surface.distance(circles.at(middle)) * sign > 0.0
        near, far = np.where(before, middle, near), np.where(before, far, middle)
    points[met] = circles.at(0.5 * (near + far))
    return points


def _circles(C: Floats, A: Floats, B: Floats, steps: tuple[float, float], side: float) -> tuple[Circles, Bools]:
    """Where the spheres about A and B meet, a pointing away from C, and which of these circles exist."""
    along, out = B - A, A - C
    square = np.sum(along * along, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 0.5 + 0.5 * (steps[1] - steps[0]) * (steps[1] + steps[0]) / square
        radius2 = steps[1] ** 2 - share**2 * square
        a = out - (np.sum(out * along, axis=1) / square)[:, None] * along
        length2 = np.sum(a * a, axis=1)
        exists = (radius2 > 0.0) & (length2 > 0.0)
        a = a * np.sqrt(np.where(exists, radius2 / length2, np.nan))[:, None]
        b = np.cross(a, along) * (side / np.sqrt(square))[:, None]
    return Circles(A + share[:, None] * along, a, b), exists


def _shear(C: Floats, A: Floats, X: Floats, B: Floats) -> Floats:
    """A right angle less the angle between the mid-lines of cells that are not folded."""
    p, q = X - C, A - B
    return np.asarray(np.arctan2(np.sum((p - q) * (p + q), axis=1), 2.0 * np.linalg.norm(np.cross(q, p), axis=1)))
