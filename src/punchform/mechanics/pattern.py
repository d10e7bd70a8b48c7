"""The sparse pattern of the Hessian, and where in it every clique of unknowns adds its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, triu

from punchform.arrays import Ints
from punchform.grid import Grid
from punchform.mechanics import sweeps

REACH = 4
"""Elements of one wire this far apart share no unknown, with the longest stencil of any kinematics."""


@dataclass(frozen=True)
class Pattern:
    """Upper triangle in CSR form: indptr (n + 1,), indices (entries,) sorted in each row.

    places: per list of cliques (k, S) an array (k, S (S + 1) / 2) of positions in the values, pair by pair as in
    `sweeps.scatter`; -1 for a pair with an unused unknown, -2 - position where both are the same unknown.
    """

    indptr: Ints
    indices: Ints
    places: tuple[NDArray[np.int32], ...]

    @property
    def entries(self) -> int:
        """Number of stored entries."""
        return len(self.indices)


def analyse(cliques: Sequence[Ints], count: int) -> Pattern:
    """The pattern in which the unknowns of each clique (rows of the arrays (k, S), -1 for none) all meet."""
    met = csr_array((count, count), dtype=np.int8)
    for clique in cliques:
        used = clique >= 0
        owner = np.repeat(np.arange(len(clique)), used.sum(axis=1))
        member = np.ones(used.sum(), dtype=np.int8)
        incidence = csr_array((member, (owner, clique[used])), shape=(len(clique), count))
        incidence.data[:] = 1
        met = met + incidence.astype(bool).T @ incidence.astype(bool)
    upper = csr_array(triu(met, format="csr"))
    upper.sort_indices()
    indptr, indices = upper.indptr.astype(np.int64), upper.indices.astype(np.int64)
    return Pattern(indptr, indices, tuple(_places(clique, indptr, indices) for clique in cliques))


def _places(clique: Ints, indptr: Ints, indices: Ints) -> NDArray[np.int32]:
    slots = clique.shape[1]
    # Half the size of the usual integers: this is the largest array of all.
    found = np.empty((len(clique), slots * (slots + 1) // 2), dtype=np.int32)
    sweeps.find_places(np.ascontiguousarray(clique), indptr, indices, found)
    return found


def colours(grid: Grid) -> tuple[Ints, ...]:
    """Groups of elements (their numbers) that share no unknown with others of the same group."""
    lower = np.where(grid.direction > 0, grid.start, grid.end)
    along = grid.index[lower, grid.family]
    key = REACH * grid.family + along % REACH
    return tuple(np.nonzero(key == k)[0] for k in range(2 * REACH) if (key == k).any())
