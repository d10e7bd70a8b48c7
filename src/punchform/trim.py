"""The trim: what lies beyond a radius is cut off, and a smaller grid is left as it lies, Eq. (7.9).

Nothing is solved: the forces of the wires that were cut are missing at the new edge, and only the next stage finds the
equilibrium of what is left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.case import CrossingSpring, WireCase
from punchform.errors import InputError
from punchform.forces import wire_mass
from punchform.grid import FEWEST_NODES, Grid
from punchform.mechanics.frames import State, crossing_angle
from punchform.solved import Shaped, flow_work, kinds_of
from punchform.whole import Whole, part_of, places_in, spread_over
from punchform.wire import Element

Solid = TypeVar("Solid", bound=Shaped)
EDGE = 1e-9
"""A crossing on the radius, to this relative size, is kept."""


@dataclass(frozen=True)
class Trimmed(Shaped):
    """What is left of a grid, with the deformations and forces that it had before the cut.

    radius: what lay beyond it in plan is gone [mm]; crossings_cut, pieces_cut: how many crossings and wire pieces of
    the whole grid are gone; wires_cut: how many straight lines of wire lost something; mass_cut: of the wire that is
    gone [kg], None without a density; blank: least and largest distance from the axis at which wires now end, in the
    flat [mm].
    """

    radius: float
    crossings_cut: int
    pieces_cut: int
    wires_cut: int
    mass_cut: float | None
    blank: tuple[float, float]


def trim(
    stage: Shaped,
    radius: float,
    elements: tuple[Element, ...],
    wire: WireCase,
    *,
    crossing: str | CrossingSpring = "pinned",
) -> Trimmed:
    """Cut off what lies beyond a radius in plan, Eq. (7.9), as a stage has left it.

    elements: one for each kind of piece. Raises InputError when hardly anything is left.
    """
    grid = stage.grid
    nodes, hanging = _kept(grid, stage.state, radius)
    left = cut(grid, nodes, nodes[grid.start] & nodes[grid.end])
    state = left_of(stage.state, nodes, nodes[grid.start] & nodes[grid.end])
    all_kept = spread_over(grid, nodes)
    rest = narrowed(stage, all_kept, crossing)
    whole = replace(rest.whole, contact=np.zeros(len(rest.whole.index)))
    if whole.crossings < FEWEST_NODES:
        raise InputError.of(
            f"only {whole.crossings} crossings lie within {radius:g} mm; a grid needs at least {FEWEST_NODES}",
            where="trim.radius",
            hint="trim it further out",
        )
    lengths = tuple(element.wire_length for element in elements)
    before, after = (wire_mass(one, wire, lengths) for one in (grid, left))
    ends = np.linalg.norm(left.flat[left.wire_ends.any(axis=(1, 2))], axis=1)
    return Trimmed(
        grid=left,
        state=state,
        whole=whole,
        energy=rest.energy,
        energy_kinds=rest.energy_kinds,
        notes=_remarks(stage.whole, all_kept, radius, int(spread_over(grid, hanging).sum())),
        hardening=stage.hardening,
        flow_work=flow_work(left, state),
        radius=radius,
        crossings_cut=stage.whole.crossings - whole.crossings,
        pieces_cut=len(stage.whole.family) - len(whole.family),
        wires_cut=_lines_cut(stage.whole, all_kept),
        mass_cut=None if before is None or after is None else before - after,
        blank=(float(ends.min()), float(ends.max())),
    )


def narrowed(stage: Solid, nodes: Bools, crossing: str | CrossingSpring) -> Solid:
    """A stage told of its kept nodes (N,) of the whole grid alone: shape and energy as if the rest had been cut off."""
    whole = part_of(stage.whole, nodes)
    kinds = kinds_of(whole) | {"crossing": _springs(whole, crossing)}
    return replace(stage, whole=whole, energy=sum(kinds.values()), energy_kinds=kinds)


def cut(grid: Grid, nodes: Bools, elements: Bools) -> Grid:
    """The grid of the kept nodes (N,) and elements (M,), in their order; both nodes of a kept element are kept."""
    if nodes.all() and elements.all():
        return grid
    number = np.where(nodes, np.cumsum(nodes) - 1, -1)
    start, end = number[grid.start[elements]], number[grid.end[elements]]
    family, direction = grid.family[elements], grid.direction[elements]
    side = (direction > 0).astype(np.int64)
    neighbours = np.full((int(nodes.sum()), 2, 2), -1, dtype=np.int64)
    neighbours[start, family, side] = end
    neighbours[end, family, 1 - side] = start
    return replace(
        grid,
        index=grid.index[nodes],
        flat=grid.flat[nodes],
        family=family,
        start=start,
        end=end,
        direction=direction,
        sigma=grid.sigma[elements],
        weight=grid.weight[elements],
        neighbours=neighbours,
        on_mirror=grid.on_mirror[nodes],
        pieces=None if grid.pieces is None else grid.pieces[elements],
        trimmed=True,
    )


def left_of(state: State, nodes: Bools, elements: Bools) -> State:
    """The state of the kept nodes (N,) and elements (M,): places and frames are of nodes, what wires remember of
    elements."""
    return replace(
        state,
        positions=state.positions[nodes],
        normals=state.normals[nodes],
        tangents=state.tangents[nodes],
        history=None if state.history is None else state.history.of(np.flatnonzero(elements)),
    )


def cut_like(grid: Grid, whole: Whole) -> Grid:
    """What is left of a grid laid without mirror planes when the nodes are those of a whole grid."""
    nodes = places_in(whole.flat, grid.flat) >= 0
    return cut(grid, nodes, nodes[grid.start] & nodes[grid.end])


def _kept(grid: Grid, state: State, radius: float) -> tuple[Bools, Bools]:
    """The nodes (N,) that stay, and those within the radius that hang on nothing which stays."""
    beyond = np.linalg.norm(state.positions[:, :2], axis=1) > radius * (1 + EDGE)
    # A wire is cut off at its last crossing: nodes between two crossings stay if both do.
    lost = beyond & grid.crossings
    inner = ~grid.crossings
    for _ in range(grid.subdivide - 1):
        lost[inner] |= np.append(lost, False)[grid.neighbours[inner]].any(axis=(1, 2))
    piece = _pieces(grid, ~lost)
    weights = np.bincount(piece, np.where(lost, 0.0, grid.node_weight))
    kept = ~lost & (piece == weights.argmax())
    return kept, ~lost & ~kept & grid.crossings & _wired(grid, ~lost)


def _pieces(grid: Grid, nodes: Bools) -> Floats:
    """Which connected piece of grid each node belongs to, (N,); nodes that are not kept are pieces of their own."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = nodes[grid.start] & nodes[grid.end]
    pairs = (grid.start[links], grid.end[links])
    joined = coo_array((np.ones(int(links.sum())), pairs), shape=(grid.nodes, grid.nodes))
    return np.asarray(connected_components(joined, directed=False)[1])


def _wired(grid: Grid, nodes: Bools) -> Bools:
    """The nodes (N,) with an element between kept ones."""
    links = nodes[grid.start] & nodes[grid.end]
    wired = np.zeros(grid.nodes, dtype=bool)
    wired[grid.start[links]] = wired[grid.end[links]] = True
    return wired


def _springs(whole: Whole, crossing: str | CrossingSpring) -> float:
    """Energy of the crossing springs of a whole grid, Eq. (4.5) [mJ]: where both wires pass."""
    if not isinstance(crossing, CrossingSpring):
        return 0.0
    passed = np.zeros((len(whole.index), 2), dtype=bool)
    passed[whole.start, whole.family - 1] = passed[whole.end, whole.family - 1] = True
    turned = crossing_angle(State(whole.positions, whole.normals, whole.tangents)) - 0.5 * np.pi
    return float(0.5 * crossing.stiffness * np.sum(turned[passed.all(axis=1)] ** 2))


def _lines_cut(whole: Whole, nodes: Bools) -> int:
    """How many straight lines of wire of a whole grid lose an element."""
    lost = ~(nodes[whole.start] & nodes[whole.end])
    family = whole.family[lost]
    across = whole.flat[whole.start[lost], 2 - family]
    return len(np.unique(np.column_stack((family, across)), axis=0))


def _remarks(whole: Whole, nodes: Bools, radius: float, hanging: int) -> tuple[str, ...]:
    """What a user should know about a trimmed grid."""
    notes = []
    if nodes.all():
        notes.append(f"no crossing lies beyond {radius:g} mm: the trim cuts nothing off")
    if hanging:
        notes.append(
            f"{hanging} crossings within {radius:g} mm hang on nothing that stays: they fall off with the trim"
        )
    return tuple(notes)
