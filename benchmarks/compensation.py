"""Compensation of the punch: a stretch-formed dish with three kinds of punch, an elastic one that does not follow, and
what was tried before the method was chosen.

    python benchmarks/compensation.py [--only stretch|paper|choices ...] [--write docs/compensation.md]

With --write the tables replace what stands between the markers `<!-- table: stretch -->`, `<!-- table: paper -->` and,
in docs/decisions/compensation.md, `<!-- table: choices -->`, each with its end.
"""

from __future__ import annotations

import argparse
import os
import platform
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from tables import put_between

from punchform import Run, read_case, run
from punchform.arrays import Floats
from punchform.case import varied
from punchform.optimise.compensated import PLACE, Wish, compensate_case
from punchform.optimise.compensation import Limits, Press, compensate
from punchform.optimise.correction_space import Space, space, terms_of
from punchform.optimise.misfit import misfit
from punchform.punch import uncorrected
from punchform.report.compensate_words import BRIEFLY, solve_rows
from punchform.report.words import percent, size

LEAST = 1e-4
"""An rms that is asked for in order to go on to the floor [mm]."""
SOLVES = 4
"""Presses and releases of each choice."""
FILLET = 287.0
"""Where the fillet of the packaged dish begins [mm]."""


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table in Markdown with the machine that made it."""
    lines = [f"| {' | '.join(row)} |" for row in (head, *rows)]
    lines.insert(1, "|" + "---|" * len(head))
    return "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores)"])


def stretch() -> str:
    """All solves of the packaged stretch-formed dish, with all kinds of punch to their end."""
    done = compensate_case(read_case("packaged:dish600"), Wish(limits=Limits(LEAST), compare=True))
    head, *rows = solve_rows(done)
    floors = {found.space.kind: found.floor for found in (done.found, *done.others.values())}
    told = [(*row[:7], size(floors[kind], "mm", 3)) for kind, row in zip(kinds(done), rows, strict=True)]
    return table((*head[:7], "floor [mm]"), [tuple(cell.replace(chr(0xA0) + "mm", "") for cell in row) for row in told])


def kinds(done) -> list[str]:  # type: ignore[no-untyped-def]
    """The kind of punch of every row."""
    return [found.space.kind for found in (done.found, *done.others.values()) for _ in found.solves]


def paper() -> str:
    """What is said of the packaged elastic dish."""
    done = compensate_case(read_case("packaged:paper"), Wish(limits=Limits(1.0)))
    assert done.reach is not None
    rows = [
        (
            f"press and release {one.number}",
            size(one.misfit.rms, "", 3),
            "" if one.follows is None else percent(one.follows),
        )
        for one in done.found.solves
        if one.misfit is not None
    ]
    rows.append(("in shapes that the punch does not move", size(done.reach.left, "", 3), percent(done.reach.beyond)))
    rows += [
        (f"over the punch as it is, with {BRIEFLY[one.name]}", "" if one.rms is None else size(one.rms, "", 3), "")
        for one in done.remedies
    ]
    return table(("", "rms [mm]", "follows; share of the squared error"), rows)


def choices() -> str:
    """The rms of the first solves for other shapes, another end of the correction, and without memory."""
    rows = [
        ("degree 8", *searched(8)),
        ("degree 12", *searched(12)),
        ("degree 16", *searched(16)),
        ("degree 16, nil from the fillet on", *searched(16, end=FILLET)),
        ("degree 16, without memory", *plain(16)),
    ]
    return table(("", *(f"solve {number}, mm" for number in range(1, SOLVES + 1))), rows)


def searched(degree: int, *, end: float | None = None) -> list[str]:
    """The rms of the solves of a search."""
    shapes, press = problem(degree, end)
    found = compensate(press, shapes, Limits(LEAST, SOLVES)).solves
    told = [size(one.misfit.rms, "", 3) for one in found if one.misfit is not None]
    return told + [""] * (SOLVES - len(told))


def plain(degree: int) -> list[str]:
    """The same of steps that answer the error one to one, without memory."""
    shapes, press = problem(degree, None)
    numbers, told = np.zeros(len(shapes.terms)), []
    for _ in range(SOLVES):
        found = press(numbers)
        told.append(size(found.rms, "", 3))
        numbers = numbers - found.answer(shapes)
    return told


@cache
def as_it_is() -> Run:
    """The packaged dish over its punch without correction, which all choices begin with."""
    return run(read_case("packaged:dish600"))


def problem(degree: int, end: float | None) -> tuple[Space, Press]:
    """A space and what presses the packaged dish over its corrections."""
    case = read_case("packaged:dish600")
    base, shapes = uncorrected(case.tool), space(case, "field", nodes=10_000, mirrored=True)
    shapes = replace(shapes, terms=terms_of("field", degree, mirrored=True), end=end or shapes.end)

    def press(numbers: Floats):  # type: ignore[no-untyped-def]
        if not numbers.any():
            return misfit(as_it_is(), base, shapes)
        return misfit(run(varied(case, {PLACE: shapes.correction(numbers)})), base, shapes)

    return shapes, press


TABLES: dict[str, Callable[[], str]] = {"stretch": stretch, "paper": paper, "choices": choices}


def main() -> None:
    """Make the tables that are asked for, print them, and write them into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=tuple(TABLES), default=("stretch", "paper"))
    parser.add_argument("--write", type=Path, metavar="PAGE")
    arguments = parser.parse_args()
    for name in arguments.only:
        made = TABLES[name]()
        print(f"{made}\n")
        if arguments.write is not None:
            put_between(arguments.write, name, made)


if __name__ == "__main__":
    main()
