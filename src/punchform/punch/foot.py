"""The foot of a point on a parametrised curve: the parameter where the distance is least.

The foot P(t) of a point x makes phi(t) = (P - x) . P' vanish. A Newton iteration inside a bracket with a sign
change, started from a guess, finds a foot; the reach of the curve (the radius below which the nearest point
is unique, Federer's formula) says whether it is *the* foot. Where it does not say so, the start is the
nearest of a row of samples; many crests away from a wavy profile, where several are about equally near, that
may pick the second best of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Bools, Floats, Ints

if TYPE_CHECKING:
    from punchform.punch.curves import Curve, Jet

SAMPLES = 257
SMALL_STEP = 1e-9
"""A Newton step this small, relative to the radius of curvature, leaves an error below rounding."""
STEP_LIMIT = 100
BLOCK = 8192


@dataclass(frozen=True)
class Samples:
    """A row of points of a curve and what follows from it.

    Attributes: t, rho, z (m,); extent and least radius of curvature [mm] of the curve; reach [mm] above and
    below it (half of what the samples say: a margin for what lies between them);
    box (rho_min, rho_max, z_min, z_max) [mm].
    """

    t: Floats
    rho: Floats
    z: Floats
    extent: float
    radius: float
    reach: tuple[float, float]
    box: tuple[float, float, float, float]

    def outside(self, rho: Floats, z: Floats, rank: Floats) -> Bools:
        """Where the square of the distance to the box exceeds the rank (n,)."""
        r0, r1, z0, z1 = self.box
        along = np.maximum(0.0, np.maximum(r0 - rho, rho - r1))
        across = np.maximum(0.0, np.maximum(z0 - z, z - z1))
        outside: Bools = along**2 + across**2 > rank
        return outside


def sampled(curve: Curve, *, extra: tuple[float, ...] = (), unique_foot: bool = False) -> Samples:
    """Samples of a curve, at equal steps of its parameter and at `extra` parameters."""
    inner = [t for t in extra if 0.0 < t < curve.end]
    t = np.union1d(np.linspace(0.0, curve.end, SAMPLES), np.array(inner, dtype=np.float64))
    p = curve.at(t)
    extent = float(np.max(p.rho) + np.ptp(p.z))
    margin = 0.01 * extent
    box = (
        float(p.rho.min()),
        float(p.rho.max()) + margin,
        float(p.z.min()) - margin,
        float(p.z.max()) + margin,
    )
    reach = (np.inf, np.inf) if unique_foot else _reach(p)
    return Samples(t, p.rho, p.z, extent, min(extent, _least_radius(p)), reach, box)


def nearest_parameter(curve: Curve, rho: Floats, z: Floats) -> tuple[Floats, Bools]:
    """Parameter of the nearest point for every (rho, z), and where it is the end with the point beyond it."""
    samples = curve.samples
    first, last = np.zeros_like(rho), np.full_like(rho, curve.end)
    clipped = _beyond_end(curve, rho, z, samples)
    t = np.where(clipped, last, curve.guess(rho, z))
    inside = np.flatnonzero(~clipped)
    t[inside] = _newton(curve, rho[inside], z[inside], t[inside], first[inside], last[inside])
    doubtful = _doubtful(curve, rho, z, t, clipped)
    if doubtful.size:
        t[doubtful], clipped[doubtful] = _search(curve, rho[doubtful], z[doubtful])
    return t, clipped


def _beyond_end(curve: Curve, rho: Floats, z: Floats, samples: Samples) -> Bools:
    """Where phi < 0 at the end, by more than rounding: the distance still falls there."""
    end = curve.at(np.array([curve.end]))
    speed = float(np.hypot(end.rho1, end.z1)[0])
    phi = (end.rho[0] - rho) * _first(end.rho1) + (end.z[0] - z) * end.z1[0]
    beyond: Bools = phi < -1e-12 * speed * samples.extent
    return beyond


def _newton(curve: Curve, rho: Floats, z: Floats, t: Floats, low: Floats, high: Floats) -> Floats:
    """Roots of phi in brackets [low, high] with phi(low) <= 0 <= phi(high), all (n,)."""
    found = t.copy()
    index = np.arange(t.size)
    small = SMALL_STEP * curve.samples.radius
    for count in range(STEP_LIMIT):
        if not index.size:
            break
        p = curve.at(t)
        dr, dz = p.rho - rho, p.z - z
        speed2 = p.rho1 * p.rho1 + p.z1 * p.z1
        phi = dr * p.rho1 + dz * p.z1
        slope = speed2 + dr * p.rho2 + dz * p.z2
        above = phi > 0
        high, low = np.where(above, t, high), np.where(above, low, t)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            new = t - phi / slope
        # Bisecting now and then bounds the count where Newton only creeps.
        halve = np.ones(t.size, np.bool_) if count > 8 and count % 3 == 0 else ~((new >= low) & (new <= high))
        halve |= slope <= 0
        new = np.where(halve, 0.5 * (low + high), new)
        far = np.abs(new - t) * np.sqrt(speed2) > small
        if far.all():
            t = new
            continue
        found[index] = new
        index = index[far]
        t, low, high, rho, z = (part[far] for part in (new, low, high, rho, z))
    found[index] = t
    return found


def _doubtful(curve: Curve, rho: Floats, z: Floats, t: Floats, clipped: Bools) -> Ints:
    """Where the foot found lies beyond the reach, so that another one may be nearer."""
    above, below = curve.samples.reach
    if np.isinf(above) and np.isinf(below):
        return np.empty(0, dtype=np.int64)
    p = curve.at(t)
    dr, dz = rho - p.rho, z - p.z
    on_top = dz * p.rho1 - dr * p.z1 > 0
    limit = np.where(clipped, min(above, below), np.where(on_top, above, below))
    return np.flatnonzero(dr * dr + dz * dz > limit * limit)


def _search(curve: Curve, rho: Floats, z: Floats) -> tuple[Floats, Bools]:
    """Feet by way of the nearest sample; a foot at the end counts as clipped."""
    samples = curve.samples
    nearest = np.empty(rho.size, dtype=np.int64)
    for start in range(0, rho.size, BLOCK):
        part = slice(start, start + BLOCK)
        square = (samples.rho - rho[part, None]) ** 2 + (samples.z - z[part, None]) ** 2
        nearest[part] = np.argmin(square, axis=1)
    last = samples.t.size - 1
    low, high = samples.t[np.maximum(nearest - 1, 0)], samples.t[np.minimum(nearest + 1, last)]
    clipped = (nearest == last) & _beyond_end(curve, rho, z, samples)
    t = np.where(clipped, curve.end, samples.t[nearest])
    inside = np.flatnonzero(~clipped)
    t[inside] = _newton(curve, rho[inside], z[inside], t[inside], low[inside], high[inside])
    return t, clipped


def _reach(p: Jet) -> tuple[float, float]:
    """Half of the reach above and below: min over pairs of |q - p|^2 / (2 N_p . (q - p))."""
    ones = np.ones_like(p.rho)
    tr, tz = p.rho1 * ones, p.z1 * ones
    speed = np.hypot(tr, tz)
    dr, dz = p.rho[None, :] - p.rho[:, None], p.z[None, :] - p.z[:, None]
    offset = (dz * tr[:, None] - dr * tz[:, None]) / speed[:, None]
    square = dr * dr + dz * dz
    with np.errstate(divide="ignore", invalid="ignore"):
        ball = np.where(offset != 0, square / (2 * np.abs(offset)), np.inf)
    above = float(np.min(ball, where=offset > 0, initial=np.inf))
    below = float(np.min(ball, where=offset < 0, initial=np.inf))
    return 0.5 * above, 0.5 * below


def _least_radius(p: Jet) -> float:
    speed = np.hypot(p.rho1, p.z1)
    curvature = float(np.max(np.abs(p.rho1 * p.z2 - p.z1 * p.rho2) / speed**3))
    return 1.0 / curvature if curvature > 0 else np.inf


def _first(value: Floats | float) -> float:
    return float(np.ravel(value)[0])
