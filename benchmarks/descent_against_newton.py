"""The paper's descent against Newton on the check case, in the paper's own kinematics.

    python benchmarks/descent_against_newton.py [--steps 10000] [--write docs/paper.md]

Prints a table of energies against steps, gradients and seconds; with --write it replaces what stands between the
markers `<!-- table: descent -->` and `<!-- end: descent -->` of the page. The seconds are of the machine it runs on.
"""

from __future__ import annotations

import argparse
import os
import platform
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

from tables import put_between

from punchform.case import PressCase, read_case
from punchform.grid import Grid, lay
from punchform.mechanics.assembly import Energy
from punchform.mechanics.descent import descend
from punchform.mechanics.frames import State
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome
from punchform.press import energy_of
from punchform.progress import Progress
from punchform.punch import surface
from punchform.start import flat_start
from punchform.wire import stiffness

MARKS = (10, 100, 1000, 10_000)
TRIALS = (4e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6)
"""Fixed step lengths [mm/N] tried from the largest down: the first with which the energy never grows is shown."""

RULES: tuple[tuple[str, str, tuple[float | None, ...]], ...] = (
    ("descent, λ exact", "exact", (None,)),
    ("descent, λ fixed at", "fixed", TRIALS),
    ("descent, direction reused, λ from", "reuse-direction", (1e-4,)),
)


@dataclass
class Trace:
    """An observer that notes when each step was reported."""

    begun: float = field(default_factory=perf_counter)
    points: list[tuple[int, float, float]] = field(default_factory=list)

    def __call__(self, event: Progress) -> None:
        """Note one step: its number, the seconds so far, the energy."""
        self.points.append((event.step, perf_counter() - self.begun, event.energy))

    def at(self, step: int) -> tuple[float, float] | None:
        """Seconds and energy at a step, if it was reached."""
        return next(((seconds, energy) for number, seconds, energy in self.points if number >= step), None)


def paper_problem() -> tuple[Grid, Energy, State]:
    """The check case in the paper's kinematics: differences, offset `lower`, every wire rising."""
    case = read_case("packaged:check")
    paper = PressCase(kinematics="differences", offset="lower")
    punch = surface(case.tool)
    grid = lay(case.grid.model_copy(update={"weave": "same"}), rim_radius=punch.rim_radius)
    start = flat_start(grid, punch)
    return grid, energy_of(grid, stiffness(case.wire, case.grid.step), punch, paper, start=start), start


def table(steps: int) -> str:
    """The comparison as a table in Markdown."""
    grid, energy, start = paper_problem()
    minimise(energy, start)
    newton = Trace()
    solved = minimise(energy, start, observe=newton)
    whole = grid.copies
    least = whole * energy.at(solved.state)
    rows = [
        f"| Newton | {len(solved.history)} | {len(solved.history)}, and {solved.factorisations} factorisations | "
        f"{newton.points[-1][1]:.2f} | {least:.3f} | 0 |"
    ]
    for name, rule, lengths in RULES:
        for length in lengths:
            trace = Trace()
            ended = descend(energy, start, rule=rule, step_length=length, max_steps=steps + 1, observe=trace)
            if ended.outcome is not Outcome.NO_DESCENT:
                break
        gradients = ended.evaluations / (steps + 1)
        for mark in MARKS:
            found = trace.at(mark)
            if found is not None:
                excess = whole * found[1] / least - 1
                label = name if length is None else f"{name} {length:g} mm/N"
                cost = f"about {gradients * mark:.0f}" if rule == "reuse-direction" else mark
                rows.append(f"| {label} | {mark} | {cost} | {found[0]:.2f} | {whole * found[1]:.1f} | {excess:.3g} |")
    head = "| method | steps | gradients | seconds | energy of the whole grid, mJ | above the minimum, relative |"
    return "\n".join([head, "|---|---|---|---|---|---|", *rows, "", f"({platform.machine()}, {os.cpu_count()} cores)"])


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    text = table(arguments.steps)
    print(text)
    if arguments.write:
        put_between(arguments.write, "descent", text)


if __name__ == "__main__":
    main()
