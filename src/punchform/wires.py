"""A grid of single straight wires of their own places and lengths, with free ends beyond their last crossings.

Where `grid` covers a blank with wires at equal steps, here each wire is given: an elastic gridshell is made of few. The
pieces between crossings, and those from the last crossings to the ends, have lengths of their own; those of one length
are of one kind, `Grid.kind`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.errors import InputError
from punchform.grid import Grid

SAME = 1e-9
"""Lengths that differ by less, relative to the longest wire, are the same."""


@dataclass(frozen=True)
class FlatWire:
    """One straight wire of the flat grid: its distance from the axis it is parallel to, and where along that axis it
    begins and ends [mm]."""

    offset: float
    low: float
    high: float


@dataclass(frozen=True)
class LaidWires:
    """The grid of given wires.

    lengths (P,): of the elements of each kind [mm]; nodes: per family and wire, by rising offset, the numbers of its
    nodes from the low end to the high one.
    """

    grid: Grid
    lengths: Floats
    nodes: tuple[tuple[Ints, ...], tuple[Ints, ...]]


@dataclass(frozen=True)
class _Chain:
    """One wire as nodes from low to high: its family and number; index (n,) along it in elements; at (n,) [mm]."""

    family: int
    number: int
    index: Ints
    at: Floats


def lay_wires(along_x: Sequence[FlatWire], along_y: Sequence[FlatWire], *, subdivide: int = 1) -> LaidWires:
    """Lay wires along x and wires along y over each other; they cross wherever both reach.

    subdivide: elements between two crossings, and from the last crossing to the end. Wires are numbered by rising
    offset, from 0 at the one nearest to the axis, and a crossing (i, j) is that of wire i along y with wire j along x.
    Raises InputError for wires without a length, at the same place, or without a crossing.
    """
    _demand_distinct((along_x, along_y))
    families = tuple(sorted(wires, key=lambda wire: wire.offset) for wires in (along_x, along_y))
    first = [-int(np.argmin([abs(wire.offset) for wire in wires])) for wires in families]
    chains = [
        _chain(family, number + first[family], wire, families[1 - family], first[1 - family], subdivide)
        for family, wires in enumerate(families)
        for number, wire in enumerate(wires)
    ]
    return _joined(chains, families, first, subdivide)


def wires_of(grid: Grid) -> LaidWires:
    """The wires of a grid that covers a blank, whose ends are its outermost crossings.

    Raises InputError for a quarter of a grid, and where the blank cuts a wire in two.
    """
    if grid.quarter:
        raise InputError.of(
            "the wires of a quarter end in its mirror planes", where="grid.symmetry", hint="lay the whole grid"
        )
    nodes = []
    for family in range(2):
        order = np.lexsort((grid.index[:, family], grid.index[:, 1 - family]))
        order = order[grid.passes[order, family]]
        number = grid.index[order, 1 - family]
        own = tuple(np.split(order, np.flatnonzero(np.diff(number)) + 1))
        if any((grid.neighbours[wire[:-1], family, 1] != wire[1:]).any() for wire in own):
            raise InputError.of("the blank cuts a wire in two, which then has more than two ends", where="grid.blank")
        nodes.append(own)
    size = np.linalg.norm(grid.flat[grid.end] - grid.flat[grid.start], axis=1)
    lengths = np.bincount(grid.kind, size) / np.bincount(grid.kind)
    return LaidWires(grid, lengths, (nodes[0], nodes[1]))


def _demand_distinct(families: tuple[Sequence[FlatWire], Sequence[FlatWire]]) -> None:
    for name, wires in zip(("along_x", "along_y"), families, strict=True):
        offsets = [wire.offset for wire in wires]
        if not wires or len(set(offsets)) < len(offsets):
            raise InputError.of("a family needs wires, each at another offset", where=name)
        for wire in wires:
            if not wire.low < wire.high:
                raise InputError.of(f"the wire at {wire.offset:g} mm has no length", where=name)


def _chain(family: int, number: int, wire: FlatWire, others: Sequence[FlatWire], first: int, subdivide: int) -> _Chain:
    """Stations at crossings and ends, `subdivide` elements apart; twice that past a wire that is too short to cross."""
    slack = SAME * (wire.high - wire.low)
    crossed = [
        (i + first, other.offset)
        for i, other in enumerate(others)
        if wire.low - slack <= other.offset <= wire.high + slack
        and other.low - slack <= wire.offset <= other.high + slack
    ]
    if not crossed:
        raise InputError.of(f"the wire at {wire.offset:g} mm crosses no other", where=("along_x", "along_y")[family])
    if crossed[0][1] - wire.low > slack:
        crossed.insert(0, (crossed[0][0] - 1, wire.low))
    if wire.high - crossed[-1][1] > slack:
        crossed.append((crossed[-1][0] + 1, wire.high))
    stations, places = (np.array(column) for column in zip(*crossed, strict=True))
    index = np.arange(subdivide * stations[0], subdivide * stations[-1] + 1)
    return _Chain(family, number, index, np.interp(index, subdivide * stations, places))


def _joined(chains: list[_Chain], families: tuple[list[FlatWire], ...], first: list[int], subdivide: int) -> LaidWires:
    """The chains as one grid: where two of them meet they share the node."""
    slack = SAME * max(float(np.ptp(chain.at)) for chain in chains)
    there: dict[tuple[int, int], int] = {}
    index: list[tuple[int, int]] = []
    flat: list[tuple[float, float]] = []
    nodes: list[Ints] = []
    for chain in chains:
        own = families[chain.family][chain.number - first[chain.family]].offset
        numbers = []
        for along, at in zip(chain.index.tolist(), chain.at.tolist(), strict=True):
            place, point = (along, subdivide * chain.number), (at, own)
            if chain.family:
                place, point = place[::-1], point[::-1]
            node = there.get(place) if chain.family else None
            # Ends of two wires may have the same number and yet lie apart.
            if node is None or np.abs(np.subtract(flat[node], point)).max() > slack:
                node = len(index)
                there.setdefault(place, node)
                index.append(place)
                flat.append(point)
            numbers.append(node)
        nodes.append(np.array(numbers))
    return _laid(chains, nodes, np.array(index), np.array(flat), subdivide)


def _laid(chains: list[_Chain], nodes: list[Ints], index: Ints, flat: Floats, subdivide: int) -> LaidWires:
    neighbours = np.full((len(index), 2, 2), -1)
    for chain, own in zip(chains, nodes, strict=True):
        neighbours[own[1:], chain.family, 0] = own[:-1]
        neighbours[own[:-1], chain.family, 1] = own[1:]
    family, lower = np.nonzero(neighbours[:, :, 1].T >= 0)
    upper = neighbours[lower, family, 1]
    outwards = index[lower, family] >= 0
    lengths = np.linalg.norm(flat[upper] - flat[lower], axis=1)
    _, kept, pieces = np.unique(np.round(lengths / (SAME * lengths.max())), return_index=True, return_inverse=True)
    grid = Grid(
        step=(float(subdivide * lengths[family == 0].max()), float(subdivide * lengths[family == 1].max())),
        index=index,
        flat=flat,
        family=family,
        start=np.where(outwards, lower, upper),
        end=np.where(outwards, upper, lower),
        direction=np.where(outwards, 1, -1),
        sigma=np.ones(len(family), dtype=np.int64),
        weight=np.ones(len(family)),
        neighbours=neighbours,
        on_mirror=np.zeros((len(index), 2), dtype=bool),
        quarter=False,
        subdivide=subdivide,
        pieces=pieces,
    )
    by_family = [tuple(own for chain, own in zip(chains, nodes, strict=True) if chain.family == w) for w in range(2)]
    return LaidWires(grid, lengths[kept], (by_family[0], by_family[1]))
