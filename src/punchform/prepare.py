"""From the case to what goes into the press: wire, punch and grid, built and checked together."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

from punchform.case import Case, DescentCase
from punchform.errors import InputError, Problem
from punchform.grid import Grid, lay
from punchform.punch import Corrected, Tool, bare, check_correction, check_sharpness, surface
from punchform.wire import Element, mirror_symmetric, pieces, stiffness

Built = TypeVar("Built")
SOFTEST = 1000.0
"""A Young's modulus below this [MPa] is doubted."""


@dataclass(frozen=True)
class Prepared:
    """What the press needs: the grid, one element per kind of piece, the punch; and what is doubtful about them."""

    grid: Grid
    elements: tuple[Element, ...]
    punch: Tool
    doubts: tuple[Problem, ...]


def prepare(case: Case) -> Prepared:
    """Build wire, punch, target and grid of a case.

    Raises InputError with the problems of all four, not only of the first that fails, and for a case without punch.
    """
    tool = case.tool
    problems: list[Problem] = []
    elements = _tried(lambda: pieces(stiffness(case.wire, case.grid.step), case.grid.subdivide), problems)
    punch = _tried(lambda: surface(tool), problems)
    doubts: tuple[Problem, ...] = ()
    if punch is not None:
        errors, doubts = _bends(punch, _finest(case))
        problems += errors
    if case.target is not None:
        problems += _tried(lambda: _target_problems(case), problems) or ()
    wire_mirrors = elements is None or mirror_symmetric(elements)
    punch_mirrors = punch is None or punch.mirror_planes
    grid = _tried(
        lambda: lay(
            case.grid,
            rim_radius=tool.rim_radius,
            mirror_planes=wire_mirrors and punch_mirrors,
            reason="the punch has none" if wire_mirrors else "the wire is crimped out of its plane",
        ),
        problems,
    )
    doubts += (*_soft(case), *_idle(case), *_unnamed(case))
    if problems or grid is None or elements is None or punch is None:
        raise InputError(problems)
    return Prepared(grid, elements, punch, doubts)


def _bends(punch: Tool, step: float) -> tuple[tuple[Problem, ...], tuple[Problem, ...]]:
    """Errors and doubts about the bends of a punch, and about those that its correction adds."""
    if not isinstance(punch, Corrected):
        return check_sharpness(punch, step)
    base, added = check_sharpness(punch.base, step), check_correction(punch, step)
    return base[0] + added[0], base[1] + added[1]


def _finest(case: Case) -> float:
    """The distance at which wires have nodes, along both axes [mm]: they follow no sharper bend."""
    return max(case.grid.step) / case.grid.subdivide


def _soft(case: Case) -> tuple[Problem, ...]:
    """A modulus that no wire has: most likely a bare number that was meant in GPa."""
    if case.wire.stiffness is not None or case.wire.youngs_modulus >= SOFTEST:
        return ()
    told = f"Young's modulus is {case.wire.youngs_modulus:g} MPa, softer than any wire: a bare number is in MPa"
    return (Problem(told, "wire.youngs_modulus", "write '210 GPa' for steel"),)


def _idle(case: Case) -> Iterator[Problem]:
    """Settings of a descent that is not asked for, and of yielding for a wire that does not."""
    if case.press.method != "descent" and case.press.descent != DescentCase():
        told = f"the settings of the descent have no effect: the method is {case.press.method}"
        yield Problem(told, "press.descent", 'write method = "descent", or leave them out')
    if case.wire.fibres is not None and not case.wire.yields:
        told = "fibres have no effect: the wire has no hardening, so that it does not yield"
        yield Problem(told, "wire.section", "give wire.hardening, or leave `section` out")


def _unnamed(case: Case) -> tuple[Problem, ...]:
    """Sections of stages that are not among those of the case."""
    if case.stages is None:
        return ()
    kinds = {step.kind for step in case.steps}
    sections = {"release": case.release, "load": case.load}
    return tuple(
        Problem(f"[{name}] has no effect: `stages` does not name it", name, f'add "{name}" to `stages`')
        for name, section in sections.items()
        if section is not None and name not in kinds
    )


def _target_problems(case: Case) -> tuple[Problem, ...]:
    """What is wrong with the wanted shape inside its aperture: the wires of the grid could not follow it."""
    assert case.target is not None
    wanted = bare(case.target.profile, case.target.aperture_radius, where="target.profile")
    return check_sharpness(wanted, _finest(case), where="target")[0]


def _tried(build: Callable[[], Built], problems: list[Problem]) -> Built | None:
    """What `build` gives, or None after adding what is wrong to the problems."""
    try:
        return build()
    except InputError as error:
        problems += error.problems
        return None
