"""What a user should be told about a formed grid beyond its figures: where they end, and what to do about it."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.case import PressCase
from punchform.grid import Grid
from punchform.net import touching
from punchform.punch import Surface
from punchform.whole import Whole
from punchform.wire import Element

LARGEST_ANGLE = 0.2
"""Beyond this angle [rad] between a wire and its chord Eq. (3.2), which is linear in it, is too soft."""
NEAR_BREAKING = 0.8
"""Part of the strain at which a wire breaks, beyond which it is said that little is left."""
UNBELIEVABLE = 0.6
"""A plastic strain in a section that only elements too long for their bends show."""
MUCH = 0.01
"""A true strain beyond which a wire may break, whatever it is made of."""
CENTRED = 0.02
"""A grid that has slid by less than this fraction of a step counts as centred."""


def remarks(
    grid: Grid, elements: tuple[Element, ...], whole: Whole, surface: Surface, case: PressCase
) -> tuple[str, ...]:
    """Notes on a formed grid, most important first; none when all is well."""
    found = (
        "" if case.chord else _steep(whole, elements),
        _overpulled(whole, elements) if case.kinematics == "free" and not case.chord else "",
        _locked(grid, whole, elements),
        *(_flowing(whole, elements) if elements[0].hardening else (_yielding(whole), _clamped(case))),
        _swinging(whole),
        _drawn_through(grid, whole, surface),
        _off_centre(whole, surface, grid.step),
        *grid.notes,
    )
    return tuple(note for note in found if note)


def _steep(whole: Whole, elements: tuple[Element, ...]) -> str:
    lengths = np.array([element.length for element in elements])
    angle = float((np.hypot(whole.D[:, 1], whole.D[:, 2]) / lengths[whole.kind]).max())
    if angle <= LARGEST_ANGLE:
        return ""
    return (
        f"a wire leaves its crossing at up to {np.rad2deg(angle):.0f} degrees to the line to the next crossing; beyond "
        f"{np.rad2deg(LARGEST_ANGLE):.0f} degrees the element is too soft, and tensions and energy come out too small: "
        "write press.frame = 'chord', or take a smaller step or larger bend radii"
    )


def _overpulled(whole: Whole, elements: tuple[Element, ...]) -> str:
    """A pull T acts in Eq. (3.2) as a bending stiffness - T s²/4: beyond Eq. (3.8) the wire buckles falsely."""
    for number, element in enumerate(elements):
        bound, pull = largest_pull(element), float(whole.F[whole.kind == number, 0].max(initial=0.0))
        if pull > bound:
            return (
                f"a wire is pulled with {pull:.3g} N; beyond {bound:.3g} N (it falls with the square of the step) the "
                "element buckles where a wire would not: its forces are wrong: write press.frame = 'chord'"
            )
    return ""


def largest_pull(element: Element) -> float:
    """The pull [N] beyond which the element of Eq. (3.2) buckles falsely, Eq. (3.8): 3 EI/s² for a straight wire."""
    C, s = element.C, element.length
    sideways = C[1, 1] - C[1, 5] ** 2 / C[5, 5]
    upwards = C[2, 2] - C[2, 4] ** 2 / C[4, 4]
    return float(s * min(sideways, upwards))


def _locked(grid: Grid, whole: Whole, elements: tuple[Element, ...]) -> str:
    """Cells sheared until neighbouring wires would touch: nothing in the energy keeps them apart."""
    section = elements[0].section
    if section is None or section.diameter >= min(grid.step):
        return ""
    limit = touching(section.diameter, grid.step)
    locked = int((np.abs(whole.cell_shear) > limit).sum())
    if not locked:
        return ""
    return (
        f"{locked} cells shear by more than the {np.rad2deg(limit):.3g} degrees at which neighbouring wires touch, "
        "which nothing here prevents: a real mesh wrinkles there; make the punch shallower or cut the blank at its "
        "corners"
    )


def _yielding(whole: Whole) -> str:
    over = whole.stress_ratio > 1
    if not over.any():
        return ""
    return (
        f"{over.sum()} wire pieces are stressed beyond the yield strength, up to {np.nanmax(whole.stress_ratio):.3g} "
        "times: real wires stay bent there, and their forces are smaller than those of these elastic ones"
    )


def _flowing(whole: Whole, elements: tuple[Element, ...]) -> tuple[str, ...]:
    """Wires that are stretched to where they break, Eq. (12.34)."""
    hardening = elements[0].hardening
    assert hardening is not None
    strain = float(np.log1p(whole.axial_strain.max()))
    if hardening.breaks_at is not None and strain > hardening.breaks_at:
        over = int((np.log1p(whole.axial_strain) > hardening.breaks_at).sum())
        return (
            f"{over} wire pieces are stretched to a true strain of up to {strain:.3g}; from {hardening.breaks_at:.3g} "
            "on they neck and break: take a softer wire, a shallower punch, or let the rim draw in",
        )
    if hardening.breaks_at is not None and strain > NEAR_BREAKING * hardening.breaks_at:
        return (
            f"wires are stretched to a true strain of up to {strain:.3g}, of the {hardening.breaks_at:.3g} at which "
            "they neck and break: little is left for scatter of the wire",
        )
    if hardening.breaks_at is None and strain > MUCH:
        return (
            f"wires are stretched to a true strain of up to {strain:.3g}; this hardening law does not say where they "
            "break: compare it with the uniform elongation of the wire",
        )
    return ()


def _swinging(whole: Whole) -> str:
    """Plastic strains that no wire bears: elements too long for the bends, whose ends turn to and fro."""
    strain = float(whole.plastic_strain.max())
    if strain <= UNBELIEVABLE:
        return ""
    return (
        f"a section of a wire has a plastic strain of {strain:.3g}, which no wire bears: the grid is too coarse for "
        "its bends, and its shape is not to be believed; write grid.subdivide = 2, or take a smaller step"
    )


def _clamped(case: PressCase) -> str:
    if case.rim != "clamp":
        return ""
    return (
        "the rim is clamped: the wires can only stretch, and elastic wires then carry forces that no real wire bears; "
        "they are a sign that it yields, which these elastic wires do not"
    )


def _drawn_through(grid: Grid, whole: Whole, surface: Surface) -> str:
    if not np.isfinite(surface.rim_radius) or grid.trimmed:
        return ""
    ends = np.bincount(whole.start, minlength=len(whole.index)) + np.bincount(whole.end, minlength=len(whole.index)) < 4
    ends[whole.crossings :] = False
    inside = np.linalg.norm(whole.positions[ends, :2], axis=1) < surface.rim_radius
    if not inside.any():
        return ""
    return (
        f"{inside.sum()} wire ends were drawn in past the rim at {surface.rim_radius:.6g} mm: the blank is too small "
        "to be held there"
    )


def _off_centre(whole: Whole, surface: Surface, step: tuple[float, float]) -> str:
    slid = float(np.linalg.norm(slide(whole, surface)))
    if slid <= CENTRED * min(step):
        return ""
    return (
        f"without friction the grid slid {slid:.3g} mm off the axis to where its energy is least; a press that keeps "
        "it centred needs a little more"
    )


def slide(whole: Whole, surface: Surface) -> Floats:
    """Mean move in plan of the crossings that lay within the rim, (2,) [mm]: zero by symmetry for a quarter."""
    within = np.linalg.norm(whole.flat, axis=1) <= surface.rim_radius
    return np.asarray((whole.positions - whole.flat)[within, :2].mean(axis=0))
