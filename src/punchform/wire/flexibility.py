"""Flexibility of a wire by unit loads, Eq. (2.4), and its inverse, the stiffness of P(3)–P(7)."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.wire.centreline import Centreline
from punchform.wire.section import Section


def flexibility(line: Centreline, section: Section) -> Floats:
    """B of Eq. (2.4): motions of A (O held) from the loads at A, (6, 6) [mm/N, 1/N, 1/(N mm)].

    Order of both: force or displacement along x, y, z, then moment or rotation about x, y, z.
    On a straight chord the section moment is linear in the arc length and the integrand quadratic, so
    two Gauss points per chord integrate it exactly: the only error is that of the polyline itself.
    """
    places, weights, tangents = _gauss_points(line)
    loads = section_loads(line.tip - places)
    strains = _compliance(tangents, section) @ loads
    B: Floats = np.einsum("g,gka,gkb->ab", weights, loads, strains)
    return B


def asymmetry(matrix: Floats) -> Floats:
    """How far a (6, 6) matrix is from P(5)–P(7), entry by entry: |M_kl − M_lk| / √(M_kk M_ll)."""
    scale = 1 / np.sqrt(np.diag(matrix))
    return np.abs(matrix - matrix.T) * np.outer(scale, scale)


def inverse(matrix: Floats) -> Floats:
    """Inverse of a symmetric positive definite (6, 6) matrix whose rows have mixed units.

    The matrix is first brought to a unit diagonal, so that the rounding error does not depend on the
    unit of length. The answer is symmetric to the last bit.
    """
    scale = 1 / np.sqrt(np.diag(matrix))
    inner = np.linalg.inv(matrix * np.outer(scale, scale))
    return 0.5 * (inner + inner.T) * np.outer(scale, scale)


def straight_wire(length: float, section: Section) -> Floats:
    """Stiffness of a straight wire, the h = 0 limit of Eq. (2.4).

    length L [mm]; returns the (6, 6) matrix C of Eq. (2.1) in element axes [N/mm, N, N mm].
    Source: textbook Timoshenko cantilever, with φ = 12 EI / (κGA L²).
    """
    L, EI = length, section.EI
    phi = 12 * EI / (section.kappa_GA * L**2)
    across = 12 * EI / (L**3 * (1 + phi))
    coupling = 6 * EI / (L**2 * (1 + phi))
    turn = (4 + phi) * EI / (L * (1 + phi))
    C = np.diag([section.EA / L, across, across, section.GJ / L, turn, turn])
    C[1, 5] = C[5, 1] = -coupling
    C[2, 4] = C[4, 2] = coupling
    return C


def deflections(line: Centreline, section: Section) -> Floats:
    """Motions of every point of the centreline under the six unit loads at A.

    Returns (n + 1, 6, 6): point, motion (displacement [mm], rotation [rad]), load ([N], [N mm]).
    A point moves by what the wire before it strains: the unit-load integrals of Eq. (2.4) up to the
    point. The last entry is B itself, the first is zero.
    """
    places, weights, tangents = _gauss_points(line)
    strains = _compliance(tangents, section) @ section_loads(line.tip - places)
    strains *= weights[:, None, None]
    stretch, bend = strains[:, :3], strains[:, 3:]
    turned = np.cross(bend, places[:, :, None], axis=1)

    def up_to_points(each: Floats) -> Floats:
        sums = np.cumsum(each[0::2] + each[1::2], axis=0)
        return np.concatenate([np.zeros((1, 3, 6)), sums])

    rotation = up_to_points(bend)
    carried = np.cross(rotation, line.points[:, :, None], axis=1)
    displacement = up_to_points(stretch - turned) + carried
    return np.concatenate([displacement, rotation], axis=1)


def section_loads(levers: Floats) -> Floats:
    """H of Eq. (2.4): from the end force F = (P, M) to a section's force P and moment M + r × P.

    levers r (g, 3) [mm], from the section to A; returns (g, 6, 6).
    """
    H = np.zeros((len(levers), 6, 6))
    H[:, :, :] = np.eye(6)
    x, y, z = levers.T
    H[:, 3, 1], H[:, 3, 2] = -z, y
    H[:, 4, 0], H[:, 4, 2] = z, -x
    H[:, 5, 0], H[:, 5, 1] = -y, x
    return H


def _gauss_points(line: Centreline) -> tuple[Floats, Floats, Floats]:
    """Two points per chord, in order from O: places (2n, 3), weights (2n,), tangents (2n, 3)."""
    middle = 0.5 * (line.points[:-1] + line.points[1:])
    reach = line.chords / np.sqrt(12.0)
    places = np.stack([middle - reach, middle + reach], axis=1).reshape(-1, 3)
    return places, np.repeat(line.lengths / 2, 2), np.repeat(line.tangents, 2, axis=0)


def _compliance(tangents: Floats, section: Section) -> Floats:
    """Section compliance in element axes: 1/EA and 1/GJ along t, 1/κGA and 1/EI across, (g, 6, 6)."""
    along = tangents[:, :, None] * tangents[:, None, :]
    across = np.eye(3) - along
    S = np.zeros((len(tangents), 6, 6))
    S[:, :3, :3] = along / section.EA + across / section.kappa_GA
    S[:, 3:, 3:] = along / section.GJ + across / section.EI
    return S
