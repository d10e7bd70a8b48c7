"""What a sweep gains by processes: the same designs of a small dish in one loop, in threads and in processes.

    python benchmarks/sweep_scaling.py [--cases 1000] [--write docs/sweeps.md]

The efficiency is that of Eq. (13.59); the begin of the workers counts. Where other programs use
the machine, compare the seconds of the processors: they tell what the work itself costs there. The page needs the
markers `<!-- table: sweep -->` and `<!-- end: sweep -->`.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from tables import put_between

from punchform.case import Case, case_from_text
from punchform.optimise.designs import hypercube, variation
from punchform.optimise.evaluations import evaluate
from punchform.optimise.pools import InOrder, Workers, given, processes
from punchform.optimise.sweep import sweep

DISH = """
schema = 1
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "70 mm" }
[wire]
diameter = "0.75 mm"
youngs_modulus = "210 GPa"
poisson = 0.3
[punch]
profile = { kind = "paraboloid", focal_length = "60 mm" }
rim_radius = "60 mm"
fillet = "20 mm"
[release]
hold = { from_radius = "60 mm" }
[target]
profile = { kind = "paraboloid", focal_length = "60 mm" }
aperture_radius = "40 mm"
tolerance = "0.5 mm"
"""
OVER = ("wire.diameter=0.5 mm:0.9 mm", "grid.crossing=pinned,welded", "wire.youngs_modulus=70 GPa:210 GPa")
WORKERS = 2
HEAD = (
    *("where", "workers", "designs", "seconds", "seconds a design", "efficiency"),
    *("processor seconds", "efficiency by these", "same figures"),
)


@dataclass(frozen=True)
class Timed:
    """How long a sweep took, on the clock and on all processors, and what it found."""

    seconds: float
    processor: float
    found: Mapping[str, Any]


def timed(case: Case, designs: list[Mapping[str, Any]], workers: Workers) -> Timed:
    """A sweep, from the begin of its workers to their end."""
    begun, used = perf_counter(), processor_seconds()
    found = {one.key: (one.figures, one.failure) for one in sweep(case, designs, executor=workers)}
    return Timed(perf_counter() - begun, processor_seconds() - used, found)


def processor_seconds() -> float:
    """What this process and those of its children that have ended have used."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in both)


def table(cases: int) -> str:
    """The table in Markdown."""
    case = case_from_text(DISH)
    designs = list(hypercube([variation(case, text) for text in OVER], cases, np.random.default_rng(1)))
    # The kernels are compiled, or found on the disk, before any clock starts.
    evaluate(case, {})
    with ExitStack() as open_ones:
        threads = given(open_ones.enter_context(ThreadPoolExecutor(WORKERS)))
        ways = {"one loop": (given(InOrder(), 1), 1), "threads": (threads, WORKERS)}
        ways["processes"] = (processes(WORKERS), WORKERS)
        done = {name: timed(case, designs, workers) for name, (workers, _) in ways.items()}
    loop = done["one loop"]
    lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    for name, (_, count) in ways.items():
        one = done[name]
        cells = (
            *(name, count, len(one.found), f"{one.seconds:.1f}", f"{one.seconds / len(designs):.3f}"),
            f"{100 * loop.seconds / (count * one.seconds):.0f} %",
            f"{one.processor:.1f}",
            f"{100 * loop.processor / one.processor:.0f} %",
            "yes" if one.found == loop.found else "NO",
        )
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores)"])


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    text = table(arguments.cases)
    print(text)
    if arguments.write:
        put_between(arguments.write, "sweep", text)


if __name__ == "__main__":
    main()
