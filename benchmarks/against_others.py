"""The press against other ways to the same minimum: L-BFGS-B, the paper's descent, and a time-stepping rod code.

    python benchmarks/against_others.py [--large] [--seconds 600] [--rods PYTHON] [--write docs/performance.md]

All start from the same net; the descent once more from its own start, P(18). L-BFGS-B (SciPy) gets the energy and
gradient of `one_chart.py`: one vector of unknowns, no restart, no matrix; once as it comes and once with unknowns
scaled by the diagonal of the Gauss-Newton matrix. It is
stopped for it, as soon as its energy is within 1e-8 of the minimum, or after `--seconds`. The descent runs for
`--seconds` too; how its remaining steps are estimated stands at `steps_needed`. With --rods, a Python that has
PyElastica (`python -m venv rods && rods/bin/pip install pyelastica`, then `--rods rods/bin/python`), a small grid
relaxes in time on a sphere; without it that table is left alone. With --write the tables replace what stands between
the markers `<!-- table: others -->` and `<!-- end: others -->`, and `rods` likewise, of the page. The seconds are of
the machine it runs on.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from dishes import Dish, Laid, dish_of
from one_chart import OneChart
from scipy.optimize import minimize
from tables import put_between

from punchform.arrays import Floats
from punchform.case import GridCase, PressCase, RectangleBlank, StraightLine, WireCase
from punchform.grid import lay
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.descent import descend
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import FreeChart
from punchform.mechanics.newton import minimise
from punchform.press import energy_of, press
from punchform.progress import Progress
from punchform.punch.bare import Sphere
from punchform.start import flat_start
from punchform.wire import stiffness

CLOSE = 1e-8
"""How near to the least energy, relatively, a method has to come."""
REPEATS = 5
MEMORY = 10
"""Pairs of steps that L-BFGS-B keeps: SciPy's default."""
SMALL = (dish_of(115.0, 0.4), Dish(300.0, 250.0, 345.0))
LARGE = (Dish(1200.0, 500.0, 1380.0),)
WIRES = 5
"""Wires of each family of the grid that relaxes in time; each has as many crossings."""
ROD = WireCase(
    diameter=0.75, youngs_modulus=210e3, poisson=0.25, shear_factor=27 / 28, centreline=StraightLine(kind="straight")
)
PIECES = (1, 2, 4)
"""Elements between two crossings of the rods that relax in time."""
SPHERE = 60.0
STEP = 7.5
PARTS = Path(__file__).with_name("rods_in_time.py")


class EnoughError(Exception):
    """Raised by an observer to end a method."""


@dataclass
class Trace:
    """Seconds and excesses, relative to the least energy, after each evaluation or step; inside: seconds of these in
    the energy and gradient alone."""

    least: float
    limit: float
    begun: float = field(default_factory=perf_counter)
    inside: float = 0.0
    steps: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    excess: list[float] = field(default_factory=list)

    def note(self, step: int, energy: float) -> None:
        """Note one energy; raises EnoughError when it is near enough, or time is up."""
        self.steps.append(step)
        self.seconds.append(perf_counter() - self.begun)
        self.excess.append(energy / self.least - 1)
        if self.excess[-1] <= CLOSE or self.seconds[-1] > self.limit:
            raise EnoughError

    def __call__(self, event: Progress) -> None:
        """Note a step of the descent."""
        self.note(event.step, event.energy)


@dataclass(frozen=True)
class Problem:
    """One grid on its punch with its energy, the net and P(18) as starts, and what Newton makes of it from the net."""

    energy: Energy
    start: State
    flat: State
    least: float
    newton: float
    factorisations: int

    @property
    def name(self) -> str:
        """How the table calls it."""
        return f"{self.energy.grid.nodes} nodes, {self.energy.kinematics.count} unknowns"


def problem(laid: Laid) -> Problem:
    """The problem, solved by Newton several times: the median of the seconds, the analysis of the pattern included."""
    start = laid.net_start
    seconds = []
    for _ in range(REPEATS):
        energy = energy_of(laid.grid, laid.elements, laid.surface, PressCase(), start=start)
        begun = perf_counter()
        solution = minimise(energy, start)
        seconds.append(perf_counter() - begun)
    assert solution.outcome.usable
    return Problem(
        energy,
        start,
        flat_start(laid.grid, laid.surface),
        energy.at(solution.state),
        float(np.median(seconds)),
        solution.factorisations,
    )


def lbfgs(function: Callable[[Floats], tuple[float, Floats]], scale: Floats, trace: Trace) -> str:
    """Run L-BFGS-B on unknowns times `scale`; how it ended in a word."""

    def scaled(y: Floats) -> tuple[float, Floats]:
        begun = perf_counter()
        value, gradient = function(y / scale)
        trace.inside += perf_counter() - begun
        trace.note(len(trace.steps) + 1, value)
        return value, gradient / scale

    options = {"maxcor": MEMORY, "maxiter": 10**9, "maxfun": 10**9, "ftol": 0.0, "gtol": 0.0, "maxls": 50}
    try:
        ended = minimize(scaled, np.zeros(len(scale)), jac=True, method="L-BFGS-B", options=options)
    except EnoughError:
        return "reached" if trace.excess[-1] <= CLOSE else "out of time"
    return f"gave up: {ended.message}".lower()


def steps_needed(trace: Trace) -> float:
    """How many steps a descent needs at least to come within CLOSE: the rate of its last half, carried on.

    On a quadratic energy, which this one is so near to its minimum, the rate of a descent along the gradient can only
    fall, with a fixed step length and with the exact one; so this is a lower bound as far as the energy is quadratic.
    """
    steps, excess = np.array(trace.steps, dtype=float) + 1.0, np.array(trace.excess)
    if excess[-1] <= CLOSE:
        return float(steps[-1])
    half = int(np.searchsorted(steps, 0.5 * steps[-1]))
    rate = math.log(excess[half] / excess[-1]) / (steps[-1] - steps[half])
    return float(steps[-1] + math.log(excess[-1] / CLOSE) / rate)


def rows(given: Problem, limit: float) -> list[str]:
    """The lines of one problem."""
    start = given.energy.kinematics.chart(given.start)
    assert isinstance(start, FreeChart)
    function = OneChart(given.energy, start)
    count = given.energy.kinematics.count
    found = [
        _row(given, "Newton", f"{given.factorisations} factorisations", given.newton, "0", "reached", given.newton)
    ]
    for name, scale in (
        ("L-BFGS-B", np.ones(count)),
        ("L-BFGS-B, scaled by the diagonal", np.sqrt(function.diagonal)),
    ):
        given.energy.clock.reset()
        trace = Trace(given.least, limit)
        word = lbfgs(function, scale, trace)
        excess = f"{trace.excess[-1]:.1e}"
        needs = trace.seconds[-1]
        found.append(_row(given, name, f"{len(trace.steps)} gradients", needs, excess, word, needs))
        kernel = given.energy.clock.kernel
        for part, seconds in (("gradients alone", trace.inside), ("passes of the kernel alone", kernel)):
            work = f"its {len(trace.steps)} {part}"
            found.append(_row(given, name, work, seconds, "", "", seconds))
    gradient, kernel = trace.inside / len(trace.steps), kernel / len(trace.steps)
    model = _seconds(lambda: given.energy.model(start, Hessian.GAUSS_NEWTON))
    found += [
        _row(given, "one energy and gradient", "as above, a mean", gradient, "", "", math.nan),
        _row(given, "one pass of the kernel", "as above, a mean", kernel, "", "", math.nan),
        _row(given, "one energy, gradient and matrix", "at the middle of a chart", model, "", "", math.nan),
    ]
    for begin, state in (("the net", given.start), ("its own start, P(18)", given.flat)):
        found += _descended(given, f"descent, λ exact, from {begin}", state, limit, 2 * gradient, 2 * kernel)
    return found


def _descended(
    given: Problem, method: str, start: State, limit: float, two_gradients: float, two_passes: float
) -> list[str]:
    """The lines of the descent from one start, with what its remaining steps would cost at least."""
    trace = Trace(given.least, limit)
    try:
        descend(given.energy, start, rule="exact", max_steps=10**9, observe=trace)
        word = "stationary"
    except EnoughError:
        word = "reached" if trace.excess[-1] <= CLOSE else "out of time"
    steps, ran = trace.steps[-1] + 1, trace.seconds[-1]
    found = [_row(given, method, f"{steps} steps", ran, f"{trace.excess[-1]:.1e}", word, math.nan)]
    needed = steps_needed(trace)
    # The exact λ needs H a once a step, which one more gradient gives: no descent can do with less than two.
    for name, each in (
        ("at its own pace", ran / steps),
        ("at two gradients a step", two_gradients),
        ("at two passes of the kernel a step", two_passes),
    ):
        seconds = each * needed
        work = f"{needed:.4g} steps {name}"
        found.append(_row(given, f"{method}, at least", work, seconds, f"{CLOSE:.0e}", "extrapolated", seconds))
    return found


def _seconds(call: Callable[[], Any]) -> float:
    """The median seconds of a call."""
    call()
    taken = []
    for _ in range(REPEATS):
        begun = perf_counter()
        call()
        taken.append(perf_counter() - begun)
    return float(np.median(taken))


def _row(given: Problem, method: str, work: str, seconds: float, excess: str, ended: str, needs: float) -> str:
    ratio = "" if math.isnan(needs) else f"{needs / given.newton:.4g}"
    return f"| {given.name} | {method} | {work} | {seconds:.4g} | {excess} | {ended} | {ratio} |"


def table(shapes: Sequence[Dish], limit: float) -> str:
    """The comparison in Markdown."""
    head = [
        "| grid | method | work | seconds | above the least energy, relative | ended | times Newton's seconds |",
        "|---|---|---|---|---|---|---|",
    ]
    found = [line for shape in shapes for line in rows(problem(shape.laid()), limit)]
    return "\n".join(
        [*head, *found, "", f"({platform.machine()}, {os.cpu_count()} cores; {limit:g} s for each method)"]
    )


def rods_table(python: str, wires: int, limit: float) -> str:
    """A small grid on a sphere: pressed by Newton, and relaxing in time under PyElastica."""
    blank = RectangleBlank(shape="rectangle", size=((wires - 0.9) * STEP, (wires - 0.9) * STEP))
    sphere = Sphere(SPHERE)
    grid = lay(GridCase(step=(STEP, STEP), blank=blank, symmetry="full", weave="same"))
    elements = stiffness(ROD, (STEP, STEP))
    start = Laid(grid, elements, sphere).net_start
    press(grid, elements, sphere, PressCase())
    begun = perf_counter()
    formed = press(grid, elements, sphere, PressCase())
    newton = perf_counter() - begun
    numbers = np.full(grid.index.max(axis=0) - grid.index.min(axis=0) + 1, -1)
    numbers[tuple((grid.index - grid.index.min(axis=0)).T)] = np.arange(grid.nodes)
    asked: dict[str, Any] = {
        "along_x": start.positions[numbers.T].tolist(),
        "step": STEP,
        "radius": SPHERE,
        "diameter": ROD.diameter,
        "youngs_modulus": ROD.youngs_modulus,
        "poisson": ROD.poisson,
        "seconds": limit,
    }
    lines = [
        "| code | elements in a step | elastic energy, mJ | of its last | steps | seconds | times Newton's seconds |",
        "|---|---|---|---|---|---|---|",
        f"| punchform | 1 | {formed.energy:.4f} | converged | {formed.steps} | {newton:.4f} | 1 |",
    ]
    for pieces in PIECES:
        done = subprocess.run(
            [python, str(PARTS)],
            input=json.dumps(asked | {"pieces": pieces}),
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        told = json.loads(done.stdout)
        for reached in told["reached"]:
            lines.append(
                f"| PyElastica {told['version']} | {pieces} | {reached['energy']:.4f} | within {reached['within']:g} "
                f"| {reached['steps']} | {reached['seconds']:.4g} | {reached['seconds'] / newton:.4g} |"
            )
    size = f"{wires} × {wires} straight wires, {grid.nodes} crossings"
    return "\n".join([*lines, "", f"({size}; {platform.machine()}, {os.cpu_count()} cores)"])


def main() -> None:
    """Print the tables, and write them into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true", help="also the 1200 mm dish with its 26 773 solved nodes")
    parser.add_argument("--tiny", action="store_true", help="only the smallest grid")
    parser.add_argument("--seconds", type=float, default=600.0, help="the limit of each method")
    parser.add_argument("--rods", metavar="PYTHON", help="a Python that has PyElastica")
    parser.add_argument("--wires", type=int, default=WIRES, help="wires of each family that relax in time")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    shapes = SMALL[:1] if arguments.tiny else SMALL + (LARGE if arguments.large else ())
    tables = {"others": table(shapes, arguments.seconds)}
    if arguments.rods:
        tables["rods"] = rods_table(arguments.rods, arguments.wires, arguments.seconds)
    for name, text in tables.items():
        print(text)
        if arguments.write:
            put_between(arguments.write, name, text)
    if not arguments.rods:
        print("\nno --rods: the comparison in time is left out; it needs a Python with PyElastica (pip: pyelastica)")


if __name__ == "__main__":
    main()
