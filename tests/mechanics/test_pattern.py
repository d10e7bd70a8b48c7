"""The places of the sparse pattern against an assembly with plain loops into a full matrix."""

from __future__ import annotations

import numpy as np
import pytest
from small_grids import STEP, dense, differences, energy_of, free_frames, grid, random_state

from punchform.arrays import Floats
from punchform.mechanics import element
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State
from punchform.mechanics.linear import upper_matrix
from punchform.mechanics.pattern import analyse

TINY = {
    "pinned": lambda: energy_of(free_frames(grid(2.0 * STEP))),
    "welded": lambda: energy_of(free_frames(grid(2.0 * STEP, symmetry="full"), welded=True)),
    "spring": lambda: energy_of(free_frames(grid(2.0 * STEP, symmetry="full")), crossing=300.0),
    "no surface": lambda: energy_of(free_frames(grid(2.0 * STEP), None)),
    "differences": lambda: energy_of(differences(grid(2.0 * STEP, symmetry="full"))),
    "differences, quarter": lambda: energy_of(differences(grid(3.0 * STEP)), crossing=300.0),
}


def _element_derivatives(energy: Energy, state: State, m: int) -> tuple[Floats, Floats]:
    """Gradient (12,) and Hessian (12, 12) of one element to (a, w_O, b, w_B)."""
    laid, bars = energy.grid, energy.bars
    w = laid.family[m]
    sigma, e = float(laid.sigma[m]), bars.offset[w]
    vectors = element.wire_ends(
        *(state.positions, state.normals, state.tangents.reshape(-1, 3), laid.family, laid.start, laid.end),
        *(laid.direction.astype(float), laid.sigma.astype(float), e, m),
    )
    D, J, K = np.empty(6), np.empty((6, 12)), np.empty((12, 12))
    element.modes(*vectors, sigma, e, bars.length[w], D)
    element.mode_rates(*vectors, sigma, e, J)
    F = bars.C[w] @ D
    element.second_order(*vectors[1:], element.loads(*vectors, sigma, e, F), K)
    return J.T @ F, J.T @ bars.C[w] @ J + K


def _by_loops(energy: Energy, state: State) -> tuple[Floats, Floats]:
    """Gradient and exact Hessian without a pattern: full matrices from unknowns to the element variables."""
    laid, kinematics = energy.grid, energy.kinematics
    chart = kinematics.chart(state)
    n = kinematics.count
    rates = np.zeros((2 * laid.nodes, 6, n))
    for row, unknowns in enumerate(kinematics.unknowns):
        for slot, unknown in enumerate(unknowns):
            if unknown >= 0:
                rates[row, :, unknown] += chart.R[row, :, slot]
    H, G = np.zeros((n, n)), np.zeros((2 * laid.nodes, 6))
    for m in range(laid.elements):
        o, b = 2 * laid.start[m] + laid.family[m], 2 * laid.end[m] + laid.family[m]
        g, h = _element_derivatives(energy, chart.state, m)
        T = np.concatenate((rates[o], rates[b]))
        G[o] += laid.weight[m] * g[:6]
        G[b] += laid.weight[m] * g[6:]
        H += laid.weight[m] * T.T @ h @ T
    for node in range(laid.nodes if energy.crossing else 0):
        if laid.passes[node].all():
            first, second = (chart.state.normals[node] @ rates[2 * node + w, 3:] for w in range(2))
            stiffness = energy.crossing * laid.node_weight[node]
            H += stiffness * np.outer(second - first, second - first)
            t1, t2 = chart.state.tangents[node]
            moment = stiffness * (np.arccos(t1 @ t2) - np.pi / 2) * chart.state.normals[node]
            G[2 * node, 3:] -= moment
            G[2 * node + 1, 3:] += moment
    for row, matrix in enumerate(chart.curvature(G)):
        for p, a in enumerate(kinematics.unknowns[row]):
            for q, b in enumerate(kinematics.unknowns[row]):
                if a >= 0 and b >= 0:
                    H[a, b] += matrix[p, q]
    return np.einsum("rcn,rc->n", rates, G), H


@pytest.mark.parametrize("name", TINY)
def test_the_sparse_matrix_is_the_full_one(name: str) -> None:
    energy = TINY[name]()
    state = random_state(energy.kinematics, energy.grid, np.random.default_rng(8))
    model = energy.model(energy.kinematics.chart(state), Hessian.EXACT)
    gradient, H = _by_loops(energy, state)
    np.testing.assert_allclose(model.gradient, gradient, rtol=0, atol=1e-12 * np.abs(gradient).max())
    np.testing.assert_allclose(dense(energy, model.values), H, rtol=0, atol=1e-12 * np.abs(H).max())


@pytest.mark.parametrize("name", TINY)
def test_the_pattern_is_an_upper_triangle_without_gaps_on_the_diagonal(name: str) -> None:
    energy = TINY[name]()
    pattern = energy.pattern
    n = energy.kinematics.count
    matrix = upper_matrix(pattern, np.ones(pattern.entries))
    rows = np.repeat(np.arange(n), np.diff(pattern.indptr))
    assert matrix.shape == (n, n)
    assert (pattern.indices >= rows).all()
    assert (np.diff(pattern.indices)[np.diff(rows) == 0] > 0).all()
    np.testing.assert_array_equal(matrix.diagonal(), np.ones(n))


def test_places_say_what_each_pair_does() -> None:
    # One clique in which unknown 2 stands twice and one slot is not used.
    pattern = analyse([np.array([[2, -1, 0, 2]])], 3)
    np.testing.assert_array_equal(
        upper_matrix(pattern, np.array([1.0, 2, 3])).toarray(), [[1, 0, 2], [0, 0, 0], [0, 0, 3]]
    )
    twice = -2 - 2
    np.testing.assert_array_equal(pattern.places[0], [[2, -1, 1, twice, -1, -1, -1, 0, 1, 2]])
