"""Laying the net: two generator wires, then quadrant by quadrant, and what it says of itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.errors import InputError
from punchform.grid import Grid
from punchform.net.fate import PLACED, UNPLACED
from punchform.net.ground import Ground, Quadrant, ground, quadrant_between
from punchform.net.words import notes_on
from punchform.punch import Surface


@dataclass(frozen=True)
class Net:
    """The net of a grid on a surface, Eq. (6.5).

    positions (N, 3): nodes in the order of the grid [mm], NaN where `reached` (N,) is False.
    cells (K, 4): corners of the complete cells, counter-clockwise from the lowest (i, j); shear (K,): how far the
    angle between their +x and +y mid-lines has closed from 90 degrees [rad], NaN for a cell that is not reached.
    limit: the shear at which the net locks [rad]; locked (K,): the cells beyond it.
    notes: in words, where it locks or ends and what to change; empty for a net that can be formed.
    """

    positions: Floats
    reached: Bools
    cells: Ints
    shear: Floats
    limit: float
    locked: Bools
    notes: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether every node has its place."""
        return bool(self.reached.all())

    @property
    def max_shear(self) -> float:
        """Largest shear without its sign [rad], 0 when no cell is reached."""
        known = np.abs(self.shear[np.isfinite(self.shear)])
        return float(known.max(initial=0.0))


def touching(diameter: float, step: tuple[float, float]) -> float:
    """The shear [rad] at which neighbouring wires of this diameter touch: cos γ = d / s, the lesser step s.

    Raises InputError for a wire that is as thick as the step.
    """
    if not diameter < min(step):
        raise InputError.of(
            f"wires of {diameter:g} mm do not fit side by side at a step of {min(step):g} mm",
            where="wire.diameter",
            hint="take a thinner wire or a larger grid.step",
        )
    return math.acos(diameter / min(step))


def lay_net(
    grid: Grid,
    surface: Surface,
    *,
    shear_limit: float = 0.5 * math.pi,
    origin: tuple[float, float] | None = None,
    direction: float = 0.0,
) -> Net:
    """Lay the grid on the surface with every edge, as a chord, exactly one step long.

    Without an origin on a surface with mirror planes, the wires (or with a cell on the axis, the strips of cells)
    along these planes stay in them. Otherwise the axis of the grid is put at origin = (x, y) [mm], and the wires
    through the node (0, 0) are geodesics, the first at `direction` [rad] to x in plan.
    shear_limit [rad]: where the net counts as locked; `touching` tells it for a wire.

    A node that cannot be placed, and all behind it, are not reached and have no position.
    Raises InputError for an origin that is not on the surface, or one given with a quarter grid.
    """
    on = ground(surface)
    if origin is None and direction == 0.0 and surface.mirror_planes:
        laid = _mirrored(grid, surface, on)
    else:
        laid = _from_geodesics(grid, surface, on, origin or (0.0, 0.0), direction)
    reached = laid.fate == PLACED
    locked = np.abs(laid.shear) > shear_limit
    return Net(
        positions=laid.positions,
        reached=reached,
        cells=laid.cells,
        shear=laid.shear,
        limit=shear_limit,
        locked=locked,
        notes=notes_on(grid, laid.fate, laid.cells, laid.shear, locked, shear_limit),
    )


class _Laid(NamedTuple):
    positions: Floats
    fate: Ints
    cells: Ints
    shear: Floats


def _mirrored(grid: Grid, surface: Surface, on: Ground) -> _Laid:
    """One quadrant between two wires in (or, with a cell on the axis, half a step beside) the mirror planes."""
    shift = _shift(grid)
    # Node i and its mirror image count the same place of the quadrant.
    place = np.where(grid.index >= 0, grid.index, -grid.index - round(2 * shift))
    wanted = _wanted(place)
    start = _over(surface, (shift * grid.step[0], shift * grid.step[1]))
    normal = on.normals(start[None])[0]
    along_x = np.array([normal[2], 0.0, -normal[0]])
    along_y = np.array([0.0, normal[2], -normal[1]])
    first = on.follow(start, _unit(along_x), np.array([0.0, 1.0, 0.0]), grid.step[0], wanted.shape[0])
    second = on.follow(start, _unit(along_y), np.array([-1.0, 0.0, 0.0]), grid.step[1], wanted.shape[1])
    quadrant = quadrant_between(on, first, second, wanted, grid.step, 1.0)
    cells = cells_of(grid)
    return _Laid(
        quadrant.positions[place[:, 0], place[:, 1]] * np.column_stack((_sign(grid.index), np.ones(grid.nodes))),
        quadrant.fate[place[:, 0], place[:, 1]],
        cells,
        _cell_shear(place, quadrant, cells),
    )


def _from_geodesics(grid: Grid, surface: Surface, on: Ground, origin: tuple[float, float], direction: float) -> _Laid:
    """Four quadrants between the geodesics that leave the node (0, 0)."""
    if grid.quarter:
        raise InputError.of(
            "a net with an origin or a direction of its own has no mirror planes",
            where="grid.symmetry",
            hint="lay the grid with symmetry = 'full'",
        )
    start, ahead, normal = _node_0(grid, surface, on, origin, direction)
    side = np.cross(normal, ahead)
    reach = np.abs(grid.index).max(axis=0) + 1
    wires = {
        (family, sign): on.geodesic(start, sign * along, grid.step[family], int(reach[family]))
        for family, along in enumerate((ahead, side))
        for sign in (1, -1)
    }
    cells = cells_of(grid)
    positions, fate = np.full((grid.nodes, 3), np.nan), np.full(grid.nodes, UNPLACED, dtype=np.int64)
    shear = np.full(len(cells), np.nan)
    for sx in (1, -1):
        for sy in (1, -1):
            nodes = np.flatnonzero((grid.index * (sx, sy) >= 0).all(axis=1))
            if not nodes.size:
                continue
            place = np.abs(grid.index[nodes])
            wanted = _wanted(place)
            first, second = wires[0, sx][: wanted.shape[0]], wires[1, sy][: wanted.shape[1]]
            quadrant = quadrant_between(on, first, second, wanted, grid.step, float(sx * sy))
            positions[nodes] = quadrant.positions[place[:, 0], place[:, 1]]
            fate[nodes] = quadrant.fate[place[:, 0], place[:, 1]]
            mine = np.flatnonzero((grid.index[cells] * (sx, sy) >= 0).all(axis=(1, 2)))
            shear[mine] = _cell_shear(grid.index * (sx, sy), quadrant, cells[mine])
    return _Laid(positions, fate, cells, shear)


def _node_0(
    grid: Grid, surface: Surface, on: Ground, origin: tuple[float, float], direction: float
) -> tuple[Floats, Floats, Floats]:
    """Where the node (0, 0) lies, the direction of its first wire, and the normal there, all (3,)."""
    start = _over(surface, origin)
    normal = on.normals(start[None])[0]
    ahead = np.array([math.cos(direction), math.sin(direction), 0.0])
    ahead = _unit(ahead - (ahead @ normal) * normal)
    shift = _shift(grid)
    if shift:
        # From the middle of the cell to its corner along the diagonal; geodesics keep their angle to it.
        x, y = shift * grid.step[0], shift * grid.step[1]
        angle = math.atan2(y, x)
        start, diagonal = on.walk(start, _turned(ahead, normal, angle), math.hypot(x, y))
        normal = on.normals(start[None])[0]
        ahead = _turned(diagonal, normal, -angle)
    return start, ahead, normal


def cells_of(grid: Grid) -> Ints:
    """Corners of all complete cells, (K, 4), counter-clockwise from the lowest (i, j)."""
    after_x, after_y = grid.neighbours[:, 0, 1], grid.neighbours[:, 1, 1]
    corner = np.flatnonzero((after_x >= 0) & (after_y >= 0))
    opposite = after_y[after_x[corner]]
    corner, opposite = corner[opposite >= 0], opposite[opposite >= 0]
    return np.column_stack((corner, after_x[corner], opposite, after_y[corner]))


def _cell_shear(place: Ints, quadrant: Quadrant, cells: Ints) -> Floats:
    """Shear of the cells (K,) from that of the quadrant; a cell astride a mirror plane has none.

    place (N, 2): where the nodes stand in the quadrant. Mirrored once, closing turns into opening.
    """
    here, opposite = place[cells[:, 0]], place[cells[:, 2]]
    turn, low = opposite - here, np.minimum(here, opposite)
    size = np.array(quadrant.shear.shape)
    shear = np.zeros(len(cells))
    inside = (turn != 0).all(axis=1) & (low < size).all(axis=1)
    shear[inside] = quadrant.shear[low[inside, 0], low[inside, 1]] * turn[inside].prod(axis=1)
    placed = quadrant.fate[place[cells, 0], place[cells, 1]] == PLACED
    shear[~placed.all(axis=1)] = np.nan
    return shear


def _wanted(place: Ints) -> Bools:
    """The places of a quadrant that are asked for, and all that come before them, (n, m)."""
    asked = np.zeros(place.max(axis=0) + 1, dtype=bool)
    asked[place[:, 0], place[:, 1]] = True
    for axis in (0, 1):
        asked = np.flip(np.logical_or.accumulate(np.flip(asked, axis), axis=axis), axis)
    return asked


def _shift(grid: Grid) -> float:
    """0 with a node on the axis, 1/2 with a cell."""
    return 0.5 * round(2 * float(grid.flat[0, 0] / grid.step[0] - grid.index[0, 0]))


def _over(surface: Surface, xy: tuple[float, float]) -> Floats:
    """The point of the surface over (x, y), (3,)."""
    height = float(surface.height(np.array([xy]))[0])
    if not math.isfinite(height):
        raise InputError.of(
            f"the net cannot begin at x = {xy[0]:g} mm, y = {xy[1]:g} mm: the surface does not reach there",
            hint="choose an origin on the punch",
        )
    return np.array([*xy, height])


def _unit(vector: Floats) -> Floats:
    return np.asarray(vector / np.linalg.norm(vector))


def _turned(vector: Floats, normal: Floats, angle: float) -> Floats:
    """A tangent vector turned about the normal."""
    return math.cos(angle) * vector + math.sin(angle) * np.cross(normal, vector)


def _sign(index: Ints) -> Ints:
    return np.where(index >= 0, 1, -1)
