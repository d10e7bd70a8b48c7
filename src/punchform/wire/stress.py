"""Largest stress in a wire from the force at its end."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.wire.centreline import Centreline
from punchform.wire.element import Element
from punchform.wire.flexibility import section_loads

MOST_POINTS = 9
"""Points of the centreline that are looked at, both ends included."""

CHUNK = 50_000
"""Elements per pass: keeps the temporary arrays near 50 MB at any number of elements."""


def stress(element: Element, F: Floats) -> Floats:
    """Largest von Mises stress along the wire from the end force F, by statics.

    F (M, 6) [N, N mm] in element axes; returns (M,) [MPa], NaN when the element was given as a matrix
    and its section is not known.

    At a section with axial force N, bending moment M and twist T the outermost fibre carries
    σ = |N|/A + M/W and τ = |T|/W_t, together √(σ² + 3τ²). The transverse shear V is left out: its
    4V/3A acts where the bending stress is nil, and next to the bending stress V s/2W of a wire that
    is built in at both crossings it is d/3s, 3 % for a step of ten diameters.

    On a straight chord N and T are constant and M is convex in the arc length, so the largest stress
    sits at an end of a chord: both chords that meet at a point are tried. A centreline of more than 8
    chords is looked at in 9 of its points, evenly spread, ends included.
    """
    if element.section is None or element.centreline is None:
        return np.full(len(F), np.nan)
    normal, twist, bend = _section_rows(element.centreline)
    section = element.section
    answer = np.empty(len(F))
    for start in range(0, len(F), CHUNK):
        part = F[start : start + CHUNK].T
        sigma = np.abs(normal @ part) / section.area
        moment = (bend @ part).reshape(3, -1, part.shape[1])
        sigma += np.sqrt(np.einsum("kgm,kgm->gm", moment, moment)) / section.bending_modulus
        tau = twist @ part / section.twisting_modulus
        answer[start : start + CHUNK] = np.sqrt((sigma**2 + 3 * tau**2).max(axis=0))
    return answer


def _section_rows(line: Centreline) -> tuple[Floats, Floats, Floats]:
    """Rows that turn F into N (g, 6), T (g, 6) and the bending moment vector (3 g, 6) of g sections."""
    chords = len(line.tangents)
    points = np.unique(np.linspace(0, chords, min(MOST_POINTS, chords + 1)).round().astype(np.int64))
    point = np.concatenate([points[:-1], points[1:]])
    chord = np.concatenate([points[:-1], points[1:] - 1])
    t = line.tangents[chord]
    H = section_loads(line.tip - line.points[point])
    force, moment = H[:, :3], H[:, 3:]
    normal = np.einsum("gk,gka->ga", t, force)
    twist = np.einsum("gk,gka->ga", t, moment)
    bend = moment - t[:, :, None] * twist[:, None, :]
    return normal, twist, bend.transpose(1, 0, 2).reshape(-1, 6)
