"""The modes in which the energy curves downwards, from the factor of an indefinite Hessian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from punchform.arrays import Floats
from punchform.mechanics.linear import Factor

ACCURACY = 1e-3
"""Relative accuracy of the eigenvalues: the modes only choose a way downhill."""


@dataclass(frozen=True)
class Modes:
    """Negative eigenvalues (k,) of the Hessian and their unit eigenvectors as columns, (n, k)."""

    values: Floats
    shapes: Floats

    def downhill(self, z: Floats, gradient: Floats) -> Floats:
        """The Newton direction z with its part in these modes turned round: the step of |H| instead of H."""
        return np.asarray(z + 2 * self.shapes @ ((gradient @ self.shapes) / self.values))


def negative_modes(factor: Factor, count: int) -> Modes | None:
    """The `count` negative eigenvalues and their modes by Lanczos iteration on the inverse; None when it fails."""
    n = factor.upper.shape[0]
    if count >= n - 1:
        return None
    inverse = LinearOperator((n, n), matvec=factor.raw_solve, dtype=np.float64)
    # The most negative eigenvalues of the inverse belong to the negative ones of the matrix.
    begin = np.cos(np.arange(n))
    try:
        inverted, shapes = eigsh(inverse, k=count, which="SA", v0=begin, tol=ACCURACY)
    except ArpackError:
        return None
    below = inverted < 0
    return Modes(1.0 / inverted[below], shapes[:, below]) if below.any() else None
