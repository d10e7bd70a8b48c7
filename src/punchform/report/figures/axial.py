"""Plan of the grid with the axial force in the wires of one family."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.report.figures.style import (
    DIVERGING,
    HALF,
    PAPER,
    about_zero,
    force_bar,
    in_colour,
    new_figure,
    plan_axes,
    touching,
    wire_width,
)
from punchform.report.quantities import AXIAL

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole


def draw_axial(run: Run, family: int, whole: Whole | None = None) -> Figure:
    """Every element of family 1 or 2 as a line coloured by F1, on the scale of both, symmetric about zero.

    whole: the grid in the stage to be shown, the formed one unless given.
    """
    whole = whole or run.formed.whole
    mine = whole.family == family
    every = AXIAL.of(whole)
    force = every[mine]
    segments = whole.positions[np.column_stack((whole.start, whole.end))[mine]][:, :, :2]
    scale = about_zero(every)
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    axes.set_facecolor(PAPER)
    # The wires of a family lie side by side at the step of the other family.
    apart = run.case.grid.step[2 - family]
    drawn = in_colour(segments, force, scale, DIVERGING, width=wire_width(axes, apart))
    drawn.set_antialiased(not touching(axes, apart))
    axes.add_collection(drawn)
    force_bar(figure, scale, AXIAL.signed_legend)
    return figure
