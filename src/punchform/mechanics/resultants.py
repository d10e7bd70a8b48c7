"""A yielding round wire by its stress resultants: the quick section law, Eqs. (12.4) to (12.8) of docs/theory.md.

Loads enter as the stresses that they would be in a section that has yielded throughout,

    n = N / A,    m = 6 M / d³,    t = 12 sqrt(3) T / pi d³    [MPa],

strains as what these work on: (epsilon, 2 d kappa / 3 pi, d twist / 3 sqrt(3)). Five surfaces yield in series, so
that their plastic strains add and none knows of the others::

        m
        | . - - .         the sphere n² + m² + t² = q²: the section yields throughout
     m_4|-.       ` .
     m_1|---._         .
        |      ` - ._   .  the lenses n² + q mu = q², mu² = (m/m_j)² + (t/t_j)²: it yields in part;
        '-----------`-.'-- n    they end in a tip, where bending costs next to nothing

The flow of a lens also moves its centre in bending and twist (linear kinematic hardening), which makes the curve of
the moment over the curvature. A row of the past holds the dissipated work, the strain at the edge and, for every
surface, equivalent plastic strain and back stress (n, m_2, m_3, t) [MPa].
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from numba import njit

from punchform.mechanics.flow_curve import ROUNDING, piece, radius, radius_on, rise, rise_from, strain_for, strain_from

HEAD = 2
"""Numbers of a past row before those of the surfaces."""
OF_SURFACE = 5
LENSES = 4
PAST = HEAD + OF_SURFACE * (LENSES + 1)
"""Length of a past row."""

BENDING = (0.660, 0.776, 0.863, 0.936)
"""m_j of Eq. (12.6): part of the plastic moment at which a lens begins to yield."""
TWISTING = (0.774, 0.839, 0.903, 0.961)
"""t_j of Eq. (12.6), of the plastic torque."""
SOFTNESS = (0.515, 1.297, 3.711, 23.6)
"""a_j of Eq. (12.6): how much a lens adds to the bending compliance 1/EI once it yields."""
PART = 0.07
"""Part that each lens has in the plastic elongation; the rest, Eq. (12.7), is the sphere's."""
BENT = 2.0 / (3.0 * pi)
TWISTED = 1.0 / (3.0 * sqrt(3.0))
ELASTIC = 64.0 / (9.0 * pi * pi)
"""Elastic compliance in bending, times E, of the loads and strains above."""


@njit(cache=True, nogil=True, error_model="numpy")
def plastic(past):
    """Equivalent plastic strain at the edge of the section, summed over the strokes, Eq. (12.8)."""
    return past[1]


@njit(cache=True, nogil=True, error_model="numpy")
def dissipated(past):
    """Work that has become heat so far, per original length [N]."""
    return past[0]


@njit(cache=True, nogil=True, error_model="numpy")
def scales(wire, lam):
    """Area [mm²] of the stretched wire and by what N / A, M / A and T / A are multiplied to become n, m and t."""
    diameter = wire[2] / sqrt(lam)
    bending, twisting = 1.0 / (BENT * diameter), 1.0 / (TWISTED * diameter)
    return 0.25 * pi * diameter * diameter, (1.0, bending, bending, twisting)


@njit(cache=True, nogil=True, error_model="numpy")
def beyond(s, past, first, factor, weight):
    """The load less the back stress (weight: 1/m_j, 1/t_j): n and the vector y of the lens, as a tuple (4,)."""
    return (
        s[0] * factor[0] - past[first + 1],
        (s[1] * factor[1] - past[first + 2]) * weight[0],
        (s[2] * factor[2] - past[first + 3]) * weight[0],
        (s[3] * factor[3] - past[first + 4]) * weight[1],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def holds(square, mu, size):
    """Whether a lens of this size holds the load nu² = square and mu, Eq. (12.6)."""
    return square + size * mu <= size * size


@njit(cache=True, nogil=True, error_model="numpy")
def flow_of_lens(nu, mu, alpha, curve, kinematic, eta):
    """Implicit flow of a lens, Eq. (12.6), under nu = |n| and mu = |y|, less the back stress [MPa].

    Returns the flow (0 where none), the size q of the lens after it and before, the slope of q over the flow [MPa], the
    flow v in bending and twist, whether the load has come to the tip, and the work of the rise of q [MPa].
    """
    square, first = nu * nu, curve[0, 1]
    # A lens only becomes larger: most need no search of the curve.
    if holds(square, mu, first):
        return 0.0, first, first, 0.0, 0.0, False, 0.0
    k = piece(curve, alpha)
    size = radius_on(curve, k, kinematic, alpha)
    if holds(square, mu, size):
        return 0.0, size, size, 0.0, 0.0, False, 0.0
    low = 0.0
    if nu > size:
        strain = strain_from(curve, k, alpha, 0.0, nu - size)
        low = PART * strain
        if mu <= 0.5 * eta * low:
            _, slope, work = rise_from(curve, k, alpha, strain)
            return low, nu, size, slope / PART, mu / eta, True, PART * work
    added, q, slope, v, work = flow_off_tip(square, mu, alpha, curve, k, size, eta, low)
    return added, q, size, slope, v, False, work


@njit(cache=True, nogil=True, error_model="numpy")
def flow_off_tip(square, mu, alpha, curve, k, size, eta, low):
    """Solve Eq. (12.6) away from the tip, by Newton between a flow `low` that is too little and 2 mu / eta: the flow,
    the size q, its slope, the flow in bending and twist, and the work of the rise of q [MPa]."""
    high = 2.0 * mu / eta
    # As if q did not grow: a lens softens far more by eta than by the curve.
    share = size * size / (size * size + square)
    added = min(max(low, (mu + square / size - size) / (eta * share)), high)
    q, slope, work = size, 0.0, 0.0
    for _ in range(100):
        height, slope, work = rise_from(curve, k, alpha, added / PART)
        q, slope = size + height, slope / PART
        across = square / q
        share = q / (q + across)
        moved = eta * added * share
        excess = q - across + moved - mu
        if excess > 0.0:
            high = added
        else:
            low = added
        rate = slope * (1.0 + across / q) + eta * share + 2.0 * moved * slope * share * across / (q * q)
        following = added - excess / rate
        if not low <= following <= high:
            following = 0.5 * (low + high)
        # What is left of the excess is rounding, of which a small flow would never become free.
        if abs(following - added) <= 1e-15 * following or abs(excess) <= 0.5 * ROUNDING * (q + across + mu):
            break
        added = following
    return added, q, slope, added * share, PART * work


@njit(cache=True, nogil=True, error_model="numpy")
def rates_of_lens(nu, added, q, slope, eta):
    """Second derivatives of the potential of a lens away from its tip, by nu and mu: w_nu_nu, w_nu_mu, w_mu_mu."""
    square, whole = nu * nu, q * q + nu * nu
    along, across = 2.0 * nu * q / whole, q * q / whole
    rate = slope * (1.0 + square / (q * q)) + eta * across + 2.0 * eta * added * slope * across * across * square / q**3
    by_mu = 1.0 / rate
    by_nu = (2.0 * nu / q + 2.0 * eta * added * q * q * nu / (whole * whole)) * by_mu
    along_rate = along + added * slope * 2.0 * nu * (square - q * q) / (whole * whole)
    across_rate = across + added * slope * 2.0 * q * square / (whole * whole)
    return (
        by_nu * along_rate + added * 2.0 * q * (q * q - square) / (whole * whole),
        by_mu * along_rate,
        by_mu * across_rate,
    )


@njit(cache=True, nogil=True, error_model="numpy")
def stiffness_of_lens(j, wire):
    """eta_j of Eq. (12.6) [MPa]."""
    return wire[0] / (ELASTIC * SOFTNESS[j] * BENDING[j] * BENDING[j])


@njit(cache=True, nogil=True, error_model="numpy")
def add_lens(j, s, past, curve, kinematic, wire, factor, dp, f):
    """Add the flow of lens j to dp (4,) and f (4, 4), both scaled; return its potential [MPa]."""
    first = HEAD + OF_SURFACE * j
    weight = (1.0 / BENDING[j], 1.0 / TWISTING[j])
    x = beyond(s, past, first, factor, weight)
    nu, mu, eta = abs(x[0]), sqrt(x[1] * x[1] + x[2] * x[2] + x[3] * x[3]), stiffness_of_lens(j, wire)
    added, q, size, slope, v, tip, work = flow_of_lens(nu, mu, past[first], curve, kinematic, eta)
    if added == 0.0:
        return 0.0
    sign = 1.0 if x[0] > 0.0 else -1.0
    back = 1.0 / mu if mu > 0.0 else 0.0
    if tip:
        along, w_nn, w_nm, w_mm, turn = added, 1.0 / slope, 0.0, 1.0 / eta, 1.0 / eta
    else:
        along, turn = added * 2.0 * nu * q / (q * q + nu * nu), v / mu
        w_nn, w_nm, w_mm = rates_of_lens(nu, added, q, slope, eta)
    by = (1.0, weight[0], weight[0], weight[1])
    dp[0] += sign * along
    f[0, 0] += w_nn
    for k in range(1, 4):
        one = x[k] * back * by[k]
        dp[k] += v * one
        f[0, k] += sign * w_nm * one
        f[k, 0] += sign * w_nm * one
        f[k, k] += turn * by[k] * by[k]
        for m in range(1, 4):
            f[k, m] += (w_mm - turn) * one * x[m] * back * by[m]
    return nu * along + mu * v - 0.5 * eta * v * v - size * added - work


@njit(cache=True, nogil=True, error_model="numpy")
def add_sphere(s, past, curve, kinematic, factor, dp, f):
    """Add the flow of the sphere, Eq. (12.5), to dp (4,) and f (4, 4), both scaled; return its potential [MPa]."""
    first = HEAD + OF_SURFACE * LENSES
    x = beyond(s, past, first, factor, (1.0, 1.0))
    q, alpha = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[3] * x[3]), past[first]
    if q <= curve[0, 1]:
        return 0.0
    number = piece(curve, alpha)
    size = radius_on(curve, number, kinematic, alpha)
    if q <= size:
        return 0.0
    part = 1.0 - LENSES * PART
    strain = strain_from(curve, number, alpha, 0.0, q - size)
    height, slope, work = rise_from(curve, number, alpha, strain)
    turn = part * strain / q
    for k in range(4):
        dp[k] += turn * x[k]
        f[k, k] += turn
        for m in range(4):
            f[k, m] += (part / slope - turn) * x[k] * x[m] / (q * q)
    return part * (height * strain - work)


@njit(cache=True, nogil=True, error_model="numpy")
def flow(s, past, curve, kinematic, wire, lam, dp, f):
    """Plastic section strain added since the past row under the load s, Eqs. (12.4) to (12.7).

    s (4,) = N, M_2, M_3, T [N, N mm]; past (PAST,); curve (K, 2) as in `flow_curve`; wire (3,) = E, G [MPa] and
    diameter [mm] before stretching by lam. Writes dp (4,) = strain, two curvatures and twist [-, 1/mm] per current
    length and f = d dp / d s (4, 4); returns w [N] with dw/ds = dp.
    """
    for k in range(4):
        dp[k] = 0.0
        for m in range(4):
            f[k, m] = 0.0
    area, factor = scales(wire, lam)
    factor = (1.0 / area, factor[1] / area, factor[2] / area, factor[3] / area)
    w = add_sphere(s, past, curve, kinematic, factor, dp, f)
    for j in range(LENSES):
        w += add_lens(j, s, past, curve, kinematic, wire, factor, dp, f)
    for k in range(4):
        dp[k] *= factor[k] * area
        for m in range(4):
            f[k, m] *= factor[k] * factor[m] * area
    return max(area * w, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def stays(s, past, curve, kinematic, wire, lam):
    """Whether nothing flows under the load s; arguments as of `flow`."""
    area, factor = scales(wire, lam)
    factor = (1.0 / area, factor[1] / area, factor[2] / area, factor[3] / area)
    for j in range(LENSES + 1):
        first = HEAD + OF_SURFACE * j
        weight = (1.0 / BENDING[j], 1.0 / TWISTING[j]) if j < LENSES else (1.0, 1.0)
        x = beyond(s, past, first, factor, weight)
        square, size = x[0] * x[0], curve[0, 1]
        mu = sqrt(x[1] * x[1] + x[2] * x[2] + x[3] * x[3])
        if holds(square, mu, size) if j < LENSES else square + mu * mu <= size * size:
            continue
        size = radius(curve, kinematic, past[first])
        if not (holds(square, mu, size) if j < LENSES else square + mu * mu <= size * size):
            return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def settle_surface(j, s, past, curve, kinematic, wire, factor, after, strain):
    """Write what surface j remembers of the accepted load s into its part of the row after, add its flow to the
    scaled strain (4,), and return its dissipation per volume [MPa]."""
    first = HEAD + OF_SURFACE * j
    lens = j < LENSES
    weight = (1.0 / BENDING[j], 1.0 / TWISTING[j]) if lens else (1.0, 1.0)
    part = PART if lens else 1.0 - LENSES * PART
    x = beyond(s, past, first, factor, weight)
    mu = sqrt(x[1] * x[1] + x[2] * x[2] + x[3] * x[3])
    if lens:
        eta = stiffness_of_lens(j, wire)
        added, q, _, _, v, tip, _ = flow_of_lens(abs(x[0]), mu, past[first], curve, kinematic, eta)
        left = 0.0 if tip else q - x[0] * x[0] / q
        along = added if tip else added * 2.0 * abs(x[0]) * q / (q * q + x[0] * x[0])
        strain[0] += along if x[0] > 0.0 else -along
    else:
        q, size = sqrt(x[0] * x[0] + mu * mu), radius(curve, kinematic, past[first])
        added = part * strain_for(curve, past[first], 0.0, max(q - size, 0.0))
        left, v = mu, added * mu / max(q, size)
        strain[0] += added * x[0] / max(q, size)
    if added == 0.0:
        return 0.0
    moved = kinematic * rise(curve, past[first], added / part)[0]
    after[first] += added / part
    after[first + 1] += x[0] * moved / q
    by = (1.0, weight[0], weight[0], weight[1])
    for k in range(1, 4):
        one = x[k] / mu if mu > 0.0 else 0.0
        strain[k] += v * one * by[k]
        after[first + 1 + k] += (x[k] - left * one * (q - moved) / q) / by[k]
    return added * (q - moved)


@njit(cache=True, nogil=True, error_model="numpy")
def settle(s, past, curve, kinematic, wire, lam, after):
    """Write the past row that follows when the load s is accepted into after (PAST,); arguments as of `flow`."""
    after[:] = past
    area, factor = scales(wire, lam)
    factor = (1.0 / area, factor[1] / area, factor[2] / area, factor[3] / area)
    heat, strain = 0.0, np.zeros(4)
    for j in range(LENSES + 1):
        heat += settle_surface(j, s, past, curve, kinematic, wire, factor, after, strain)
    after[0] += area * lam * heat
    bend = sqrt(strain[1] * strain[1] + strain[2] * strain[2]) / (2.0 * BENT)
    shear = strain[3] / (2.0 * TWISTED)
    axial = abs(strain[0]) + bend
    after[1] += sqrt(axial * axial + shear * shear / 3.0)
