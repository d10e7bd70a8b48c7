"""The end of a stroke: what flowed becomes the past, and the unloaded wire longer, thinner and straighter.

Eqs. (12.14)-(12.16) of docs/theory.md. Pull, torque and end moments stay, so that a grid in equilibrium remains in it
until its wires are asked again: what they then still flow is the error of the stroke.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from punchform.mechanics.chord import bow, to_pulls
from punchform.mechanics.laws import flow, keep
from punchform.mechanics.yielding import columns, factored, levered, section_forces

ROUNDS = 12
"""Rounds of Eq. (12.14), each of which leaves about a tenth of the error: what the pull does to a bent wire's ends."""


@njit(cache=True, nogil=True, error_model="numpy")
def settle(
    kind, D, forces, H, lever, weight, string, curving, correction, height, length, curve, kinematic, wire, points,
    memory, thin, long, turning, rest, turned, off, stretch, grown, pull, past, B, C, work,
):  # fmt: skip
    """Make what flowed in the elements (M,) their past, in place: all arrays from rest on, Eqs. (12.14)-(12.16);
    forces (M, 12), thin and long (M,) as of `respond`; turning (M, 4): of `History`.

    Elements in which nothing flows stay bit by bit as they are, but for the pull on them.
    """
    count, size = H.shape[1], past.shape[2]
    own, after, strains = np.empty((count, 4, 12)), np.empty((count, size)), np.empty((count, 4))
    s, strain, compliance = np.empty(4), np.empty(4), np.empty((4, 4))
    L, F, x, inverse = np.empty((6, 6)), np.empty(6), np.empty(12), np.empty((12, 6))
    for m in range(len(kind)):
        piece, reach, longer, flows = kind[m], 0.0, 0.0, False
        for g in range(count):
            reach += weight[piece, g] * long[m]
        levered(H[piece], lever[piece], off[m], string, reach, own)
        for g in range(count):
            section_forces(own[g], forces[m], 12, s)
            potential = flow(
                s, past[m, g], curve, kinematic, wire, thin[m], points, memory[m, g], strain, compliance
            )  # fmt: skip
            flows |= potential != 0.0
            keep(s, past[m, g], curve, kinematic, wire, thin[m], points, memory[m, g], after[g])
            share = weight[piece, g] * long[m]
            longer += share * strain[0]
            for k in range(4):
                strains[g, k] = strain[k]
                work[m] += share * s[k] * strain[k]
        for k in range(6):
            F[k] = forces[m, k]
        pull[m] = to_pulls(F, height[piece], length[piece])[0]
        grown[m] = longer / reach * long[m] / stretch[m]
        turned[m] = 0.0
        if not flows:
            continue
        past[m] = after
        reach *= stretch[m] * (1.0 + grown[m]) / long[m]
        stretch[m] *= 1.0 + grown[m]
        for g in range(count):
            for k in range(count):
                off[m, g, 0] -= reach * reach * curving[g, k] * strains[k, 1]
                off[m, g, 1] += reach * reach * curving[g, k] * strains[k, 2]
        levered(H[piece], lever[piece], off[m], string, reach, own)
        flexibility(own, weight[piece], stretch[m], wire, correction[piece], B[m])
        factored(B[m], 6, L)
        columns(L, 6, x, inverse)
        C[m] = inverse[:6]
        for k in range(4):
            turned[m, k] = -rest[m, 1 + k]
        unload(D[m], F, B[m], height[piece], length[piece], turning[m], rest[m])
        for k in range(4):
            turned[m, k] += rest[m, 1 + k]


@njit(cache=True, nogil=True, error_model="numpy")
def flexibility(H, weight, stretch, wire, correction, B):
    """Write the flexibility (6, 6) of Eq. (12.16): by the sections as they are now, and what these miss of (2.4)."""
    area = 0.25 * np.pi * wire[2] ** 2 / stretch
    inertia = area * area / (4.0 * np.pi)
    soft = 1.0 / (wire[0] * area), 1.0 / (wire[0] * inertia), 1.0 / (wire[0] * inertia), 0.5 / (wire[1] * inertia)
    for r in range(6):
        for c in range(6):
            total = correction[r, c]
            for g in range(len(H)):
                for k in range(4):
                    total += weight[g] * stretch * soft[k] * H[g, k, r] * H[g, k, c]
            B[r, c] = total


@njit(cache=True, nogil=True, error_model="numpy")
def unload(D, F, B, h, s, turning, rest):
    """Move the measures at rest (6,) and F (6,) so that the elastic wire of flexibility B is loaded as before: the same
    pull, torque and end moments, the bow's share included, Eq. (12.14)."""
    free = sqrt(s * s + h * h)
    before, pulls = from_modes(D, h, s), to_pulls(F, h, s)
    part = pulls[0] * free / 30.0
    turns = before[1] - turning[0], before[2] - turning[1], before[3] - turning[2], before[4] - turning[3]
    now = before
    for _ in range(ROUNDS):
        gone = (
            turns[0] - now[1],
            turns[1] - now[2],
            turns[2] - now[3],
            turns[3] - now[4],
        )
        end_force = from_pulls(
            (
                pulls[0],
                pulls[1] + part * (4.0 * gone[0] - gone[2]),
                pulls[2] + part * (4.0 * gone[1] - gone[3]),
                pulls[3] + part * (4.0 * gone[2] - gone[0]),
                pulls[4] + part * (4.0 * gone[3] - gone[1]),
                pulls[5],
            ),
            h,
            s,
        )
        for k in range(6):
            F[k] = end_force[k]
        modes = np.zeros(6)
        for k in range(6):
            for c in range(6):
                modes[k] += B[k, c] * F[c]
        now = from_modes(modes, h, s)
    rest[0] += before[0] - bow(turns, free) + bow((now[1], now[2], now[3], now[4]), free) - now[0]
    for k in range(1, 6):
        rest[k] += before[k] - now[k]


@njit(cache=True, nogil=True, error_model="numpy")
def from_modes(D, h, s):
    """The chord measures as a tuple (6,): Eq. (3.13) the other way."""
    free = sqrt(s * s + h * h)
    along, up = s / free, h / free
    beta_o, gamma_o = (along * D[2] - up * D[0]) / free, D[1] / free
    return (
        along * D[0] + up * D[2],
        beta_o,
        gamma_o,
        D[4] + beta_o,
        gamma_o - (along * D[5] - up * D[3]),
        along * D[3] + up * D[5],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def from_pulls(pulls, h, s):
    """The end force as a tuple (6,) from what acts on the chord measures: `to_pulls` the other way."""
    free = sqrt(s * s + h * h)
    along, up = s / free, h / free
    across, turn = pulls[1] + pulls[3], -pulls[4]
    return (
        along * pulls[0] - up / free * across,
        (pulls[2] - turn) / free,
        up * pulls[0] + along / free * across,
        along * pulls[5] - up * turn,
        pulls[3],
        up * pulls[5] + along * turn,
    )
