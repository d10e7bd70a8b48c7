"""Plans of the grid with a figure of every wire piece: its largest stress, or what has flowed in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.report.figures.style import (
    HALF,
    PAPER,
    PLAN_BAR,
    SEQUENTIAL,
    colour_bar,
    from_zero,
    in_colour,
    new_figure,
    plan_axes,
    touching,
    wire_width,
)
from punchform.report.quantities import STRESS, Reading

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole


def draw_stress(run: Run, whole: Whole | None = None, *, reach: float | None = None) -> Figure:
    """Every element of both families as a line coloured by its stress, from zero.

    whole: the grid in the stage to be shown, the formed one unless given; reach: where the scale ends [MPa].
    """
    whole = whole or run.formed.whole
    return draw_pieces(run, whole, STRESS, reach)


def draw_pieces(run: Run, whole: Whole, shown: Reading, reach: float | None = None) -> Figure:
    """Every element of both families as a line coloured by a quantity of wires, from zero; without those not known."""
    values = shown.of(whole)
    known = np.isfinite(values)
    segments = whole.positions[np.column_stack((whole.start, whole.end))[known]][:, :, :2]
    scale = from_zero(values[known], reach)
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    axes.set_facecolor(PAPER)
    apart = min(run.case.grid.step)
    dense = touching(axes, apart)
    # Shades are drawn in their order: where wires of a dense grid cover each other the larger value is on top.
    width = wire_width(axes, apart) * (1.0 if dense else 0.6)
    drawn = in_colour(segments, values[known], scale, SEQUENTIAL, width=width)
    drawn.set_antialiased(not dense)
    axes.add_collection(drawn)
    colour_bar(figure, PLAN_BAR, scale, SEQUENTIAL, shown.legend)
    return figure
