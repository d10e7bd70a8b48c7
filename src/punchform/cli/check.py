"""`punchform check`: all that can be said about a case without solving it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from punchform.case import Case, parse, read_text
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.errors import InputError, Problem
from punchform.grid import Grid, lay
from punchform.punch import check_sharpness, surface
from punchform.wire import mirror_symmetric, stiffness

Built = TypeVar("Built")


def check(path: str) -> Exit:
    """Check all that can be checked without solving. Raises InputError with everything that is wrong."""
    source = read_text(path)
    case = parse(source)
    try:
        grid, warnings = _build(case)
    except InputError as error:
        raise source.placed(error) from None
    part = "a quarter of them solved" if grid.quarter else "all of them solved"
    whole = grid.nodes if not grid.quarter else round(4 * float(grid.node_weight.sum()))
    print(f"{path}: usable; {whole} crossings, {part}")
    for note in (*grid.notes, *(f"{warning.where}: {warning.message}" for warning in warnings)):
        say(f"note: {note}")
    return Exit.DONE


def _build(case: Case) -> tuple[Grid, tuple[Problem, ...]]:
    """The grid of a case and what is doubtful about its punch, after wire, punch and grid were all built.

    Raises InputError with the problems of all three.
    """
    problems: list[Problem] = []
    warnings: tuple[Problem, ...] = ()
    elements = _tried(lambda: stiffness(case.wire, case.grid.step), problems)
    punch = _tried(lambda: surface(case.punch), problems)
    if punch is not None:
        errors, warnings = check_sharpness(punch, min(case.grid.step))
        problems += errors
    planes = elements is None or mirror_symmetric(elements)
    grid = _tried(
        lambda: lay(
            case.grid,
            rim_radius=case.punch.rim_radius,
            mirror_planes=planes,
            reason="the wire is crimped out of its plane",
        ),
        problems,
    )
    if problems or grid is None:
        raise InputError(problems)
    return grid, warnings


def _tried(build: Callable[[], Built], problems: list[Problem]) -> Built | None:
    """What `build` gives, or None after adding what is wrong to the problems."""
    try:
        return build()
    except InputError as error:
        problems += error.problems
        return None
