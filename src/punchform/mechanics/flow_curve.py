"""The flow curve of a wire: flow stress [MPa] over equivalent plastic strain, straight between its points, Eq. (12.1).

`curve` (K, 2) holds strain and stress of its points. The first is (0, yield strength), every slope is positive, and
the last goes on for ever. Of a rise of the flow stress the share `kinematic` moves the centre of the elastic range,
the rest widens it. `flow_under` is the flow of one fibre with a stress along the wire and one around its axis. Where
the piece on which a strain lies is known, `radius_on`, `rise_from` and `strain_from` save the search for it.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

ROUNDING = 4e-16
"""How near to 1 the rounded sum of a few numbers can be brought."""


@njit(cache=True, nogil=True, error_model="numpy")
def piece(curve, alpha):
    """Index of the straight piece on which the strain alpha lies; a point belongs to the piece that begins there."""
    low, high = 0, curve.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if curve[middle, 0] <= alpha:
            low = middle
        else:
            high = middle
    return low


@njit(cache=True, nogil=True, error_model="numpy")
def slope_of(curve, k):
    """Slope of piece k [MPa]."""
    return (curve[k + 1, 1] - curve[k, 1]) / (curve[k + 1, 0] - curve[k, 0])


@njit(cache=True, nogil=True, error_model="numpy")
def flow_stress(curve, alpha):
    """Flow stress [MPa] at the equivalent plastic strain alpha, Eq. (12.1)."""
    k = piece(curve, alpha)
    return curve[k, 1] + slope_of(curve, k) * (alpha - curve[k, 0])


@njit(cache=True, nogil=True, error_model="numpy")
def radius(curve, kinematic, alpha):
    """Half-width of the elastic range [MPa] at alpha, Eq. (12.1)."""
    return curve[0, 1] + (1.0 - kinematic) * (flow_stress(curve, alpha) - curve[0, 1])


@njit(cache=True, nogil=True, error_model="numpy")
def radius_on(curve, k, kinematic, alpha):
    """The same on the piece k, on which alpha is known to lie."""
    here = curve[k, 1] + slope_of(curve, k) * (alpha - curve[k, 0])
    return curve[0, 1] + (1.0 - kinematic) * (here - curve[0, 1])


@njit(cache=True, nogil=True, error_model="numpy")
def rise(curve, alpha, added):
    """How far the flow stress rises while the strain grows from alpha by `added` >= 0: rise [MPa], slope at its end
    [MPa], and the integral of the rise over the added strain [MPa]."""
    return rise_from(curve, piece(curve, alpha), alpha, added)


@njit(cache=True, nogil=True, error_model="numpy")
def rise_from(curve, k, alpha, added):
    """`rise` from the piece k, on which alpha is known to lie."""
    last = curve.shape[0] - 2
    slope = slope_of(curve, k)
    height, work = 0.0, 0.0
    while k < last and alpha + added >= curve[k + 1, 0]:
        part = curve[k + 1, 0] - alpha
        work += (height + 0.5 * slope * part) * part
        height += slope * part
        alpha = curve[k + 1, 0]
        added = max(added - part, 0.0)
        k += 1
        slope = slope_of(curve, k)
    work += (height + 0.5 * slope * added) * added
    return height + slope * added, slope, work


@njit(cache=True, nogil=True, error_model="numpy")
def strain_for(curve, alpha, modulus, excess):
    """The added strain x >= 0 for which its rise plus modulus x [MPa] makes up the `excess` >= 0 [MPa]."""
    return strain_from(curve, piece(curve, alpha), alpha, modulus, excess)


@njit(cache=True, nogil=True, error_model="numpy")
def strain_from(curve, k, alpha, modulus, excess):
    """`strain_for` from the piece k, on which alpha is known to lie."""
    last = curve.shape[0] - 2
    added = 0.0
    while k < last:
        slope = slope_of(curve, k) + modulus
        part = curve[k + 1, 0] - alpha
        if slope * part > excess:
            return added + excess / slope
        excess -= slope * part
        added += part
        alpha = curve[k + 1, 0]
        k += 1
    return added + excess / (slope_of(curve, k) + modulus)


@njit(cache=True, nogil=True, error_model="numpy")
def flow_under(sigma, tau, alpha, curve, kinematic, young, shear):
    """Implicit return of a fibre, Eq. (12.3), from the stresses (sigma, tau) [MPa] that it would have if it did not
    flow, less the back stress.

    Returns the added equivalent plastic strain (0 where it does not flow), the von Mises length q [MPa] of what is
    left of the stresses, the back stress still that of before, and what `rise` says of the added strain.
    """
    square = sigma * sigma + 3.0 * tau * tau
    # The elastic range only becomes wider: most fibres need no search of the curve.
    if square <= curve[0, 1] * curve[0, 1]:
        return 0.0, sqrt(square), (0.0, 0.0, 0.0)
    k, trial = piece(curve, alpha), sqrt(square)
    size = radius_on(curve, k, kinematic, alpha)
    if trial <= size:
        return 0.0, trial, (0.0, 0.0, 0.0)
    # Of the moduli E along and 3G around, the one that counts for a small flow: exact where one stress is alone.
    modulus = (young * sigma * sigma + 9.0 * shear * tau * tau) / square
    added = strain_from(curve, k, alpha, modulus, trial - size)
    if sigma != 0.0 and tau != 0.0:
        high = (trial - size) / min(young, 3.0 * shear)
        added = flow_in_both(sigma, tau, alpha, curve, k, size, young, shear, added, high)
    risen = rise_from(curve, k, alpha, added)
    return added, size + risen[0], risen


@njit(cache=True, nogil=True, error_model="numpy")
def flow_in_both(sigma, tau, alpha, curve, k, size, young, shear, added, high):
    """The added strain of `flow_under` under both stresses, by Newton between 0 and `high` from the one given."""
    low = 0.0
    for _ in range(60):
        height, slope, _ = rise_from(curve, k, alpha, added)
        q = size + height
        one, two = q + young * added, q + 3.0 * shear * added
        a, b = sigma * sigma / (one * one), 3.0 * tau * tau / (two * two)
        root = sqrt(a + b)
        if root > 1.0:
            low = added
        else:
            high = added
        # 1 / root is almost straight in the added strain.
        rate = (a * (slope + young) / one + b * (slope + 3.0 * shear) / two) / (root * root * root)
        following = added + (1.0 - 1.0 / root) / rate
        if not low <= following <= high:
            following = 0.5 * (low + high)
        # What is left of 1 - root is rounding, of which a small flow would never become free.
        if abs(following - added) <= 1e-15 * following or abs(root - 1.0) <= ROUNDING:
            break
        added = following
    return added


@njit(cache=True, nogil=True, error_model="numpy")
def left_of(sigma, tau, added, q, young, shear):
    """What the flow that `flow_under` returns leaves of the stresses (sigma, tau)."""
    return sigma / (1.0 + young * added / q), tau / (1.0 + 3.0 * shear * added / q)
