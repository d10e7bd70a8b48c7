"""The start of a gridshell: every wire an arc of its own length between its two ends."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.optimize import brentq

from punchform.arrays import Bools, Floats, Ints
from punchform.errors import InputError
from punchform.grid import Grid
from punchform.mechanics.frames import State, lone_tangents, perpendicular, unit

STRAIGHT = 1e-9
"""A wire longer than the way between its ends by less than this part lies straight."""


def arched(grid: Grid, wires: tuple[tuple[Ints, ...], tuple[Ints, ...]], held: Ints, points: Floats, up: int) -> State:
    """The state with wires that arch towards `up`, +1 or -1 along z, between the held nodes (K,) at points (K, 3).

    wires: per family the nodes of each wire, in order. Crossings lie midway between their two arcs, and the arcs bend
    to them; a wire that is not held at both ends lies where those that cross it do. Raises InputError for a wire that
    fewer than two of them cross.
    """
    chains = [(family, nodes) for family, own in enumerate(wires) for nodes in own]
    place = np.full((grid.nodes, 3), np.nan)
    place[held] = points
    total, count = np.zeros((grid.nodes, 3)), np.zeros(grid.nodes)
    arcs: dict[int, Floats] = {}
    for number, (family, nodes) in enumerate(chains):
        if np.isfinite(place[nodes[[0, -1]], 0]).all():
            low, high = place[nodes[[0, -1]]]
            arcs[number] = _arc(_along(grid, family, nodes), low, high, np.eye(3)[family], up)
            total[nodes] += arcs[number]
            count[nodes] += 1
    free = np.isnan(place[:, 0]) & (count > 0)
    place[free] = total[free] / count[free, None]
    crossed = np.asarray(grid.passes.all(axis=1))
    for number, (family, nodes) in enumerate(chains):
        s = _along(grid, family, nodes)
        if number in arcs:
            known = crossed[nodes] | np.isin(nodes, held)
            place[nodes] = arcs[number] + _between(s, s[known], (place[nodes] - arcs[number])[known])
        else:
            known = np.isfinite(place[nodes, 0])
            if known.sum() < 2:
                raise InputError.of(
                    "a wire hangs loose: too few of the wires that cross it are held at both ends",
                    where="press.ends",
                    hint="say where its own two ends go",
                )
            place[nodes] = _between(s, s[known], place[nodes][known])
    return _with_frames(grid, chains, place)


def _along(grid: Grid, family: int, nodes: Ints) -> Floats:
    """How far along its wire each node lies, (n,) [mm]."""
    return np.asarray(grid.flat[nodes, family] - grid.flat[nodes[0], family])


def _between(s: Floats, known: Floats, values: Floats) -> Floats:
    """Vectors (n, 3) along a wire from those at known places, straight in between and beyond."""
    found = np.stack([np.interp(s, known, column) for column in values.T], axis=1)
    for beyond, one, other in ((s < known[0], 0, 1), (s > known[-1], -1, -2)):
        if beyond.any() and len(known) > 1:
            slope = (values[one] - values[other]) / (known[one] - known[other])
            found[beyond] = values[one] + (s[beyond, None] - known[one]) * slope
    return found


def _arc(s: Floats, low: Floats, high: Floats, axis: Floats, up: int) -> Floats:
    """Points (n, 3) of a circular arc from one end to the other, as long as the wire; straight where that is short."""
    length, way = float(s[-1]), float(np.linalg.norm(high - low))
    if way >= length * (1 - STRAIGHT):
        return np.asarray(low + (s / length)[:, None] * (high - low))
    half = brentq(lambda angle: np.sin(angle) / angle - way / length, 1e-9, np.pi)
    chord = (high - low) / way if way > STRAIGHT * length else axis
    rise = np.array([0.0, 0.0, float(up)])
    rise -= (rise @ chord) * chord
    # Over ends straight above each other a wire may arch to any side: along its own direction in the flat grid.
    rise = unit(rise if np.linalg.norm(rise) > STRAIGHT else axis - (axis @ chord) * chord)
    radius, angle = 0.5 * length / half, half * (2 * s / length - 1)
    middle = 0.5 * (low + high)
    return np.asarray(
        middle + radius * (np.sin(angle)[:, None] * chord + (np.cos(angle) - np.cos(half))[:, None] * rise)
    )


def _with_frames(grid: Grid, chains: list[tuple[int, Ints]], positions: Floats) -> State:
    """Tangents along the wires; normals across both wires at crossings, carried along the wires from there."""
    tangents = np.empty((grid.nodes, 2, 3))
    for family, nodes in chains:
        s = _along(grid, family, nodes)
        order: Literal[1, 2] = 2 if len(s) > 2 else 1
        columns = [np.gradient(column, s, edge_order=order) for column in positions[nodes].T]
        tangents[nodes, family] = unit(np.column_stack(columns))
    crossed = np.asarray(grid.passes.all(axis=1))
    normals = np.empty((grid.nodes, 3))
    normals[crossed] = unit(np.cross(tangents[crossed, 0], tangents[crossed, 1]))
    for family, nodes in chains:
        alone = ~crossed[nodes]
        own = tangents[nodes, family]
        carried = _carried(own, normals[nodes], crossed[nodes], _along(grid, family, nodes))[alone]
        normals[nodes[alone]] = unit(carried - np.sum(carried * own[alone], axis=1)[:, None] * own[alone])
        tangents[nodes[alone]] = lone_tangents(np.full(len(carried), family), own[alone], normals[nodes[alone]])
    for family in range(2):
        tangents[crossed, family] = perpendicular(tangents[crossed, family], normals[crossed])
    return State(positions, normals, tangents)


def _carried(tangents: Floats, normals: Floats, known: Bools, s: Floats) -> Floats:
    """Normals (n, 3) along a wire from those known at some nodes, without twist; between two by distance of both.

    A wire may turn by more than a right angle on its way: what is across it there is not what is nearest to across.
    """
    total = np.where(known[:, None], normals, 0.0)
    for order in (np.arange(len(s)), np.arange(len(s))[::-1]):
        last, here = -1, np.zeros(3)
        for before, node in zip(np.append(order[0], order[:-1]), order, strict=True):
            here = normals[node] if known[node] else _transported(here, tangents[before], tangents[node])
            last = int(node) if known[node] else last
            if not known[node] and last >= 0:
                total[node] += here / abs(s[node] - s[last])
    return total


def _transported(vector: Floats, old: Floats, new: Floats) -> Floats:
    """The vector turned by the shortest rotation from one unit tangent to the next."""
    return np.asarray(vector - (vector @ new) / (1.0 + old @ new) * (old + new))
