"""Figures of how nodes move: by the release, by a load, and along the mode of a saddle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.arrays import Floats
from punchform.report.figures.style import (
    DIVERGING,
    HALF,
    INK,
    PAPER,
    PLAN_BAR,
    TEXT,
    colour_bar,
    even_about_zero,
    in_colour,
    new_figure,
    plan_axes,
    squares,
)
from punchform.report.quantities import DEFLECTION, RISE, with_unit
from punchform.report.words import size

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole

ARROWS_ACROSS = 24


def draw_sag(run: Run, *, reach: float | None = None) -> Figure:
    """Every crossing as a square coloured by how far the release moved it up or down, to `reach` [mm]; the lowest is
    ringed."""
    released = run.released
    assert released is not None
    figure = _plan(run, released.whole, released.moved[:, 2], f"{with_unit(RISE, 'mm')}   (+ up)", reach)
    if released.max_sag < 0:
        x, y, _ = released.whole.positions[released.lowest]
        axes = figure.axes[0]
        axes.plot(
            x, y, "o", markersize=9, markerfacecolor="none", markeredgecolor="white", markeredgewidth=1.2, zorder=4
        )
        axes.annotate(
            size(released.max_sag, "mm", 3), (float(x), float(y)), xytext=(-50, -16), textcoords="offset points",
            fontsize=TEXT, color=INK, zorder=5,
            bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        )  # fmt: skip
    return figure


def draw_deflection(run: Run) -> Figure:
    """Every crossing as a square coloured by how far the load moved it along its normal."""
    released, loaded = run.released, run.loaded
    assert released is not None
    assert loaded is not None
    along_normal = np.sum(loaded.moved * released.whole.normals, axis=1)
    return _plan(run, loaded.whole, along_normal, f"{with_unit(DEFLECTION, 'mm')}   (+ outwards)")


def draw_mode(run: Run) -> Figure:
    """The lowest mode: colour is its vertical part, arrows what it moves sideways."""
    released = run.released
    assert released is not None
    mode = released.stability.mode
    assert mode is not None
    places = released.whole.positions
    label = "vertical part of the mode, of largest length 1 [mm/mm]"
    figure = _plan(run, released.whole, mode[:, 2], label)
    axes = figure.axes[0]
    across = int(np.ptp(released.whole.index, axis=0).max()) + 1
    every = -(-across // ARROWS_ACROSS)
    some = np.flatnonzero((released.whole.index[: released.whole.crossings] % every == 0).all(axis=1))
    low, high = axes.get_xlim()
    longest = float(np.hypot(mode[some, 0], mode[some, 1]).max(initial=0.0)) or 1.0
    axes.quiver(
        places[some, 0], places[some, 1], mode[some, 0], mode[some, 1], color=INK, width=0.003, zorder=4,
        angles="xy", scale_units="xy", scale=longest / (1.6 * (high - low) / ARROWS_ACROSS),
    )  # fmt: skip
    return figure


def _plan(run: Run, whole: Whole, values: Floats, label: str, reach: float | None = None) -> Figure:
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    axes.set_facecolor(PAPER)
    scale = even_about_zero(values, reach)
    shown = slice(whole.crossings)
    places = squares(whole.positions[shown], run.case.grid.step)
    axes.add_collection(in_colour(places, values[shown], scale, DIVERGING, width=0.0))
    colour_bar(figure, PLAN_BAR, scale, DIVERGING, label)
    return figure
