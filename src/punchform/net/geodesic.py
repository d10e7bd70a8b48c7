"""Geodesics of any surface as generators of a net: wires that are straight within it; slower than by tables.

A geodesic x(s) of a surface with signed distance d, |grad d| = 1, obeys x'' = -(x'ᵀ ∇²d x') grad d, Eq. (6.6).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from punchform.arrays import Floats
from punchform.punch import Surface

TOLERANCE = 1e-12
CHORD_STEPS = 50
POLISHING = 4


def geodesic(surface: Surface, start: Floats, ahead: Floats, step: float, count: int) -> Floats:
    """Nodes (count, 3) at equal chords along the geodesic that leaves `start` in the unit direction `ahead`.

    Rows are NaN from where the surface ends.
    """
    nodes = np.full((count, 3), np.nan)
    nodes[0] = start
    if count == 1:
        return nodes
    # On a wire that turns back on itself chords are shorter than arcs: the path is extended until it is enough.
    reach = 1.1 * count * step
    path = _path(surface, start, ahead, reach)
    arc = 0.0
    for n in range(1, count):
        next_arc = _chord_end(path, nodes[n - 1], arc, step, reach)
        if next_arc is None:
            break
        here = path(next_arc)
        nodes[n] = _polished(surface, nodes[n - 1], here[:3], here[3:], step)
        arc = next_arc
    return nodes


def walk(surface: Surface, start: Floats, ahead: Floats, length: float) -> tuple[Floats, Floats]:
    """Where a geodesic of the given length ends, and its direction there, both (3,)."""
    end = _path(surface, start, ahead, length)(length)
    return end[:3], end[3:] / np.linalg.norm(end[3:])


def _path(surface: Surface, start: Floats, ahead: Floats, length: float) -> Any:
    """The geodesic as a function of its arc: position and direction, (6,)."""
    from scipy.integrate import solve_ivp

    def change(_: float, y: Floats) -> Floats:
        gap = surface.gap(y[None, :3])
        bend = y[3:] @ gap.hessian[0] @ y[3:]
        return np.concatenate((y[3:], -bend * gap.gradient[0]))

    solved = solve_ivp(
        change,
        (0.0, length),
        np.concatenate((start, ahead)),
        method="DOP853",
        rtol=TOLERANCE,
        atol=TOLERANCE * np.repeat((length, 1.0), 3),
        dense_output=True,
    )
    return solved.sol


def _chord_end(path: Any, before: Floats, arc: float, step: float, reach: float) -> float | None:
    """The arc at which the path is one step away from the node before, by Newton; None beyond its end."""
    at = arc + step
    for _ in range(CHORD_STEPS):
        if not at <= reach:
            return None
        here = path(at)
        chord = here[:3] - before
        length = float(np.linalg.norm(chord))
        change = (length - step) * length / float(chord @ here[3:])
        at -= change
        if abs(change) <= 1e-10 * step:
            return float(at)
    return None


def _polished(surface: Surface, before: Floats, here: Floats, ahead: Floats, step: float) -> Floats:
    """The point moved along `ahead` and the normal, onto the surface and to one step from the node before."""
    for _ in range(POLISHING):
        distance, gradient = surface.distance_gradient(here[None])
        normal, chord = gradient[0], here - before
        length = float(np.linalg.norm(chord))
        here = here - distance[0] * normal
        off = length - step - float(distance[0] * normal @ chord) / length
        here = here - off * length / float(chord @ ahead) * ahead
    return here
