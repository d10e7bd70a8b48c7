"""What to conclude from each figure of a run, in a sentence with its numbers: the beginning of its caption."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy import Accuracy, Aligned
from punchform.export.result import largest
from punchform.report.accuracy_words import makeup, part
from punchform.report.figures.deviation import DIRECTIONS
from punchform.report.figures.plastic import middle_wire
from punchform.report.figures.sections import near_section
from punchform.report.words import drawn_in, percent, place, radii, size, where_sheared

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole

TOLD_PARTS = 3
LEAST = 0.01
"""A part of less than this share of the mean square is not told."""


def found(name: str, run: Run) -> str:
    """What the figure of this name comes to in this run; nothing where there is no number to tell."""
    return FOUND[name](run) if name in FOUND else ""


def _shape(run: Run) -> str:
    z = run.formed.whole.positions[:, 2]
    return f"The shell stands {size(float(np.nanmax(z)), 'mm', 3)} high over the plane of the rim."


def _shear(run: Run) -> str:
    shear = np.degrees(np.abs(run.formed.whole.cell_shear))
    known = shear[np.isfinite(shear)]
    return (
        f"The cells shear by up to {where_sheared(run.formed.whole)}; half of them stay below "
        f"{size(float(np.median(known)), '°', 3)}."
    )


def _contact(run: Run) -> str:
    force = run.formed.whole.contact
    held = float(force.min())
    down = f"; where it is blue up to {size(-held, 'N', 3)} must hold one down" if held < 0 else ""
    return f"The punch pushes a crossing with up to {size(float(force.max()), 'N', 3)}{down}."


def _axial(run: Run, family: int, released: bool) -> str:
    whole = _stage(run, released)
    force = whole.F[whole.family == family, 0]
    pull, press = max(float(force.max()), 0.0), max(-float(force.min()), 0.0)
    return (
        f"Pulled by up to {size(pull, 'N', 3)}, pressed by up to {size(press, 'N', 3)}; "
        f"{percent(float(np.mean(force < 0)))} of the pieces are pressed."
    )


def _stress(run: Run, released: bool) -> str:
    whole = _stage(run, released)
    worst = int(np.nanargmax(whole.stress))
    where = place(float(radii(whole.positions[[whole.start[worst]]])[0]))
    most = f"The largest stress is {size(float(whole.stress[worst]), 'MPa', 3)}, {where} from the axis"
    ratio = largest(whole.stress_ratio)
    if ratio is None:
        return f"{most}."
    over = float(np.mean(whole.stress_ratio > 1))
    return f"{most}: {size(ratio, '', 3)} times the yield strength, which {percent(over)} of the pieces pass."


def _sections(run: Run) -> str:
    return drawn_in(run.formed.draw_in)


def _progress(run: Run) -> str:
    first, last = run.formed.history[0], run.formed.history[-1]
    return (
        f"In {last.number - first.number} steps the largest entry of the gradient went from {first.gradient:.2g} to "
        f"{last.gradient:.2g}."
    ).replace("-", "−")


def _deviation(run: Run, *, judged: bool) -> str:
    accuracy, aligned = _aligned(run, judged)
    told = aligned.statistics[accuracy.judge.measure]
    spread = f"{size(told.rms, 'mm', 3)} rms, from {size(told.lowest, 'mm', 3)} to {size(told.highest, 'mm', 3)}"
    green = _share_within(accuracy, aligned)
    return (
        f"{spread}." if green is None else f"{spread}; {percent(green)} of the weighted area is within the tolerance."
    )


def _spread(run: Run) -> str:
    accuracy, aligned = _aligned(run, judged=True)
    told = aligned.statistics[accuracy.judge.measure]
    return (
        f"Mean {size(told.mean, 'mm', 3)}, rms about it {size(told.sigma, 'mm', 3)}; 95 % of the area lies within "
        f"±{size(told.p95, 'mm', 3)}."
    )


def _profiles(run: Run) -> str:
    accuracy, aligned = _aligned(run, judged=True)
    whole, values = run.final.whole, aligned.deviations.of(accuracy.judge.measure)
    reach = 0.5 * min(run.case.grid.step)
    on_line = {at: accuracy.mask & near_section(whole.flat, at, reach) for at in DIRECTIONS}
    rms = [
        f"{size(float(np.sqrt(np.mean(values[on] ** 2))), 'mm', 3)} along {at}°"
        for at, on in on_line.items()
        if on.any()
    ]
    return f"Rms {', '.join(rms)}." if rms else ""


def _lobes(run: Run) -> str:
    _, aligned = _aligned(run, judged=True)
    told = [f"{percent(share)} {part(name)}" for name, share in makeup(aligned)[:TOLD_PARTS] if share >= LEAST]
    return f"Of the mean square, {', '.join(told)}." if told else ""


def _sag(run: Run) -> str:
    released = run.released
    assert released is not None
    up = released.moved[: released.whole.crossings, 2]
    return (
        f"The crossings move by {size(float(np.sqrt(np.mean(up**2))), 'mm', 3)} rms up or down, from "
        f"{size(float(up.min()), 'mm', 3)} to {size(float(up.max()), 'mm', 3)}; the middle by "
        f"{size(released.apex, 'mm', 3)}."
    )


def _before_after(run: Run) -> str:
    assert run.released is not None
    moved = np.linalg.norm(run.released.moved, axis=1)
    return f"The crossing that moves most goes {size(float(moved.max()), 'mm', 3)}."


def _deflection(run: Run) -> str:
    assert run.loaded is not None
    return (
        f"{size(run.loaded.load, 'N', 3)} move the crossings by {size(run.loaded.rms_deflection, 'mm', 3)} rms along "
        f"their normals and by up to {size(run.loaded.largest_deflection, 'mm', 3)}."
    )


def _elongation(run: Run) -> str:
    strain = run.formed.whole.axial_strain
    most, middle = float(strain.max()), float(np.median(strain))
    return f"Wire pieces are up to {percent(most)} longer, half of them by less than {percent(middle)}."


def _plastic(run: Run) -> str:
    formed = run.formed
    return (
        f"{percent(formed.yielded)} of the wire pieces have yielded, by a plastic strain of up to "
        f"{percent(formed.max_plastic_strain)}."
    )


def _middle(run: Run) -> str:
    whole = run.formed.whole
    wires = {name: middle_wire(whole, family) for family, name in ((1, "x"), (2, "y"))}
    told = [
        f"along {name} up to {percent(float(whole.axial_strain[wire].max()))}, of which "
        f"{percent(float((whole.stretch[wire] - 1.0).max()))} stays"
        for name, wire in wires.items()
    ]
    return f"The middle wires are longer: {'; '.join(told)}."


def _stage(run: Run, released: bool) -> Whole:
    if not released:
        return run.formed.whole
    assert run.released is not None
    return run.released.whole


def _aligned(run: Run, judged: bool) -> tuple[Accuracy, Aligned]:
    """The accuracy and the judged alignment, or the other of the two that are drawn."""
    accuracy = run.accuracy
    assert accuracy is not None
    one = accuracy.aligned
    return accuracy, one if judged else accuracy.fitted if one is accuracy.as_held else accuracy.as_held


def _share_within(accuracy: Accuracy, aligned: Aligned) -> float | None:
    """Which part of the weighted area lies within the tolerance; None without one."""
    limit, mask = accuracy.judge.tolerance, accuracy.mask
    if limit is None:
        return None
    inside = np.abs(aligned.deviations.of(accuracy.judge.measure)[mask]) <= limit
    weights = accuracy.weights[mask]
    return min(float(weights @ inside) / math.fsum(weights), 1.0)


FOUND: dict[str, Callable[[Run], str]] = {
    "shape": _shape,
    "shear": _shear,
    "contact": _contact,
    "axial_x": partial(_axial, family=1, released=False),
    "axial_y": partial(_axial, family=2, released=False),
    "axial_x_released": partial(_axial, family=1, released=True),
    "axial_y_released": partial(_axial, family=2, released=True),
    "stress": partial(_stress, released=False),
    "stress_released": partial(_stress, released=True),
    "sections": _sections,
    "progress": _progress,
    "deviation": partial(_deviation, judged=True),
    "deviation_other": partial(_deviation, judged=False),
    "deviation_histogram": _spread,
    "deviation_sections": _profiles,
    "lobes": _lobes,
    "sag": _sag,
    "before_after": _before_after,
    "deflection": _deflection,
    "elongation": _elongation,
    "plastic_strain": _plastic,
    "elongation_middle": _middle,
}
"""The conclusion of each figure, by its name in the gallery."""
