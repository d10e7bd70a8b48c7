"""What holds the grid after the press: which crossings, in which directions, and at which heights (Eq. (7.1))."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.case import HoldFrom, HoldNodes, HoldPoints, HoldRing, ReleaseCase, Rib
from punchform.errors import InputError, Problem
from punchform.grid import Grid

EDGE = 1e-9
"""A node on a radius, to this relative size, belongs to it."""


@dataclass(frozen=True)
class Held:
    """held (N,): nodes that keep position and frames; fixed (N, 3): directions in which a node cannot move;
    positions (N, 3): where the nodes start, those at a given height already there [mm]."""

    held: Bools
    fixed: Bools
    positions: Floats

    @property
    def count(self) -> int:
        """How many nodes are held in any direction."""
        return int((self.held | self.fixed.any(axis=1)).sum())


def holds(grid: Grid, positions: Floats, case: ReleaseCase) -> Held:
    """What the case holds of a formed grid with these positions (N, 3) [mm].

    Raises InputError for a hold or rib that no crossing lies on, and for numbers of crossings that do not exist.
    """
    held, fixed = np.zeros(grid.nodes, dtype=bool), np.zeros((grid.nodes, 3), dtype=bool)
    radius = np.linalg.norm(positions[:, :2], axis=1)
    match case.hold:
        case HoldFrom(from_radius=least):
            held = radius >= least * (1 - EDGE)
            _demand(held, "release.hold.from_radius", f"no crossing was formed at or beyond {least:g} mm")
            if held.all():
                raise InputError.of(
                    f"every crossing was formed at or beyond {least:g} mm: nothing would be let go",
                    where="release.hold.from_radius",
                    hint="take a larger radius, or leave the section [release] out",
                )
        case HoldRing(ring=ring):
            on = _near(np.abs(radius - ring), grid)
            _demand(on, "release.hold.ring", f"no crossing was formed within half a step of {ring:g} mm")
            fixed[on, 2] = True
        case HoldPoints():
            fixed[_supports(grid, positions, case.hold)] = True
        case HoldNodes(nodes=nodes):
            fixed[_numbered(grid, nodes)] = True
        case "rim":
            fixed[grid.wire_ends.any(axis=(1, 2))] = True
    moved = positions.copy()
    for number, rib in enumerate(case.ribs):
        on = _near(_off_rib(rib, positions), grid)
        _demand(on, f"release.ribs[{number}]", "no crossing was formed within half a step of this rib")
        fixed[on, 2] = True
        moved[on, 2] = positions[on, 2] + rib.lift if rib.height is None else rib.height
    return Held(held, fixed & ~held[:, None], np.where(held[:, None], positions, moved))


def followed(held: Held, formed: Floats, after: Floats, case: ReleaseCase, grid: Grid) -> Floats:
    """Where the held nodes are, (N, 3) [mm], when the grid has been formed otherwise and ribs stand elsewhere.

    formed, after (N, 3): positions after the press, as they were when it was decided what is held, and now; case: with
    ribs that hold the same crossings at other heights. Directions that are not held are those of `after`.
    """
    moved = after.copy()
    for rib in case.ribs:
        on = _near(_off_rib(rib, formed), grid) & ~held.held
        moved[on, 2] = after[on, 2] + rib.lift if rib.height is None else rib.height
    return moved


def _near(distance: Floats, grid: Grid) -> Bools:
    return np.asarray((distance <= 0.5 * min(grid.step) * (1 + EDGE)) & grid.crossings)


def _demand(on: Bools, where: str, message: str) -> None:
    if not on.any():
        raise InputError.of(message, where=where, hint="look at the radii in nodes.csv of a run without it")


def _off_rib(rib: Rib, positions: Floats) -> Floats:
    """Distance in plan of every node from the line of a rib, (N,) [mm]."""
    x, y = positions[:, 0], positions[:, 1]
    if rib.radius is not None:
        return np.asarray(np.abs(np.hypot(x, y) - rib.radius))
    assert rib.spokes is not None
    off = np.full(len(x), np.inf)
    for angle in 2 * np.pi * np.arange(rib.spokes) / rib.spokes:
        along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        off = np.minimum(off, np.where(along >= 0, np.abs(across), np.hypot(x, y)))
    return off


def _supports(grid: Grid, positions: Floats, hold: HoldPoints) -> Bools:
    """The node nearest to each support; of a quarter those supports that lie in it, which the rest must mirror."""
    angles = hold.first + 2 * np.pi * np.arange(hold.points) / hold.points
    places = hold.radius * np.column_stack((np.cos(angles), np.sin(angles)))
    if grid.quarter:
        _demand_mirrored(places, hold)
        places = places[(places >= -EDGE * hold.radius).all(axis=1)]
    distance = np.linalg.norm(positions[:, None, :2] - places[None], axis=2)
    distance[~grid.crossings] = np.inf
    if distance.min(axis=0).max() > max(grid.step):
        raise InputError.of(
            f"a support on the radius of {hold.radius:g} mm has no crossing within one step",
            where="release.hold.radius",
            hint="take a radius inside the formed grid",
        )
    on = np.zeros(grid.nodes, dtype=bool)
    on[distance.argmin(axis=0)] = True
    return on


def _demand_mirrored(places: Floats, hold: HoldPoints) -> None:
    for sign in ((-1, 1), (1, -1)):
        apart = np.linalg.norm(places[:, None] * np.array(sign) - places[None], axis=2).min(axis=1)
        if apart.max() > EDGE * hold.radius:
            raise InputError.of(
                f"{hold.points} supports from this angle are not symmetric about both axes, and a quarter is solved",
                where="release.hold",
                hint='take another number or angle, or release.symmetry = "full"',
            )


def _demand_images(nodes: tuple[tuple[int, int], ...]) -> None:
    lacking = {(a * i, b * j) for i, j in nodes for a in (1, -1) for b in (1, -1)} - set(nodes)
    if lacking:
        some = ", ".join(map(str, sorted(lacking)[:4])) + (", ..." if len(lacking) > 4 else "")
        raise InputError.of(
            f"a quarter is solved, which would hold the mirror images {some} too",
            where="release.hold.nodes",
            hint='name them as well, or write release.symmetry = "full"',
        )


def _numbered(grid: Grid, nodes: tuple[tuple[int, int], ...]) -> Bools:
    """The nodes with these numbers (i, j); of a quarter grid, which holds their images too, they must all be named."""
    wanted = grid.subdivide * (np.abs(nodes) if grid.quarter else np.asarray(nodes))
    here = {tuple(number): place for place, number in enumerate(grid.index.tolist())}
    missing = [given for given, one in zip(nodes, wanted.tolist(), strict=True) if tuple(one) not in here]
    if missing:
        raise InputError(Problem(f"the grid has no crossing {one}", "release.hold.nodes") for one in missing[:20])
    if grid.quarter:
        _demand_images(nodes)
    on = np.zeros(grid.nodes, dtype=bool)
    on[[here[tuple(one)] for one in wanted.tolist()]] = True
    return on
