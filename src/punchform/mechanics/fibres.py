"""A yielding round wire seen as a bundle of fibres: the section law that the resultant law is judged by.

The bundle is that of the circle of unit diameter, y to the left and z up in the section::

        z            a fibre at (y, z) with the share a of the area:
      .-|-.          strain       epsilon + kappa_2 z - kappa_3 y      stress sigma along the wire
     /  o--\\--y      shear strain rho times the twist                  stress tau around the axis
     \\_____/         s = (N, M_2, M_3, T) = area sum of a (sigma, sigma z, -sigma y, rho tau)

Equations (12.2) and (12.3) of docs/theory.md. Sections enter scaled: strains e = (epsilon, d kappa_2, d kappa_3,
d twist) without unit, loads s / (A, A d, A d, A d) in MPa. A row of the past holds the dissipated work, the scaled
plastic strain of the section and, for every fibre, plastic strain, plastic shear, equivalent plastic strain and the
two back stresses [MPa].
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from numba import njit

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.mechanics.flow_curve import flow_under, left_of, radius

HEAD = 5
"""Numbers of a past row before those of the fibres."""
OF_FIBRE = 5
MEMORY = 24
"""Numbers that `flow` may be given to begin from: the scaled strain, load and flexibility of its last answer."""
MOST_STEPS = 200
CLOSE = 1e-13
"""Loads are met to this part of the stress in the section ..."""
MET = 1e-7
"""... and given up, with w = inf, where they are not met to this part."""


def past_size(fibres: int) -> int:
    """Length of a past row for so many fibres."""
    return HEAD + OF_FIBRE * fibres


def round_points(rings: int, sectors: int) -> Floats:
    """Fibres of the circle of unit diameter, (rings * sectors, 3): y, z and share of the area, Eq. (12.2).

    Gauss points in rho², equal sectors, the two axes in between: area and second moments are exact, so EA, EI and GJ
    are those of the round section. Raises InputError for no ring, or sectors that are not even and at least four.
    """
    if rings < 1 or sectors < 4 or sectors % 2:
        raise InputError.of(
            f"{rings} rings of {sectors} sectors are no section that bends alike both ways",
            hint="take at least 1 ring and an even number of sectors from 4 on; 4 rings of 16 are good for most uses",
        )
    place, weight = np.polynomial.legendre.leggauss(rings)
    rho = np.repeat(np.sqrt((1 + place) / 8), sectors)
    angle = np.tile(2 * pi / sectors * (np.arange(sectors) + 0.5), rings)
    share = np.repeat(weight / (2 * sectors), sectors)
    return np.column_stack([rho * np.cos(angle), rho * np.sin(angle), share])


@njit(cache=True, nogil=True, error_model="numpy")
def plastic(past):
    """Largest equivalent plastic strain among the fibres."""
    largest = 0.0
    for i in range(HEAD + 2, past.size, OF_FIBRE):
        largest = max(largest, past[i])
    return largest


@njit(cache=True, nogil=True, error_model="numpy")
def dissipated(past):
    """Work that has become heat so far, per original length [N]."""
    return past[0]


@njit(cache=True, nogil=True, error_model="numpy")
def trial_of_fibre(e, past, i, y, z, rho, young, shear):
    """Stresses (sigma, tau) of the fibre whose past begins at i if it did not flow, less its back stress [MPa]."""
    sigma = young * (e[0] + z * e[1] - y * e[2] - past[i]) - past[i + 3]
    return sigma, shear * (rho * e[3] - past[i + 1]) - past[i + 4]


@njit(cache=True, nogil=True, error_model="numpy")
def sweep(e, past, curve, kinematic, young, shear, points, carried, loads, K, lost):
    """Stresses of all fibres at the scaled strain e (4,): write the load that they carry and what flow has taken from
    it into carried and loads (4,), the tangent of the section into K (4, 4) and how far it is below the elastic one
    into lost (4, 4); return by how much the energy is below the elastic one [MPa], 0 where no fibre flows."""
    below = 0.0
    for k in range(4):
        carried[k] = loads[k] = 0.0
        for m in range(4):
            lost[k, m] = 0.0
    for p in range(points.shape[0]):
        y, z, share = points[p, 0], points[p, 1], points[p, 2]
        i = HEAD + OF_FIBRE * p
        rho = sqrt(y * y + z * z)
        sigma, tau = trial_of_fibre(e, past, i, y, z, rho, young, shear)
        added, q, (height, slope, work) = flow_under(sigma, tau, past[i + 2], curve, kinematic, young, shear)
        if added == 0.0:
            add_stress(share, y, z, rho, sigma + past[i + 3], tau + past[i + 4], carried)
            continue
        left, around = left_of(sigma, tau, added, q, young, shear)
        add_stress(share, y, z, rho, left + past[i + 3], around + past[i + 4], carried)
        eps, gamma = added * left / q, 3.0 * added * around / q
        size = q - height
        below += share * (sigma * eps + tau * gamma - 0.5 * (young * eps * eps + shear * gamma * gamma))
        below -= share * (size * added + work)
        # Compliance of the fibre's flow, Eq. (12.3), and what is left of its stiffness.
        m_1, m_2, turn = left / q, 3.0 * around / q, added / q
        f_11 = m_1 * m_1 / slope + turn * (1.0 - m_1 * m_1)
        f_12 = m_1 * m_2 * (1.0 / slope - turn)
        f_22 = m_2 * m_2 / slope + turn * (3.0 - m_2 * m_2)
        c_11, c_22 = 1.0 / young + f_11, 1.0 / shear + f_22
        det = c_11 * c_22 - f_12 * f_12
        l_11, l_12, l_22 = young - c_22 / det, f_12 / det, shear - c_11 / det
        add_stress(share, y, z, rho, young * eps, shear * gamma, loads)
        add_stiffness(share, y, z, rho, l_11, l_12, l_22, lost)
    for k in range(4):
        for m in range(4):
            K[k, m] = -lost[k, m]
    add_elastic(young, shear, K)
    return below


@njit(cache=True, nogil=True, error_model="numpy")
def add_stress(share, y, z, rho, sigma, tau, loads):
    """Add the stresses of a fibre to the scaled loads (4,)."""
    loads[0] += share * sigma
    loads[1] += share * z * sigma
    loads[2] -= share * y * sigma
    loads[3] += share * rho * tau


@njit(cache=True, nogil=True, error_model="numpy")
def add_stiffness(share, y, z, rho, l_11, l_12, l_22, K):
    """Add the symmetric stiffness (l_11, l_12, l_22) of a fibre to that of the scaled section K (4, 4)."""
    row = (1.0, z, -y)
    for k in range(3):
        for m in range(3):
            K[k, m] += share * row[k] * row[m] * l_11
        K[k, 3] += share * row[k] * rho * l_12
        K[3, k] += share * row[k] * rho * l_12
    K[3, 3] += share * rho * rho * l_22


@njit(cache=True, nogil=True, error_model="numpy")
def add_elastic(young, shear, K):
    """Add the elastic stiffness of the scaled section, Eq. (12.2), to K (4, 4)."""
    K[0, 0] += young
    K[1, 1] += young / 16.0
    K[2, 2] += young / 16.0
    K[3, 3] += shear / 8.0


@njit(cache=True, nogil=True, error_model="numpy")
def solve(K, right, x):
    """Write the solution of the positive definite K x = right into x (4,); K becomes its Cholesky factor."""
    for k in range(4):
        for m in range(k + 1):
            total = K[k, m]
            for n in range(m):
                total -= K[k, n] * K[m, n]
            K[k, m] = sqrt(total) if k == m else total / K[m, m]
    solve_again(K, right, x)


@njit(cache=True, nogil=True, error_model="numpy")
def solve_again(K, right, x):
    """The same with the factor that `solve` has left in K."""
    for k in range(4):
        total = right[k]
        for n in range(k):
            total -= K[k, n] * x[n]
        x[k] = total / K[k, k]
    for k in range(3, -1, -1):
        total = x[k]
        for n in range(k + 1, 4):
            total -= K[n, k] * x[n]
        x[k] = total / K[k, k]


@njit(cache=True, nogil=True, error_model="numpy")
def missing(load, carried, r):
    """Write the load less what the fibres carry into r (4,); return its size, moments as stress at the edge."""
    size = 0.0
    for k in range(4):
        r[k] = load[k] - carried[k]
        size = max(size, abs(r[k]) * (1.0 if k == 0 else 8.0))
    return size


@njit(cache=True, nogil=True, error_model="numpy")
def foretold(load, past, stiff, memory, e):
    """Write the strain e (4,) that the last answer in memory (24,) foretells, or the elastic one where that is NaN."""
    for k in range(4):
        if np.isnan(memory[0]):
            e[k] = past[1 + k] + load[k] / stiff[k]
        else:
            e[k] = memory[k]
            for m in range(4):
                e[k] += memory[8 + 4 * k + m] * (load[m] - memory[4 + m])


@njit(cache=True, nogil=True, error_model="numpy")
def strain_under(load, past, curve, kinematic, young, shear, points, memory, e, loads, K, lost):
    """Write the scaled strain e (4,) under which the fibres carry the scaled load (4,) [MPa], Eq. (12.3), and what
    `sweep` leaves in loads, K and lost; return what it returns.

    Newton on the convex difference of the energy and the load's work, from what is `foretold`. Where a step goes too
    far, the slope of that difference along it has turned, and a zero of the slope is looked for in between.
    """
    stiff = (young, young / 16.0, young / 16.0, shear / 8.0)
    r, step, here, carried = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    size = curve[0, 1]
    foretold(load, past, stiff, memory, e)
    for k in range(4):
        size = max(size, abs(load[k]))
    below = sweep(e, past, curve, kinematic, young, shear, points, carried, loads, K, lost)
    gap, least = missing(load, carried, r), np.inf
    for _ in range(MOST_STEPS):
        if gap <= CLOSE * size or (gap <= MET * size and gap >= 0.5 * least):
            break
        least = gap
        solve(K, r, step)
        descent = r[0] * step[0] + r[1] * step[1] + r[2] * step[2] + r[3] * step[3]
        part = 1.0
        for k in range(4):
            here[k] = e[k]
        for _ in range(30):
            for k in range(4):
                e[k] = here[k] + part * step[k]
            below = sweep(e, past, curve, kinematic, young, shear, points, carried, loads, K, lost)
            gap = missing(load, carried, r)
            slope = r[0] * step[0] + r[1] * step[1] + r[2] * step[2] + r[3] * step[3]
            if slope >= -0.5 * descent:
                break
            part *= max(descent / (descent - slope), 0.1)
    # Kinks of a curve can leave the last digits; a load that is not met at all must not pass for an answer.
    return below if gap <= MET * size and np.isfinite(below) else np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def enter(s, wire, lam, load):
    """Write the scaled load (4,) [MPa] of s = (N, M_2, M_3, T) and return the area and the diameter as stretched."""
    area, diameter = 0.25 * pi * wire[2] * wire[2] / lam, wire[2] / sqrt(lam)
    load[0] = s[0] / area
    for k in range(1, 4):
        load[k] = s[k] / (area * diameter)
    return area, diameter


@njit(cache=True, nogil=True, error_model="numpy")
def flow(s, past, curve, kinematic, wire, lam, points, memory, dp, f):
    """Plastic section strain added since the past row under the load s, by fibres, Eqs. (12.2) and (12.3).

    s (4,) = N, M_2, M_3, T [N, N mm]; past (past_size,); curve (K, 2) as in `flow_curve`; wire (3,) = E, G [MPa] and
    diameter [mm] before stretching by lam; points (n, 3) of `round_points`; memory (24,): of a call nearby, or NaN,
    overwritten. Writes dp (4,) = strain, two curvatures and twist [-, 1/mm] per current length and f = d dp / d s
    (4, 4); returns w [N] with dw/ds = dp. A load that is too great for any answer gives w = inf.
    """
    young, shear = wire[0], wire[1]
    load, e, loads = np.empty(4), np.empty(4), np.empty(4)
    K, lost = np.empty((4, 4)), np.empty((4, 4))
    stiff = (young, young / 16.0, young / 16.0, shear / 8.0)
    area, diameter = enter(s, wire, lam, load)
    below = strain_under(load, past, curve, kinematic, young, shear, points, memory, e, loads, K, lost)
    for k in range(4):
        dp[k], memory[k], memory[4 + k] = 0.0, e[k], load[k]
        for m in range(4):
            f[k, m], memory[8 + 4 * k + m] = 0.0, 1.0 / stiff[k] if k == m else 0.0
    if below == 0.0 or below == np.inf:
        return below
    for m in range(4):
        dp[m] = loads[m] / stiff[m]
        below -= 0.5 * loads[m] * dp[m]
        for k in range(4):
            load[k] = lost[k, m] / stiff[m]
        if m == 0:
            solve(K, load, e)
        else:
            solve_again(K, load, e)
        for k in range(4):
            f[k, m] = e[k]
            memory[8 + 4 * k + m] += e[k]
    for k in range(4):
        by = 1.0 if k == 0 else 1.0 / diameter
        dp[k] *= by
        for m in range(k + 1):
            per = area if m == 0 else area * diameter
            f[k, m] = 0.5 * (f[k, m] + f[m, k]) * by / per
            f[m, k] = f[k, m]
    return max(area * below, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def stays(s, past, curve, kinematic, wire, lam, points):
    """Whether no fibre flows under the load s; arguments as of `flow`."""
    young, shear = wire[0], wire[1]
    area = 0.25 * pi * wire[2] * wire[2] / lam
    stiff = area * young * wire[2] / (16.0 * sqrt(lam))
    e = (
        past[1] + s[0] / (area * young),
        past[2] + s[1] / stiff,
        past[3] + s[2] / stiff,
        past[4] + s[3] * young / (2.0 * stiff * shear),
    )
    for p in range(points.shape[0]):
        y, z = points[p, 0], points[p, 1]
        i = HEAD + OF_FIBRE * p
        sigma, tau = trial_of_fibre(e, past, i, y, z, sqrt(y * y + z * z), young, shear)
        size = radius(curve, kinematic, past[i + 2])
        if sigma * sigma + 3.0 * tau * tau > size * size:
            return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def settle(s, past, curve, kinematic, wire, lam, points, memory, after):
    """Write the past row that follows when the load s is accepted into after (past_size,); arguments as of `flow`."""
    young, shear = wire[0], wire[1]
    load, e, loads = np.empty(4), np.empty(4), np.empty(4)
    K, lost = np.empty((4, 4)), np.empty((4, 4))
    enter(s, wire, lam, load)
    strain_under(load, past, curve, kinematic, young, shear, points, memory, e, loads, K, lost)
    after[:] = past
    stiff = (young, young / 16.0, young / 16.0, shear / 8.0)
    for k in range(4):
        after[1 + k] += loads[k] / stiff[k]
    heat = 0.0
    for p in range(points.shape[0]):
        y, z = points[p, 0], points[p, 1]
        i = HEAD + OF_FIBRE * p
        sigma, tau = trial_of_fibre(e, past, i, y, z, sqrt(y * y + z * z), young, shear)
        added, q, risen = flow_under(sigma, tau, past[i + 2], curve, kinematic, young, shear)
        if added == 0.0:
            continue
        left, around = left_of(sigma, tau, added, q, young, shear)
        moved = kinematic * risen[0]
        after[i] += added * left / q
        after[i + 1] += 3.0 * added * around / q
        after[i + 2] += added
        after[i + 3] += moved * left / q
        after[i + 4] += moved * around / q
        heat += points[p, 2] * added * (q - moved)
    after[0] += 0.25 * pi * wire[2] * wire[2] * heat
