"""The flat grid: nodes, wires, elements, their weave signs and symmetry weights. No physics.

The plane z = 0 is covered by two families of wires, family 0 along x and family 1 along y::

            |       |       |
        ----o-------o-------o----   family 0, wire j + 1
            |       |       |
        ----o-------o-------o----   family 0, wire j        node (i, j): the crossing of
            |       |       |                               wire i of family 1 with wire j of family 0
          wire i  wire i+1          family 1

An element is the piece of one wire between two neighbouring crossings. Its end O (`start`) is the one nearer to
the centre line of its family, its end B (`end`) the other: Eq. (2.1). With `subdivide = n` the piece is cut into n
elements of equal step, joined at nodes that belong to this one wire, Eq. (7.5).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.drawing import drawing_room
from punchform.errors import InputError
from punchform.outline import inside, reach

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from punchform.case import GridCase

FEWEST_NODES = 9


@dataclass(frozen=True)
class Grid:
    """The grid that is solved: the whole grid or, with two mirror planes, its first quadrant.

    step: the distance between crossings along family 0 and family 1 [mm].
    index (N, 2): the integers (i, j), counted in elements: those of crossings are multiples of `subdivide`;
    flat (N, 2): x and y in the plane [mm].
    family, start, end (M,): per element its family (0 or 1) and its nodes O and B.
    direction (M,): +1 when the element runs from O to B along +x or +y, else -1.
    sigma (M,): +1 when the wire rises from O to B, -1 when it falls.
    weight (M,): 1, or 1/2 for an element that lies in a mirror plane.
    neighbours (N, 2, 2): per node and family the node before and after it along the wire, -1 for none.
    subdivide: into how many elements a wire is cut between crossings.
    pieces (M,): which kind of piece an element is, in the order of the pieces; its family when None.
    on_mirror (N, 2): whether the node lies in the mirror plane x = 0, y = 0; all False on a whole grid.
    notes: what a user should know about how the grid was laid.
    trimmed: whether a part of it was cut off after it was laid.
    """

    step: tuple[float, float]
    index: Ints
    flat: Floats
    family: Ints
    start: Ints
    end: Ints
    direction: Ints
    sigma: Ints
    weight: Floats
    neighbours: Ints
    on_mirror: Bools
    quarter: bool
    notes: tuple[str, ...] = ()
    subdivide: int = 1
    pieces: Ints | None = None
    trimmed: bool = False

    @property
    def nodes(self) -> int:
        """Number of solved nodes N."""
        return len(self.index)

    @property
    def elements(self) -> int:
        """Number of solved elements M."""
        return len(self.family)

    @property
    def kind(self) -> Ints:
        """Which kind of piece each element is, (M,)."""
        return self.family if self.pieces is None else self.pieces

    @property
    def crossings(self) -> Bools:
        """Which nodes are crossings, or ends of wires, and not between two of them, (N,)."""
        return np.asarray((self.index % self.subdivide == 0).all(axis=1))

    @property
    def node_weight(self) -> Floats:
        """The share of a node in the solved part, (N,): 1, 1/2 on a mirror plane, 1/4 on both."""
        return np.asarray(0.5 ** self.on_mirror.sum(axis=1))

    @property
    def copies(self) -> int:
        """How many times the energy of the solved part makes that of the whole grid."""
        return 4 if self.quarter else 1

    @property
    def passes(self) -> Bools:
        """Whether a wire of family w passes the node with at least one element, (N, 2)."""
        return np.asarray((self.neighbours >= 0).any(axis=2))

    @property
    def wire_ends(self) -> Bools:
        """Whether the wire of family w ends at a node, before it or after it, (N, 2, 2)."""
        missing = self.neighbours < 0
        # Before a mirror plane the wire goes on in its own image.
        missing[:, :, 0] &= ~self.on_mirror
        return np.asarray(missing & self.passes[:, :, None])

    def plot(self) -> Figure:
        """A figure of the flat grid: its wires in plan, those of a quarter with their mirror images."""
        figure: Figure = drawing_room().plot_grid(self)
        return figure

    def _repr_html_(self) -> str:
        shown: str = drawing_room().html_of_grid(self)
        return shown


def lay(
    case: GridCase, *, rim_radius: float = 0.0, mirror_planes: bool = True, reason: str = "the punch has none"
) -> Grid:
    """Lay the two families of wires over the blank.

    rim_radius: the radius the blank must reach [mm]; mirror_planes: whether punch and wire allow the two mirror
    planes x = 0 and y = 0, and the reason when they do not. A quarter grid is laid when the case asks for it and
    the planes exist, the whole grid otherwise; `notes` then says why.
    Raises InputError when the blank is too small, falls apart, or does not reach the rim.
    """
    _demand_reach(case, rim_radius)
    x, y = _lines(case, 0), _lines(case, 1)
    i, j = (a.ravel() for a in np.meshgrid(x, y, indexing="ij"))
    flat = np.column_stack(((i + _shift(case)) * case.step[0], (j + _shift(case)) * case.step[1]))
    index = np.column_stack((i, j))[inside(case.blank, flat)]
    index = _connected(index)
    why_whole = _why_whole(case, index, mirror_planes, reason)
    quarter = case.symmetry == "quarter" and not why_whole
    if quarter:
        index = index[(index >= 0).all(axis=1)]
    notes = (f"the whole grid is solved: {why_whole}",) if case.symmetry == "quarter" and why_whole else ()
    return _grid(case, index, quarter, notes)


def restepped(grid: Grid, step: tuple[float, float]) -> Grid:
    """The same nodes and wires at other steps [mm], whatever the blank then holds: for derivatives by the step."""
    return replace(grid, step=step, flat=grid.flat * (np.asarray(step) / np.asarray(grid.step)))


def undivided(grid: Grid) -> Grid:
    """The same grid with one element between two crossings: what the net and tables of crossings know."""
    if grid.subdivide == 1:
        return grid
    kept = np.flatnonzero(grid.crossings)
    index = grid.index[kept] // grid.subdivide
    first = np.flatnonzero(grid.crossings[grid.start])
    start = np.searchsorted(kept, grid.start[first])
    neighbours = _neighbours(index)
    side = (grid.direction[first] > 0).astype(np.int64)
    end = neighbours[start, grid.family[first], side]
    return replace(
        grid,
        index=index,
        flat=grid.flat[kept],
        family=grid.family[first],
        start=start,
        end=end,
        direction=grid.direction[first],
        sigma=grid.sigma[first],
        weight=grid.weight[first],
        neighbours=neighbours,
        on_mirror=grid.on_mirror[kept],
        subdivide=1,
        pieces=None,
    )


def _grid(case: GridCase, crossings: Ints, quarter: bool, notes: tuple[str, ...]) -> Grid:
    count = case.subdivide
    index = _divided(crossings, count)
    neighbours = _neighbours(index)
    family, lower = np.nonzero(neighbours[:, :, 1].T >= 0)
    upper = neighbours[lower, family, 1]
    # Every element points away from the centre line; one that crosses it points to the positive side.
    outwards = index[lower, family] >= (0 if case.centre == "node" else -count)
    start, end = np.where(outwards, lower, upper), np.where(outwards, upper, lower)
    on_mirror = (index == 0) & quarter
    # The crossing at which the whole piece begins, and how many elements this one is away from it.
    inner = np.where(outwards[:, None], index[start] // count, -(-index[start] // count))
    away = np.abs(index[start] - count * inner).max(axis=1)
    return Grid(
        step=case.step,
        index=index,
        flat=(index / count + _shift(case)) * np.asarray(case.step),
        family=family,
        start=start,
        end=end,
        direction=np.where(outwards, 1, -1),
        sigma=_weave_signs(case.weave, family, inner),
        weight=np.where(on_mirror[start, 1 - family] & on_mirror[end, 1 - family], 0.5, 1.0),
        neighbours=neighbours,
        on_mirror=on_mirror,
        quarter=quarter,
        notes=notes,
        subdivide=count,
        pieces=family * count + away,
    )


def _divided(crossings: Ints, count: int) -> Ints:
    """The indices of the crossings and of `count` - 1 nodes between each two neighbours, counted in elements."""
    if count == 1:
        return crossings
    node, family = np.nonzero(_neighbours(crossings)[:, :, 1] >= 0)
    between = (
        count * crossings[node][:, None] + np.arange(1, count)[:, None] * np.eye(2, dtype=np.int64)[family][:, None]
    )
    index = np.concatenate((count * crossings, between.reshape(-1, 2)))
    return index[np.lexsort((index[:, 1], index[:, 0]))]


def _weave_signs(weave: str, family: Ints, start: Ints) -> Ints:
    """sigma of each element from the (i, j) of its end O: the weave of Eq. (3.1)."""
    if weave == "same":
        return np.ones(len(family), dtype=np.int64)
    side = np.where(family == 0, 1, -1)
    if weave == "stacked":
        return np.asarray(-side)
    return np.asarray(side * np.where(start.sum(axis=1) % 2 == 0, 1, -1))


def _shift(case: GridCase) -> float:
    return 0.0 if case.centre == "node" else 0.5


def _lines(case: GridCase, axis: int) -> Ints:
    """The integers of all wires that the blank can hold along one axis, symmetric about the centre."""
    count = int(np.floor(reach(case.blank)[axis] / case.step[axis] * (1 + 1e-9) - _shift(case)))
    first = -count if case.centre == "node" else -count - 1
    return np.arange(first, count + 1)


def _demand_reach(case: GridCase, rim_radius: float) -> None:
    nearest = reach(case.blank)[2]
    if nearest < rim_radius * (1 - 1e-9):
        raise InputError.of(
            f"the blank reaches only {nearest:.6g} mm from the axis, the rim lies at {rim_radius:.6g} mm",
            where="grid.blank",
            hint="make the blank larger, or punch.rim_radius smaller",
        )


def _neighbours(index: Ints) -> Ints:
    """Per node and family the nodes before and after it along the wire, (N, 2, 2), -1 for none."""
    low = index.min(axis=0) - 1
    table = np.full(index.max(axis=0) - low + 2, -1, dtype=np.int64)
    at = index - low
    table[at[:, 0], at[:, 1]] = np.arange(len(index))
    before_after = [
        [table[at[:, 0] - 1, at[:, 1]], table[at[:, 0] + 1, at[:, 1]]],
        [table[at[:, 0], at[:, 1] - 1], table[at[:, 0], at[:, 1] + 1]],
    ]
    return np.asarray(np.moveaxis(np.array(before_after), 2, 0))


def _connected(index: Ints) -> Ints:
    """The nodes that belong together; single crossings on the outline without any element are left out."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if len(index) == 0:
        _too_few(0)
    after = _neighbours(index)[:, :, 1]
    node, family = np.nonzero(after >= 0)
    links = coo_array((np.ones(len(node)), (node, after[node, family])), shape=(len(index),) * 2)
    _, piece = connected_components(links, directed=False)
    sizes = np.bincount(piece)
    if (sizes > 1).sum() > 1:
        raise InputError.of(
            f"the blank falls into {(sizes > 1).sum()} separate pieces of grid at this step",
            where="grid.blank",
            hint="widen its narrow parts or take a smaller step",
        )
    kept = index[sizes[piece] > 1]
    if len(kept) < FEWEST_NODES:
        _too_few(len(kept))
    return np.asarray(kept)


def _too_few(count: int) -> None:
    raise InputError.of(
        f"the blank holds only {count} crossings; a grid needs at least {FEWEST_NODES}",
        where="grid.blank",
        hint="make the blank larger or grid.step smaller",
    )


def _why_whole(case: GridCase, index: Ints, mirror_planes: bool, reason: str) -> str:
    """Why the grid has no mirror planes through nodes, or nothing when it has them."""
    if not mirror_planes:
        return f"the grid would have mirror planes, but {reason}"
    if case.centre == "cell" and case.weave == "plain":
        return "a plain weave with a cell on the axis has no mirror planes"
    if case.centre == "cell":
        return "with a cell on the axis the mirror planes cut elements, not nodes"
    far = np.abs(index).max(axis=0)
    covered = np.zeros(2 * far + 1, dtype=bool)
    covered[tuple((index + far).T)] = True
    if not (np.array_equal(covered, covered[::-1]) and np.array_equal(covered, covered[:, ::-1])):
        return "the blank is not symmetric about both axes"
    return ""
