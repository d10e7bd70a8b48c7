"""Wires that yield: the force-based element of section 12, whose end force follows from its modes and its past.

The end force F is one for the whole wire between two crossings; statics says what it does to each section, a section
law what plastic strain that adds since the last stroke, and the modes are the sum of both, Eq. (12.11):

    D = B F + sum_g w_g H_g' p_g(H_g F)

F is found where the concave function F·D - B*(F), Eq. (12.12), is largest, which is the incremental energy P(8) of the
yielding element; the derivative of F with D, Eq. (12.13), takes the place of C. While something flows, F is followed by
six more forces: those with which the pull on the wire keeps its sections from leaving the chord, Eq. (12.17).
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from punchform.mechanics.laws import flow, stays

FORETOLD_STEPS, STEPS = 40, 80
"""Newton steps for the end force of one element, from where it is foretold and from the elastic one."""
SHORTEST = 1e-4
"""The shortest part of the way that the modes of such an element go at once, where nothing else helps."""
EXACT = 1e-22
"""Gain of a step, relative to the energy, at which the end force is found."""
ROUNDING = 1e-14
"""The same where no step leads any further."""
LOWEST = 2.0**-30
"""The shortest fraction of a step that is tried."""


@njit(cache=True, nogil=True, error_model="numpy")
def levered(H, lever, off, string, reach, out):
    """Write the statics (G, 4, 12) of a wire of length `reach` whose sections have moved by `off` (G, 2) from where
    they were made: from F, Eq. (12.10), and from the forces across the chord, Eq. (12.17)."""
    root = sqrt(reach)
    for g in range(len(H)):
        for k in range(4):
            for c in range(6):
                out[g, k, c] = H[g, k, c] + off[g, 0] * lever[g, 0, k, c] + off[g, 1] * lever[g, 1, k, c]
                out[g, k, 6 + c] = 0.0
        for c in range(3):
            out[g, 1, 6 + c] = out[g, 2, 9 + c] = root * string[g, c]


@njit(cache=True, nogil=True, error_model="numpy")
def section_forces(H, F, size, s):
    """Write s = H F (4,) of the first `size` forces."""
    for k in range(4):
        total = 0.0
        for c in range(size):
            total += H[k, c] * F[c]
        s[k] = total


@njit(cache=True, nogil=True, error_model="numpy")
def complementary(
    F, size, pull, H, share, past, curve, kinematic, wire, stretch, points, memory, B, s, strain, compliance,
    motion, soft,
):  # fmt: skip
    """The complementary energy B*(F), Eq. (12.12) [mJ], of `size` forces; writes its derivative, the modes, into
    motion (12,), and the second one into soft (12, 12)."""
    energy = 0.0
    for k in range(size):
        total = 0.0
        for c in range(size):
            if k < 6 and c < 6:
                soft[k, c] = B[k, c]
            else:
                soft[k, c] = 1.0 / pull if k == c else 0.0
            total += soft[k, c] * F[c]
        motion[k] = total
        energy += 0.5 * total * F[k]
    for g in range(len(H)):
        section_forces(H[g], F, size, s)
        potential = flow(s, past[g], curve, kinematic, wire, stretch, points, memory[g], strain, compliance)
        if potential != 0.0:
            energy += share[g] * potential
            add_flow(H[g], size, share[g], strain, compliance, motion, soft)
    return energy


@njit(cache=True, nogil=True, error_model="numpy")
def add_flow(H, size, share, strain, compliance, motion, soft):
    """Add what flows in the section of statics H (4, 12) to motion (12,) and soft (12, 12)."""
    for c in range(size):
        for k in range(4):
            motion[c] += share * H[k, c] * strain[k]
        one, two, three, four = 0.0, 0.0, 0.0, 0.0
        for r in range(4):
            one += compliance[0, r] * H[r, c]
            two += compliance[1, r] * H[r, c]
            three += compliance[2, r] * H[r, c]
            four += compliance[3, r] * H[r, c]
        one, two, three, four = share * one, share * two, share * three, share * four
        for r in range(size):
            soft[c, r] += one * H[0, r] + two * H[1, r] + three * H[2, r] + four * H[3, r]


@njit(cache=True, nogil=True, error_model="numpy")
def factored(A, size, L):
    """Write the Cholesky factor of the positive definite A (size, size) into L, its diagonal inverted; NaN where A is
    not definite."""
    for k in range(size):
        for c in range(k + 1):
            total = A[k, c]
            for r in range(c):
                total -= L[k, r] * L[c, r]
            if k == c:
                L[k, k] = 1.0 / sqrt(total) if total > 0.0 else np.nan
            else:
                L[k, c] = total * L[c, c]


@njit(cache=True, nogil=True, error_model="numpy")
def solved(L, size, right, x):
    """Write the solution (size,) of A x = right by the factor that `factored` wrote."""
    for k in range(size):
        total = right[k]
        for r in range(k):
            total -= L[k, r] * x[r]
        x[k] = total * L[k, k]
    for k in range(size - 1, -1, -1):
        x[k] *= L[k, k]
        for r in range(k):
            x[r] -= L[k, r] * x[k]


@njit(cache=True, nogil=True, error_model="numpy")
def columns(L, size, x, out):
    """Write the first six columns of the inverse of A into out (12, 6), by its factor; x (12,) is work space."""
    right = np.zeros(12)
    for c in range(6):
        right[c] = 1.0
        solved(L, size, right, x)
        right[c] = 0.0
        for k in range(12):
            out[k, c] = x[k] if k < size else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def stays_elastic(H, F, past, curve, kinematic, wire, stretch, points, s):
    """Whether nothing flows in any section under the end force F."""
    for g in range(len(H)):
        section_forces(H[g], F, 6, s)
        if not stays(s, past[g], curve, kinematic, wire, stretch, points):
            return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def respond(
    first, last, kind, D, H, lever, weight, string, curve, kinematic, wire, points, off, thin, long, pull, past, B, C,
    memory, forces, modes, hard, stiffness, energies,
):  # fmt: skip
    """Write forces (M, 12), whose first six are F, the derivatives of F with D, stiffness (M, 6, 6), and energies (M,)
    of the elements from first to last, Eqs. (12.12) and (12.13); the energy is infinite where the search fails.

    It begins at the forces of the modes (M, 6) of an earlier call, NaN where none is known, moved by hard (M, 12, 6),
    the derivative of the forces where they last flowed; both are overwritten. thin, long (M,): stretch that the area
    and the length of the wire have in the stroke, Eq. (12.18).
    """
    count = H.shape[1]
    own, share = np.empty((count, 4, 12)), np.empty(count)
    s, strain, compliance = np.empty(4), np.empty(4), np.empty((4, 4))
    motion, wanted, trial, step = np.empty(12), np.zeros(12), np.empty(12), np.empty(12)
    soft, L, elastic = np.empty((12, 12)), np.empty((12, 12)), np.empty(6)
    for m in range(first, last):
        reach = 0.0
        for g in range(count):
            share[g] = weight[kind[m], g] * long[m]
            reach += share[g]
        levered(H[kind[m]], lever[kind[m]], off[m], string, reach, own)
        F = forces[m]
        for k in range(6):
            wanted[k], elastic[k] = D[m, k], 0.0
            for c in range(6):
                elastic[k] += C[m, k, c] * D[m, c]
        if stays_elastic(own, elastic, past[m], curve, kinematic, wire, thin[m], points, s):
            energies[m] = 0.0
            for k in range(6):
                F[k], F[6 + k] = elastic[k], 0.0
                energies[m] += 0.5 * elastic[k] * D[m, k]
                for c in range(6):
                    stiffness[m, k, c] = C[m, k, c]
                    if np.isnan(modes[m, 0]):
                        hard[m, k, c], hard[m, 6 + k, c] = C[m, k, c], 0.0
        else:
            size = 12 if pull[m] > 0.0 else 6
            for steps in (FORETOLD_STEPS, STEPS):
                foretold(F, size, elastic, D[m], modes[m], hard[m])
                energies[m] = largest(
                    F, size, pull[m], wanted, own, share, past[m], curve, kinematic, wire, thin[m], points,
                    memory[m], B[m], steps, s, strain, compliance, motion, trial, step, soft, L,
                )  # fmt: skip
                if np.isfinite(energies[m]):
                    break
                # From within a wire that hardly hardens the way along its limit is long, from far beyond it short.
                modes[m], memory[m] = np.nan, np.nan
            else:
                energies[m] = marched(
                    F, size, pull[m], D[m], hard[m], wanted, own, share, past[m], curve, kinematic, wire, thin[m],
                    points, memory[m], B[m], s, strain, compliance, motion, trial, step, soft, L,
                )  # fmt: skip
            columns(L, size, step, hard[m])
            stiffness[m] = hard[m, :6]
        modes[m] = D[m]
        if not np.isfinite(energies[m]):
            modes[m], memory[m] = np.nan, np.nan


@njit(cache=True, nogil=True, error_model="numpy")
def foretold(F, size, elastic, D, modes, hard):
    """Move the forces F (12,) of the modes (6,) to where they are likely to be for D (6,); to the `elastic` ones
    where nothing is known."""
    for k in range(12):
        if k >= size:
            F[k] = 0.0
        elif np.isnan(modes[0]):
            F[k] = elastic[k] if k < 6 else 0.0
        else:
            for c in range(6):
                F[k] += hard[k, c] * (D[c] - modes[c])


@njit(cache=True, nogil=True, error_model="numpy")
def marched(
    F, size, pull, D, hard, wanted, H, share, past, curve, kinematic, wire, stretch, points, memory, B,
    s, strain, compliance, motion, trial, step, soft, L,
):  # fmt: skip
    """What `largest` finds when the modes grow from zero to D (6,) in parts, each as long as the search allows: for a
    wire that hardly hardens and is bent and turned on far beyond its limit. hard (12, 6) is overwritten."""
    before, reach, part, value = np.zeros(12), 0.0, 0.25, np.inf
    F[:], hard[:], memory[:] = 0.0, 0.0, np.nan
    while reach < 1.0 and part >= SHORTEST:
        ahead = min(reach + part, 1.0)
        for k in range(size):
            F[k] = before[k]
            for c in range(6):
                F[k] += (ahead - reach) * hard[k, c] * D[c]
        for k in range(6):
            wanted[k] = ahead * D[k]
        value = largest(
            F, size, pull, wanted, H, share, past, curve, kinematic, wire, stretch, points, memory, B, FORETOLD_STEPS,
            s, strain, compliance, motion, trial, step, soft, L,
        )  # fmt: skip
        if np.isfinite(value):
            columns(L, size, step, hard)
            before[:] = F
            reach, part = ahead, 2.0 * part
        else:
            memory[:] = np.nan
            part *= 0.25
    return value


@njit(cache=True, nogil=True, error_model="numpy")
def largest(
    F, size, pull, wanted, H, share, past, curve, kinematic, wire, stretch, points, memory, B, steps,
    s, strain, compliance, motion, trial, step, soft, L,
):  # fmt: skip
    """Move F (12,) to where F·D - B*(F) is largest, Eq. (12.12), for the wanted modes D (12,); its value, or infinity
    where none is found in so many steps. Leaves the factor of the last second derivative in L (12, 12)."""
    stored = complementary(
        F, size, pull, H, share, past, curve, kinematic, wire, stretch, points, memory, B, s, strain,
        compliance, motion, soft,
    )  # fmt: skip
    reached = dot(F, wanted, size) - stored
    for _ in range(steps):
        factored(soft, size, L)
        for k in range(size):
            trial[k] = wanted[k] - motion[k]
        solved(L, size, trial, step)
        gain = dot(step, trial, size)
        if gain <= EXACT * (abs(reached) + stored):
            return reached
        length = 1.0
        while length >= LOWEST:
            for k in range(size):
                trial[k] = F[k] + length * step[k]
            stored = complementary(
                trial, size, pull, H, share, past, curve, kinematic, wire, stretch, points, memory, B, s,
                strain, compliance, motion, soft,
            )  # fmt: skip
            value = dot(trial, wanted, size) - stored
            if value >= reached + 1e-4 * length * gain - 1e-14 * (abs(reached) + stored):
                break
            # The slope along the step has turned: its zero, as if it were straight.
            slope = dot(step, wanted, size) - dot(step, motion, size)
            length *= min(max(gain / (gain - slope), 0.1), 0.5) if slope < 0.0 else 0.5
        else:
            # Nothing but rounding is left where so little is to be gained.
            return reached if gain <= ROUNDING * (abs(reached) + stored) else np.inf
        for k in range(size):
            F[k] = trial[k]
        reached = value
    return reached if gain <= ROUNDING * (abs(reached) + stored) else np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def dot(a, b, size):
    """The product of the first `size` numbers of both."""
    total = 0.0
    for k in range(size):
        total += a[k] * b[k]
    return total
