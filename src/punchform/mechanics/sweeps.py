"""The loops over elements: where the kernels of `element` meet grids, charts and the sparse matrix.

All are plain loops that compile once and release the interpreter lock. Arrays common to them: x, normals (N, 3);
tangents (2 N, 3), row 2 node + family; family, piece, start, end, direction, sigma, weight (M,); C (P, 6, 6), offset,
length, rise (P,) per kind of piece. With `chord` the elements are seen from their chords, Eq. (3.12), else from their
frames at O, Eq. (3.2); rest (M, 10), or one row of zeros for all: as of `chord.measures`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from punchform.mechanics.chord import chord_modes, expand_chord
from punchform.mechanics.element import end_force, expand, modes, wire_ends

NO_HESSIAN, GAUSS_NEWTON, PROJECTED, EXACT = -1, 0, 1, 2
"""Kinds of Hessian that `models` can make."""


@njit(cache=True, nogil=True)
def states(
    x, normals, tangents, family, piece, start, end, direction, sigma, weight, C, offset, length, rise, chord, rest,
    D, F, energies,
):  # fmt: skip
    """Write modes D (M, 6), end forces F (M, 6) and energies (M,) of all elements, P(3), P(8)."""
    for m in range(len(family)):
        own = piece[m]
        ends = wire_ends(x, normals, tangents, family, start, end, direction, sigma, offset[own], m)
        if chord:
            chord_modes(*ends, sigma[m], offset[own], rise[own], length[own], row_of(rest, m), D[m])
        else:
            modes(*ends, sigma[m], offset[own], length[own], D[m])
        energies[m] = end_force(C[own], D[m], F[m])


@njit(cache=True, nogil=True)
def energies(
    x, normals, tangents, family, piece, start, end, direction, sigma, weight, C, offset, length, rise, chord, rest,
    energies,
):  # fmt: skip
    """Write the energies (M,) of all elements, P(8) [mJ]."""
    D, F = np.empty(6), np.empty(6)
    for m in range(len(family)):
        own = piece[m]
        ends = wire_ends(x, normals, tangents, family, start, end, direction, sigma, offset[own], m)
        if chord:
            chord_modes(*ends, sigma[m], offset[own], rise[own], length[own], row_of(rest, m), D)
        else:
            modes(*ends, sigma[m], offset[own], length[own], D)
        energies[m] = end_force(C[own], D, F)


@njit(cache=True, nogil=True)
def models(
    chosen, x, normals, tangents, family, piece, start, end, direction, sigma, weight, C, offset, length, rise, chord,
    rest, stiffness, given, forces, R, places, kind, energies, G, values,
):  # fmt: skip
    """Add the chosen elements to G (2 N, 6) and to the sparse values; write their energies.

    given: the end forces (M, 6) and their derivatives with D, stiffness (M, 6, 6), are there already, and so are the
    energies; else they follow from C by P(3) and P(8).
    G is the gradient to shifts and spin vectors; the Hessian is carried to the unknowns by R (2 N, 6, S):
    Rᵀ Jᵀ C J R for the kind GAUSS_NEWTON, with the second-order terms of Eq. (3.4) or (3.14) for EXACT, and for
    PROJECTED the latter with the negative eigenvalues of each element left out. NO_HESSIAN leaves the values alone.
    """
    exact = kind in (PROJECTED, EXACT)
    slots = R.shape[2]
    D, F, g = np.empty(6), np.empty(6), np.empty(12)
    J, K = np.empty((6, 12)), np.empty((12, 12))
    JR, CJR = np.empty((6, 2 * slots)), np.empty((6, 2 * slots))
    KR, H = np.empty((12, 2 * slots)), np.empty((2 * slots, 2 * slots))
    for number in range(len(chosen)):
        m = chosen[number]
        w, own = family[m], piece[m]
        row_o, row_b = 2 * start[m] + w, 2 * end[m] + w
        ends = wire_ends(x, normals, tangents, family, start, end, direction, sigma, offset[own], m)
        tangent = stiffness[m] if given else C[own]
        if given:
            F[:] = forces[m]
        if chord:
            energy = expand_chord(
                *ends, sigma[m], offset[own], rise[own], length[own], row_of(rest, m), tangent, given, exact, D, F, g,
                J, K,
            )  # fmt: skip
        else:
            energy = expand(*ends, sigma[m], offset[own], length[own], tangent, exact, D, F, g, J, K)
        if not given:
            energies[m] = energy
        for c in range(6):
            G[row_o, c] += weight[m] * g[c]
            G[row_b, c] += weight[m] * g[6 + c]
        if kind == NO_HESSIAN:
            continue

        carry(J, R[row_o], R[row_b], JR)
        for k in range(6):
            for q in range(2 * slots):
                total = 0.0
                for r in range(6):
                    total += tangent[k, r] * JR[r, q]
                CJR[k, q] = total
        if exact:
            carry(K, R[row_o], R[row_b], KR)

        for p in range(2 * slots):
            for q in range(p, 2 * slots):
                total = 0.0
                for k in range(6):
                    total += JR[k, p] * CJR[k, q]
                if exact:
                    for c in range(6):
                        if p < slots:
                            total += R[row_o, c, p] * KR[c, q]
                        else:
                            total += R[row_b, c, p - slots] * KR[6 + c, q]
                H[p, q] = H[q, p] = weight[m] * total
        if kind == PROJECTED:
            make_semidefinite(H)
        add(H, places[m], values)


@njit(cache=True, nogil=True)
def row_of(table, m):
    """Row m, or the only row there is."""
    return table[m if len(table) > 1 else 0]


@njit(cache=True, nogil=True)
def carry(rows, R_o, R_b, carried):
    """Write rows (k, 12) over the variables of an element as rows (k, 2 S) over its unknowns, by R of both ends."""
    slots = R_o.shape[1]
    for k in range(len(rows)):
        for q in range(slots):
            at_o = at_b = 0.0
            for c in range(6):
                at_o += rows[k, c] * R_o[c, q]
                at_b += rows[k, 6 + c] * R_b[c, q]
            carried[k, q] = at_o
            carried[k, slots + q] = at_b


@njit(cache=True, nogil=True)
def make_semidefinite(H):
    """Leave out the negative eigenvalues of the symmetric H (S, S)."""
    eigenvalues, vectors = np.linalg.eigh(H)
    for k in range(len(H)):
        if eigenvalues[k] >= 0.0:
            break
        for p in range(len(H)):
            for q in range(len(H)):
                H[p, q] -= eigenvalues[k] * vectors[p, k] * vectors[q, k]


@njit(cache=True, nogil=True)
def add(H, places, values):
    """Add the symmetric H (S, S) to the sparse values at its places (S (S + 1) / 2,), as `Pattern.places` says."""
    pair = 0
    for p in range(len(H)):
        for q in range(p, len(H)):
            place = places[pair]
            pair += 1
            if place >= 0:
                values[place] += H[p, q]
            elif place < -1:
                values[-2 - place] += 2.0 * H[p, q]


@njit(cache=True, nogil=True)
def scatter(matrices, places, kind, values):
    """Add symmetric matrices (k, S, S) to the sparse values at their places; for PROJECTED made semidefinite."""
    for m in range(len(matrices)):
        if kind == PROJECTED:
            make_semidefinite(matrices[m])
        add(matrices[m], places[m], values)


@njit(cache=True, nogil=True)
def reduce(R, G, unknowns, reduced):
    """Add Rᵀ G to the gradient over the unknowns."""
    for row in range(len(R)):
        for q in range(R.shape[2]):
            unknown = unknowns[row, q]
            if unknown < 0:
                continue
            for c in range(6):
                reduced[unknown] += R[row, c, q] * G[row, c]


@njit(cache=True, nogil=True)
def find_places(clique, indptr, indices, places):
    """Write where each pair of each clique lies in the upper CSR values, as `Pattern.places` says."""
    for m in range(len(clique)):
        pair = 0
        for p in range(clique.shape[1]):
            for q in range(p, clique.shape[1]):
                a, b = clique[m, p], clique[m, q]
                if a < 0 or b < 0:
                    places[m, pair] = -1
                else:
                    row, column = min(a, b), max(a, b)
                    low, high = indptr[row], indptr[row + 1] - 1
                    while low < high:
                        middle = (low + high) // 2
                        if indices[middle] < column:
                            low = middle + 1
                        else:
                            high = middle
                    places[m, pair] = -2 - low if p != q and a == b else low
                pair += 1
