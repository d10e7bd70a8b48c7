"""`State`: where the nodes are and how they are turned, and what a step does to it (docs/theory.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints

if TYPE_CHECKING:
    from punchform.mechanics.history import History


@dataclass(frozen=True)
class State:
    """Positions (N, 3) [mm], unit normals (N, 3) and the unit tangents of both wires (N, 2, 3) of all nodes.

    history: what wires that yield remember of earlier strokes, None for new ones; a step leaves it as it is.
    """

    positions: Floats
    normals: Floats
    tangents: Floats
    history: History | None = None


def basis(normals: Floats) -> Floats:
    """Two unit vectors across each normal, as columns, (N, 3, 2).

    The first follows x (or z where the normal itself follows x), the second is normal × first. On the mirror planes
    x = 0 and y = 0 one of them therefore lies in the plane and the other across it.
    """
    along = np.zeros_like(normals)
    steep = np.abs(normals[:, 0]) > 0.9
    along[~steep, 0] = 1.0
    along[steep, 2] = 1.0
    first = unit(along - normals * np.sum(along * normals, axis=1)[:, None])
    return np.stack((first, np.cross(normals, first)), axis=2)


def unit(vectors: Floats) -> Floats:
    """The vectors (..., 3) scaled to length 1."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def turned(vectors: Floats, rotation: Floats) -> Floats:
    """The vectors (n, 3) turned by the rotation vectors (n, 3) [rad]: Rodrigues' formula."""
    angle = np.linalg.norm(rotation, axis=1)[:, None]
    # sin(a)/a and (1 - cos a)/a² without loss of digits at small angles.
    sine = np.sinc(angle / np.pi)
    versine = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    once = np.cross(rotation, vectors)
    return np.asarray(vectors + sine * once + versine * np.cross(rotation, once))


def turn(state: State, positions: Floats, tilt: Floats, spin: Floats) -> State:
    """The state after a step: new positions, then each wire spun about the normal, then all tilted, Eq. (4.1).

    tilt (N, 3): rotation vectors across the normals; spin (N, 2): angles of the two wires about the normal [rad].
    """
    normals = unit(turned(state.normals, tilt))
    tangents = np.empty_like(state.tangents)
    for w in range(2):
        spun = turned(state.tangents[:, w], state.normals * spin[:, w, None])
        tangents[:, w] = perpendicular(turned(spun, tilt), normals)
    return State(positions, normals, tangents, state.history)


def perpendicular(vectors: Floats, normals: Floats) -> Floats:
    """The unit vectors nearest to the given ones across the normals, all (n, 3)."""
    return unit(vectors - normals * np.sum(vectors * normals, axis=1)[:, None])


def lone_tangents(family: Ints, along: Floats, normals: Floats) -> Floats:
    """Both tangents (n, 2, 3) of nodes of one wire each: its own along given directions (n, 3), the other across."""
    own = perpendicular(along, normals)
    tangents = np.empty((len(own), 2, 3))
    tangents[np.arange(len(own)), family] = own
    tangents[np.arange(len(own)), 1 - family] = np.where(family == 0, 1, -1)[:, None] * np.cross(normals, own)
    return tangents


def crossing_angle(state: State) -> Floats:
    """The angle theta from the first to the second tangent about the normal, (N,), Eq. (4.5) [rad]."""
    first, second = state.tangents[:, 0], state.tangents[:, 1]
    sine = np.sum(state.normals * np.cross(first, second), axis=1)
    return np.asarray(np.arctan2(sine, np.sum(first * second, axis=1)))


def squared(state: State) -> State:
    """The state with both wires of each node turned alike about the normal until they are at right angles."""
    half = 0.5 * (crossing_angle(state) - 0.5 * np.pi)
    return turn(state, state.positions, np.zeros_like(state.normals), np.column_stack((half, -half)))


def is_finite(state: State) -> bool:
    """Whether every number of the state is finite: a failed projection leaves NaN."""
    return bool(np.isfinite(state.positions).all() and np.isfinite(state.tangents).all())
