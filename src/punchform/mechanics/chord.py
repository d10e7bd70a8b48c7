"""The element seen from its chord: the same six modes D, without the false strain of a frame fixed at O.

The wire drawn as it rises (docs/theory.md, section 3; sigma = +1)::

       n_O                        n_B
        |                      ____B' ──► t_B          m_B = B' - B = sigma e n_B
        O         ____________/    |                   m_O = O' - O = sigma (e - h) n_O
        |   _____/                 B                   c   = B' - O', the chord
        O'_/ ──► t_O

The unloaded wire rises from O' to B' by h over s. In the frame at either end its chord then lies along an axis u
between t and n; with v across it in the same plane and j the sight of an end is (u, v, j), and Eq. (3.10) gives the
coordinates p = (u·c, v·c, j·c) of the chord in it. From the two sights follow the chord measures
L = (l, beta_O, gamma_O, beta_B, gamma_B, tau), Eqs. (3.11) and (3.12), which do not change when the element turns as a
whole, and from them D by the linear map of Eq. (3.13). All derivatives, Eq. (3.14), come from the six coordinates: a
rate over the variables (a, w_O, b, w_B) is a vector with two levers.
"""

from __future__ import annotations

from math import atan2, sqrt

import numpy as np
from numba import njit

from punchform.mechanics.element import end_force
from punchform.mechanics.vectors import cross, dot, minus, plus, scaled

UNITS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SMALL = 0.01
"""Below this square of the sine the series of Eq. (3.11) is used, with eight terms."""


@njit(cache=True, nogil=True)
def sight(t, n, j, sigma, h, s):
    """The axes (u, v, j) of Eq. (3.10): u along the chord of the unloaded wire, seen from the frame (t, j, n)."""
    size = 1.0 / sqrt(s * s + h * h)
    along, up = s * size, sigma * h * size
    return plus(scaled(along, t), scaled(up, n)), plus(scaled(sigma * along, n), scaled(-h * size, t)), j


@njit(cache=True, nogil=True)
def chord_of(d, t, j, n, n_b, t_b, sigma, e, h, s):
    """The chord c, the arms m_O and m_B of its ends, and sight and coordinates from O and from B, Eq. (3.10)."""
    m_o, m_b = scaled(sigma * (e - h), n), scaled(sigma * e, n_b)
    c = minus(d, m_o)
    at_o, at_b = sight(t, n, j, sigma, h, s), sight(t_b, n_b, cross(n_b, t_b), sigma, h, s)
    from_o = dot(at_o[0], c), dot(at_o[1], c), dot(at_o[2], c)
    from_b = dot(at_b[0], c), dot(at_b[1], c), dot(at_b[2], c)
    return c, m_o, m_b, at_o, at_b, from_o, from_b


@njit(cache=True, nogil=True)
def opening(p):
    """g of Eq. (3.11) and its first and second derivative with q = y² + z², for p = (x, y, z)."""
    q = p[1] * p[1] + p[2] * p[2]
    square = p[0] * p[0] + q
    r, part = sqrt(square), q / square
    if p[0] > 0.0 and part < SMALL:
        g = slope = bend = 0.0
        term = 1.0
        for k in range(8):
            g += term / (2 * k + 1)
            slope -= term / (2 * k + 3)
            bend += 2.0 * term / (2 * k + 5)
            term *= part * (2 * k + 1) / (2 * k + 2)
    else:
        g = atan2(sqrt(q), p[0]) / sqrt(part)
        slope = 0.5 * (p[0] / r - g) / part
        bend = 0.5 * (-p[0] / r - 3.0 * slope) / part
    return g / r, slope / (r * square), bend / (r * square * square)


@njit(cache=True, nogil=True)
def angle_rates(p):
    """Derivatives of beta and gamma, Eq. (3.11), with the coordinates p, two tuples (3,)."""
    square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2]
    g, slope, _ = opening(p)
    mixed = 2.0 * slope * p[1] * p[2]
    beta = -p[1] / square, g + 2.0 * slope * p[1] * p[1], mixed
    return beta, (-p[2] / square, mixed, g + 2.0 * slope * p[2] * p[2])


@njit(cache=True, nogil=True)
def add_angle_curvature(p, beta, gamma, first, N):
    """Add the second derivatives of beta and gamma, Eq. (3.11), weighed by the numbers of these names, to N."""
    square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2]
    _, slope, bend = opening(p)
    weight = beta * p[1] + gamma * p[2]
    g_rate = -1.0 / square, 2.0 * slope * p[1], 2.0 * slope * p[2]
    weights = 0.0, beta, gamma
    N[first, first] += 2.0 * weight * p[0] / (square * square)
    for r in range(1, 3):
        N[first, first + r] += 2.0 * weight * p[r] / (square * square)
        N[first + r, first] += 2.0 * weight * p[r] / (square * square)
        N[first + r, first + r] += 2.0 * weight * slope
        for k in range(1, 3):
            N[first + r, first + k] += 4.0 * weight * bend * p[r] * p[k]
    for r in range(3):
        for k in range(3):
            N[first + r, first + k] += weights[r] * g_rate[k] + g_rate[r] * weights[k]


@njit(cache=True, nogil=True)
def measures(line, h, s, rest):
    """L of Eqs. (3.11) and (3.12) as a tuple (6,) [mm, rad], counted from those at rest, the first six of rest (10,);
    the last four: what else the bow leaves out of the turns, Eq. (12.14)."""
    c, _, _, at_o, at_b, from_o, from_b = line
    g_o, g_b = opening(from_o)[0], opening(from_b)[0]
    beta_o, gamma_o, beta_b, gamma_b = g_o * from_o[1], g_o * from_o[2], g_b * from_b[1], g_b * from_b[2]
    tau = 0.5 * (dot(at_b[2], at_o[1]) - dot(at_b[1], at_o[2])) + gamma_o * beta_b - beta_o * gamma_b
    turns = beta_o - rest[1], gamma_o - rest[2], beta_b - rest[3], gamma_b - rest[4]
    free = sqrt(s * s + h * h)
    bowed = turns[0] - rest[6], turns[1] - rest[7], turns[2] - rest[8], turns[3] - rest[9]
    return sqrt(dot(c, c)) - free + bow(bowed, free) - rest[0], *turns, tau - rest[5]


@njit(cache=True, nogil=True)
def bow(turns, free):
    """By how much the arc of a beam is longer than its chord, Eq. (3.12), for the turns (4,) of its ends."""
    beta_o, gamma_o, beta_b, gamma_b = turns
    squares = beta_o * beta_o + gamma_o * gamma_o + beta_b * beta_b + gamma_b * gamma_b
    return free / 15.0 * squares - free / 30.0 * (beta_o * beta_b + gamma_o * gamma_b)


@njit(cache=True, nogil=True)
def to_modes(L, h, s):
    """Eq. (3.13): the six modes as a tuple, from the chord measures (6,) or from their rates."""
    free = sqrt(s * s + h * h)
    along, up = s / free, h / free
    return (
        along * L[0] - h * L[1],
        free * L[2],
        up * L[0] + s * L[1],
        along * L[5] - up * (L[2] - L[4]),
        L[3] - L[1],
        up * L[5] + along * (L[2] - L[4]),
    )


@njit(cache=True, nogil=True)
def to_pulls(F, h, s):
    """What acts on the chord measures, (6,): the transpose of Eq. (3.13) on the end force F (6,)."""
    free = sqrt(s * s + h * h)
    along, up = s / free, h / free
    turn = along * F[5] - up * F[3]
    return (
        along * F[0] + up * F[2],
        s * F[2] - h * F[0] - F[4],
        free * F[1] + turn,
        F[4],
        -turn,
        along * F[3] + up * F[5],
    )


@njit(cache=True, nogil=True)
def angle_pulls(pulls, L, rest, h, s):
    """What acts on the four angles, bow and twist of Eq. (3.12) included."""
    part, twist = pulls[0] * sqrt(s * s + h * h) / 30.0, pulls[5]
    b_o, g_o, b_b, g_b = L[1] - rest[6], L[2] - rest[7], L[3] - rest[8], L[4] - rest[9]
    return (
        pulls[1] + part * (4.0 * b_o - b_b) - twist * (L[4] + rest[4]),
        pulls[2] + part * (4.0 * g_o - g_b) + twist * (L[3] + rest[3]),
        pulls[3] + part * (4.0 * b_b - b_o) + twist * (L[2] + rest[2]),
        pulls[4] + part * (4.0 * g_b - g_o) - twist * (L[1] + rest[1]),
    )


@njit(cache=True, nogil=True)
def chord_modes(d, t, j, n, n_b, t_b, sigma, e, h, s, rest, D):
    """Write the six modes of Eq. (3.13) into D (6,) [mm, rad]; rest (10,): as of `measures`."""
    modes = to_modes(measures(chord_of(d, t, j, n, n_b, t_b, sigma, e, h, s), h, s, rest), h, s)
    for k in range(6):
        D[k] = modes[k]


@njit(cache=True, nogil=True)
def put_rate(A, k, v, lever_o, lever_b):
    """Write the rate of v·c over (a, w_O, b, w_B), Eq. (3.14), into row k of A."""
    at_o, at_b = cross(v, lever_o), cross(v, lever_b)
    for r in range(3):
        A[k, r] = -v[r]
        A[k, 3 + r] = at_o[r]
        A[k, 6 + r] = v[r]
        A[k, 9 + r] = at_b[r]


@njit(cache=True, nogil=True)
def coordinate_rates(line, A):
    """Write the rates of the coordinates of the chord from O and from B, Eq. (3.14), into A (6, 12)."""
    c, m_o, m_b, at_o, at_b, _, _ = line
    for k in range(3):
        put_rate(A, k, at_o[k], plus(c, m_o), scaled(-1.0, m_b))
        put_rate(A, 3 + k, at_b[k], m_o, minus(c, m_b))


@njit(cache=True, nogil=True)
def mode_rates_of(line, A, L, rest, h, s, J):
    """Write dD/d(a, w_O, b, w_B) into J (6, 12), from the rates A (6, 12) of the coordinates."""
    _, _, _, at_o, at_b, p, _ = line
    (b_o, g_o), (b_b, g_b) = angle_rates(p), angle_rates(line[6])
    r = sqrt(dot(p, p))
    spin = scaled(0.5, minus(cross(at_b[2], at_o[1]), cross(at_b[1], at_o[2])))
    bowed = angle_pulls((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), L, rest, h, s)
    whole = L[1] + rest[1], L[2] + rest[2], L[3] + rest[3], L[4] + rest[4]
    for q in range(12):
        from_o, from_b = (A[0, q], A[1, q], A[2, q]), (A[3, q], A[4, q], A[5, q])
        turns = dot(b_o, from_o), dot(g_o, from_o), dot(b_b, from_b), dot(g_b, from_b)
        stretch = dot(p, from_o) / r
        for k in range(4):
            stretch += bowed[k] * turns[k]
        twist = turns[1] * whole[2] + whole[1] * turns[2] - turns[0] * whole[3] - whole[0] * turns[3]
        if 3 <= q < 6:
            twist -= spin[q - 3]
        elif q >= 9:
            twist += spin[q - 9]
        column = to_modes((stretch, *turns, twist), h, s)
        for k in range(6):
            J[k, q] = column[k]


@njit(cache=True, nogil=True)
def expand_chord(d, t, j, n, n_b, t_b, sigma, e, h, s, rest, C, given, exact, D, F, g, J, K):
    """Write modes D (6,), end force F (6,), gradient g (12,), rates J (6, 12) and, if exact, the second-order terms
    K (12, 12) of Eq. (3.14); return the energy P(8) [mJ]. given: F is there already, of a law other than P(3)."""
    line = chord_of(d, t, j, n, n_b, t_b, sigma, e, h, s)
    L = measures(line, h, s, rest)
    modes = to_modes(L, h, s)
    for k in range(6):
        D[k] = modes[k]
    energy = 0.0 if given else end_force(C, D, F)
    A = np.empty((12, 12))
    coordinate_rates(line, A)
    mode_rates_of(line, A, L, rest, h, s, J)
    for q in range(12):
        g[q] = 0.0
        for k in range(6):
            g[q] += F[k] * J[k, q]
    if exact:
        second_order_of(line, A, L, rest, to_pulls(F, h, s), h, s, K)
    return energy


@njit(cache=True, nogil=True)
def second_order_of(line, A, L, rest, pulls, h, s, K):
    """Write the second-order terms of Eq. (3.14) into the symmetric K (12, 12); A (12, 12) begins with the rates of
    the coordinates."""
    c, m_o, m_b, at_o, at_b, from_o, from_b = line
    moments = angle_pulls(pulls, L, rest, h, s)
    tension = pulls[0] / sqrt(dot(c, c))
    y_o, y_b = turning(at_o, from_o, moments[0], moments[1]), turning(at_b, from_b, moments[2], moments[3])
    N = np.zeros((6, 6))
    coordinate_curvature(from_o, from_b, moments, pulls, sqrt(s * s + h * h), N)
    products(A, N, m_o, m_b, y_o, y_b, tension, K)
    push = plus(scaled(tension, c), plus(y_o, y_b))
    add_turned(K, 3, push, scaled(-1.0, m_o))
    add_turned(K, 3, c, y_o)
    add_turned(K, 9, push, m_b)
    add_turned(K, 9, c, y_b)
    add_pair(K, at_b[2], scaled(0.5 * pulls[5], at_o[1]))
    add_pair(K, at_b[1], scaled(-0.5 * pulls[5], at_o[2]))


@njit(cache=True, nogil=True)
def products(A, N, m_o, m_b, y_o, y_b, tension, K):
    """Write what Eq. (3.14) has of products of two rates, of the coordinates and of c, into K; spoils A (12, 12)."""
    B = np.empty((12, 12))
    for k in range(6):
        for q in range(3, 12):
            total = 0.0
            for m in range(6):
                total += N[k, m] * A[m, q]
            B[k, q] = total
    # Rows 6 to 8 of A and 9 to 11 of B are the rates of c, the others those of y_O + y_B with half the tension on c.
    for k in range(3):
        put_rate(A, 6 + k, UNITS[k], m_o, scaled(-1.0, m_b))
        put_rate(A, 9 + k, UNITS[k], scaled(-1.0, y_o), scaled(-1.0, y_b))
        for q in range(12):
            turned = A[9 + k, q] if q % 6 > 2 else 0.0
            A[9 + k, q] = B[6 + k, q] = 0.5 * tension * A[6 + k, q] + turned
            B[9 + k, q] = A[6 + k, q]
    for p in range(3, 12):
        for q in range(p, 12):
            total = 0.0
            for k in range(12):
                total += A[k, p] * B[k, q]
            K[p, q] = K[q, p] = total
    # Nothing but c knows the shifts, and c moves with b - a.
    for p in range(3):
        for q in range(3, 12):
            K[p, q] = K[q, p] = -K[6 + p, q]
    for p in range(3):
        for q in range(3):
            K[p, q] = K[6 + p, 6 + q]


@njit(cache=True, nogil=True)
def turning(axes, p, beta, gamma):
    """The vector y of Eq. (3.14): what the moments beta and gamma of an end do to its axes along the chord."""
    beta_rate, gamma_rate = angle_rates(p)
    weights = plus(scaled(beta, beta_rate), scaled(gamma, gamma_rate))
    return plus(plus(scaled(weights[0], axes[0]), scaled(weights[1], axes[1])), scaled(weights[2], axes[2]))


@njit(cache=True, nogil=True)
def coordinate_curvature(from_o, from_b, moments, pulls, free, N):
    """Add the second derivatives of the energy at constant F with the six coordinates, Eq. (3.14), to N (6, 6)."""
    add_angle_curvature(from_o, moments[0], moments[1], 0, N)
    add_angle_curvature(from_b, moments[2], moments[3], 3, N)
    one, other = angle_rates(from_o), angle_rates(from_b)
    square = dot(from_o, from_o)
    pull, twist, bow = pulls[0] / sqrt(square), pulls[5], pulls[0] * free / 30.0
    for r in range(3):
        for k in range(3):
            N[r, k] += 4.0 * bow * (one[0][r] * one[0][k] + one[1][r] * one[1][k])
            N[r, k] -= pull * from_o[r] * from_o[k] / square
            N[3 + r, 3 + k] += 4.0 * bow * (other[0][r] * other[0][k] + other[1][r] * other[1][k])
            between = -bow * (one[0][r] * other[0][k] + one[1][r] * other[1][k])
            between += twist * (one[1][r] * other[0][k] - one[0][r] * other[1][k])
            N[r, 3 + k] += between
            N[3 + k, r] += between


@njit(cache=True, nogil=True)
def add_turned(K, first, p, q):
    """Add the form p·(w x (w x q)) of the spin vector w whose columns begin at `first`."""
    trace = dot(p, q)
    for r in range(3):
        K[first + r, first + r] -= trace
        for c in range(3):
            K[first + r, first + c] += 0.5 * (p[r] * q[c] + p[c] * q[r])


@njit(cache=True, nogil=True)
def add_pair(K, p, q):
    """Add the second variation of p·q, p turning with B and q with O, Eq. (3.4)."""
    add_turned(K, 3, p, q)
    add_turned(K, 9, p, q)
    trace = dot(p, q)
    for r in range(3):
        K[3 + r, 9 + r] += trace
        K[9 + r, 3 + r] += trace
        for c in range(3):
            K[9 + r, 3 + c] -= q[r] * p[c]
            K[3 + c, 9 + r] -= q[r] * p[c]
