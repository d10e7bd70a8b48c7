"""What an element is, said to a person: its matrices, their checks, its stiffnesses in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from punchform.arrays import Floats
from punchform.wire import paper
from punchform.wire.element import Element
from punchform.wire.flexibility import straight_wire

Axes = Literal["element", "paper"]

ACTIONS = (
    "pulling the wire straight",
    "pushing it sideways in the surface",
    "lifting its end along the normal",
    "twisting it",
    "bending it up or down",
    "bending it sideways in the surface",
)
"""What a load along each of the element axes does, in the order of F."""


@dataclass(frozen=True)
class Principal:
    """One stiffness of the wire in words.

    held: force per displacement when the end A can move in no other way (the diagonal of C).
    free: the same when no other load acts and the end goes where it likes (1 over the diagonal of B).
    Both [N/mm] or [N mm/rad]. The ratios compare with a straight wire of the same section between
    the same crossings; None when the section is not known.
    """

    action: str
    held: float
    free: float
    unit: str
    held_ratio: float | None
    free_ratio: float | None


@dataclass(frozen=True, eq=False)
class ElementReport:
    """The element of a case with its checks. C and B (6, 6) in `axes`; principal always in mm, N."""

    title: str
    axes: Axes
    C: Floats
    B: Floats
    asymmetry: float
    inverse_error: float
    eigenvalues: Floats
    principal: tuple[Principal, ...]

    @property
    def units(self) -> dict[str, str]:
        """Units of the blocks of C and B: forces and displacements first, then moments and rotations."""
        length = "mm" if self.axes == "element" else "m"
        return {
            "C": f"N/{length}, N, N {length}",
            "B": f"{length}/N, 1/N, 1/(N {length})",
            "eigenvalues": "N/mm",
        }

    def json_ready(self) -> dict[str, Any]:
        """Plain numbers, lists and strings, ready for `json.dumps`."""
        return {
            "title": self.title,
            "axes": self.axes,
            "units": self.units,
            "C": self.C.tolist(),
            "B": self.B.tolist(),
            "checks": {
                "asymmetry": self.asymmetry,
                "inverse_error": self.inverse_error,
                "positive_definite": bool(self.eigenvalues[0] > 0),
                "eigenvalues": self.eigenvalues.tolist(),
            },
            "principal": [vars(each) for each in self.principal],
        }

    def text(self) -> str:
        """The report as lines for a terminal, 96 columns at most."""
        return "\n".join(
            [
                self.title,
                *_axes_lines(self.axes),
                "",
                f"Stiffness C [{self.units['C']}]: rows are loads, columns motions",
                *_matrix_lines(self.C, self.axes),
                "",
                f"Flexibility B = 1/C [{self.units['B']}]: rows are motions, columns loads",
                *_matrix_lines(self.B, self.axes),
                "",
                "Checks",
                f"  symmetric            |C - C'| = {self.asymmetry:.1e} of √(C_kk C_ll)",
                f"  inverse              |C B - 1| = {self.inverse_error:.1e}",
                f"  positive definite    {'yes' if self.eigenvalues[0] > 0 else 'NO'}; eigenvalues "
                + ", ".join(f"{value:.4g}" for value in self.eigenvalues)
                + " N/mm",
                "                       (rotations times the step)",
                "",
                *_principal_lines(self.principal),
            ]
        )


def describe(element: Element, *, axes: Axes = "element") -> ElementReport:
    """The report on an element, in its own axes (mm, N) or in those of the paper's Table 1 (m, N)."""
    C, B = element.C, element.B
    scale = np.sqrt(np.diag(C))
    residual = (C @ B - np.eye(6)) * np.outer(1 / scale, scale)
    if axes == "paper":
        C, B = paper.to_paper_axes(C), paper.flexibility_to_paper_axes(B)
    return ElementReport(
        title=_title(element),
        axes=axes,
        C=C,
        B=B,
        asymmetry=element.asymmetry,
        inverse_error=float(np.abs(residual).max()),
        eigenvalues=element.eigenvalues,
        principal=_principal(element),
    )


def _principal(element: Element) -> tuple[Principal, ...]:
    held, free = np.diag(element.C), 1 / np.diag(element.B)
    held_ratios: list[float | None] = [None] * 6
    free_ratios: list[float | None] = [None] * 6
    if element.section is not None:
        straight = straight_wire(element.length, element.section)
        held_ratios = [float(value) for value in held / np.diag(straight)]
        free_ratios = [float(value) for value in free * np.diag(np.linalg.inv(straight))]
    units = ["N/mm"] * 3 + ["N mm/rad"] * 3
    return tuple(
        Principal(ACTIONS[k], float(held[k]), float(free[k]), units[k], held_ratios[k], free_ratios[k])
        for k in range(6)
    )


def _title(element: Element) -> str:
    sizes = f"step {element.length:.6g} mm, crimp height {element.height:.6g} mm"
    if element.section is None or element.centreline is None:
        return f"One wire between two crossings: {sizes}, stiffness given as a matrix"
    chords = len(element.centreline.lengths)
    line = "a straight line" if chords == 1 else f"{chords} chords"
    return f"One wire between two crossings: {sizes}, round wire {element.section.diameter:.6g} mm, {line}"


def _axes_lines(axes: Axes) -> list[str]:
    if axes == "element":
        return ["Axes: x along the wire, y sideways in the surface, z along the surface normal"]
    return [
        "Axes of the paper's Table 1: 1 along the surface normal (the crimp), 3 along the wire, 2 sideways",
    ]


def _matrix_lines(matrix: Floats, axes: Axes) -> list[str]:
    names = "xyz" if axes == "element" else "123"
    heads = [*names, *(f"r{name}" for name in names)]
    # A number that symmetry makes nil comes out as rounding dirt: show the nil.
    scale = np.sqrt(np.abs(np.diag(matrix)))
    shown = np.where(np.abs(matrix) < 1e-12 * np.outer(scale, scale), 0.0, matrix)
    lines = ["     " + "".join(f"{head:>13}" for head in heads)]
    lines += [
        f"  {head:>3}" + "".join(f"{value:>13.5g}" for value in row) for head, row in zip(heads, shown, strict=True)
    ]
    return lines


def _principal_lines(principal: tuple[Principal, ...]) -> list[str]:
    compare = principal[0].held_ratio is not None
    lines = ["Stiffness in words                      all else held       end else free"]
    if compare:
        lines[0] += "    of a straight wire's"
    for each in principal:
        line = f"  {each.action:<36}{each.held:>10.5g} {each.unit:<9}{each.free:>10.5g} {each.unit:<9}"
        if each.held_ratio is not None and each.free_ratio is not None:
            line += f"{each.held_ratio:>8.3f}, {each.free_ratio:.3f}"
        lines.append(line.rstrip())
    return [
        *lines,
        "  all else held: the end makes this motion alone, as between two crossings;",
        "  end else free: this load acts alone and the end goes where it likes.",
    ]
