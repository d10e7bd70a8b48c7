"""A wire cut in pieces between two crossings, each an element of its own, Eq. (7.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.wire.centreline import Centreline
from punchform.wire.element import Element, along
from punchform.wire.flexibility import inverse, section_loads

SAME = 1e-9
"""A cut this near to a point of the centreline, as a part of the length, is made there."""


def pieces(elements: Sequence[Element], count: int) -> tuple[Element, ...]:
    """All pieces of wires cut into `count` pieces of equal step: those of the first wire from O to A, then the next.

    Raises InputError for a wire that is only known by its matrix, and for one that turns back on its way.
    """
    if count == 1:
        return tuple(elements)
    return tuple(piece for element in elements for piece in _pieces(element, count))


def together(parts: Sequence[Element]) -> Floats:
    """Stiffness (6, 6) of pieces one after the other: their flexibilities add up, Eq. (7.6)."""
    lever = np.zeros(3)
    B = np.zeros((6, 6))
    for part in reversed(parts):
        H = section_loads(lever[None])[0]
        B += H.T @ part.B @ H
        lever += (part.length, 0.0, 0.0 if part.centreline is None else part.centreline.rise)
    return inverse(B)


def cut(line: Centreline, count: int) -> list[Centreline]:
    """The parts of a centreline between x = k s / count, each from the point of the line y = 0 at its height.

    Raises InputError for a line that turns back.
    """
    points, length = line.points, float(line.tip[0])
    if (np.diff(points[:, 0]) <= 0.0).any():
        raise InputError.of(
            "a wire whose centreline turns back, or climbs straight up, cannot be cut in pieces of equal step",
            where="grid.subdivide",
            hint="leave out grid.subdivide, or give the centreline with rising x",
        )
    places = length * np.arange(count + 1) / count
    new = [x for x in places if np.abs(points[:, 0] - x).min() > SAME * length]
    x = np.sort(np.concatenate((points[:, 0], new)))
    all_points = np.column_stack((x, np.interp(x, *points[:, :2].T), np.interp(x, *points[:, ::2].T)))
    at = [int(np.abs(x - place).argmin()) for place in places]
    parts = []
    for first, last in pairwise(at):
        part = all_points[first : last + 1] - all_points[first] * (1.0, 0.0, 1.0)
        part.setflags(write=False)
        parts.append(Centreline(part, aside=float(part[-1, 1])))
    return parts


def _pieces(element: Element, count: int) -> list[Element]:
    line, section = element.centreline, element.section
    if line is None or section is None:
        raise InputError.of(
            "a wire whose stiffness is given as a matrix cannot be cut in pieces: nobody knows how it runs",
            where="grid.subdivide",
            hint="give the wire as diameter, youngs_modulus and a centreline, or leave out grid.subdivide",
        )
    found, reached = [], 0.0
    for part in cut(line, count):
        reached += part.rise
        piece = along(part, section, hardening=element.hardening, fibres=element.fibres)
        found.append(replace(piece, height=element.height, drop=line.rise - reached))
    return found
