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

STEPS = 80
"""Newton steps for the end force of one element."""
EXACT = 1e-22
"""Gain of a step, relative to the energy, at which the end force is found."""
ROUNDING = 1e-14
"""The same where no step leads any further."""
LOWEST = 2.0**-30
"""The shortest fraction of a step that is tried."""


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def section_forces(H, F, size, s):
    """Write s = H F (4,) of the first `size` forces."""
    for k in range(4):
        total = 0.0
        for c in range(size):
            total += H[k, c] * F[c]
        s[k] = total


@njit(cache=True, nogil=True)
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
        if potential == 0.0:
            continue
        energy += share[g] * potential
        for c in range(size):
            for k in range(4):
                motion[c] += share[g] * H[g, k, c] * strain[k]
                carried = 0.0
                for r in range(4):
                    carried += compliance[k, r] * H[g, r, c]
                carried *= share[g]
                for r in range(c + 1):
                    soft[r, c] += H[g, k, r] * carried
    for c in range(size):
        for r in range(c):
            soft[c, r] = soft[r, c]
    return energy


@njit(cache=True, nogil=True)
def inverted(A, size, L, out):
    """Write the inverse of the positive definite A (size, size), by its Cholesky factor L."""
    for k in range(size):
        for c in range(k + 1):
            total = A[k, c]
            for r in range(c):
                total -= L[k, r] * L[c, r]
            if k == c:
                L[k, k] = sqrt(total) if total > 0.0 else np.nan
            else:
                L[k, c] = total / L[c, c]
    for column in range(size):
        for k in range(size):
            total = 1.0 if k == column else 0.0
            for r in range(k):
                total -= L[k, r] * out[r, column]
            out[k, column] = total / L[k, k]
        for k in range(size - 1, -1, -1):
            total = out[k, column]
            for r in range(k + 1, size):
                total -= L[r, k] * out[r, column]
            out[k, column] = total / L[k, k]


@njit(cache=True, nogil=True)
def stays_elastic(H, F, past, curve, kinematic, wire, stretch, points, s):
    """Whether nothing flows in any section under the end force F."""
    for g in range(len(H)):
        section_forces(H[g], F, 6, s)
        if not stays(s, past[g], curve, kinematic, wire, stretch, points):
            return False
    return True


@njit(cache=True, nogil=True)
def respond(
    first, last, kind, D, H, lever, weight, string, curve, kinematic, wire, points, off, stretch, pull, past, B, C,
    memory, forces, stiffness, energies,
):  # fmt: skip
    """Write forces (M, 12), whose first six are F, the derivatives of F with D, stiffness (M, 6, 6), and energies (M,)
    of the elements from first to last, Eqs. (12.12) and (12.13). The forces also are where the search begins; the
    energy is infinite where it fails."""
    count = H.shape[1]
    own, share = np.empty((count, 4, 12)), np.empty(count)
    s, strain, compliance = np.empty(4), np.empty(4), np.empty((4, 4))
    motion, wanted, trial, step = np.empty(12), np.zeros(12), np.empty(12), np.empty(12)
    soft, L, hard = np.empty((12, 12)), np.empty((12, 12)), np.empty((12, 12))
    for m in range(first, last):
        reach = 0.0
        for g in range(count):
            share[g] = weight[kind[m], g] * stretch[m]
            reach += share[g]
        levered(H[kind[m]], lever[kind[m]], off[m], string, reach, own)
        F, known = forces[m], False
        for k in range(6):
            wanted[k], trial[k] = D[m, k], 0.0
            for c in range(6):
                trial[k] += C[m, k, c] * D[m, c]
            known |= F[k] != 0.0
        if stays_elastic(own, trial, past[m], curve, kinematic, wire, stretch[m], points, s):
            energies[m] = 0.0
            for k in range(6):
                F[k], F[6 + k] = trial[k], 0.0
                energies[m] += 0.5 * trial[k] * D[m, k]
                for c in range(6):
                    stiffness[m, k, c] = C[m, k, c]
            continue
        size = 12 if pull[m] > 0.0 else 6
        for k in range(12):
            if k >= size or (k >= 6 and not known):
                F[k] = 0.0
            elif not known:
                F[k] = trial[k]
        energies[m] = largest(
            F, size, pull[m], wanted, own, share, past[m], curve, kinematic, wire, stretch[m], points, memory[m], B[m],
            s, strain, compliance, motion, trial, step, soft, L, hard,
        )  # fmt: skip
        for k in range(6):
            for c in range(6):
                stiffness[m, k, c] = hard[k, c]


@njit(cache=True, nogil=True)
def largest(
    F, size, pull, wanted, H, share, past, curve, kinematic, wire, stretch, points, memory, B,
    s, strain, compliance, motion, trial, step, soft, L, hard,
):  # fmt: skip
    """Move F (12,) to where F·D - B*(F) is largest, Eq. (12.12), for the wanted modes D (12,); its value, or infinity
    where none is found. Leaves the inverse of the last second derivative in hard (12, 12)."""
    stored = complementary(
        F, size, pull, H, share, past, curve, kinematic, wire, stretch, points, memory, B, s, strain,
        compliance, motion, soft,
    )  # fmt: skip
    reached = -stored
    for k in range(size):
        reached += F[k] * wanted[k]
    for _ in range(STEPS):
        inverted(soft, size, L, hard)
        gain = 0.0
        for k in range(size):
            step[k] = 0.0
            for c in range(size):
                step[k] += hard[k, c] * (wanted[c] - motion[c])
            gain += step[k] * (wanted[k] - motion[k])
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
            value = -stored
            for k in range(size):
                value += trial[k] * wanted[k]
            if value >= reached + 1e-4 * length * gain - 1e-14 * (abs(reached) + stored):
                break
            length *= 0.5
        else:
            # Nothing but rounding is left where so little is to be gained.
            return reached if gain <= ROUNDING * (abs(reached) + stored) else np.inf
        for k in range(size):
            F[k] = trial[k]
        reached = value
    return reached if gain <= ROUNDING * (abs(reached) + stored) else np.inf
