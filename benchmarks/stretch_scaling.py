"""Stretch-forming from small dishes to large ones: clamped wires of annealed 304 that yield, pressed in strokes.

    python benchmarks/stretch_scaling.py [--large] [--strokes 15] [--write docs/performance.md]

Every row runs in a process of its own, after a tiny press that loads the compiled kernels, so that its peak memory is
its own. The last two columns compare one evaluation of energy, gradient and matrix with that of the linear chord
element on the same grid and state: of wires that could yield and do not, and of those of the press at the end of its
last stroke, from which they flow on. With --write the table replaces what stands between the markers
`<!-- table: stretch -->` and `<!-- end: stretch -->` of the page.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from dishes import Dish, Laid
from press_scaling import PARTS, crossings, peak_memory
from tables import from_processes, put_between

from punchform.case import PressCase, read_case
from punchform.case.wire import WireCase
from punchform.errors import NoEquilibrium
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State
from punchform.press import Formed, energy_of, press
from punchform.wire import stiffness

STROKES = 15
REPEATS = 5
SIZES = (60.0, 150.0, 300.0, 600.0)
LARGE = (1200.0,)
HEAD = (
    *("case", "crossings", "solved nodes", "strokes", "energy, mJ", "largest elongation, %"),
    *("factorisations", "most in a stroke", "press, s", *(f"{part}, s" for part in PARTS), "peak memory, GB"),
    *("times the linear element, elastic", "flowing"),
)


def dish(rim_radius: float) -> Dish:
    """A dish whose focal length is half its aperture, and its blank."""
    return Dish(rim_radius, rim_radius, 1.15 * rim_radius)


def laid_to_yield(shape: Dish) -> Laid:
    """The same grid, punch and mesh as `shape.laid`, of a wire that yields."""
    case = read_case("packaged:check")
    given = case.wire.model_dump(include={"diameter", "shear_factor", "centreline"}, exclude_unset=True)
    wire = WireCase.model_validate(given | {"material": "304 annealed"})
    return replace(shape.laid(), elements=stiffness(wire, case.grid.step))


def clamp(strokes: int) -> PressCase:
    """The press that stretches."""
    return PressCase(rim="clamp", frame="chord", strokes=strokes)


def formed_in(laid: Laid, strokes: int) -> Formed:
    """The dish, pressed in so many strokes."""
    return press(laid.grid, laid.elements, laid.surface, clamp(strokes))


def ratios(laid: Laid, strokes: int, last: State) -> tuple[float, float]:
    """Seconds of one evaluation over those of the linear chord element: elastic, and flowing on from the last state."""
    yielding = energy_of(laid.grid, laid.elements, laid.surface, clamp(strokes), start=last)
    linear = replace(yielding, bars=replace(yielding.bars, yielding=None))
    law = yielding.bars.yielding
    assert law is not None
    strong = replace(law, curve=law.curve * (1.0, 1e3))
    elastic = replace(yielding, bars=replace(yielding.bars, yielding=strong))
    new = replace(last, history=None)
    least = seconds(linear, new)
    return seconds(elastic, new) / least, seconds(yielding, last) / least


def seconds(energy: Energy, state: State) -> float:
    """The least seconds of one evaluation among some, each at a place that the last has not been at."""
    chart = energy.kinematics.chart(state)
    energy.model(chart, Hessian.EXACT)
    found = []
    for number in range(REPEATS):
        z = 1e-4 * np.random.default_rng(number).standard_normal(energy.kinematics.count)
        near = energy.kinematics.chart(chart.moved(z))
        begun = perf_counter()
        energy.model(near, Hessian.EXACT)
        found.append(perf_counter() - begun)
    return min(found)


def measured(rim_radius: float, strokes: int) -> dict[str, Any]:
    """One row of the table, by column; a press without an equilibrium says why instead of an energy."""
    formed_in(laid_to_yield(dish(60.0)), 2)
    laid = laid_to_yield(dish(rim_radius))
    known = {
        "case": dish(rim_radius).name,
        "crossings": crossings(laid),
        "solved nodes": laid.grid.nodes,
        "strokes": strokes,
    }
    begun = perf_counter()
    try:
        formed = formed_in(laid, strokes)
    except NoEquilibrium as error:
        return known | {"energy, mJ": str(error), "press, s": f"{perf_counter() - begun:.2f}"}
    known |= {
        "energy, mJ": f"{formed.energy:.3f}",
        "largest elongation, %": f"{100 * formed.whole.axial_strain.max():.2f}",
        "factorisations": formed.factorisations,
        "most in a stroke": max(stroke.factorisations for stroke in formed.strokes),
        "press, s": f"{perf_counter() - begun:.2f}",
        **{f"{part}, s": f"{formed.seconds[part]:.2f}" for part in PARTS},
        "peak memory, GB": f"{peak_memory():.2f}",
    }
    elastic, flowing = ratios(laid, strokes, formed.state)
    return known | {"times the linear element, elastic": f"{elastic:.2f}", "flowing": f"{flowing:.2f}"}


def main() -> None:
    """Print the table, and write it into a page when asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true", help="also the dish of 2.4 m (minutes)")
    parser.add_argument("--tiny", action="store_true", help="only the smallest dish")
    parser.add_argument("--strokes", type=int, default=STROKES)
    parser.add_argument("--row", type=float, metavar="RADIUS", help="measure the dish of this rim here, as JSON")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    if arguments.row:
        print(json.dumps(measured(arguments.row, arguments.strokes)))
        return
    sizes = SIZES[:1] if arguments.tiny else SIZES + (LARGE if arguments.large else ())
    rows = [("--row", str(size), "--strokes", str(arguments.strokes)) for size in sizes]
    text = from_processes(__file__, HEAD, rows)
    print(text)
    if arguments.write:
        put_between(arguments.write, "stretch", text)


if __name__ == "__main__":
    main()
