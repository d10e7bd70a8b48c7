"""The residual state of the wires as stresses in their beams, at the places where CalculiX keeps stresses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.export.beams import Beams
from punchform.mechanics.frames import unit
from punchform.whole import Whole
from punchform.wire import Section

ACROSS = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""The first axis of the sections of wires along x and along y, as far as it lies across the beam."""
GAUSS, KRONROD = 1 / np.sqrt(3.0), np.sqrt(6.0 / 7.0)
"""The integration points on a line: two of Gauss, which the rule of Kronrod keeps when it adds the middle and these."""


def _points() -> Floats:
    """The integration points of a beam in their order, (50, 3): along the beam, along the first and the second axis of
    its section, as parts of the half lengths. The eight of Gauss come first, then those that Kronrod's rule adds to the
    section at either of the two places along the beam."""
    first = [(a, n1, n2) for n1 in (-GAUSS, GAUSS) for n2 in (GAUSS, -GAUSS) for a in (-GAUSS, GAUSS)]
    line = (-KRONROD, -GAUSS, 0.0, GAUSS, KRONROD)
    added = [
        (a, n1, n2)
        for a in (-GAUSS, GAUSS)
        for n1 in line
        for n2 in line[::-1]
        if not (abs(n1) == GAUSS and abs(n2) == GAUSS)
    ]
    return np.array(first + added)


POINTS = _points()


@dataclass(frozen=True)
class Square:
    """The square section that resists as a round one does, when a single brick stands for it.

    side a [mm] with a⁴/12 over a² = EI over EA; youngs_modulus [MPa]; shear_modulus [MPa]: of one brick, which resists
    twist with G a⁴/6. Poisson's ratio is 0, so that stiff crossings do not keep the wires from thinning.
    """

    side: float
    youngs_modulus: float
    shear_modulus: float


def square(section: Section) -> Square:
    """The square with the rigidities EA, EI and GJ of a section: of a round one a = √3/2 d, E' = π/3 E."""
    side = float(np.sqrt(12 * section.EI / section.EA))
    return Square(side, section.EA / side**2, 6 * section.GJ / side**4)


def stresses(beams: Beams, whole: Whole, loads: Floats, side: float) -> Floats:
    """Stresses (B, 50, 6) [MPa], xx, yy, zz, xy, xz, yz, of the beams of the wires.

    loads (M, 2, 6): on the ends of the elements, as `end_loads` says; side [mm] of the square section. The force in an
    element is everywhere that on its far end, the moment follows from it by statics.
    """
    nodes = beams.places[beams.wires]
    force, moment = loads[beams.element, 1, :3], loads[beams.element, 1, 3:]
    far = whole.positions[whole.end[beams.element]]
    found = np.empty((len(nodes), len(POINTS), 6))
    for k, (a, n1, n2) in enumerate(POINTS):
        place = np.einsum("k,bkc->bc", (0.5 * a * (a - 1), 1 - a * a, 0.5 * a * (a + 1)), nodes)
        t = unit(np.einsum("k,bkc->bc", (a - 0.5, -2 * a, a + 0.5), nodes))
        first = unit(ACROSS[beams.family - 1] - t * np.sum(ACROSS[beams.family - 1] * t, axis=1)[:, None])
        second = np.cross(t, first)
        here = moment + np.cross(far - place, force)
        found[:, k] = _stress(t, 0.5 * side * (n1 * first + n2 * second), force, here, side)
    return found


def _stress(t: Floats, r: Floats, force: Floats, moment: Floats, side: float) -> Floats:
    """Stress (B, 6) at r from the axis t, all (B, 3), of a square section."""
    area, inertia = side**2, side**4 / 12
    pull, torque = np.sum(force * t, axis=1)[:, None], np.sum(moment * t, axis=1)[:, None]
    bend = np.cross(t, moment)
    along = pull / area + np.sum(bend * r, axis=1)[:, None] / inertia
    across = (force - pull * t) / area + torque * np.cross(t, r) / (2 * inertia)
    tensor = along[:, :, None] * t[:, :, None] * t[:, None]
    tensor += across[:, :, None] * t[:, None] + t[:, :, None] * across[:, None]
    return np.stack([tensor[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], axis=1)
