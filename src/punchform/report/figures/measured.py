"""Figures of a comparison: map of the deviations, histogram, and the labelled points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgb
from matplotlib.figure import Figure

from punchform.arrays import Floats
from punchform.report.figures.style import (
    DIVERGING,
    HALF,
    INK,
    PALE,
    PAPER,
    PLAN_BAR,
    SOFT,
    TEXT,
    dress,
    new_figure,
    plan_axes,
    points_per_mm,
)

if TYPE_CHECKING:
    from punchform.measured import Comparison
    from punchform.measured.comparison import Deviation

GOOD = "#b9d8b0"
CLIPPED = 0.98
"""The share of the points that the colours reach to; the rest take the last colour."""
SHADES, PALEST = 256, 0.25
MANY = 2000
"""More dots than this are one picture inside an SVG."""


def draw_deviation_map(done: Comparison) -> Figure:
    """Every point that counts, coloured by its judged deviation; in tolerance green, strays ringed, others pale."""
    return _map(done, done.judged, done.tolerance)


def draw_prediction_map(done: Comparison) -> Figure:
    """The same against the predicted shape, on a scale of its own: what the prediction did not know."""
    return _map(done, done.prediction, None)


def _map(done: Comparison, deviation: Deviation, tolerance: float | None) -> Figure:
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=done.aligned, rim=done.case.rim_radius)
    axes.set_facecolor(PAPER)
    shown = deviation.inside
    size = _dot(axes, done.aligned)
    axes.scatter(
        done.aligned[~shown, 0],
        done.aligned[~shown, 1],
        s=size,
        c=PALE,
        linewidths=0,
        zorder=2,
        rasterized=len(done.aligned) > MANY,
    )
    scale, colours = deviation_colours(deviation.value[shown], tolerance)
    # The largest deviations are drawn last, so that they are not hidden.
    order = np.flatnonzero(shown)[np.argsort(np.abs(deviation.value[shown]), kind="stable")]
    axes.scatter(
        done.aligned[order, 0],
        done.aligned[order, 1],
        s=size,
        c=deviation.value[order],
        cmap=colours,
        norm=scale,
        linewidths=0,
        zorder=3,
        rasterized=len(done.aligned) > MANY,
    )
    strays = shown & done.outliers
    axes.scatter(
        done.aligned[strays, 0],
        done.aligned[strays, 1],
        s=4 * size + 20,
        facecolors="none",
        edgecolors=INK,
        linewidths=0.9,
        zorder=4,
    )
    _bar(figure, scale, colours, tolerance)
    return figure


def draw_histogram(done: Comparison) -> Figure:
    """Shares of the points by their deviation, with the tolerance as lines and the average."""
    values = done.judged.value[done.judged.inside & done.counted]
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.135, 0.135, 0.835, 0.8))
    reach = reach_of(values, done.tolerance)
    bins = np.linspace(-reach, reach, 2 * int(np.clip(np.sqrt(len(values)), 8, 30)) + 2)
    clipped = np.clip(values, -reach, reach)
    count, edges = np.histogram(clipped, bins)
    scale, colours = deviation_colours(values, done.tolerance)
    middles = 0.5 * (edges[:-1] + edges[1:])
    axes.bar(
        middles, 100 * count / len(values), width=np.diff(edges), color=colours(scale(middles)), edgecolor=SOFT, lw=0.4
    )
    for limit in () if done.tolerance is None else (-done.tolerance, done.tolerance):
        axes.axvline(limit, color=INK, linewidth=1.0, linestyle="--")
    axes.axvline(float(values.mean()), color=INK, linewidth=1.2)
    axes.annotate(
        "average", (float(values.mean()), 1.0), xycoords=("data", "axes fraction"), xytext=(4, -10),
        textcoords="offset points", fontsize=TEXT - 1, color=INK,
    )  # fmt: skip
    over = int((np.abs(values) > reach).sum())
    beyond = f"   ({over} points beyond the ends are in the last bars)" if over else ""
    dress(axes, x=f"deviation [mm]{beyond}", y="share of the points [%]")
    axes.set_xlim(-reach, reach)
    return figure


def draw_call_outs(done: Comparison) -> Figure:
    """The labelled points with their deviations, in two columns beside the plan so that no labels overlap."""
    figure = new_figure(6.8, 4.0)
    axes = plan_axes(figure, points=done.aligned, rim=done.case.rim_radius)
    axes.set_position((0.285, 0.12, 0.44, 0.84))
    axes.set_ylabel("")
    axes.scatter(
        done.aligned[done.judged.inside, 0],
        done.aligned[done.judged.inside, 1],
        s=_dot(axes, done.aligned),
        c=PALE,
        linewidths=0,
        zorder=2,
        rasterized=len(done.aligned) > MANY,
    )
    rows = done.labelled
    place = done.aligned[rows, :2]
    scale, colours = deviation_colours(done.judged.value[done.judged.inside], done.tolerance)
    axes.scatter(
        place[:, 0],
        place[:, 1],
        s=34,
        c=done.judged.value[rows],
        cmap=colours,
        norm=scale,
        edgecolors=INK,
        linewidths=0.7,
        zorder=5,
    )
    for side in (-1, 1):
        # Half of the labels on either side, whatever the points' places, from top to bottom as the points lie.
        by_x = np.argsort(place[:, 0], kind="stable")
        half = by_x[: len(by_x) // 2] if side < 0 else by_x[len(by_x) // 2 :]
        half = half[np.argsort(-place[half, 1], kind="stable")]
        levels = np.linspace(0.95, 0.05, max(len(half), 2))
        for level, k in zip(levels, half, strict=False):
            name, value = done.cloud.names[rows[k]], done.judged.value[rows[k]]
            text = f"{name[:12]}  {value:+.3g} mm".replace("-", "−")
            axes.annotate(
                text, place[k], xytext=(-0.16 if side < 0 else 1.04, level), textcoords="axes fraction",
                fontsize=TEXT - 1, color=INK, ha="right" if side < 0 else "left", va="center",
                arrowprops={"arrowstyle": "-", "color": SOFT, "lw": 0.5, "shrinkB": 3}, zorder=4,
            )  # fmt: skip
    return figure


def deviation_colours(
    values: Floats, tolerance: float | None, reach: float | None = None
) -> tuple[Normalize, LinearSegmentedColormap]:
    """A scale symmetric about zero and its colours: blue below, red above, green within the tolerance.

    reach: where it ends [mm], when figures have it in common.
    """
    reach = reach or reach_of(values, tolerance)
    centres = (np.arange(SHADES) + 0.5) / SHADES * 2 - 1
    band = 0.0 if tolerance is None else tolerance / reach
    # Just outside the tolerance a point is pale, but not so pale that it is lost on the paper.
    strength = PALEST + (1 - PALEST) * np.clip((np.abs(centres) - band) / (1 - band), 0, 1) if band else np.abs(centres)
    shades = np.array(colormaps[DIVERGING](0.5 + 0.5 * np.sign(centres) * strength))[:, :3]
    shades[np.abs(centres) <= band] = to_rgb(GOOD)
    return Normalize(-reach, reach), LinearSegmentedColormap.from_list("deviation", list(shades), N=SHADES)


def reach_of(values: Floats, tolerance: float | None) -> float:
    """Where the colours end [mm]: most points, and never so near that the tolerance fills all of it."""
    most = float(np.quantile(np.abs(values), CLIPPED)) if values.size else 0.0
    return max(most, 0.0 if tolerance is None else 1.5 * tolerance) or 1.0


def _dot(axes: Axes, points: Floats) -> float:
    """Area of a dot in square points, so that the dots of an even cloud nearly touch."""
    apart = float(np.sqrt(np.prod(np.ptp(points[:, :2], axis=0)) / len(points))) * points_per_mm(axes)
    return float(np.clip(0.6 * apart, 1.2, 6.0)) ** 2


def _bar(figure: Figure, scale: Normalize, colours: LinearSegmentedColormap, tolerance: float | None) -> None:
    axes = figure.add_axes(PLAN_BAR)
    bar = figure.colorbar(ScalarMappable(scale, colours), cax=axes, extend="both")
    bar.outline.set_linewidth(0.4)
    dress(axes, y="along the normal [mm]")
    reach = float(scale.vmax or 1.0)
    ticks = [-reach, -0.5 * reach, 0.5 * reach, reach]
    # Ticks nearer than a line of text would be printed over each other.
    if tolerance is None or tolerance < 0.07 * reach:
        ticks += [0.0]
    else:
        ticks = [tick for tick in ticks if abs(abs(tick) - tolerance) > 0.07 * reach] + [-tolerance, 0.0, tolerance]
    # Two digits below a millimetre: a longer number would push the label off the picture.
    digits = 3 if reach >= 1 else 2
    names = [f"{tick:+.{digits}g}".replace("-", "−") if tick else "0" for tick in sorted(ticks)]
    axes.set_yticks(sorted(ticks), names)
    axes.minorticks_off()
