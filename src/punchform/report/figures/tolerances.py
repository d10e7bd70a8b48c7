"""How accuracy scatters: the samples against the tolerance, and what makes them scatter."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from punchform.optimise.tolerances import Tolerances
from punchform.report.figures.style import ACCENT, HALF, INK, PALE, PUNCH, SOFT, TEXT, dress, new_figure

FEWEST_BINS, MOST_BINS = 8, 40
MOST_BARS = 12


def draw_histogram(found: Tolerances) -> Figure:
    """How many samples have which rms; beyond the tolerance in another colour, the nominal case as a dashed line."""
    figure = new_figure(HALF[0], 3.7)
    axes = figure.add_axes((0.115, 0.135, 0.865, 0.775))
    bins = int(np.clip(np.sqrt(len(found.values)), FEWEST_BINS, MOST_BINS))
    low, high = float(found.values.min()), float(found.values.max())
    width = (high - low) / bins or 0.01 * high
    # The tolerance is an edge, so that every bar is on one side of it.
    first = int(np.floor((low - found.tolerance) / width))
    edges = found.tolerance + width * np.arange(first, first + bins + 2)
    heights, _ = np.histogram(found.values, edges)
    out = edges[:-1] >= found.tolerance - 0.5 * width
    shown = low - 0.5 * (high - low) < found.tolerance < high + 0.5 * (high - low)
    for mine, ink in ((~out, ACCENT), (out, PUNCH)):
        axes.bar(edges[:-1][mine], heights[mine], np.diff(edges)[mine], align="edge", color=ink, edgecolor="white",
                 linewidth=0.5)  # fmt: skip
    if shown:
        axes.axvline(found.tolerance, color=INK, linewidth=1.4, label=f"tolerance {found.tolerance:.4g} mm")
    if found.nominal is not None:
        axes.axvline(found.nominal, color=SOFT, linewidth=1.2, linestyle="--", label=f"nominal {found.nominal:.4g} mm")
    axes.set_ylim(0, 1.28 * heights.max())
    axes.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=6))
    axes.grid(axis="y", color=PALE, linewidth=0.5)
    axes.set_axisbelow(True)
    if axes.get_legend_handles_labels()[1]:
        legend = axes.legend(loc="best", fontsize=TEXT - 1, labelcolor=INK, framealpha=1.0, edgecolor="white")
        legend.set_zorder(5)
    words = f"mean {found.mean:.4g} mm, standard deviation {found.deviation:.3g} mm"
    dress(axes, x="rms deviation [mm]", y="samples", title=words)
    return figure


def draw_influences(found: Tolerances) -> Figure:
    """The share of each number in the variance of the rms, the largest on top, with the sign of its effect."""
    shown = found.influences[:MOST_BARS][::-1]
    figure = new_figure(HALF[0], 0.95 + 0.36 * len(shown))
    bottom = 0.5 / figure.get_figheight()
    axes = figure.add_axes((0.42, bottom, 0.54, 1 - bottom - 0.32 / figure.get_figheight()))
    shares = np.array([100 * one.share for one in shown])
    inks = [PUNCH if one.slope > 0 else ACCENT for one in shown]
    reach = max(1.2 * shares.max(), 10.0)
    axes.barh(np.arange(len(shown)), shares, height=0.62, color=inks)
    for row, one in enumerate(shown):
        axes.text(
            shares[row] + 0.015 * reach,
            row,
            f"{one.slope:+.2f}".replace("-", "−"),
            va="center",
            fontsize=TEXT - 1,
            color=INK,
        )
    axes.set_yticks(np.arange(len(shown)), [one.place for one in shown])
    axes.set_xlim(0, reach)
    told = 0.0 if found.explained is None else found.explained
    title = f"{100 * told:.0f} % of the variance is linear"
    dress(axes, x="share of the variance of the rms [%]", title=title)
    axes.grid(axis="x", color=PALE, linewidth=0.5)
    axes.set_axisbelow(True)
    return figure
