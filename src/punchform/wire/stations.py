"""Where along a wire its sections are looked at, and what statics makes of an end force there: Eq. (12.10)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre

from punchform.arrays import Floats
from punchform.wire.centreline import Centreline
from punchform.wire.element import Element
from punchform.wire.flexibility import section_loads

STATIONS = 5
"""Gauss-Lobatto points of a wire between two crossings: its ends, where it bends most, are two of them."""


STRINGS = 3
"""Shapes across the chord in which a pulled wire is kept straight while it flows."""


@dataclass(frozen=True, eq=False)
class Stations:
    """The sections of one kind of piece, G of them from O to A.

    H (G, 4, 6): from the end force F to pull N, moments M2, M3 across the wire and torque T [N, N mm], Eq. (12.10);
    lever (G, 2, 4, 6): how H changes when the section moves off the chord by 1 mm, along the chord's normal and
    sideways; weight (G,): length of wire that belongs to each [mm]; curving (G, G): Eq. (12.15); string (G, 3):
    Eq. (12.17).
    """

    H: Floats
    lever: Floats
    weight: Floats
    curving: Floats
    string: Floats


def stations(element: Element, count: int = STATIONS) -> Stations:
    """The sections of an element whose centreline is known, at Gauss-Lobatto points of its arc length."""
    line = element.centreline
    assert line is not None
    places, weights = lobatto(count)
    points, tangents = _at(line, places)
    sideways = np.array([0.0, 1.0, 0.0]) - tangents * tangents[:, 1:2]
    sideways /= np.linalg.norm(sideways, axis=1)[:, None]
    axes = np.stack((sideways, np.cross(tangents, sideways), tangents), axis=1)
    loads = section_loads(line.tip - points)
    free = np.hypot(line.tip[0], line.rise)
    off = np.array([[-line.rise, 0.0, line.tip[0]], [0.0, free, 0.0]]) / free
    lever = np.zeros((count, 2, 4, 6))
    for k, way in enumerate(off):
        # The lever to A becomes shorter by what the section moves: its moment changes by - way × P.
        lever[:, k, 1:, :3] = axes @ -_cross_matrix(way)
    H = np.concatenate((tangents[:, None] @ loads[:, :3], axes @ loads[:, 3:]), axis=1)
    curving, string = _curving(places, weights)
    return Stations(H, lever, weights * line.lengths.sum(), curving, string)


def lobatto(count: int) -> tuple[Floats, Floats]:
    """Gauss-Lobatto points and weights on (0, 1): both ends, and the extrema of a Legendre polynomial between them."""
    polynomial = Legendre.basis(count - 1)
    inner = polynomial.deriv().roots()
    x = np.concatenate(([-1.0], np.sort(inner.real), [1.0]))
    weights = 2.0 / (count * (count - 1) * polynomial(x) ** 2)
    return 0.5 * (x + 1.0), 0.5 * weights


def _curving(places: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Of a wire of length 1, its curvature v'' interpolated and v = 0 at both ends: the deflections (G, G) per
    curvature at each place; and the moments (G, 3) of forces that do the work of the largest parts of ½ ∫ v'²."""
    deflections = []
    for k, place in enumerate(places):
        others = np.delete(places, k)
        bent = (Polynomial.fromroots(others) / np.prod(place - others)).integ(2)
        deflections.append(bent - Polynomial([0.0, bent(1.0)]))
    slopes = [deflection.deriv() for deflection in deflections]
    stretch = np.array([[(one * other).integ()(1.0) for other in slopes] for one in slopes])
    sizes, shapes = np.linalg.eigh(stretch)
    string = shapes[:, : -STRINGS - 1 : -1] * np.sqrt(sizes[: -STRINGS - 1 : -1]) / weights[:, None]
    return np.stack([deflection(places) for deflection in deflections], axis=1), string


def _at(line: Centreline, places: Floats) -> tuple[Floats, Floats]:
    """Points (G, 3) and unit tangents (G, 3) at fractions of the arc length."""
    reached = np.concatenate(([0.0], np.cumsum(line.lengths)))
    wanted = places * reached[-1]
    points = np.column_stack([np.interp(wanted, reached, line.points[:, k]) for k in range(3)])
    chord = np.clip(np.searchsorted(reached, wanted, side="right") - 1, 0, len(line.lengths) - 1)
    return points, line.tangents[chord]


def _cross_matrix(v: Floats) -> Floats:
    """The matrix of v × ."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
