"""What the error of a dish costs in gain, and where its mesh leaks: a table of the report. No HTML here."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from punchform.accuracy import Accuracy
from punchform.antenna import SPEED_OF_LIGHT, highest_frequency, leak, leaks_above, loss
from punchform.report.section import Matrix
from punchform.report.words import size

if TYPE_CHECKING:
    from punchform.case import Case

BANDS = ((1.5, "L"), (4.0, "C"), (8.0, "X"), (12.0, "Ku"), (20.0, "K"), (30.0, "Ka"))
"""Frequencies [GHz] at which the loss is told, and their bands."""
LOSSES = (0.5, 1.0)
"""Losses [dB] for which the highest frequency is told."""
FAR = 3.0
"""Beyond this loss [dB] the formula says no more than that it is large."""
COARSE = 0.4
"""With the wires farther apart than this part of a wavelength the formula of the mesh is not told."""
THIN = 0.2
"""Nor with wires thicker than this part of the step."""
NOTHING = "–"


def gain_matrix(case: Case, accuracy: Accuracy) -> Matrix:
    """Loss of gain by the half-path σ, Eq. (9.19), beside what the mesh lets through, Eq. (9.21)."""
    shown = (accuracy.as_held, accuracy.fitted)
    errors = [aligned.statistics["half-path"].sigma for aligned in shown]
    step, limit = max(case.grid.step), leaks_above(max(case.grid.step))
    rows = [("half-path σ", *(size(error, "mm") for error in errors), "")]
    rows += [
        (
            f"{f:g} GHz ({band}){', mesh leaks' if f > limit else ''}",
            *(_loss(error, f) for error in errors),
            _through(step, case.wire.diameter, f),
        )
        for f, band in BANDS
    ]
    rows += [(f"{dB:g} dB are lost at", *(_frequency(error, dB, limit) for error in errors), "") for dB in LOSSES]
    return Matrix(
        "Loss of gain after Ruze, by the weighted half-path σ",
        ("", *(aligned.name for aligned in shown), "through the mesh"),
        tuple(rows),
        note=f"It is judged {accuracy.aligned.name}; in the best fit the feed follows the focus. σ is how "
        "far the paths of the rays scatter about their mean, halved. The losses after Ruze are by the shape alone: "
        f"above about {size(limit, 'GHz', 2)}, where the wires are more than a tenth of a wavelength apart, the mesh "
        "itself leaks. The last column is for a perfect mesh whose wires touch. Ruze's formula is for errors without "
        "order; lobes also turn and deform the beam.",
        wide=True,
    )


def _loss(error: float, frequency: float) -> str:
    found = loss(error, SPEED_OF_LIGHT / frequency)
    return size(found, "dB", 3) if found <= FAR else f"more than {FAR:g} dB"


def _through(step: float, diameter: float, frequency: float) -> str:
    wavelength = SPEED_OF_LIGHT / frequency
    if step > COARSE * wavelength or not 0 < diameter <= THIN * step:
        return NOTHING
    return size(leak(step, diameter, wavelength), "dB", 2)


def _frequency(error: float, decibel: float, limit: float) -> str:
    found = highest_frequency(error, decibel)
    if not math.isfinite(found) or found >= 1e4:
        return "no frequency"
    return f"{size(found, 'GHz', 3)}{' (mesh leaks)' if found > limit else ''}"
