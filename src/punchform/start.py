"""Where the search for the formed grid begins: the inextensible net, or the paper's flat start P(18)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import PressCase
from punchform.errors import InputError
from punchform.grid import Grid
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, perpendicular
from punchform.net import start_state
from punchform.punch import Surface, laid_onto

VERTICAL = 1e-6
"""How far from upright a wall must be [rad] for a flat wire to show its own way down it."""


def begin(grid: Grid, surface: Surface, case: PressCase) -> tuple[State, tuple[str, ...]]:
    """The start that a case asks for, and notes on it.

    The flat one where the rim is clamped, and where the net does not reach every node, which the notes then explain.
    """
    if case.start == "flat" or case.rim == "clamp":
        return flat_start(grid, surface), ()
    net = start_state(grid, surface)
    if not net.net.complete:
        return flat_start(grid, surface), (*net.net.notes, "the press therefore started from the flat grid")
    return State(net.positions, net.normals, net.tangents), ()


def struck(state: State, surface: Surface) -> State:
    """The start of a second press: the grid as it lies, every node moved onto the surface along its
    normals, Eq. (7.10).

    Raises InputError where the surface has nothing for a node.
    """
    positions = laid_onto(surface, state.positions)
    if not np.isfinite(positions).all():
        raise InputError.of(
            "the grid lies where the punch has no surface, so it cannot be pressed again",
            where="press",
            hint="hold it better in the release before",
        )
    normals = normals_of(surface.gap(positions))
    tangents = [perpendicular(state.tangents[:, w], normals) for w in range(2)]
    return replace(state, positions=positions, normals=normals, tangents=np.stack(tangents, axis=1))


def flat(grid: Grid) -> State:
    """The grid as it lies before the punch touches it."""
    return State(
        np.column_stack((grid.flat, np.zeros(grid.nodes))),
        np.broadcast_to(np.eye(3)[2], (grid.nodes, 3)).copy(),
        np.broadcast_to(np.eye(3)[:2], (grid.nodes, 2, 3)).copy(),
    )


def flat_start(grid: Grid, surface: Surface) -> State:
    """The paper's start P(18): every node moves straight up onto the surface, u_x = u_y = 0, u_z = f.

    Raises InputError where the surface has no height over a node.
    """
    height = surface.height(grid.flat)
    if not np.isfinite(height).all():
        raise InputError.of(
            "the blank reaches beyond the surface, so the flat grid cannot be laid straight onto it",
            where="grid.blank",
            hint="make the blank smaller, or start from the net",
        )
    positions = np.column_stack((grid.flat, height))
    normals = normals_of(surface.gap(positions))
    tangents = [perpendicular(_downhill(np.eye(3)[w], normals), normals) for w in range(2)]
    return State(positions, normals, np.stack(tangents, axis=1))


def _downhill(wire: Floats, normals: Floats) -> Floats:
    """The direction of a flat wire, bent down a little where it leaves the dome: on a vertical wall it points down."""
    down = np.outer(normals @ wire, (0.0, 0.0, -VERTICAL))
    return np.asarray(wire + down)
