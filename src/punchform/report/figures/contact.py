"""Plan of the formed grid with the force of the tool on every node."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
    squares,
)
from punchform.report.quantities import CONTACT

if TYPE_CHECKING:
    from punchform.run import Run


def draw_contact(run: Run, *, reach: float | None = None) -> Figure:
    """Every crossing as a square coloured by its contact force, on a scale symmetric about zero, to `reach` [N]."""
    whole = run.formed.whole
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    axes.set_facecolor(PAPER)
    scale = about_zero(whole.contact, reach)
    shown = slice(whole.crossings)
    places, force = squares(whole.positions[shown], run.case.grid.step), whole.contact[shown]
    axes.add_collection(in_colour(places, force, scale, DIVERGING, width=0.0))
    force_bar(figure, scale, CONTACT.signed_legend)
    return figure
