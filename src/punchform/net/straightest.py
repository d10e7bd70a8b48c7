"""Geodesics of a surface of revolution in tables, compiled, Eq. (6.6): the wires of a net with an origin of its own.

With the level F of the tables instead of a distance a geodesic obeys x'' = -(x'ᵀ ∇²F x') ∇F / |∇F|². It is carried
on by Dormand and Prince's steps of order 5, which become short where the curvature jumps: at the ends of a fillet.
"""

from __future__ import annotations

import math

import numpy as np

from punchform.arrays import Floats
from punchform.net.chain import CONIC, GRAPH, Chain
from punchform.net.compiled import compiled
from punchform.net.kernel import Vector, level

TOLERANCE = 1e-13
"""Error of one substep: of positions relative to the step, of directions as it is."""
SHORTEST = 1e-15
"""A substep this short, relative to the step, is taken whatever its error: the jump it crosses turns it by less."""
SUBSTEPS = 100_000
CHORD_STEPS = 50
POLISHING = 3
FURTHEST = 2.0
"""Arc in steps beyond which the wire turns back instead of reaching the next crossing; a half circle has π/2."""

STAGES = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
"""Dormand and Prince 1980: weights of the slopes before each stage; the last row is the step itself."""
ERROR = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@compiled
def geodesic(chain: Chain, nodes: Floats, ahead: Vector, step: float) -> None:
    """Fill nodes (n, 3) at equal chords along the geodesic that leaves nodes[0] in the unit direction `ahead`.

    Rows stay as they are from where the wire cannot go on.
    """
    here = np.array([nodes[0, 0], nodes[0, 1], nodes[0, 2], ahead[0], ahead[1], ahead[2]])
    for n in range(1, len(nodes)):
        if not _next_crossing(chain, here, nodes[n - 1], step):
            return
        for axis in range(3):
            nodes[n, axis] = here[axis]


@compiled
def walk(chain: Chain, here: Floats, length: float) -> None:
    """Move a point and its unit direction, here (6,), by an arc along its geodesic."""
    _advance(chain, here, length, length)
    _put_on_surface(chain, here)


@compiled
def _next_crossing(chain: Chain, here: Floats, before: Floats, step: float) -> bool:
    """Carry here (6,) on until it is one step away from the node before; False where it never is."""
    further, arc = step, 0.0
    for _ in range(CHORD_STEPS):
        arc += further
        if not abs(arc) <= FURTHEST * step:
            return False
        _advance(chain, here, further, step)
        further = _missing(here, before, step)
        if abs(further) <= 1e-10 * step:
            for _ in range(POLISHING):
                _put_on_surface(chain, here)
                further = _missing(here, before, step)
                for axis in range(3):
                    here[axis] += further * here[3 + axis]
            return True
    return False


@compiled
def _missing(here: Floats, before: Floats, step: float) -> float:
    """How much further along its direction a point is one step away from the node before, by one Newton step."""
    x, y, z = here[0] - before[0], here[1] - before[1], here[2] - before[2]
    length = math.sqrt(x * x + y * y + z * z)
    along: float = x * here[3] + y * here[4] + z * here[5]
    return (step - length) * length / along


@compiled
def _put_on_surface(chain: Chain, here: Floats) -> None:
    """Move a point along the normal onto the surface, and its direction into the tangent plane."""
    F, gx, gy, gz, _, _ = level(chain, here[0], here[1], here[2], 0, 0)
    square = gx * gx + gy * gy + gz * gz
    off, out = F / square, (here[3] * gx + here[4] * gy + here[5] * gz) / square
    tx, ty, tz = here[3] - out * gx, here[4] - out * gy, here[5] - out * gz
    length = math.sqrt(tx * tx + ty * ty + tz * tz)
    here[0], here[1], here[2] = here[0] - off * gx, here[1] - off * gy, here[2] - off * gz
    here[3], here[4], here[5] = tx / length, ty / length, tz / length


@compiled
def _advance(chain: Chain, here: Floats, length: float, scale: float) -> None:
    """Move a point and its direction, here (6,), by an arc of either sign; NaN where the error cannot be kept."""
    slopes, there = np.empty((7, 6)), np.empty(6)
    h, rest, k, p = length, length, 0, 0
    for _ in range(SUBSTEPS):
        if abs(h) >= abs(rest):
            h = rest
        for stage in range(7):
            for place in range(6):
                there[place] = here[place]
                for earlier in range(stage):
                    there[place] += h * STAGES[stage, earlier] * slopes[earlier, place]
            k, p = _slope(chain, there, slopes[stage], k, p)
        error = 0.0
        for place in range(6):
            off = 0.0
            for stage in range(7):
                off += h * ERROR[stage] * slopes[stage, place]
            error = max(error, abs(off) / scale if place < 3 else abs(off))
        if error <= TOLERANCE or abs(h) <= SHORTEST * scale:
            for place in range(6):
                here[place] = there[place]
            if h == rest:
                return
            rest -= h
        h *= min(5.0, max(0.2, 0.9 * (TOLERANCE / error) ** 0.2)) if error > 0.0 else 5.0
    here.fill(math.nan)


@compiled
def _slope(chain: Chain, here: Floats, slope: Floats, k: int, p: int) -> tuple[int, int]:
    """Derivative (6,) of position and direction by the arc; k and p as in `level`."""
    x, y, z = here[0], here[1], here[2]
    _, gx, gy, gz, k, p = level(chain, x, y, z, k, p)
    F_rr, F_zz = _second(chain, x, y, k, p)
    rho2 = x * x + y * y
    tx, ty, tz = here[3], here[4], here[5]
    if rho2 > 0.0:
        outwards, around = (x * tx + y * ty) ** 2 / rho2, (x * ty - y * tx) ** 2 / rho2
        circle = (gx * x + gy * y) / rho2
    else:
        outwards, around, circle = tx * tx + ty * ty, 0.0, 0.0
    pull = (F_rr * outwards + circle * around + F_zz * tz * tz) / (gx * gx + gy * gy + gz * gz)
    slope[0], slope[1], slope[2] = tx, ty, tz
    slope[3], slope[4], slope[5] = -pull * gx, -pull * gy, -pull * gz
    return k, p


@compiled
def _second(chain: Chain, x: float, y: float, k: int, p: int) -> tuple[float, float]:
    """Second derivatives of F by rho and by z."""
    size = chain.sizes[k]
    if chain.kinds[k] == CONIC:
        return size[4] / (size[2] * size[2]), size[4] / (size[3] * size[3])
    if chain.kinds[k] == GRAPH:
        t = (math.sqrt(x * x + y * y) - chain.origins[p]) * chain.scales[p]
        f, slope, bend = 0.0, 0.0, 0.0
        for c in chain.coefficients[p]:
            bend = bend * t + 2.0 * slope
            slope = slope * t + f
            f = f * t + c
        return -bend * chain.scales[p] ** 2, 0.0
    return 0.0, 0.0
