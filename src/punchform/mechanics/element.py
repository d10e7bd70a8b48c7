"""One wire between two crossings, in the frame at O: its six modes D, their derivatives, and second-order terms.

Stencil (docs/theory.md, sections 2 and 3; the wire drawn as it rises, sigma = +1)::

      n_O = k                     n_B
       |                           |   A ──► t_B
       |      _____________________|__/
       |_____/                     |  | e
       O ──► t_O = i               B  |       d = x_B - x_O + sigma e n_B   Eq. (3.1)

Every mode is a constant plus a signed product p · q of a vector p that moves with B (d, n_B, t_B) and a vector q of
the frame at O (t, j, n), Eq. (3.2). The element has 12 variables (a, w_O, b, w_B): the shifts of O and B and the spin
vectors of the two frames. Eq. (3.4) gives the variations; gathering the terms by q turns them into closed forms:

* the force on A in space        f = F1 t + F2 j + sigma F3 n
* what acts on n_B and t_B       g_n = sigma e f - sigma F4 j,      g_t = -sigma F5 n + F6 j
* what acts on t, j, n at O      P_t = F1 d,  P_j = F2 d - sigma F4 n_B + F6 t_B,  P_n = sigma F3 d - sigma F5 t_B

The kernels read like these formulas and know nothing of grids or unknowns.
"""

from __future__ import annotations

from numba import njit

from punchform.mechanics.vectors import cross, dot, minus, plus, row, scaled


@njit(cache=True, nogil=True)
def modes(d, t, j, n, n_b, t_b, sigma, e, s, D):
    """Write the six modes of Eq. (3.2) into D (6,) [mm, rad]."""
    D[0] = dot(d, t) - s
    D[1] = dot(d, j)
    D[2] = sigma * dot(d, n) - e
    D[3] = -sigma * dot(n_b, j)
    D[4] = -sigma * dot(t_b, n)
    D[5] = dot(t_b, j)


@njit(cache=True, nogil=True)
def end_force(C, D, F):
    """Write F = C D, P(3), into F (6,) and return the energy ½ D·F, P(8) [mJ]."""
    energy = 0.0
    for k in range(6):
        force = 0.0
        for m in range(6):
            force += C[k, m] * D[m]
        F[k] = force
        energy += 0.5 * D[k] * force
    return energy


@njit(cache=True, nogil=True)
def put(J, k, column, sign, v):
    """Write sign v into three columns of row k of J."""
    J[k, column] = sign * v[0]
    J[k, column + 1] = sign * v[1]
    J[k, column + 2] = sign * v[2]


@njit(cache=True, nogil=True)
def mode_rates(d, t, j, n, n_b, t_b, sigma, e, J):
    """Write dD/d(a, w_O, b, w_B), Eq. (3.4), into J (6, 12)."""
    arm = scaled(sigma * e, n_b)
    for k, sign, q in ((0, 1.0, t), (1, 1.0, j), (2, sigma, n)):
        put(J, k, 0, -sign, q)
        put(J, k, 3, sign, cross(q, d))
        put(J, k, 6, sign, q)
        put(J, k, 9, sign, cross(arm, q))
    for k, sign, p, q in ((3, -sigma, n_b, j), (4, -sigma, t_b, n), (5, 1.0, t_b, j)):
        put(J, k, 0, 0.0, q)
        put(J, k, 3, sign, cross(q, p))
        put(J, k, 6, 0.0, q)
        put(J, k, 9, sign, cross(p, q))


@njit(cache=True, nogil=True)
def loads(d, t, j, n, n_b, t_b, sigma, e, F):
    """The vectors f, g_n, g_t, P_t, P_j, P_n of the module's page, from the end force F (6,)."""
    f = plus(plus(scaled(F[0], t), scaled(F[1], j)), scaled(sigma * F[2], n))
    g_n = plus(scaled(sigma * e, f), scaled(-sigma * F[3], j))
    g_t = plus(scaled(-sigma * F[4], n), scaled(F[5], j))
    p_t = scaled(F[0], d)
    p_j = plus(plus(scaled(F[1], d), scaled(-sigma * F[3], n_b)), scaled(F[5], t_b))
    p_n = plus(scaled(sigma * F[2], d), scaled(-sigma * F[4], t_b))
    return f, g_n, g_t, p_t, p_j, p_n


@njit(cache=True, nogil=True)
def gradient(t, j, n, n_b, t_b, pulls, G):
    """Write dE/d(a, w_O, b, w_B) into G (12,) [N, N mm]; `pulls` as `loads` returns them."""
    f, g_n, g_t, p_t, p_j, p_n = pulls
    at_o = plus(plus(cross(t, p_t), cross(j, p_j)), cross(n, p_n))
    at_b = plus(cross(n_b, g_n), cross(t_b, g_t))
    for c in range(3):
        G[c] = -f[c]
        G[3 + c] = at_o[c]
        G[6 + c] = f[c]
        G[9 + c] = at_b[c]


@njit(cache=True, nogil=True)
def second_order(t, j, n, n_b, t_b, pulls, K):
    """Write the sum of F_k times the Hessian of D_k, Eq. (3.4), into the symmetric K (12, 12)."""
    f, g_n, g_t, p_t, p_j, p_n = pulls
    trace_o = dot(p_t, t) + dot(p_j, j) + dot(p_n, n)
    trace_b = dot(g_n, n_b) + dot(g_t, t_b)
    skew = ((0.0, -f[2], f[1]), (f[2], 0.0, -f[0]), (-f[1], f[0], 0.0))
    for r in range(3):
        for c in range(3):
            unit = 1.0 if r == c else 0.0
            mixed_b = g_n[r] * n_b[c] + g_t[r] * t_b[c]
            mixed_b_turned = g_n[c] * n_b[r] + g_t[c] * t_b[r]
            mixed_o = p_t[r] * t[c] + p_j[r] * j[c] + p_n[r] * n[c]
            mixed_o_turned = p_t[c] * t[r] + p_j[c] * j[r] + p_n[c] * n[r]
            K[r, c] = K[r, 6 + c] = K[6 + r, c] = K[6 + r, 6 + c] = 0.0
            K[r, 9 + c] = K[9 + r, c] = K[6 + r, 9 + c] = K[9 + r, 6 + c] = 0.0
            K[r, 3 + c] = skew[r][c]
            K[3 + c, r] = skew[r][c]
            K[6 + r, 3 + c] = -skew[r][c]
            K[3 + c, 6 + r] = -skew[r][c]
            K[3 + r, 3 + c] = 0.5 * (mixed_o + mixed_o_turned) - trace_o * unit
            K[9 + r, 9 + c] = 0.5 * (mixed_b + mixed_b_turned) - trace_b * unit
            K[9 + r, 3 + c] = trace_b * unit - mixed_b
            K[3 + c, 9 + r] = trace_b * unit - mixed_b


@njit(cache=True, nogil=True)
def expand(d, t, j, n, n_b, t_b, sigma, e, s, C, exact, D, F, g, J, K):
    """Write modes D (6,), end force F (6,), gradient g (12,), rates J (6, 12) and, if exact, the second-order terms
    K (12, 12) of Eq. (3.4); return the energy P(8) [mJ]."""
    modes(d, t, j, n, n_b, t_b, sigma, e, s, D)
    energy = end_force(C, D, F)
    pulls = loads(d, t, j, n, n_b, t_b, sigma, e, F)
    gradient(t, j, n, n_b, t_b, pulls, g)
    mode_rates(d, t, j, n, n_b, t_b, sigma, e, J)
    if exact:
        second_order(t, j, n, n_b, t_b, pulls, K)
    return energy


@njit(cache=True, nogil=True)
def wire_ends(x, normals, tangents, family, start, end, direction, sigma, e, m):
    """The vectors d, t, j, n, n_B, t_B of element m, Eq. (3.1); tangents (2 N, 3), row 2 node + family."""
    o, b, w = start[m], end[m], family[m]
    n, n_b = row(normals, o), row(normals, b)
    t = scaled(direction[m], row(tangents, 2 * o + w))
    t_b = scaled(direction[m], row(tangents, 2 * b + w))
    d = plus(minus(row(x, b), row(x, o)), scaled(sigma[m] * e, n_b))
    return d, t, cross(n, t), n, n_b, t_b
