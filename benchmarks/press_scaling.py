"""The press from a small dish to a million crossings: factorisations, seconds, and the floor that these stand on.

    python benchmarks/press_scaling.py [--large] [--write docs/performance.md]

Every row runs in a process of its own, after a tiny press that loads the compiled kernels, so that its peak memory is
its own. Two bare times belong to a row: one factorisation and solve of its last matrix with the pattern already
analysed, and that analysis, which a call with the matrix alone makes before. The floor is one analysis and as many
factorisations and solves as the press needs; `over the bare calls` compares with as many calls that are given the
matrix alone. `again` is a second press, whose pattern is known and whose floor has no analysis. With --write the
table replaces what stands between the markers `<!-- table: press -->` and `<!-- end: press -->` of the page. The
seconds are of the machine it runs on.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from dishes import Dish, Hemisphere, Laid, dish_of
from tables import from_processes, put_between

from punchform.case import PressCase
from punchform.errors import NoEquilibrium
from punchform.mechanics.assembly import Hessian
from punchform.mechanics.linear import forget_analysis, solver_for
from punchform.press import Formed, energy_of, press

WARM = Dish(75.0, 62.5, 86.25)
CHECK = Dish(300.0, 250.0, 345.0)
SMALL: tuple[Dish | Hemisphere, ...] = (
    dish_of(115.0, 0.4),
    dish_of(300.0, 0.3),
    CHECK,
    dish_of(300.0, 0.5),
    Dish(1200.0, 500.0, 1380.0),
    dish_of(1200.0, 0.3),
    dish_of(1200.0, 0.5),
    Hemisphere(1200, whole=False),
    Hemisphere(4600, whole=False),
    Hemisphere(18_400, whole=False),
    Hemisphere(1200, whole=True),
    Hemisphere(4600, whole=True),
)
LARGE: tuple[Dish | Hemisphere, ...] = (
    dish_of(2500.0, 0.3),
    dish_of(2500.0, 0.5),
    Dish(3680.0, 2900.0, 4232.0),
)
ROWS: dict[str, Dish | Hemisphere] = {shape.name: shape for shape in (WARM, *SMALL, *LARGE)}
BARE = 3
"""How many bare factorisations the median is of; one above MANY unknowns."""
MANY = 500_000
PARTS = ("kernel", "assembly", "factorisation", "solve", "other")
HEAD = (
    "case",
    "crossings",
    "solved nodes",
    "unknowns",
    "energy, mJ",
    "last decrement",
    "factorisations",
    "press, s",
    *(f"{part}, s" for part in PARTS),
    "bare factorisation and solve, s",
    "bare analysis, s",
    "over the floor",
    "over the bare calls",
    "again, s",
    "again, over the floor",
    "peak memory, GB",
)


def measured(shape: Dish | Hemisphere) -> dict[str, Any]:
    """One row of the table, by column; a press without an equilibrium says why instead of an energy."""
    warm = WARM.laid()
    press(warm.grid, warm.elements, warm.surface, PressCase())
    laid = shape.laid()
    known = {"case": shape.name, "crossings": crossings(laid), "solved nodes": laid.grid.nodes}
    begun = perf_counter()
    try:
        formed = press(laid.grid, laid.elements, laid.surface, PressCase())
    except NoEquilibrium as error:
        return known | {"energy, mJ": str(error), "press, s": f"{perf_counter() - begun:.2f}"}
    seconds = perf_counter() - begun
    memory = peak_memory()
    begun = perf_counter()
    press(laid.grid, laid.elements, laid.surface, PressCase())
    again = perf_counter() - begun
    unknowns, bare, analysis = bare_seconds(laid, formed)
    calls = formed.factorisations
    return known | {
        "unknowns": unknowns,
        "energy, mJ": f"{formed.energy:.3f}",
        "last decrement": f"{formed.history[-1].decrement:.0e}",
        "factorisations": formed.factorisations,
        "press, s": f"{seconds:.2f}",
        **{f"{part}, s": f"{formed.seconds[part]:.2f}" for part in PARTS},
        "bare factorisation and solve, s": f"{bare:.3f}",
        "bare analysis, s": f"{analysis:.3f}",
        "over the floor": f"{seconds / (analysis + calls * bare):.2f}",
        "over the bare calls": f"{seconds / (calls * (analysis + bare)):.2f}",
        "again, s": f"{again:.2f}",
        "again, over the floor": f"{again / (calls * bare):.2f}",
        "peak memory, GB": f"{memory:.2f}",
    }


def crossings(laid: Laid) -> int:
    """Crossings of the whole grid."""
    copies = laid.grid.copies * laid.grid.node_weight
    return round(float(copies.sum()))


def peak_memory() -> float:
    """The most memory that this process has held so far [GB]."""
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return largest / (1e9 if sys.platform == "darwin" else 1e9 / 1024)


def bare_seconds(laid: Laid, formed: Formed) -> tuple[int, float, float]:
    """The number of unknowns, the median seconds of one factorisation and solve of the last matrix, and those of the
    analysis that a first call with that matrix makes before."""
    energy = energy_of(laid.grid, laid.elements, laid.surface, PressCase(), start=formed.state)
    model = energy.model(energy.kinematics.chart(formed.state), Hessian.EXACT)
    solver = solver_for(energy.pattern, formed.linear_solver)

    def call() -> float:
        begun = perf_counter()
        solver.factor(model.values).raw_solve(model.gradient)
        return perf_counter() - begun

    forget_analysis()
    first = call()
    bare = float(np.median([call() for _ in range(1 if energy.kinematics.count > MANY else BARE)]))
    return energy.kinematics.count, bare, max(first - bare, 0.0)


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true", help="also dishes of 5 m and 7.4 m: minutes, and gigabytes")
    parser.add_argument("--only", choices=ROWS, metavar="CASE", help="one case by its name in the table")
    parser.add_argument("--row", choices=ROWS, metavar="CASE", help="measure one case here, as JSON")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    if arguments.row:
        print(json.dumps(measured(ROWS[arguments.row])))
        return
    shapes = (ROWS[arguments.only],) if arguments.only else SMALL + (LARGE if arguments.large else ())
    text = from_processes(__file__, HEAD, [("--row", shape.name) for shape in shapes])
    print(text)
    if arguments.write:
        put_between(arguments.write, "press", text)


if __name__ == "__main__":
    main()
