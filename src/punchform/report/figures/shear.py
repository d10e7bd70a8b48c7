"""Plan of the formed grid with the shear angle of every cell."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.report.figures.style import (
    HALF,
    INK,
    PLAN_BAR,
    SEQUENTIAL,
    TEXT,
    colour_bar,
    from_zero,
    in_colour,
    new_figure,
    plan_axes,
)

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole


def draw_shear(run: Run, *, reach: float | None = None) -> Figure:
    """Cells coloured by the size of their shear angle, from zero to the largest or `reach` [deg]; the most sheared cell
    is ringed."""
    whole = run.formed.whole
    corners = whole.positions[whole.cells][:, :, :2]
    shear = np.degrees(np.abs(whole.cell_shear))
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    scale = from_zero(shear, reach)
    axes.add_collection(in_colour(corners, shear, scale, SEQUENTIAL, width=0.3))
    most = most_sheared(whole)
    spot = corners[most].mean(axis=0)
    axes.plot(*spot, "o", markersize=9, markerfacecolor="none", markeredgecolor="white", markeredgewidth=1.2)
    axes.annotate(
        f"{shear[most]:.2f}°", spot, xytext=(-44, -14), textcoords="offset points", fontsize=TEXT, color=INK,
        bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
    )  # fmt: skip
    colour_bar(figure, PLAN_BAR, scale, SEQUENTIAL, "shear angle |γ| [°]")
    return figure


def most_sheared(whole: Whole) -> int:
    """The number of the most sheared cell; of mirror images to rounding the one farthest along x = y."""
    shear = np.abs(whole.cell_shear)
    ties = np.flatnonzero(shear >= shear.max() * (1 - 1e-6))
    return int(ties[np.argmax(whole.positions[whole.cells[ties]][:, :, :2].sum(axis=(1, 2)))])
