"""The numbers of a run as rows of tables: what it comes to in the tool, where its energy is, how its solve went."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from punchform.export.result import largest
from punchform.report.quantities import strain
from punchform.report.section import Rows, Tables
from punchform.report.words import energy, percent, size

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Solved

KINDS = {
    "stretch": "stretching",
    "bend": "bending out of the surface",
    "in_plane": "bending in the surface",
    "twist": "twisting",
    "crossing": "turning of the crossings",
}


def result_rows(run: Run) -> Rows:
    formed = run.formed
    contact, force = formed.whole.contact, formed.whole.F[:, 0]
    stress, ratio = largest(formed.whole.stress), largest(formed.whole.stress_ratio)
    return (
        ("Elastic energy of the whole grid", energy(formed.energy)),
        ("Largest shear angle", size(math.degrees(formed.max_shear), "°", 4)),
        ("Largest draw-in of the edge", size(formed.draw_in, "mm")),
        ("Axial force in the wires", span(float(force.min()), float(force.max()), "N")),
        (f"Largest {strain(yields=formed.hardening is not None).label}", percent(formed.max_axial_strain)),
        ("Largest stress", "not known" if stress is None else size(stress, "MPa")),
        ("Largest stress / yield strength", "not known" if ratio is None else size(ratio, "", 3)),
        ("Contact force on a node", span(float(contact.min()), float(contact.max()), "N")),
        ("Press force along the axis", size(formed.push, "N")),
        *_holder_rows(run),
    )


def _holder_rows(run: Run) -> Rows:
    """What the holder did, where there is one."""
    grip = run.formed.grip
    if grip is None:
        return ()
    return (
        ("Work against the friction of the holder", energy(grip.work)),
        ("Longest slip through the holder", size(grip.largest_slip, "mm")),
        ("Crossings that slipped, of those in the holder at first", percent(grip.slipped)),
    )


def grid_rows(run: Run) -> Rows:
    whole, case = run.formed.whole, run.case
    return (
        ("Nodes", f"{len(whole.positions)} ({run.formed.solved_nodes} solved)"),
        ("Wire elements", f"{len(whole.family)}"),
        ("Step", " × ".join(f"{step:g} mm" for step in dict.fromkeys(case.grid.step))),
        ("Wire diameter", f"{case.wire.diameter:g} mm"),
        ("Radius of the rim", f"{case.tool.rim_radius:g} mm"),
        ("Depth of the shell", size(float(whole.positions[:, 2].max()), "mm")),
    )


def energy_rows(stage: Solved) -> Rows:
    """Where the energy of a stage is."""
    total, kinds = stage.energy or 1.0, stage.energy_kinds
    rows = [
        (f"in {KINDS.get(kind, kind)}", f"{energy(part)} ({percent(part / total)})") for kind, part in kinds.items()
    ]
    if min(kinds.values(), default=0.0) < 0:
        rows.append(("A part can be negative: the crimp couples the ways to deform.", ""))
    return tuple(rows)


def solve_rows(stage: Solved) -> Rows:
    """How the solve of a stage went."""
    negative = stage.negative_eigenvalues
    return (
        ("Ended", stage.outcome.value),
        ("Steps", f"{stage.steps}"),
        ("Factorisations", f"{stage.factorisations} ({stage.linear_solver})"),
        ("Negative eigenvalues at the end", "not counted" if negative is None else f"{negative}"),
        *((f"Seconds: {part}", f"{seconds:.2f}") for part, seconds in stage.seconds.items()),
    )


def stroke_tables(run: Run) -> Tables:
    """How the strokes went, where there was more than one."""
    strokes = run.formed.strokes
    if len(strokes) < 2:
        return ()
    rows = []
    for stroke in strokes:
        rubbed = "" if run.formed.grip is None else f", {energy(stroke.friction_work)} of friction"
        told = f"{energy(stroke.energy)} in the wires{rubbed}; {stroke.factorisations} factorisations"
        rows.append((f"Down to {percent(stroke.share)} of the depth", told))
    return (("Strokes", tuple(rows)),)


def span(low: float, high: float, unit: str) -> str:
    """A range in words: from low to high."""
    return f"{size(low, '')} to {size(high, unit)}"
