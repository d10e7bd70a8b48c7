"""The sparse solvers on our own matrices: seconds, accuracy, inertia.

    python benchmarks/linear_solvers.py [--large] [--write docs/decisions/linear-solver.md]

The matrices are exact Hessians of the check case near its minimum and, with --large, of the 1200 mm dish with 26 773
solved nodes. With --write the table replaces what stands between the markers `<!-- table: solvers -->` and
`<!-- end: solvers -->` of the page. The seconds are of the machine it runs on.
"""

from __future__ import annotations

import argparse
import os
import platform
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import numpy as np
from tables import put_between

from punchform.arrays import Floats
from punchform.case import CircleBlank, ParaboloidProfile, PunchCase, read_case
from punchform.grid import lay
from punchform.mechanics import linear
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.linear import multiply, solver_for, upper_matrix
from punchform.mechanics.newton import minimise
from punchform.mechanics.pattern import Pattern
from punchform.press import energy_of
from punchform.punch import surface
from punchform.start import flat_start
from punchform.wire import stiffness

MODULES = {"rslab": "rslab", "pardiso": "pymklpardiso", "scipy": "scipy"}
REPEATS = 3


def hessian(*, large: bool) -> tuple[str, Pattern, Floats, Floats]:
    """A name, the pattern, the values near the minimum, and the gradient two steps before as right-hand side."""
    case = read_case("packaged:check")
    punch_case, blank = case.tool, case.grid.blank
    if large:
        punch_case = PunchCase(
            profile=ParaboloidProfile(kind="paraboloid", focal_length=500), rim_radius=1200, fillet=30
        )
        blank = CircleBlank(shape="circle", radius=1380)
    punch = surface(punch_case)
    grid = lay(case.grid.model_copy(update={"blank": blank}), rim_radius=punch.rim_radius)
    start = flat_start(grid, punch)
    energy: Energy = energy_of(grid, stiffness(case.wire, case.grid.step), punch, case.press, start=start)
    state = minimise(energy, start).state
    chart = energy.kinematics.chart(state)
    model = energy.model(chart, Hessian.EXACT)
    rng = np.random.default_rng(0)
    moved = energy.kinematics.chart(chart.moved(1e-3 * rng.standard_normal(energy.kinematics.count)))
    gradient = energy.model(moved, Hessian.GAUSS_NEWTON).gradient
    return f"{grid.nodes} nodes, {energy.kinematics.count} unknowns", energy.pattern, model.values, gradient


def rows(name: str, pattern: Pattern, values: Floats, b: Floats) -> list[str]:
    """One line per installed solver."""
    upper = upper_matrix(pattern, values)
    found = []
    for library, module in MODULES.items():
        if not find_spec(module):
            found.append(f"| {name} | {library} | not installed | | | | | |")
            continue
        # The solve that led here has analysed this pattern already.
        linear._dissected.cache_clear()
        begun = perf_counter()
        solver = solver_for(pattern, library)
        factor = solver.factor(values)
        first = perf_counter() - begun
        again, solves = [], []
        for _ in range(REPEATS):
            begun = perf_counter()
            factor = solver.factor(values)
            again.append(perf_counter() - begun)
            begun = perf_counter()
            raw = factor.raw_solve(b)
            solves.append(perf_counter() - begun)
        residuals = [np.linalg.norm(b - multiply(upper, x)) / np.linalg.norm(b) for x in (raw, factor.solve(b))]
        found.append(
            f"| {name} | {library} | {first:.3f} | {np.median(again):.3f} | {np.median(solves):.4f} "
            f"| {residuals[0]:.1e} | {residuals[1]:.1e} | {factor.negative} |"
        )
    return found


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    lines = [
        "| matrix | solver | analyse and factor, s | factor again, s | solve, s | residual | refined | negative |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for large in (False, True) if arguments.large else (False,):
        lines += rows(*hessian(large=large))
    text = "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores; relative residuals)"])
    print(text)
    if arguments.write:
        put_between(arguments.write, "solvers", text)


if __name__ == "__main__":
    main()
