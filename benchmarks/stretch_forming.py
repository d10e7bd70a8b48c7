"""Stretch-forming against draw-forming: the packaged case `dish600` with one thing changed at a time.

    python benchmarks/stretch_forming.py [--only NAME ...] [--kept FOLDER] [--write docs/stretch_forming.md]

Every run leaves its figures as a file in the folder --kept, and is not run again while that file is there. With --only
(part of) the names of runs, those alone are run. With --write the tables replace what stands between the
markers `<!-- table: forming -->`, `<!-- table: flow -->`, `<!-- table: lengths -->`, `<!-- table: strokes -->` and
`<!-- table: sections -->`, each with its end; a run that has not been made leaves its cells empty.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from tables import put_between

from punchform import Run, read_case, run
from punchform.accuracy import ALIGNMENTS, Accuracy, best_fit, measure_case
from punchform.case import Case, HolderCase, ReleaseCase, StraightLine
from punchform.errors import NoEquilibrium
from punchform.prepare import prepare
from punchform.punch import Surface
from punchform.release import release
from punchform.solved import Shaped
from punchform.whole import Whole

Figures = dict[str, Any]

ELASTIC = {"hardening": "none"}
STRAIGHT = {"centreline": StraightLine(height=0.75)}
STACKED, WELDED = {"weave": "stacked"}, {"crossing": "welded"}
HOLDER = HolderCase(force_per_length=60.0, friction=0.15)
MIDDLE = 0.5
"""The part of the rim's radius, from the axis, over which the curvature of the middle wire is taken."""
JUDGED = 270.0
"""Radius within which the dish is judged, as in the packaged case [mm]."""
TINY = 1e-6
FLAT = 1e5
"""A focal length beyond this is that of a flat grid [mm]."""


@dataclass(frozen=True)
class Variant:
    """The packaged case with some settings changed; name: of its row, and of its file."""

    name: str
    wire: dict[str, Any] = field(default_factory=dict)
    grid: dict[str, Any] = field(default_factory=dict)
    press: dict[str, Any] = field(default_factory=dict)

    def case(self) -> Case:
        """Its case, with the frame at the chord whatever the wire, as a wire that yields has it anyhow."""
        base = read_case("packaged:dish600")
        press = {"frame": "chord", **self.press}
        changes = {"wire": self.wire, "grid": self.grid, "press": press}
        parts = {name: getattr(base, name).model_copy(update=update) for name, update in changes.items()}
        return base.model_copy(update=parts)


CLAMPED = "yields, clamped, crimped, pinned"
FORMING = (
    Variant("elastic, drawn in", wire=ELASTIC, press={"rim": "draw"}),
    Variant("elastic, clamped", wire=ELASTIC),
    Variant("yields, drawn in", press={"rim": "draw"}),
    Variant("yields, holder", press={"rim": "draw", "hold": HOLDER}),
    Variant(CLAMPED),
    Variant("yields, clamped, crimped, welded", grid=WELDED),
    Variant("yields, clamped, straight, pinned", wire=STRAIGHT, grid=STACKED),
    Variant("yields, clamped, straight, welded", wire=STRAIGHT, grid=STACKED | WELDED),
)
STROKES = (
    *(Variant(f"{count} strokes", press={"strokes": count}) for count in (6, 24, 48)),
    *(Variant(f"straight, {count} strokes", wire=STRAIGHT, grid=STACKED, press={"strokes": count}) for count in (48,)),
)
SECTIONS = (Variant("fibres, clamped", wire={"section": "fibres"}),)


def figures(variant: Variant) -> Figures:
    """What a run of a variant says; or, where it ends in no equilibrium, why."""
    case, begun = variant.case(), perf_counter()
    try:
        done = run(case)
    except NoEquilibrium as error:
        return {"failure": str(error)}
    seconds, tool = perf_counter() - begun, prepare(case).punch
    assert done.released is not None
    before, after = accuracy(case, done.formed, tool), accuracy(case, done.released, tool)
    parts = after.as_held.harmonics
    assert parts is not None
    return {
        "formed_rms": before.judged.rms,
        "rms": after.as_held.statistics["normal"].rms,
        "fitted": after.fitted.statistics["normal"].rms,
        "apex": done.released.apex,
        "sag": done.released.max_sag,
        "lobes": {part.m: part.rms for part in parts.parts},
        "elongation": apart(done.formed.whole),
        "pull": float(done.formed.whole.F[:, 0].max()),
        "draw_in": done.formed.draw_in,
        "energy": done.formed.energy,
        "left": done.released.energy,
        "factorisations": done.formed.factorisations,
        "in_release": done.released.factorisations,
        "leaves": done.released.stability.negative,
        "seconds": seconds,
        "notes": [*done.formed.notes, *done.released.notes],
        **flow(case, done),
        **middle_wire(case, done, tool),
        **out_of_the_tool(case, done, tool),
    }


def apart(whole: Whole) -> float:
    """How much further apart than flat neighbouring crossings are at most, relative to the step."""
    now, flat = (np.linalg.norm(at[whole.end] - at[whole.start], axis=1) for at in (whole.positions, whole.flat))
    return float((now / flat).max() - 1)


def out_of_the_tool(case: Case, done: Run, tool: Surface) -> Figures:
    """The same grid with nothing held, laid back onto its target as well as it goes: shift and tilts, one shape.

    The focal length is that of the best fit that may change it: infinite, or nearly, for a flat grid.
    """
    elements = prepare(case).elements
    try:
        free = release(done.formed, elements, ReleaseCase(), case.framed(case.press), crossing=case.grid.crossing)
    except NoEquilibrium as error:
        return {"free_failure": str(error)}
    found = accuracy(case, free, tool)
    judged = free.whole.positions[found.mask], found.weights[found.mask], found.target
    return {
        "free_rms": best_fit(*judged, ALIGNMENTS["3-parameter"], "normal").rms,
        "free_focal": found.fitted.fit.pose.f,
        "free_leaves": free.stability.negative,
    }


def accuracy(case: Case, stage: Shaped, tool: Any) -> Accuracy:
    """How near a stage of the case is to its target."""
    assert case.target is not None
    return measure_case(stage.whole.positions, stage.whole.cells, case.target, apex_height=tool.height_at_axis)


def flow(case: Case, done: Run) -> Figures:
    """The plastic strain of the wire pieces that lie within the rim when formed."""
    whole = done.formed.whole
    radii = np.linalg.norm(whole.positions[:, :2], axis=1)
    inside = np.maximum(radii[whole.start], radii[whole.end]) <= case.tool.rim_radius
    nearer = np.minimum(radii[whole.start], radii[whole.end])
    middle, stiff = nearer < TINY, inside & (whole.plastic_strain == 0)
    strains = whole.plastic_strain[inside]
    return {
        "plastic_mean": float(strains.mean()),
        "plastic_middle": float(whole.plastic_strain[middle].mean()),
        "yielded": float((strains > 0).mean()),
        "stiff_from": float(nearer[stiff].min()) if stiff.any() else case.tool.rim_radius,
        "plastic_within": float(strains[nearer[inside] <= JUDGED].min()),
    }


def middle_wire(case: Case, done: Run, tool: Surface) -> Figures:
    """The wire through the axis: its length over that when flat within the rim, the elastic part of it, curvature."""
    assert done.released is not None
    rim = case.tool.rim_radius
    wire = prepare(case).elements[0]
    assert wire.section is not None
    formed, released = done.formed.whole, done.released.whole
    on_it = (formed.family == 1) & (formed.index[formed.start, 1] == 0)
    far = np.linalg.norm(formed.flat, axis=1)
    on_it &= np.maximum(far[formed.start], far[formed.end]) <= rim * (1 + 1e-9)
    known: Figures = {
        "arc": arc(tool, rim),
        "elastic": float((formed.F[on_it, 0] / (wire.section.EA / formed.stretch[on_it])).mean()),
        "slope": 0.0,
    }
    for name, whole in (("formed", formed), ("released", released)):
        between = whole.positions[whole.end[on_it]] - whole.positions[whole.start[on_it]]
        known[f"length_{name}"] = float(np.linalg.norm(between, axis=1).sum() / (on_it.sum() * wire.length))
        known[f"curvature_{name}"] = curvature(whole, MIDDLE * rim)
    if wire.hardening is not None:
        strain = float(formed.plastic_strain[on_it].mean())
        rise = float(wire.hardening.flow(strain + 1e-4) - wire.hardening.flow(strain)) / 1e-4
        known["slope"] = rise / (rise + wire.section.youngs_modulus)
    return known


def arc(tool: Surface, rim: float) -> float:
    """Length of the profile of the punch over the radius of its rim."""
    x = np.linspace(0.0, rim, 20_001)
    z = tool.height(np.column_stack((x, np.zeros_like(x))))
    return float(np.hypot(np.diff(x), np.diff(z)).sum() / rim)


def curvature(whole: Whole, reach: float) -> float:
    """Of the wire through the axis around it, by the parabola of least squares [1/mm]."""
    at = (whole.index[:, 1] == 0) & (np.abs(whole.positions[:, 0]) <= reach)
    x, z = whole.positions[at, 0], whole.positions[at, 2]
    return float(-2 * np.polyfit(x, z, 2)[0])


# --- tables ---------------------------------------------------------------------------------------------------

Column = tuple[str, Callable[[Figures], str]]


def number(name: str, digits: int, factor: float = 1.0, *, sign: bool = False) -> Callable[[Figures], str]:
    """A figure with so many decimals."""
    form = f"{{:{'+' if sign else ''}.{digits}f}}"
    return lambda known: form.format(factor * known[name]).replace("-", "−")


def lobe(m: int) -> Callable[[Figures], str]:
    """The rms of the part of the released deviation with m lobes [mm]."""
    # Files of figures name them by words.
    return lambda known: f"{known['lobes'][str(m)]:.3f}"


def free(name: str, digits: int, *, sign: bool = False) -> Callable[[Figures], str]:
    """A figure of the grid that nothing holds, or that it finds no rest."""
    shown = number(name, digits, sign=sign)
    return lambda known: "no rest" if "free_failure" in known else shown(known)


def fitted(known: Figures) -> str:
    """The rms after the best fit; any flat grid would fit a paraboloid without curvature."""
    return "flat" if known["curvature_released"] < 1 / FLAT**2 else number("fitted", 3)(known)


def focal(known: Figures) -> str:
    """The focal length of the grid that nothing holds."""
    return "flat" if known.get("free_focal", 0.0) > FLAT else free("free_focal", 1)(known)


def released_to(known: Figures) -> str:
    """The rms in the tool and after the release."""
    return f"{known['formed_rms']:.3f} → {known['rms']:.3f}"


PER_CENT = 100.0
FORMED: tuple[Column, ...] = (
    ("rms in the tool → released, mm", released_to),
    ("after best fit, mm", fitted),
    ("middle moves, mm", number("apex", 2, sign=True)),
    ("lowest sinks, mm", number("sag", 2)),
    ("m = 0, mm", lobe(0)),
    ("m = 2, mm", lobe(2)),
    ("m = 4, mm", lobe(4)),
    ("ways of leaving the symmetry", number("leaves", 0)),
    ("nothing held: rms, mm", free("free_rms", 2)),
    ("its focal length, mm", focal),
    ("factorisations, press", number("factorisations", 0)),
    ("release", number("in_release", 0)),
)
FLOW: tuple[Column, ...] = (
    ("draw-in, mm", number("draw_in", 2)),
    ("crossings apart by up to, %", number("elongation", 2, PER_CENT)),
    ("largest pull, N", number("pull", 0)),
    ("plastic strain within the rim, mean, %", number("plastic_mean", 2, PER_CENT)),
    ("at the middle, %", number("plastic_middle", 2, PER_CENT)),
    ("least in the aperture, %", number("plastic_within", 2, PER_CENT)),
    ("wire pieces within the rim that yielded, %", number("yielded", 1, PER_CENT)),
    ("all of them within a radius of, mm", number("stiff_from", 0)),
    ("elastic energy in the tool, J", number("energy", 2, 1e-3)),
    ("released, J", number("left", 3, 1e-3)),
)
LENGTHS: tuple[Column, ...] = (
    ("profile of the punch over its radius", number("arc", 4)),
    ("middle wire, formed", number("length_formed", 4)),
    ("released", number("length_released", 4)),
    ("lost in the release, %", lambda k: f"{100 * (1 - k['length_released'] / k['length_formed']):.3f}"),
    ("elastic strain of its pull, %", number("elastic", 3, PER_CENT)),
    ("slope of the tensile curve over E, %", number("slope", 2, PER_CENT)),
    ("curvature in the middle, formed, 1/m", number("curvature_formed", 4, 1e3)),
    ("released, 1/m", number("curvature_released", 4, 1e3)),
    ("lost, %", lambda k: f"{100 * (1 - k['curvature_released'] / k['curvature_formed']):.2f}".replace("-", "−")),
)
TOLD: tuple[Column, ...] = (
    ("released rms, mm", number("rms", 4)),
    ("after best fit, mm", number("fitted", 4)),
    ("m = 4, mm", lobe(4)),
    ("middle moves, mm", number("apex", 4, sign=True)),
    ("lowest sinks, mm", number("sag", 4)),
    ("nothing held: rms, mm", free("free_rms", 3)),
    ("its focal length, mm", focal),
    ("elastic energy in the tool, mJ", number("energy", 1)),
    ("crossings apart by up to, %", number("elongation", 3, PER_CENT)),
    ("plastic strain, mean, %", number("plastic_mean", 3, PER_CENT)),
    ("largest pull, N", number("pull", 1)),
    ("factorisations, press", number("factorisations", 0)),
)


def table(first: str, rows: Iterable[tuple[str, Figures | None]], columns: tuple[Column, ...]) -> str:
    """A table in Markdown; a row without figures is empty, one of a failure says it."""
    heads = (first, *(head for head, _ in columns))
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for name, known in rows:
        if known is None or "failure" in known:
            cells = ["" if known is None else known["failure"], *[""] * (len(columns) - 1)]
        else:
            cells = [cell(known) for _, cell in columns]
        lines.append(f"| {' | '.join((name, *cells))} |")
    return "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores)"])


def tables(found: Callable[[str], Figures | None]) -> dict[str, str]:
    """All tables by their names."""
    straight = "yields, clamped, straight, pinned"
    strokes = [
        ("woven, 6", "6 strokes"),
        ("woven, 12", CLAMPED),
        ("woven, 24", "24 strokes"),
        ("woven, 48", "48 strokes"),
        ("straight, 12", straight),
        ("straight, 48", "straight, 48 strokes"),
    ]
    sections = [
        ("clamped, resultants", CLAMPED),
        ("clamped, fibres", "fibres, clamped"),
    ]
    forming = [(one.name, found(one.name)) for one in FORMING]
    lengths = [(name, known) for name, known in forming if "clamped" in name]
    return {
        "forming": table("wires and rim", forming, FORMED),
        "flow": table("wires and rim", forming, FLOW),
        "lengths": table("wires and rim", lengths, LENGTHS),
        "strokes": table("wires, strokes", ((name, found(of)) for name, of in strokes), TOLD),
        "sections": table("rim, section", ((name, found(of)) for name, of in sections), TOLD),
    }


def kept(folder: Path, name: str) -> Figures | None:
    """The figures of a run that was made."""
    file = folder / f"{name.replace(', ', '_').replace(' ', '_')}.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else None


def keep(folder: Path, name: str, known: Figures) -> None:
    """Leave the figures of a run."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name.replace(', ', '_').replace(' ', '_')}.json"
    file.write_text(json.dumps(known, indent=1), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="*", help="parts of the names of the runs to make; none for the tables alone")
    parser.add_argument("--kept", type=Path, default=Path("build/stretch_forming"), help="folder of the figures")
    parser.add_argument("--write", type=Path, help="the page that holds the tables")
    chosen = parser.parse_args()
    for variant in (*FORMING, *STROKES, *SECTIONS):
        wanted = chosen.only is None or any(part in variant.name for part in chosen.only)
        if wanted and kept(chosen.kept, variant.name) is None:
            keep(chosen.kept, variant.name, figures(variant))
            print(f"{variant.name}: made", flush=True)
    for name, text in tables(lambda name: kept(chosen.kept, name)).items():
        print(f"{text}\n")
        if chosen.write:
            put_between(chosen.write, name, text)


if __name__ == "__main__":
    main()
