"""The whole grid as a user sees it, also when only a quarter was solved: nodes, elements, cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.grid import Grid
from punchform.mechanics.frames import State


@dataclass(frozen=True)
class Whole:
    """Arrays over all N nodes (sorted by i, then j), M elements and K cells of the grid.

    index (N, 2): (i, j); flat, positions (N, 3) [mm]; normals (N, 3) and tangents (N, 2, 3), along +x
    and +y, of the node frames, whose normals lean a little against those of the surface;
    contact (N,): normal force of the tool [N], positive where the punch pushes the grid away.
    family (M,): 1 along x, 2 along y; start, end (M,): node numbers of O and B; sigma (M,): weave sign;
    D, F (M, 6): modes and end forces in element axes, Eq. (3.2), P(3) [mm, rad; N, N mm]; energy (M,) [mJ];
    axial_strain (M,): of the pull F1 alone, Eq. (3.9); stress (M,): largest von Mises stress [MPa], NaN when the
    section is not known; stress_ratio (M,): stress over yield strength, NaN when that is not given.
    cells (K, 4): corners counter-clockwise; cell_shear (K,): how far the mid-lines are from square [rad], positive
    where the angle between +x and +y wires has become smaller.
    """

    index: Ints
    flat: Floats
    positions: Floats
    normals: Floats
    tangents: Floats
    contact: Floats
    family: Ints
    start: Ints
    end: Ints
    sigma: Ints
    D: Floats
    F: Floats
    energy: Floats
    axial_strain: Floats
    stress: Floats
    stress_ratio: Floats
    cells: Ints
    cell_shear: Floats


def unfold(
    grid: Grid,
    state: State,
    *,
    D: Floats,
    F: Floats,
    energy: Floats,
    contact: Floats,
    stress: Floats,
    axial_compliance: Floats,
    yield_strength: float | None,
) -> Whole:
    """The whole grid from its solved part. D, F (M, 6), energy, stress (M,) and contact (N,) are of that part;
    axial_compliance (2,): strain per pull of each family, Eq. (3.9) [1/N].

    A mirrored wire turns the other way: D2, D4, D6 (sideways, twist, sideways bending) change sign with every mirror.
    """
    source, signs = _node_copies(grid)
    number = _numbers(grid.index[source] * signs)
    element, element_signs = _element_copies(grid)
    turned = np.ones((len(element), 6))
    turned[:, 1::2] = element_signs.prod(axis=1)[:, None]
    space = np.column_stack((signs, np.ones(len(signs), dtype=np.int64)))
    positions = state.positions[source] * space
    index = grid.index[source] * signs
    cells = _cells(index, number)
    return Whole(
        index=index,
        flat=np.column_stack((grid.flat[source] * signs, np.zeros(len(source)))),
        positions=positions,
        normals=state.normals[source] * space,
        tangents=state.tangents[source] * space[:, None] * signs[:, :, None],
        contact=contact[source] / grid.node_weight[source],
        family=grid.family[element] + 1,
        start=_at(number, index, grid.index[grid.start[element]] * element_signs),
        end=_at(number, index, grid.index[grid.end[element]] * element_signs),
        sigma=grid.sigma[element],
        D=D[element] * turned,
        F=F[element] * turned,
        energy=energy[element],
        axial_strain=F[element, 0] * axial_compliance[grid.family[element]],
        stress=stress[element],
        stress_ratio=stress[element] / (np.nan if yield_strength is None else yield_strength),
        cells=cells,
        cell_shear=cell_shear(positions, cells),
    )


def state_on(grid: Grid, whole: Whole) -> State:
    """The state of a grid laid without mirror planes, from the whole grid that a quarter of it stood for."""
    place = _at(_numbers(whole.index), whole.index, grid.index)
    return State(whole.positions[place], whole.normals[place], whole.tangents[place])


def unfold_vectors(grid: Grid, vectors: Floats, odd: tuple[bool, bool] = (False, False)) -> Floats:
    """Vectors at the solved nodes (N, 3) as those of the whole grid; odd: they change sign across x = 0, y = 0."""
    source, signs = _node_copies(grid)
    space = np.column_stack((signs, np.ones(len(signs), dtype=np.int64)))
    flips = np.where(odd, signs, 1).prod(axis=1)
    return np.asarray(vectors[source] * space * flips[:, None])


def cell_shear(positions: Floats, cells: Ints) -> Floats:
    """Shear of the cells (K,) [rad]: a right angle less the angle between the two mid-lines."""
    p, q, r, s = (positions[cells[:, k]] for k in range(4))
    along_x, along_y = q + r - p - s, r + s - p - q
    lengths = np.linalg.norm(along_x, axis=1) * np.linalg.norm(along_y, axis=1)
    return np.asarray(np.arcsin(np.clip(np.sum(along_x * along_y, axis=1) / lengths, -1.0, 1.0)))


def _mirrors(grid: Grid) -> list[tuple[int, int]]:
    return [(sx, sy) for sx in (1, -1) for sy in (1, -1)] if grid.quarter else [(1, 1)]


def _node_copies(grid: Grid) -> tuple[Ints, Ints]:
    """Per node of the whole grid the solved node it copies, (N,), and its mirror signs (N, 2); sorted by (i, j)."""
    source, signs = _copies(grid, grid.on_mirror)
    index = grid.index[source] * signs
    order = np.lexsort((index[:, 1], index[:, 0]))
    return source[order], signs[order]


def _element_copies(grid: Grid) -> tuple[Ints, Ints]:
    """The same for elements, unsorted."""
    return _copies(grid, grid.on_mirror[grid.start] & grid.on_mirror[grid.end])


def _copies(grid: Grid, in_plane: Bools) -> tuple[Ints, Ints]:
    """What lies in a mirror plane (n, 2) is not copied by it."""
    source, signs = [], []
    for sx, sy in _mirrors(grid):
        copied = np.nonzero(~((in_plane[:, 0] & (sx < 0)) | (in_plane[:, 1] & (sy < 0))))[0]
        source.append(copied)
        signs.append(np.broadcast_to((sx, sy), (len(copied), 2)))
    return np.concatenate(source), np.concatenate(signs)


def _numbers(index: Ints) -> Ints:
    """A table of node numbers over (i, j), -1 where there is no node; it has a margin of one."""
    low = index.min(axis=0)
    table = np.full(index.max(axis=0) - low + 2, -1, dtype=np.int64)
    table[tuple((index - low).T)] = np.arange(len(index))
    return table


def _at(number: Ints, index: Ints, wanted: Ints) -> Ints:
    return np.asarray(number[tuple((wanted - index.min(axis=0)).T)])


def _cells(index: Ints, number: Ints) -> Ints:
    """Corners of all complete cells, (K, 4), counter-clockwise from the lowest (i, j)."""
    at = index - index.min(axis=0)
    corners = [number[at[:, 0] + a, at[:, 1] + b] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    cells = np.column_stack(corners)
    return np.asarray(cells[(cells >= 0).all(axis=1)])
