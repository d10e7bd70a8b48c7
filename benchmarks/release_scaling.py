"""The release from small grids to large ones: factorisations and seconds for every kind of hold.

    python benchmarks/release_scaling.py [--large] [--write docs/performance.md]

The grids are those of `press_scaling.py`, pressed and then let go. Factorisations are of both solves of Eq. (7.4), the
softened one and the real one; those that tell whether the whole grid is stable, Eq. (7.2), are within the seconds only.
With --write the table replaces what stands between the markers `<!-- table: release -->` and `<!-- end: release -->`.
"""

from __future__ import annotations

import argparse
import os
import platform
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

from dishes import Dish, Hemisphere
from press_scaling import WARM, crossings
from tables import put_between

from punchform.case import HoldFrom, HoldRing, PressCase, ReleaseCase
from punchform.errors import NoEquilibrium
from punchform.press import press
from punchform.release import release

SMALL: tuple[Dish | Hemisphere, ...] = (
    Dish(300.0, 250.0, 345.0),
    Hemisphere(1200, whole=False),
    Hemisphere(4600, whole=False),
    Dish(600.0, 500.0, 690.0),
)
LARGE: tuple[Dish | Hemisphere, ...] = (Hemisphere(18_400, whole=False), Dish(1200.0, 500.0, 1380.0))
HEAD = (
    *("case", "crossings", "solved nodes", "held", "energy, mJ", "largest sag, mm", "factorisations"),
    *("negative eigenvalues, quarter", "whole", "release, s"),
)


def rows(shape: Dish | Hemisphere) -> list[str]:
    """The lines of one grid, one for each hold that it has nodes for."""
    laid = shape.laid()
    formed = press(laid.grid, laid.elements, laid.surface, PressCase())
    holds = {"nothing": ReleaseCase(), "wire ends, pinned": ReleaseCase(hold="rim")}
    if isinstance(shape, Dish):
        holds["all from the rim outwards"] = ReleaseCase(hold=HoldFrom(from_radius=shape.rim_radius))
        holds["heights on the rim"] = ReleaseCase(hold=HoldRing(ring=shape.rim_radius))
    found = []
    for name, case in holds.items():
        begun = perf_counter()
        known = [shape.name, crossings(laid), laid.grid.nodes, name]
        try:
            done = release(formed, laid.elements, case, PressCase())
        except NoEquilibrium as error:
            known += [str(error), "–", "–", "–", "–"]
        else:
            known += [f"{done.energy:.4f}", f"{done.max_sag:.3f}", done.factorisations]
            known += [done.negative_eigenvalues, done.stability.negative]
        known.append(f"{perf_counter() - begun:.2f}")
        found.append(f"| {' | '.join(map(str, known))} |")
        print(found[-1])
    return found


def table(shapes: Sequence[Dish | Hemisphere]) -> str:
    """The table in Markdown."""
    laid = WARM.laid()
    release(press(laid.grid, laid.elements, laid.surface, PressCase()), laid.elements, ReleaseCase(), PressCase())
    lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    lines += [line for shape in shapes for line in rows(shape)]
    return "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores)"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--large", action="store_true", help="also the large grids (some minutes)")
    parser.add_argument("--write", type=Path, help="the page that holds the table")
    chosen = parser.parse_args()
    text = table(SMALL + (LARGE if chosen.large else ()))
    print(text)
    if chosen.write:
        put_between(chosen.write, "release", text)


if __name__ == "__main__":
    main()
