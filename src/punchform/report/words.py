"""The result in plain words: what a person wants to hear first. No HTML here."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats
from punchform.export.result import largest
from punchform.report.figures.shear import most_sheared

if TYPE_CHECKING:
    from punchform.press import Formed
    from punchform.run import Run
    from punchform.whole import Whole

NO_BREAK_SPACE, THIN_SPACE = chr(0xA0), chr(0x202F)
FAINT = 0.001
"""A share of the force below which it is not worth a word that the grid must be held down."""


def verdict(run: Run) -> tuple[str, ...]:
    """Sentences on how the solve ended, energy, shear, draw-in, wire forces, yield and contact."""
    return (
        _ending(run.formed),
        _shear(run.formed),
        drawn_in(run.formed.draw_in),
        *_holder(run.formed),
        _wires(run.formed),
        _yield(run),
        _contact(run.formed),
    )


def tiles(run: Run) -> tuple[tuple[str, str], ...]:
    """The figures of a run that are asked for first, each with its name."""
    formed, accuracy = run.formed, run.accuracy
    judged: tuple[tuple[str, str], ...] = ()
    if accuracy is not None:
        limit = accuracy.judge.tolerance
        judged = (
            (f"rms deviation, {accuracy.judge.alignment}", size(accuracy.judged.rms, "mm", 3)),
            ("tolerance", "none" if limit is None else size(limit, "mm", 3)),
        )
    stress = largest(formed.whole.stress)
    return (
        *judged,
        ("largest shear", size(math.degrees(formed.max_shear), "°", 3)),
        ("draw-in of the edge", size(formed.draw_in, "mm", 3)),
        *((("largest stress", size(stress, "MPa", 3)),) if stress is not None else ()),
        ("press force along the axis", size(formed.push, "N", 3)),
    )


def size(value: float, unit: str, digits: int = 4) -> str:
    """A number to so many digits with its unit, without an exponent where a person would not write one."""
    if not math.isfinite(value):
        return "not known"
    text = f"{value:.{digits - 1}e}"
    power = int(text.partition("e")[2])
    if value == 0:
        text = "0"
    elif -3 <= power < 6:
        text = f"{value:,.{max(digits - 1 - power, 0)}f}".replace(",", THIN_SPACE)
    space = "" if unit in ("", "°") else NO_BREAK_SPACE
    return f"{text}{space}{unit}".replace("-", "−")


def energy(value: float) -> str:
    """An energy [mJ] in mJ, or in J from 1 J on."""
    return size(value / 1000, "J", 5) if abs(value) >= 1000 else size(value, "mJ", 5)


def percent(share: float) -> str:
    """A share as a percentage with three digits."""
    return size(100 * share, "%", 3)


def place(value: float) -> str:
    """A coordinate or radius to the millimetre, or finer on a small part."""
    return f"{value:.{0 if abs(value) >= 10 else 1}f}{NO_BREAK_SPACE}mm".replace("-", "−")


def _ending(formed: Formed) -> str:
    steps = f"{formed.steps} step{'' if formed.steps == 1 else 's'}"
    held = f"storing {energy(formed.energy)} of elastic energy"
    if formed.outcome.name == "CONVERGED":
        return f"The solve {formed.outcome.value} in {steps}: the grid lies on the punch, {held}."
    return (
        f"The solve did not reach a minimum of the energy: {formed.outcome.value}. It ended after {steps} "
        f"{held}; take the figures below as a hint, not as the answer."
    )


def where_sheared(whole: Whole) -> str:
    """The largest shear of a grid with cells, and where it is."""
    most = most_sheared(whole)
    x, y, _ = whole.positions[whole.cells[most]].mean(axis=0)
    return (
        f"{size(math.degrees(abs(float(whole.cell_shear[most]))), '°', 3)} "
        f"(at x = {place(x)}, y = {place(y)}, {place(math.hypot(x, y))} from the axis)"
    )


def radii(points: Floats) -> Floats:
    """Distances (n,) [mm] of points (n, 3) from the axis."""
    return np.hypot(points[:, 0], points[:, 1])


def _shear(formed: Formed) -> str:
    if not len(formed.whole.cells):
        return "The grid has no closed cell, so there is no shear to report."
    return f"The cells shear by up to {where_sheared(formed.whole)}."


def drawn_in(length: float) -> str:
    """How far the edge of the blank is drawn in [mm], as a sentence."""
    if length <= 1e-6:
        return "The edge of the blank is not drawn in."
    return f"The edge of the blank is drawn in by up to {size(length, 'mm', 3)}."


def _holder(formed: Formed) -> tuple[str, ...]:
    grip = formed.grip
    if grip is None:
        return ()
    if grip.slipped == 0:
        return ("The holder holds the whole flange: nothing slips through it.",)
    return (
        f"The flange slips between the faces of the holder by up to {size(grip.largest_slip, 'mm', 3)}, at "
        f"{percent(grip.slipped)} of the crossings that lie between them at first; the wires do "
        f"{energy(grip.work)} of work against its friction.",
    )


def _wires(formed: Formed) -> str:
    force, strain = formed.whole.F[:, 0], formed.max_axial_strain
    pull, press = float(force.max()), float(force.min())
    parts = [f"pulled by up to {size(pull, 'N', 3)}"] if pull > 0 else []
    parts += [f"pressed by up to {size(-press, 'N', 3)}"] if press < 0 else []
    forces = " and ".join(parts) or "without axial force"
    if formed.hardening is not None:
        return f"The wires are {forces}, and up to {percent(strain)} longer than in the flat blank."
    return f"The wires are {forces} (largest strain by the pull {percent(strain)})."


def _yield(run: Run) -> str:
    if run.formed.hardening is not None:
        return _flowed(run.formed)
    whole = run.formed.whole
    known = np.isfinite(whole.stress)
    if not known.any():
        return "The stress in the wires is not known, because their stiffness was given as a matrix."
    worst = int(np.nanargmax(whole.stress))
    where = place(float(radii(whole.positions[whole.start])[worst]))
    most = f"The largest stress in a wire is {size(float(whole.stress[worst]), 'MPa', 3)}, {where} from the axis"
    if np.isnan(whole.stress_ratio[worst]):
        return f"{most}; whether it yields is not known without `wire.yield_strength`."
    over = int((whole.stress_ratio > 1).sum())
    ratio = percent(float(np.nanmax(whole.stress_ratio)))
    strength = float(whole.stress[worst] / whole.stress_ratio[worst])
    share = f"{ratio} of the yield strength {size(strength, 'MPa', 3)}"
    if not over:
        return f"{most}: {share}; the wires stay elastic and would spring back."
    return (
        f"{most}: {share}; {over} of {len(whole.stress)} wire segments would yield, "
        "which this elastic answer does not follow."
    )


def _flowed(formed: Formed) -> str:
    """What wires that yield have come to, and how near they are to breaking."""
    if not formed.yielded:
        return "No wire yields: the grid stays elastic and would spring back."
    said = (
        f"{percent(formed.yielded)} of the wire pieces have yielded, with a plastic strain of up to "
        f"{percent(formed.max_plastic_strain)} in a bend or along the wire; this is what keeps the shape when the "
        "punch has gone."
    )
    share = formed.strain_to_break
    if share is None:
        return f"{said} Where the wire breaks its flow curve does not say."
    if share >= 1:
        return f"{said} Stretched to {size(share, '', 3)} times the true strain at which it necks, the wire breaks."
    return f"{said} The wire is stretched to {percent(share)} of the true strain at which it necks and breaks."


def _contact(formed: Formed) -> str:
    force, radius = formed.whole.contact, radii(formed.whole.positions)
    pushed, held = float(force[force > 0].sum()), -float(force[force < 0].sum())
    press = f"The press needs {size(formed.push, 'N', 3)} along the axis"
    if held <= FAINT * pushed:
        return f"{press}; nothing has to hold the grid down."
    order = np.argsort(radius)
    share = np.cumsum(np.maximum(-force[order], 0.0)) / held
    low, high = radius[order][np.searchsorted(share, (0.05, 0.95))]
    return (
        f"{press}. In places the grid would lift off: an upper tool or the rim has to hold it down there with "
        f"{size(held, 'N', 3)} in all, square to the surface, nine tenths of it between {place(low)} and "
        f"{place(high)} from the axis."
    )
