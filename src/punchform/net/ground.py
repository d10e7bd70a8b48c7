"""What a net is laid on: a surface of revolution in tables, marched by the kernel, or any surface.

Both know how to follow a plane section or a geodesic, to march a quadrant, and to tell normals.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.net import anywhere, geodesic, kernel, straightest
from punchform.net.chain import Chain, chain
from punchform.net.compiled import is_cached
from punchform.net.fate import BEYOND, NO_INTERSECTION, PLACED, UNPLACED
from punchform.punch import Surface


class Quadrant(NamedTuple):
    """A net between two wires: positions (n, m, 3), NaN where there is none, shear of its cells (n - 1, m - 1)
    [rad], positive where the angle between the wires has become smaller, and the fate of its nodes (n, m)."""

    positions: Floats
    shear: Floats
    fate: Ints


class Ground(Protocol):
    """A surface as the net sees it."""

    def follow(self, start: Floats, ahead: Floats, across: Floats, step: float, count: int) -> Floats:
        """Nodes (count, 3) at equal chords along a plane section, NaN where it cannot go on.

        start, ahead (3,): the first node and the direction there; across (3,): unit normal of the plane such that
        ahead × across points to the grid's side.
        """
        ...

    def geodesic(self, start: Floats, ahead: Floats, step: float, count: int) -> Floats:
        """Nodes (count, 3) at equal chords along the geodesic that leaves `start` in the unit direction `ahead`.

        NaN where it cannot go on.
        """
        ...

    def walk(self, start: Floats, ahead: Floats, length: float) -> tuple[Floats, Floats]:
        """Where a geodesic of the given length ends, and its unit direction there, both (3,)."""
        ...

    def march(self, quadrant: Quadrant, wanted: Bools, steps: tuple[float, float], side: float) -> None:
        """Fill a quadrant whose two wires are there, where `wanted` (n, m); see `kernel.march`."""
        ...

    def normals(self, points: Floats) -> Floats:
        """Unit normals (n, 3) towards the grid's side at points (n, 3) on the surface."""
        ...


@dataclass(frozen=True)
class Tabled:
    """A surface of revolution in tables, Eq. (6.5) by the kernel."""

    chain: Chain

    def follow(self, start: Floats, ahead: Floats, across: Floats, step: float, count: int) -> Floats:
        """See `Ground`."""
        nodes = np.full((count, 3), np.nan)
        nodes[0] = start
        kernel.follow(self.chain, nodes, _vector(ahead), _vector(across), float(step))
        return nodes

    def geodesic(self, start: Floats, ahead: Floats, step: float, count: int) -> Floats:
        """See `Ground`."""
        nodes = np.full((count, 3), np.nan)
        nodes[0] = start
        straightest.geodesic(self.chain, nodes, _vector(ahead), float(step))
        return nodes

    def walk(self, start: Floats, ahead: Floats, length: float) -> tuple[Floats, Floats]:
        """See `Ground`."""
        here = np.concatenate((start, ahead))
        straightest.walk(self.chain, here, float(length))
        return here[:3], here[3:]

    def march(self, quadrant: Quadrant, wanted: Bools, steps: tuple[float, float], side: float) -> None:
        """See `Ground`."""
        kernel.march(self.chain, *quadrant, wanted, (float(steps[0]), float(steps[1])), float(side))

    def normals(self, points: Floats) -> Floats:
        """See `Ground`."""
        found = np.empty((len(points), 3))
        kernel.normals(self.chain, np.ascontiguousarray(points, dtype=np.float64), found)
        return found


@dataclass(frozen=True)
class Untabled:
    """Any surface, Eq. (6.5) by anti-diagonals on its signed distance."""

    surface: Surface

    def follow(self, start: Floats, ahead: Floats, across: Floats, step: float, count: int) -> Floats:
        """See `Ground`."""
        return anywhere.follow(self.surface, start, ahead, across, step, count)

    def geodesic(self, start: Floats, ahead: Floats, step: float, count: int) -> Floats:
        """See `Ground`."""
        return geodesic.geodesic(self.surface, start, ahead, step, count)

    def walk(self, start: Floats, ahead: Floats, length: float) -> tuple[Floats, Floats]:
        """See `Ground`."""
        return geodesic.walk(self.surface, start, ahead, length)

    def march(self, quadrant: Quadrant, wanted: Bools, steps: tuple[float, float], side: float) -> None:
        """See `Ground`."""
        anywhere.march(self.surface, *quadrant, wanted, steps, side)

    def normals(self, points: Floats) -> Floats:
        """See `Ground`."""
        return anywhere.normals(self.surface, points)


def ground(surface: Surface) -> Ground:
    """The fastest way to march on a surface."""
    tables = chain(surface)
    return Untabled(surface) if tables is None else Tabled(tables)


def quadrant_between(
    on: Ground, first: Floats, second: Floats, wanted: Bools, steps: tuple[float, float], side: float
) -> Quadrant:
    """The net between two wires (n, 3), (m, 3) that begin in the same node, where `wanted` (n, m)."""
    n, m = wanted.shape
    made = Quadrant(
        np.full((n, m, 3), np.nan),
        np.full((max(n - 1, 0), max(m - 1, 0)), np.nan),
        np.full((n, m), UNPLACED, dtype=np.int64),
    )
    for edge, fate, wire, asked in (
        (made.positions[:, 0], made.fate[:, 0], first, wanted[:, 0]),
        (made.positions[0], made.fate[0], second, wanted[0]),
    ):
        edge[asked] = wire[asked]
        placed = np.isfinite(wire[:, 0])
        fate[asked] = np.where(placed, PLACED, BEYOND)[asked]
        ends = np.flatnonzero(asked & ~placed)[:1]
        fate[ends] = NO_INTERSECTION
    on.march(made, wanted, steps, side)
    return made


def _vector(values: Floats) -> kernel.Vector:
    return float(values[0]), float(values[1]), float(values[2])


def kernels_are_compiled(*, geodesics: bool) -> bool:
    """Whether an earlier run has left the compiled march on disk, and the compiled geodesics if they are needed."""
    return is_cached(kernel.march) and (is_cached(straightest.geodesic) or not geodesics)
