"""Marching on a surface of revolution, compiled, Eq. (6.5): about a tenth of a microsecond per node.

A new node X closes the cell of three known ones::

        B ------- X
       /         /        |X - A| = step 2,  |X - B| = step 1,  X on the surface,
      /         /         on the far side of AB from C
     C ------- A

The two spheres meet in a circle about the line AB. On it X = M + a cos θ + b sin θ, where θ = 0 closes the flat
parallelogram and C (at equal steps) lies at θ = π, so that the edges are right for every θ and the surface alone
decides: one equation F(θ) = 0, solved by Newton in tan(θ/2) from the θ of the cell before.
"""

from __future__ import annotations

import math

from punchform.arrays import Bools, Floats, Ints
from punchform.net.chain import CONIC, LINE, Chain
from punchform.net.compiled import compiled
from punchform.net.fate import BEYOND, COLLAPSED, NO_INTERSECTION, PLACED

Vector = tuple[float, float, float]

CLOSE = 1e-8
"""A Newton step in tan(θ/2) below this leaves an error below rounding."""
NEWTON_STEPS = 12
WIDEST = 0.6
"""Largest |tan(θ/2)| at which Newton is trusted to have found the root nearest to θ = 0."""
SCAN, SCAN_STEPS, BISECTIONS = 0.05, 112, 60


@compiled
def level(chain: Chain, x: float, y: float, z: float, k: int, p: int) -> tuple[float, float, float, float, int, int]:
    """F and its gradient at a point; k and p are the segment and the piece to look at first, returned as found."""
    rho = math.sqrt(x * x + y * y)
    last = chain.kinds.size - 1
    while k < last:
        joint = chain.joints[k]
        if (rho - joint[0]) * joint[2] + (z - joint[1]) * joint[3] <= 0.0:
            break
        k += 1
    while k > 0:
        joint = chain.joints[k - 1]
        if (rho - joint[0]) * joint[2] + (z - joint[1]) * joint[3] >= 0.0:
            break
        k -= 1
    kind, size = chain.kinds[k], chain.sizes[k]
    if kind == LINE:
        F = (rho - size[0]) * size[2] + (z - size[1]) * size[3]
        F_rho, F_z = size[2], size[3]
    elif kind == CONIC:
        u, w = (rho - size[0]) / size[2], (z - size[1]) / size[3]
        F = 0.5 * size[4] * (u * u + w * w - 1.0)
        F_rho, F_z = size[4] * u / size[2], size[4] * w / size[3]
    else:
        f, slope, p = graph(chain, rho, int(size[1]), int(size[2]), p)
        F, F_rho, F_z = z - size[0] - f, -slope, 1.0
    if rho > 0.0:
        F_rho /= rho
    return F, F_rho * x, F_rho * y, F_z, k, p


@compiled
def graph(chain: Chain, rho: float, first: int, last: int, p: int) -> tuple[float, float, int]:
    """f and its slope at rho, and the piece that was used."""
    p = min(max(p, first), last)
    while p < last and rho > chain.highs[p]:
        p += 1
    while p > first and rho < chain.lows[p]:
        p -= 1
    t = (rho - chain.origins[p]) * chain.scales[p]
    f, slope = 0.0, 0.0
    for c in chain.coefficients[p]:
        slope = slope * t + f
        f = f * t + c
    return f, slope * chain.scales[p], p


@compiled
def meet(
    chain: Chain, m: Vector, a: Vector, b: Vector, tau: float, k: int, p: int
) -> tuple[bool, Vector, Vector, float, int, int]:
    """The point of the circle m + a cos θ + b sin θ on the surface that is nearest to θ = 0.

    tau: where to begin, as tan(θ/2). Returns whether there is one, the point, the gradient of F there (to 1e-8),
    tan(θ/2), and the segment and piece.
    """
    for _ in range(NEWTON_STEPS):
        w = 1.0 / (1.0 + tau * tau)
        c, s = (1.0 - tau * tau) * w, 2.0 * tau * w
        F, gx, gy, gz, k, p = level(
            chain, m[0] + c * a[0] + s * b[0], m[1] + c * a[1] + s * b[1], m[2] + c * a[2] + s * b[2], k, p
        )
        slope = 2.0 * w * (c * (gx * b[0] + gy * b[1] + gz * b[2]) - s * (gx * a[0] + gy * a[1] + gz * a[2]))
        step = F / slope
        tau -= step
        if not abs(tau) < WIDEST:
            break
        if abs(step) < CLOSE:
            w = 1.0 / (1.0 + tau * tau)
            c, s = (1.0 - tau * tau) * w, 2.0 * tau * w
            x = (m[0] + c * a[0] + s * b[0], m[1] + c * a[1] + s * b[1], m[2] + c * a[2] + s * b[2])
            return True, x, (gx, gy, gz), tau, k, p
    return search(chain, m, a, b, k, p)


@compiled
def search(
    chain: Chain, m: Vector, a: Vector, b: Vector, k: int, p: int
) -> tuple[bool, Vector, Vector, float, int, int]:
    """The same by scanning outwards from θ = 0 and bisecting: slow, and sure where the surface bends sharply."""
    sign, near, far, middle = 0.0, 0.0, 0.0, 0.0
    bisections = 0
    g = (0.0, 0.0, 0.0)
    for n in range(SCAN_STEPS + BISECTIONS):
        # 0, +1, -1, +2, -2 ... times the step of the scan, and after a change of sign the bisection.
        reach = SCAN * ((n + 1) // 2)
        middle = 0.5 * (near + far) if bisections > 0 else math.copysign(reach, n % 2 - 0.5)
        c, s = math.cos(middle), math.sin(middle)
        x = (m[0] + c * a[0] + s * b[0], m[1] + c * a[1] + s * b[1], m[2] + c * a[2] + s * b[2])
        F, gx, gy, gz, k, p = level(chain, x[0], x[1], x[2], k, p)
        g = (gx, gy, gz)
        if n == 0:
            sign = 1.0 if F > 0.0 else -1.0
        elif bisections == 0:
            if F * sign <= 0.0:
                near, far = middle - math.copysign(SCAN, middle), middle
                bisections = 1
            elif n >= SCAN_STEPS:
                break
        else:
            if F * sign > 0.0:
                near = middle
            else:
                far = middle
            bisections += 1
            if bisections >= BISECTIONS:
                return True, x, g, math.tan(0.5 * middle), k, p
    return False, (math.nan, math.nan, math.nan), g, 0.0, k, p


@compiled
def follow(chain: Chain, nodes: Floats, ahead: Vector, across: Vector, step: float) -> None:
    """Fill nodes (n, 3) at equal chords along the section of the surface by a plane: a wire in a mirror plane.

    nodes[0] is where the wire begins, ahead its direction there, across the unit normal of the plane such that
    ahead × across points to the grid's side. Rows stay as they are from where the wire cannot go on.
    """
    k, p, tau = 0, 0, 0.0
    ax, ay, az = ahead[0] * step, ahead[1] * step, ahead[2] * step
    for n in range(1, len(nodes)):
        a = (ax, ay, az)
        b = (ay * across[2] - az * across[1], az * across[0] - ax * across[2], ax * across[1] - ay * across[0])
        m = (nodes[n - 1, 0], nodes[n - 1, 1], nodes[n - 1, 2])
        placed, x, _, tau, k, p = meet(chain, m, a, b, tau, k, p)
        if not placed:
            break
        nodes[n, 0], nodes[n, 1], nodes[n, 2] = x
        ax, ay, az = x[0] - m[0], x[1] - m[1], x[2] - m[2]
        # Scaled back to the step, so that rounding does not add up along the wire.
        stretch = step / math.sqrt(ax * ax + ay * ay + az * az)
        ax, ay, az = ax * stretch, ay * stretch, az * stretch


@compiled
def march(
    chain: Chain, x: Floats, shear: Floats, fate: Ints, wanted: Bools, steps: tuple[float, float], side: float
) -> None:
    """Fill the net between two wires that leave the same node: x[:, 0] along the first family, x[0] the second.

    x (n, m, 3), shear (n - 1, m - 1) [rad] and fate (n, m) are filled where `wanted` (n, m) asks for nodes; with
    every wanted node all before it are wanted. steps along the two families; side: +1 when the first wire, the
    second and the normal are right-handed, else -1.
    """
    n, m = wanted.shape
    k, p = 0, 0
    for i in range(n - 1):
        tau = 0.0
        for j in range(m - 1):
            if not wanted[i + 1, j + 1]:
                break
            if fate[i, j] != PLACED or fate[i + 1, j] != PLACED or fate[i, j + 1] != PLACED:
                fate[i + 1, j + 1] = BEYOND
                continue
            C, A, B = _row(x, i, j), _row(x, i + 1, j), _row(x, i, j + 1)
            found, M, a, b = _circle(C, A, B, steps, side)
            if not found:
                fate[i + 1, j + 1] = NO_INTERSECTION
                continue
            found, X, g, tau, k, p = meet(chain, M, a, b, tau, k, p)
            if not found:
                fate[i + 1, j + 1] = NO_INTERSECTION
                continue
            if g[0] * b[0] + g[1] * b[1] + g[2] * b[2] <= 0.0:
                fate[i + 1, j + 1] = COLLAPSED
                continue
            x[i + 1, j + 1, 0], x[i + 1, j + 1, 1], x[i + 1, j + 1, 2] = X
            fate[i + 1, j + 1] = PLACED
            shear[i, j] = _shear(C, A, X, B)


@compiled
def _row(x: Floats, i: int, j: int) -> Vector:
    return x[i, j, 0], x[i, j, 1], x[i, j, 2]


@compiled
def _circle(
    C: Vector, A: Vector, B: Vector, steps: tuple[float, float], side: float
) -> tuple[bool, Vector, Vector, Vector]:
    """The circle on which the two spheres meet: whether they do, its centre M and its axes a (outwards), b."""
    dx, dy, dz = B[0] - A[0], B[1] - A[1], B[2] - A[2]
    ex, ey, ez = A[0] - C[0], A[1] - C[1], A[2] - C[2]
    square = dx * dx + dy * dy + dz * dz
    share = 0.5 + 0.5 * (steps[1] - steps[0]) * (steps[1] + steps[0]) / square
    radius2 = steps[1] * steps[1] - share * share * square
    back = (ex * dx + ey * dy + ez * dz) / square
    ax, ay, az = ex - back * dx, ey - back * dy, ez - back * dz
    length2 = ax * ax + ay * ay + az * az
    M = (A[0] + share * dx, A[1] + share * dy, A[2] + share * dz)
    if not (radius2 > 0.0 and length2 > 0.0):
        return False, M, M, M
    stretch = math.sqrt(radius2 / length2)
    ax, ay, az = ax * stretch, ay * stretch, az * stretch
    turn = side / math.sqrt(square)
    b = ((ay * dz - az * dy) * turn, (az * dx - ax * dz) * turn, (ax * dy - ay * dx) * turn)
    return True, M, (ax, ay, az), b


@compiled
def _shear(C: Vector, A: Vector, X: Vector, B: Vector) -> float:
    """A right angle less the angle between the mid-lines of a cell that is not folded."""
    px, py, pz = X[0] - C[0], X[1] - C[1], X[2] - C[2]
    qx, qy, qz = A[0] - B[0], A[1] - B[1], A[2] - B[2]
    # With the diagonals p, q the mid-lines are p + q and p - q: their product p² - q², their cross product 2 q × p.
    cx, cy, cz = qy * pz - qz * py, qz * px - qx * pz, qx * py - qy * px
    dot = (px - qx) * (px + qx) + (py - qy) * (py + qy) + (pz - qz) * (pz + qz)
    return math.atan2(dot, 2.0 * math.sqrt(cx * cx + cy * cy + cz * cz))


@compiled
def normals(chain: Chain, points: Floats, found: Floats) -> None:
    """Fill the unit normals (n, 3), towards the grid's side, at points (n, 3) on the surface."""
    k, p = 0, 0
    for n in range(len(points)):
        _, gx, gy, gz, k, p = level(chain, points[n, 0], points[n, 1], points[n, 2], k, p)
        scale = 1.0 / math.sqrt(gx * gx + gy * gy + gz * gz)
        found[n, 0], found[n, 1], found[n, 2] = gx * scale, gy * scale, gz * scale
