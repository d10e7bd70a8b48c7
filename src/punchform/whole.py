"""The whole grid as a user sees it, also when only a quarter was solved: nodes, elements, cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.grid import Grid
from punchform.mechanics.frames import State

NodeValues = TypeVar("NodeValues", Floats, Bools)
OF_NODES = ("index", "between", "flat", "positions", "normals", "tangents", "contact")
"""The arrays of a whole grid that have a row for each node."""


@dataclass(frozen=True)
class Whole:
    """Arrays over all N nodes (crossings first, by i, then j), M elements and K cells of the grid.

    index (N, 2): (i, j), of a node between two crossings those of the one nearer to the centre; between (N,): how many
    elements away that one is, 0 for crossings and wire ends; flat, positions (N, 3) [mm]; normals (N, 3) and tangents
    (N, 2, 3), along +x and +y, of the node frames, whose normals lean a little against those of the surface;
    contact (N,): normal force of the tool [N], positive where the punch pushes the grid away.
    family (M,): 1 along x, 2 along y; kind (M,): of piece, as `Grid.kind`; start, end (M,): node numbers of O and B;
    sigma (M,): weave sign;
    D, F (M, 6): modes and end forces in element axes, Eq. (3.2), P(3) [mm, rad; N, N mm]; energy (M,) [mJ];
    axial_strain (M,): of the pull F1 alone, Eq. (3.9), for a wire that yields by how much it is longer than when it was
    new; stretch (M,): length of the unloaded wire over that of the new one; plastic_strain (M,): largest equivalent one
    of its sections; stress (M,): largest von Mises stress [MPa], that of Eq. (12.4) for a wire that yields, NaN when
    the section is not known; stress_ratio (M,): stress over yield strength, NaN when that is not given.
    cells (K, 4): corners counter-clockwise; cell_shear (K,): how far the mid-lines are from square [rad], positive
    where the angle between +x and +y wires has become smaller.
    """

    index: Ints
    between: Ints
    flat: Floats
    positions: Floats
    normals: Floats
    tangents: Floats
    contact: Floats
    family: Ints
    kind: Ints
    start: Ints
    end: Ints
    sigma: Ints
    D: Floats
    F: Floats
    energy: Floats
    axial_strain: Floats
    stretch: Floats
    plastic_strain: Floats
    stress: Floats
    stress_ratio: Floats
    cells: Ints
    cell_shear: Floats

    @property
    def crossings(self) -> int:
        """How many of the nodes, from the first, are crossings or wire ends."""
        return int((self.between == 0).sum())


def unfold(
    grid: Grid,
    state: State,
    *,
    D: Floats,
    F: Floats,
    energy: Floats,
    contact: Floats,
    stress: Floats,
    axial_strain: Floats,
    stretch: Floats,
    plastic_strain: Floats,
    yield_strength: float | None,
) -> Whole:
    """The whole grid from its solved part, of which are D, F (M, 6), energy, stress, strains, stretch (M,) and
    contact (N,).

    A mirrored wire turns the other way: D2, D4, D6 (sideways, twist, sideways bending) change sign with every mirror.
    """
    source, signs = _node_copies(grid)
    number = _numbers(grid, source, signs)
    element, element_signs = _element_copies(grid)
    turned = np.ones((len(element), 6))
    turned[:, 1::2] = element_signs.prod(axis=1)[:, None]
    space = np.column_stack((signs, np.ones(len(signs), dtype=np.int64)))
    positions = state.positions[source] * space
    index, between = _crossing_near(grid)
    index = index[source] * signs
    cells = _cells(index, np.flatnonzero(np.all(grid.passes[source], axis=1)))
    return Whole(
        index=index,
        between=between[source],
        flat=np.column_stack((grid.flat[source] * signs, np.zeros(len(source)))),
        positions=positions,
        normals=state.normals[source] * space,
        tangents=_with_those_across(grid, state)[source] * space[:, None] * signs[:, :, None],
        contact=contact[source] / grid.node_weight[source],
        family=grid.family[element] + 1,
        kind=grid.kind[element],
        start=_at(number, grid, grid.start[element], element_signs),
        end=_at(number, grid, grid.end[element], element_signs),
        sigma=grid.sigma[element],
        D=D[element] * turned,
        F=F[element] * turned,
        energy=energy[element],
        axial_strain=axial_strain[element],
        stretch=stretch[element],
        plastic_strain=plastic_strain[element],
        stress=stress[element],
        stress_ratio=stress[element] / (np.nan if yield_strength is None else yield_strength),
        cells=cells,
        cell_shear=cell_shear(positions, cells),
    )


def state_on(grid: Grid, whole: Whole) -> State:
    """The state of a grid laid without mirror planes, from the whole grid that a quarter of it stood for."""
    source, _ = _node_copies(grid)
    place = np.argsort(source)
    return State(whole.positions[place], whole.normals[place], whole.tangents[place])


def unfold_vectors(grid: Grid, vectors: Floats, odd: tuple[bool, bool] = (False, False)) -> Floats:
    """Vectors at the solved nodes (N, 3) as those of the whole grid; odd: they change sign across x = 0, y = 0."""
    source, signs = _node_copies(grid)
    space = np.column_stack((signs, np.ones(len(signs), dtype=np.int64)))
    flips = np.where(odd, signs, 1).prod(axis=1)
    return np.asarray(vectors[source] * space * flips[:, None])


def unfold_loads(grid: Grid, loads: Floats) -> Floats:
    """Forces and moments at the ends of the solved elements (m, 2, 6) as those of the elements of the whole grid."""
    source, signs = _element_copies(grid)
    space = np.column_stack((signs, np.ones(len(signs), dtype=np.int64)))
    turned = np.concatenate((space, signs.prod(axis=1)[:, None] * space), axis=1)
    return np.asarray(loads[source] * turned[:, None])


def fold_vectors(grid: Grid, vectors: Floats) -> Floats:
    """What vectors at the nodes of the whole grid (N, 3) do to the solved nodes (n, 3): the transpose of unfolding."""
    source, signs = _node_copies(grid)
    space = np.column_stack((signs, np.ones(len(signs), dtype=np.int64)))
    folded = np.zeros((grid.nodes, 3))
    np.add.at(folded, source, vectors * space)
    return folded


def spread_over(grid: Grid, values: NodeValues) -> NodeValues:
    """What is known of the solved nodes (N, ...) and the same for mirror images, of all nodes of the whole grid."""
    return np.asarray(values[_node_copies(grid)[0]])


def part_of(whole: Whole, nodes: Bools) -> Whole:
    """The kept nodes (N,) of a whole grid with the elements and cells that lose none of theirs."""
    number = np.where(nodes, np.cumsum(nodes) - 1, -1)
    elements = nodes[whole.start] & nodes[whole.end]
    cells = nodes[whole.cells].all(axis=1)
    kept = {name: getattr(whole, name)[nodes] for name in OF_NODES}
    kept |= {name: number[getattr(whole, name)[elements]] for name in ("start", "end")}
    kept |= {"cells": number[whole.cells[cells]], "cell_shear": whole.cell_shear[cells]}
    others = {name: value[elements] for name, value in vars(whole).items() if name not in kept}
    return Whole(**kept, **others)


def places_in(other: Floats, flat: Floats) -> Ints:
    """Where each node that is flat at (N, 2 or 3) is among others that are flat at (n, 2 or 3); -1 where it is not."""
    # Adding 0.0 takes the sign off a zero: images of one place are the same numbers.
    there = {place: number for number, place in enumerate(map(tuple, (other[:, :2] + 0.0).tolist()))}
    return np.array([there.get((x, y), -1) for x, y in (flat[:, :2] + 0.0).tolist()], dtype=np.int64)


def numbers_in_whole(grid: Grid) -> Ints:
    """The number that each solved node has in the whole grid, (N,)."""
    return np.asarray(_numbers(grid, *_node_copies(grid))[0, 0])


def cell_shear(positions: Floats, cells: Ints) -> Floats:
    """Shear of the cells (K,) [rad]: a right angle less the angle between the two mid-lines."""
    p, q, r, s = (positions[cells[:, k]] for k in range(4))
    along_x, along_y = q + r - p - s, r + s - p - q
    lengths = np.linalg.norm(along_x, axis=1) * np.linalg.norm(along_y, axis=1)
    return np.asarray(np.arcsin(np.clip(np.sum(along_x * along_y, axis=1) / lengths, -1.0, 1.0)))


def node_shear(nodes: int, cells: Ints, shear: Floats) -> Floats:
    """Mean of the shear (K,) of the cells (K, 4) around each node, (N,), in its unit; NaN for a node without a cell."""
    corners = cells.ravel()
    total = np.bincount(corners, np.repeat(shear, 4), nodes)
    count = np.bincount(corners, minlength=nodes)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _mirrors(grid: Grid) -> list[tuple[int, int]]:
    return [(sx, sy) for sx in (1, -1) for sy in (1, -1)] if grid.quarter else [(1, 1)]


def _node_copies(grid: Grid) -> tuple[Ints, Ints]:
    """Per node of the whole grid the solved node it copies, (N,), and its mirror signs (N, 2).

    Sorted by (i, j), crossings first; grids with the same nodes have them in the same order.
    """
    source, signs = _copies(grid, grid.on_mirror)
    index = grid.index[source] * signs
    order = np.lexsort((index[:, 1], index[:, 0], ~grid.crossings[source]))
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


def _numbers(grid: Grid, source: Ints, signs: Ints) -> Ints:
    """The number in the whole grid of each solved node's image under the mirror signs, (2, 2, N); index 1 for -1."""
    table = np.full((2, 2, grid.nodes), -1, dtype=np.int64)
    table[(*(signs.T < 0).astype(np.int64), source)] = np.arange(len(source))
    return table


def _at(number: Ints, grid: Grid, node: Ints, signs: Ints) -> Ints:
    """The numbers of the images of solved nodes; a node in a mirror plane is its own image."""
    mirrored = (signs < 0) & ~grid.on_mirror[node]
    return np.asarray(number[mirrored[:, 0].astype(np.int64), mirrored[:, 1].astype(np.int64), node])


def _with_those_across(grid: Grid, state: State) -> Floats:
    """Tangents (N, 2, 3); where only one wire passes the other is the direction across it, which nothing else moves."""
    tangents = state.tangents.copy()
    for family, turn in ((0, -1.0), (1, 1.0)):
        alone = ~grid.passes[:, family]
        tangents[alone, family] = turn * np.cross(state.normals[alone], tangents[alone, 1 - family])
    return tangents


def _crossing_near(grid: Grid) -> tuple[Ints, Ints]:
    """(i, j) of each solved node, or of the crossing nearer to the centre between two; and how far away that is."""
    index, away = grid.index // grid.subdivide, np.zeros(grid.nodes, dtype=np.int64)
    inner = ~grid.crossings[grid.start]
    node, direction = grid.start[inner], grid.direction[inner, None]
    index[node] = direction * (direction * grid.index[node] // grid.subdivide)
    away[node] = np.abs(grid.index[node] - grid.subdivide * index[node]).max(axis=1)
    return index, away


def _cells(index: Ints, crossed: Ints) -> Ints:
    """Corners of all complete cells, (K, 4), counter-clockwise from the lowest (i, j); crossed: numbers of the nodes
    that both families pass, as all corners of a cell do."""
    if not len(crossed):
        return np.empty((0, 4), dtype=np.int64)
    at = index[crossed] - index[crossed].min(axis=0)
    table = np.full(at.max(axis=0) + 2, -1, dtype=np.int64)
    table[tuple(at.T)] = crossed
    corners = [table[at[:, 0] + a, at[:, 1] + b] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    cells = np.column_stack(corners)
    return np.asarray(cells[(cells >= 0).all(axis=1)])
