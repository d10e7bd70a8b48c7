"""The paper's Table 1 as printed, and the way from its axes and units to ours, Eq. (2.2)."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats

STEP = 7.5
"""Step of the grid that Table 1 belongs to [mm]."""

# Dubynyak et al., Table 1: the stiffness matrix of the grid element, SI (N/m, N, N m), digits as printed.
# Its axis 3 runs along the wire, its axis 1 in the direction of the crimp.
TABLE_1 = (
    (2.582e05, 9.566e-10, 1.405e06, 7.845e-13, -4.415e02, 2.163e-14),
    (9.612e-10, 8.962e04, 5.333e-11, 3.361e02, 2.061e-13, -3.361e01),
    (1.405e06, 1.318e-11, 1.181e07, -2.354e-13, -8.395e02, -2.311e-15),
    (8.073e-13, 3.361e02, -3.356e-14, 1.694e00, -3.566e-16, -1.346e-01),
    (-4.415e02, 2.092e-13, -8.395e02, -3.414e-16, 1.776e00, -7.324e-17),
    (1.891e-14, -3.361e01, -2.328e-14, -1.346e-01, -7.048e-17, 3.611e-01),
)


def to_element_axes(printed: Floats) -> Floats:
    """From Table 1's axes and SI to element axes and mm, N: C (6, 6) → (6, 6), Eq. (2.2)."""
    turn = _rotation()
    return turn @ (printed / _metres()) @ turn.T


def to_paper_axes(C: Floats) -> Floats:
    """From element axes and mm, N to Table 1's axes and SI: the inverse of `to_element_axes`."""
    turn = _rotation()
    return (turn.T @ C @ turn) * _metres()


def flexibility_to_paper_axes(B: Floats) -> Floats:
    """The same for a flexibility: (6, 6) [mm/N, 1/N, 1/(N mm)] → [m/N, 1/N, 1/(N m)]."""
    turn = _rotation()
    return (turn.T @ B @ turn) / _metres()


def _rotation() -> Floats:
    """x = z_table, y = −y_table, z = x_table for forces and moments alike: (6, 6), a proper rotation."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    return np.kron(np.eye(2), turn)


def _metres() -> Floats:
    """Factors from N/mm, N, N mm to N/m, N, N m: (6, 6)."""
    length = np.repeat([1e3, 1.0], 3)
    return np.outer(length, [1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3])
