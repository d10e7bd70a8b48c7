"""The sparse pattern of the Hessian, and where in it every clique of unknowns adds its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numba import njit
from numpy.typing import NDArray

from punchform.arrays import Ints
from punchform.grid import Grid
from punchform.mechanics import sweeps

SEAM = 2
"""Half the width of a seam, in elements: beyond it no unknown is shared, with the longest stencil of any kinematics."""


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


@dataclass(frozen=True, eq=False)
class _Cliques:
    """What a pattern depends on, and nothing else."""

    arrays: tuple[Ints, ...]
    count: int

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, _Cliques)
            and self.count == other.count
            and len(self.arrays) == len(other.arrays)
            and all(map(np.array_equal, self.arrays, other.arrays))
        )

    def __hash__(self) -> int:
        return hash((self.count, *(array.shape for array in self.arrays)))


def analyse(cliques: Sequence[Ints], count: int) -> Pattern:
    """The pattern in which the unknowns of each clique (rows of the arrays (k, S), -1 for none) all meet."""
    return _analysed(_Cliques(tuple(cliques), count))


@lru_cache(maxsize=1)
def _analysed(wanted: _Cliques) -> Pattern:
    """The last pattern is kept: passes, stages and sweeps meet it again."""
    cliques, count = wanted.arrays, wanted.count
    width = max(clique.shape[1] for clique in cliques)
    stacked = np.full((sum(map(len, cliques)), width), -1, dtype=np.int64)
    first = 0
    for clique in cliques:
        stacked[first : first + len(clique), : clique.shape[1]] = clique
        first += len(clique)
    indptr, indices = _upper(stacked, *_owners(stacked, count))
    return Pattern(indptr, indices, tuple(_places(clique, indptr, indices) for clique in cliques))


@njit(cache=True, nogil=True)
def _owners(cliques, count):
    """The cliques that each unknown belongs to: those of unknown a at owners[begin[a] : begin[a + 1]]."""
    begin = np.zeros(count + 2, dtype=np.int64)
    for m in range(cliques.shape[0]):
        for p in range(cliques.shape[1]):
            if cliques[m, p] >= 0:
                begin[cliques[m, p] + 2] += 1
    for a in range(count):
        begin[a + 2] += begin[a + 1]
    owners = np.empty(begin[count + 1], dtype=np.int64)
    for m in range(cliques.shape[0]):
        for p in range(cliques.shape[1]):
            if cliques[m, p] >= 0:
                owners[begin[cliques[m, p] + 1]] = m
                begin[cliques[m, p] + 1] += 1
    return begin[:-1], owners


@njit(cache=True, nogil=True)
def _upper(cliques, begin, owners):
    """Upper CSR pattern of all pairs that share a clique; a first pass counts, a second writes and sorts."""
    count = len(begin) - 1
    indptr = np.zeros(count + 1, dtype=np.int64)
    seen = np.full(count, -1, dtype=np.int64)
    indices = np.empty(0, dtype=np.int64)
    for filling in (False, True):
        if filling:
            for a in range(count):
                indptr[a + 1] += indptr[a]
            indices = np.empty(indptr[count], dtype=np.int64)
            seen[:] = -1
        for a in range(count):
            entries = 0
            for place in range(begin[a], begin[a + 1]):
                clique = cliques[owners[place]]
                for b in clique:
                    if b >= a and seen[b] != a:
                        seen[b] = a
                        if filling:
                            indices[indptr[a] + entries] = b
                        entries += 1
            if filling:
                indices[indptr[a] : indptr[a + 1]].sort()
            else:
                indptr[a + 1] = entries
    return indptr, indices


def _places(clique: Ints, indptr: Ints, indices: Ints) -> NDArray[np.int32]:
    slots = clique.shape[1]
    # Half the size of the usual integers: this is the largest array of all.
    found = np.empty((len(clique), slots * (slots + 1) // 2), dtype=np.int32)
    sweeps.find_places(np.ascontiguousarray(clique), indptr, indices, found)
    return found


def shares(grid: Grid, threads: int) -> tuple[tuple[Ints, ...], Ints]:
    """Groups of elements (their numbers) that can be added at the same time, and the seams between them for after.

    Strips of the grid with seams so wide that no two strips share a node or an unknown, each in the natural order,
    in which neighbours in the grid are neighbours in memory. One group without a seam where the strips are too narrow.
    """
    along = np.sort(grid.index[np.stack((grid.start, grid.end)), 0], axis=0)
    places = np.quantile(along[0], np.arange(1, threads) / threads).astype(np.int64)
    edges = [np.iinfo(np.int64).min, *places, np.iinfo(np.int64).max]
    strips = tuple(
        np.flatnonzero((along[0] > low + SEAM * (low != edges[0])) & (along[1] < high - SEAM * (high != edges[-1])))
        for low, high in pairwise(edges)
    )
    nodes = [np.unique(np.stack((grid.start[strip], grid.end[strip]))) for strip in strips]
    apart = sum(map(len, nodes)) == len(np.unique(np.concatenate(nodes)))
    if not apart or min(map(len, strips)) == 0:
        return (np.arange(grid.elements),), np.empty(0, dtype=np.int64)
    seam = np.ones(grid.elements, dtype=bool)
    seam[np.concatenate(strips)] = False
    return strips, np.flatnonzero(seam)
