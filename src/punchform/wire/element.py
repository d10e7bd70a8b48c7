"""The element: one wire between two crossings, as a 6×6 stiffness with the line it came from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.wire import paper
from punchform.wire.centreline import Centreline, centreline
from punchform.wire.flexibility import asymmetry, flexibility, inverse
from punchform.wire.hardening import Hardening
from punchform.wire.section import Section, round_section
from punchform.wire.yielding import hardening_of

if TYPE_CHECKING:
    from punchform.case import WireCase

SYMMETRY_TOLERANCE = 1e-6
"""How far a matrix given directly may be from symmetric, |C_kl − C_lk| / √(C_kk C_ll)."""

DEFINITE_TOLERANCE = 1e-13
"""The smallest eigenvalue of a usable matrix, as a part of the largest (both in N/mm)."""

COUPLING_TOLERANCE = 1e-9
"""A coupling |C_kl| / √(C_kk C_ll) below this is rounding."""

MOTIONS = (
    "displacement along the wire",
    "displacement sideways in the surface",
    "displacement along the normal",
    "twist about the wire",
    "rotation that bends it up or down",
    "rotation that bends it sideways in the surface",
)
"""The six motions of D, Eq. (3.2), in words."""


@dataclass(frozen=True, eq=False)
class Element:
    """One wire between two crossings, P Fig. 3: F = C D with O held and the load at A.

    C (6, 6) in element axes [N/mm, N, N mm]; height h of A above O and length s, the step [mm].
    section and centreline are None when C was given as a matrix. asymmetry is how far that matrix,
    or the flexibility of Eq. (2.4), was from symmetric before it was made so, by `asymmetry`. Of a wire cut in pieces
    an element is one of them: height is that of the whole wire and drop how far the piece ends below A, Eq. (7.5).
    hardening is how the wire yields, None for an elastic one; C is the stiffness before it does. fibres: rings and
    sectors of its section, None where that is followed by its resultants.
    """

    C: Floats
    height: float
    length: float
    section: Section | None = None
    centreline: Centreline | None = None
    asymmetry: float = 0.0
    drop: float = 0.0
    hardening: Hardening | None = None
    fibres: tuple[int, int] | None = None

    @property
    def wire_length(self) -> float:
        """Length of the wire itself between two crossings [mm]; the step where the centreline is not known."""
        return self.length if self.centreline is None else float(self.centreline.lengths.sum())

    @property
    def B(self) -> Floats:
        """Flexibility, P(4): B = C⁻¹, (6, 6) [mm/N, 1/N, 1/(N mm)]."""
        return inverse(self.C)

    @property
    def eigenvalues(self) -> Floats:
        """Eigenvalues of C in rising order, rotations measured as displacements φ s, (6,) [N/mm]."""
        return eigenvalues(self.C, self.length)


def stiffness(case: WireCase, step: tuple[float, float]) -> tuple[Element, Element]:
    """The element of each family of wires; one and the same object when the steps are equal.

    step (s_x, s_y) [mm]. Raises InputError when the matrix of the case is not a stiffness, when it
    would have to serve two different steps, when the centreline does not fit a step, or when the wire cannot yield as
    the case says.
    """
    first, second = step
    hardening = hardening_of(case)
    if first == second:
        element = _element(case, first, hardening)
        return element, element
    if case.stiffness is not None:
        raise InputError.of(
            f"one matrix cannot serve wires of two lengths ({first:.6g} and {second:.6g} mm)",
            where="wire.stiffness",
            hint="use equal steps, or give the wire as diameter, youngs_modulus, ... and a centreline",
        )
    return _element(case, first, hardening), _element(case, second, hardening)


def mirror_symmetric(elements: tuple[Element, ...]) -> bool:
    """Whether the wires look the same in a mirror along them: no coupling of D1, D3, D5 with D2, D4, D6.

    A centreline that leaves its plane, or a matrix with such entries, has a left- and a right-handed form.
    """
    for element in elements:
        size = np.sqrt(np.diag(element.C))
        coupling = np.abs(element.C / np.outer(size, size))[0::2, 1::2]
        if coupling.max() > COUPLING_TOLERANCE:
            return False
    return True


def axial_compliance(element: Element) -> float:
    """Strain per pull F1 along the wire when its ends do not turn, Eq. (3.9) [1/N]: 1/EA of a straight wire."""
    B = element.B
    return float((B[0, 0] - B[0, 4] ** 2 / B[4, 4]) / element.length)


def along(
    line: Centreline,
    section: Section,
    *,
    height: float | None = None,
    hardening: Hardening | None = None,
    fibres: tuple[int, int] | None = None,
) -> Element:
    """The element of a wire with a given centreline and section, Eq. (2.4), and how it yields.

    height [mm] is the offset of A from O where it differs from the rise of the centreline: wires
    that are stacked, not woven, stay straight and yet lie one on top of the other.
    """
    B = flexibility(line, section)
    C = inverse(B)
    C.setflags(write=False)
    rise = line.rise if height is None else height
    skew = float(asymmetry(B).max())
    return Element(C, rise, float(line.tip[0]), section, line, skew, hardening=hardening, fibres=fibres)


def given(matrix: Floats, *, height: float, length: float) -> Element:
    """The element of a matrix given directly, (6, 6) in element axes [N/mm, N, N mm].

    Raises InputError when it is not symmetric to 1e-6 or not positive definite, P(8).
    """
    where = "wire.stiffness"
    if matrix.shape != (6, 6):
        raise InputError.of(f"expected 6 rows of 6 numbers, not {matrix.shape}", where=where)
    if not np.isfinite(matrix).all():
        raise InputError.of("every number of the matrix must be finite", where=where)
    C = 0.5 * (matrix + matrix.T)
    low = float(np.diag(C).min())
    if low <= 0:
        number = int(np.argmin(np.diag(C))) + 1
        raise InputError.of(
            f"not positive definite: C{number}{number} = {low:.6g} ({MOTIONS[number - 1]}) must be positive",
            where=where,
        )
    skew = asymmetry(matrix)
    row, column = np.unravel_index(int(np.argmax(skew)), (6, 6))
    if skew[row, column] > SYMMETRY_TOLERANCE:
        raise InputError.of(
            f"not symmetric: row {row + 1}, column {column + 1} is {matrix[row, column]:.6g}, "
            f"but row {column + 1}, column {row + 1} is {matrix[column, row]:.6g}",
            where=where,
            hint="by reciprocity, P(5)-(7), the stiffness of an elastic wire is symmetric",
        )
    _check_definite(C, length, where)
    C.setflags(write=False)
    return Element(C, height, length, asymmetry=float(skew.max()))


def eigenvalues(C: Floats, length: float) -> Floats:
    """Eigenvalues of C in rising order with rotations measured as displacements φ s, (6,) [N/mm]."""
    return np.asarray(np.linalg.eigvalsh(_one_unit(C, length)), dtype=np.float64)


def _element(case: WireCase, step: float, hardening: Hardening | None) -> Element:
    if case.stiffness is not None:
        return _from_matrix(case, step)
    if case.centreline is None:
        raise InputError.of("a wire without a stiffness needs a centreline", where="wire")
    section = round_section(
        case.diameter,
        youngs_modulus=case.youngs_modulus,
        poisson=case.poisson,
        shear_factor=case.shear_factor,
    )
    line = centreline(case.centreline, step)
    height = case.centreline.height if case.centreline.kind == "straight" else line.rise
    if abs(case.height - height) > 1e-6 * step:
        raise InputError.of(
            f"the height is {case.height:.6g} mm, but the centreline says {height:.6g} mm",
            where="wire.height",
            hint="leave out wire.height: it is for a wire whose stiffness is given as a matrix",
        )
    fibres = None if case.fibres is None else (case.fibres.rings, case.fibres.sectors)
    return along(line, section, height=height, hardening=hardening, fibres=fibres)


def _from_matrix(case: WireCase, step: float) -> Element:
    if case.stiffness != "paper":
        return given(np.array(case.stiffness, dtype=np.float64), height=case.height, length=step)
    if abs(step - paper.STEP) > 1e-9 * paper.STEP:
        raise InputError.of(
            f"the paper's Table 1 belongs to a step of {paper.STEP} mm, not {step:.6g} mm",
            where="wire.stiffness",
            hint="set grid.step = '7.5 mm', or give the wire as diameter, youngs_modulus and a centreline",
        )
    return given(paper.to_element_axes(np.array(paper.TABLE_1)), height=case.height, length=step)


def _check_definite(C: Floats, length: float, where: str) -> None:
    """P(8): the energy of every motion is positive. Raises InputError."""
    values, vectors = np.linalg.eigh(_one_unit(C, length))
    if values[0] > DEFINITE_TOLERANCE * values[-1]:
        return
    motion = MOTIONS[int(np.argmax(np.abs(vectors[:, 0])))]
    raise InputError.of(
        f"not positive definite: the smallest of the 6 eigenvalues is {values[0]:.6g} N/mm, "
        f"the largest {values[-1]:.6g} N/mm (rotations times the step); its motion is mostly {motion}",
        where=where,
        hint="a wire resists every motion of its end, P(8): look for a wrong sign or a zero row",
    )


def _one_unit(C: Floats, length: float) -> Floats:
    """C with rotations φ replaced by displacements φ s, so that all of it is in N/mm."""
    scale = np.repeat([1.0, 1 / length], 3)
    return C * np.outer(scale, scale)
