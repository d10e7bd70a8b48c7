"""Exact equal-edge nets, Eq. (6.1) and (6.3): what a grid of inextensible straight wires becomes.

A net is an array (n + 1, n + 1, 3): node (i, j) of the quarter u, v >= 0, node (0, 0) on the axis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.case import GridCase, RectangleBlank
from punchform.grid import Grid, lay
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, perpendicular
from punchform.punch import Paraboloid, Sphere, Surface


@dataclass(frozen=True)
class Dome:
    """A bare surface with its exact net: net(chord, n) gives (n + 1, n + 1, 3)."""

    surface: Surface
    net: Callable[[float, int], Floats]


def sphere(radius: float) -> Dome:
    return Dome(Sphere(radius), lambda chord, count: sphere_net(radius, chord, count))


def paraboloid(focal_length: float) -> Dome:
    return Dome(Paraboloid(focal_length), lambda chord, count: paraboloid_net(focal_length, chord, count))


def chords_of_parabola(focal_length: float, chord: float, count: int, *, first: float = 0.0) -> Floats:
    """Abscissas x_0 = first, x_1, ... of equal chords along z = -x²/4f, (count + 1,)."""
    x = [first]
    for _ in range(count):
        here, there = x[-1], x[-1] + chord
        for _ in range(60):
            across, down = there - here, (there**2 - here**2) / (4 * focal_length)
            step = (across**2 + down**2 - chord**2) / (2 * across + down * there / focal_length)
            there -= step
            if abs(step) < 1e-15 * chord:
                break
        x.append(there)
    return np.array(x)


def translated(x: Floats, focal_length: float) -> Floats:
    """Eq. (6.1): one parabola carried along the other, from their abscissas x (n + 1,)."""
    first, second = np.meshgrid(x, x, indexing="ij")
    return np.stack((first, second, -(first**2 + second**2) / (4 * focal_length)), axis=2)


def paraboloid_net(focal_length: float, chord: float, count: int) -> Floats:
    """Eq. (6.1) with a node on the axis."""
    return translated(chords_of_parabola(focal_length, chord, count), focal_length)


def sphere_net(radius: float, chord: float, count: int) -> Floats:
    """Eq. (6.3): node (i + 1, j + 1) mirrors node (i, j) in the plane of the centre, (i + 1, j) and (i, j + 1)."""
    angle = 2 * np.arcsin(chord / (2 * radius)) * np.arange(count + 1)
    net = np.zeros((count + 1, count + 1, 3))
    net[:, 0, 0] = net[0, :, 1] = radius * np.sin(angle)
    net[:, 0, 2] = net[0, :, 2] = radius * np.cos(angle)
    for diagonal in range(2 * count - 1):
        i = np.arange(max(0, diagonal - count + 1), min(diagonal, count - 1) + 1)
        j = diagonal - i
        across = np.cross(net[i + 1, j], net[i, j + 1])
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        net[i + 1, j + 1] = net[i, j] - 2 * across * np.sum(net[i, j] * across, axis=1, keepdims=True)
    return net


def square_grid(step: float, count: int, *, symmetry: str = "quarter") -> Grid:
    """Straight wires over a square of half side `count` steps, node (0, 0) on the axis."""
    side = 2 * count * step
    blank = RectangleBlank(size=(side, side))
    return lay(GridCase.model_validate({"step": step, "weave": "same", "blank": blank, "symmetry": symmetry}))


def laid(net: Floats, grid: Grid, surface: Surface) -> State:
    """A start for the quarter grid: its nodes on the net, its frames from differences of the net."""
    i, j = grid.index.T
    positions = net[i, j]
    normals = normals_of(surface.gap(positions))
    tangents = [perpendicular(along(net, w)[i, j], normals) for w in range(2)]
    return State(positions, normals, np.stack(tangents, axis=1))


def along(net: Floats, family: int) -> Floats:
    """Unit tangents of the wires of one family, (n + 1, n + 1, 3), by differences over the net and its mirror image."""
    turned = np.moveaxis(net, family, 0)
    mirrored = turned[1:2] * np.where(np.arange(3) == family, -1.0, 1.0)
    rates = np.gradient(np.concatenate((mirrored, turned)), axis=0)[1:]
    return np.moveaxis(rates / np.linalg.norm(rates, axis=2, keepdims=True), 0, family)
