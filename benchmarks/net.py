"""The inextensible net from a thousand to a million nodes: seconds on one core, and how exact its edges are.

    python benchmarks/net.py [--nodes 1000 10000 100000 1000000] [--repeats 5] [--write docs/performance.md]

The grids are round blanks on a dish with a fillet and a flange. With mirror planes one quadrant is marched and the
other three are its images; with a direction of its own every node is marched. Compilation is not counted; the grid is
laid before the clock starts. With --write the table replaces what stands between the markers `<!-- table: net -->` and
`<!-- end: net -->` of the page. The seconds are of the machine it runs on.
"""

from __future__ import annotations

import argparse
import os
import platform
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import numpy as np
from dishes import FLANGE
from tables import put_between

from punchform.case import CircleBlank, GridCase, ParaboloidProfile, PunchCase
from punchform.grid import Grid, lay
from punchform.net import Net, lay_net
from punchform.punch import Surface, surface

STEP = 7.5
RATIO = 0.4
"""Focal length over diameter."""
FILLET_STEPS = 4.0
TURNED = 0.3
"""Direction of the first wire where no mirror plane is used [rad]."""
FEW = 300


def dish(nodes: int) -> tuple[Grid, Surface]:
    """A whole grid of about so many nodes and its punch."""
    blank = STEP * float(np.sqrt(nodes / np.pi))
    rim = blank / FLANGE
    profile = ParaboloidProfile(kind="paraboloid", focal_length=2 * RATIO * rim)
    punch = surface(PunchCase(profile=profile, rim_radius=rim, fillet=FILLET_STEPS * STEP))
    grid = lay(
        GridCase(step=(STEP, STEP), blank=CircleBlank(radius=blank), symmetry="full"),
        rim_radius=rim,
    )
    return grid, punch


def edge_error(grid: Grid, net: Net) -> float:
    """The largest deviation of an edge from its step, relative to the step."""
    edges = np.linalg.norm(net.positions[grid.end] - net.positions[grid.start], axis=1)
    return float(np.nanmax(np.abs(edges / STEP - 1)))


def row(nodes: int, direction: float, repeats: int) -> str:
    """One line: the median of the repeats."""
    grid, punch = dish(nodes)
    seconds = []
    for _ in range(repeats):
        begun = perf_counter()
        net = lay_net(grid, punch, direction=direction)
        seconds.append(perf_counter() - begun)
    how = "every node" if direction else "one quadrant"
    median = float(np.median(seconds))
    return (
        f"| {grid.nodes} | {how} | {1e3 * median:.2f} | {1e9 * median / grid.nodes:.0f} | {edge_error(grid, net):.1e} "
        f"| {int((~net.reached).sum())} |"
    )


def table(sizes: Sequence[int], repeats: int) -> str:
    """The table in Markdown."""
    head = [
        "| nodes | marched | milliseconds | nanoseconds a node | edge error, relative | nodes without a place |",
        "|---|---|---|---|---|---|",
    ]
    directions = (0.0, TURNED)
    for direction in directions:
        row(FEW, direction, 1)
    rows = [row(nodes, direction, repeats) for nodes in sizes for direction in directions]
    return "\n".join([*head, *rows, "", f"({platform.machine()}, one core; median of {repeats})"])


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, nargs="+", default=[1000, 10_000, 100_000, 1_000_000])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    text = table(arguments.nodes, arguments.repeats)
    print(text)
    if arguments.write:
        put_between(arguments.write, "net", text)


if __name__ == "__main__":
    main()
