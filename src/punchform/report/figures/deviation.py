"""Figures of the accuracy: map of the deviations, histogram, deviation along the radius, and lobes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from punchform.accuracy import Accuracy, Aligned
from punchform.arrays import Floats, Ints
from punchform.report.figures.measured import GOOD, deviation_colours
from punchform.report.figures.sections import along, near_section
from punchform.report.figures.style import (
    ACCENT,
    HALF,
    INK,
    PALE,
    PAPER,
    PLAN_BAR,
    PUNCH,
    SOFT,
    TEXT,
    dress,
    in_colour,
    new_figure,
    plan_axes,
    squares,
)

if TYPE_CHECKING:
    from punchform.run import Run

DIRECTIONS = (0, 45, 90, 135)
LINES = ((INK, "-"), (PUNCH, "-"), (ACCENT, "--"), (SOFT, "-."))
SEEN = 0.005
"""A part that is less than this share of the mean square gets no figure at its bar."""


def draw_deviation(run: Run, accuracy: Accuracy, aligned: Aligned, *, reach: float | None = None) -> Figure:
    """Every judged crossing as a square coloured by its deviation, in the tolerance green and outlined; others pale.

    reach: where the scale ends [mm], when figures have it in common.
    """
    whole = run.final.whole
    values = aligned.deviations.of(accuracy.judge.measure)
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    axes.set_facecolor(PAPER)
    step, crossing = run.case.grid.step, np.arange(len(whole.positions)) < whole.crossings
    mask = accuracy.mask & crossing
    others = squares(whole.positions[crossing & ~mask], step)
    axes.add_collection(in_colour(others, np.zeros(len(others)), Normalize(-1, 1), _one(PALE), width=0.0))
    scale, colours = deviation_colours(values[mask], accuracy.judge.tolerance, reach)
    axes.add_collection(in_colour(squares(whole.positions[mask], step), values[mask], scale, colours, width=0.0))
    if accuracy.judge.tolerance is not None:
        _outline(axes, whole.positions, whole.cells[mask[whole.cells].all(axis=1)], values, accuracy.judge.tolerance)
    angle = np.linspace(0, 2 * np.pi, 181)
    for radius in (accuracy.aperture.inner_radius, accuracy.aperture.radius):
        axes.plot(radius * np.cos(angle), radius * np.sin(angle), color=INK, linewidth=0.6, zorder=3)
    _bar(figure, scale, colours, accuracy)
    return figure


def draw_spread(accuracy: Accuracy, aligned: Aligned) -> Figure:
    """Share of the weighted area by its deviation, with the tolerance as lines and the mean."""
    judge, mask = accuracy.judge, accuracy.mask
    values, weights = aligned.deviations.of(judge.measure)[mask], accuracy.weights[mask]
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.135, 0.135, 0.835, 0.8))
    band = 1.5 * (judge.tolerance or 0.0)
    low, high = min(float(values.min()), -band), max(float(values.max()), band)
    margin = 0.02 * (high - low) or 1.0
    bins = np.linspace(low - margin, high + margin, 2 * int(np.clip(np.sqrt(len(values)), 8, 25)) + 2)
    share, edges = np.histogram(values, bins, weights=100 * weights / weights.sum())
    scale, colours = deviation_colours(values, judge.tolerance)
    middles = 0.5 * (edges[:-1] + edges[1:])
    axes.bar(middles, share, width=np.diff(edges), color=colours(scale(middles)), edgecolor=SOFT, lw=0.4)
    for limit in () if judge.tolerance is None else (-judge.tolerance, judge.tolerance):
        axes.axvline(limit, color=INK, linewidth=1.0, linestyle="--")
    mean = aligned.statistics[judge.measure].mean
    axes.axvline(mean, color=INK, linewidth=1.2)
    axes.annotate(
        "mean", (mean, 1.0), xycoords=("data", "axes fraction"), xytext=(4, -10),
        textcoords="offset points", fontsize=TEXT - 1, color=INK,
    )  # fmt: skip
    dress(axes, x=_label(accuracy), y="share of the weighted area [%]")
    axes.set_xlim(low - margin, high + margin)
    return figure


def draw_profiles(run: Run, accuracy: Accuracy, aligned: Aligned) -> Figure:
    """The deviation of the nodes on four lines through the axis, with the band of the tolerance."""
    whole, judge = run.final.whole, accuracy.judge
    values = aligned.deviations.of(judge.measure)
    mask = accuracy.mask & (np.arange(len(whole.positions)) < whole.crossings)
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.135, 0.135, 0.835, 0.775))
    if judge.tolerance is not None:
        axes.axhspan(-judge.tolerance, judge.tolerance, color=GOOD, linewidth=0, zorder=0)
    axes.axhline(0.0, color=SOFT, linewidth=0.6, zorder=1)
    for degrees, (ink, line) in zip(DIRECTIONS, LINES, strict=True):
        near = mask & near_section(whole.flat, degrees, 0.5 * min(run.case.grid.step))
        place, mean = _side_by_side(whole.flat[near, :2] @ along(degrees), whole.positions[near], values[near], degrees)
        axes.plot(place, mean, line, color=ink, linewidth=1.3, label=f"{degrees}°")
    dress(axes, x="along the section [mm]", y=_label(accuracy))
    radius = accuracy.aperture.radius
    axes.set_xlim(-1.02 * radius, 1.02 * radius)
    figure.legend(
        loc="upper right", fontsize=TEXT, frameon=False, labelcolor=INK, ncols=4, borderaxespad=0.1, columnspacing=1.0
    )
    return figure


def draw_lobes(accuracy: Accuracy) -> Figure:
    """The rms of each part of the deviation, as held and after the best fit; their squares add up."""
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.135, 0.135, 0.835, 0.775))
    shown = [aligned for aligned in (accuracy.as_held, accuracy.fitted) if aligned.harmonics is not None]
    names: list[str] = []
    for row, (aligned, ink) in enumerate(zip(shown, (ACCENT, PUNCH), strict=False)):
        names, sizes = parts_of(aligned)
        places = np.arange(len(names)) + 0.4 * (row - 0.5 * (len(shown) - 1))
        axes.bar(places, sizes, width=0.38, color=ink, label=aligned.name)
        squared = float(np.sum(sizes**2))
        for place, size in zip(places, sizes, strict=True):
            if size**2 > SEEN * squared:
                axes.annotate(
                    f"{100 * size**2 / squared:.0f}", (place, size), xytext=(0, 2), textcoords="offset points",
                    ha="center", fontsize=TEXT - 2, color=INK,
                )  # fmt: skip
    axes.set_xticks(np.arange(len(names)), names)
    axes.margins(y=0.1)
    axes.set_ylim(bottom=0.0)
    dress(axes, x="mean, and parts with m lobes around the axis", y=f"rms of the part, {accuracy.judge.measure} [mm]")
    figure.legend(
        loc="upper right", fontsize=TEXT, frameon=False, labelcolor=INK, ncols=2, borderaxespad=0.1, columnspacing=1.0
    )
    return figure


def parts_of(aligned: Aligned) -> tuple[list[str], Floats]:
    """The parts that a deviation falls into and their rms (n,) [mm]: mean, m = 0, 1, ..., and what is left.

    Raises ValueError where the aperture holds too few nodes to tell parts apart.
    """
    found = aligned.harmonics
    if found is None:
        raise ValueError("no harmonics were found")
    shares = np.array([part.share for part in found.parts] + [found.residual])
    sizes = found.sigma * np.sqrt(np.maximum(shares, 0.0))
    return ["mean", *(f"{part.m}" for part in found.parts), "rest"], np.concatenate(([abs(found.mean)], sizes))


def _outline(axes: Axes, positions: Floats, cells: Ints, values: Floats, tolerance: float) -> None:
    """Lines where the values (N,) at the corners of the cells (K, 4) pass the tolerance, upwards and downwards."""
    if not len(cells):
        return
    low, high = float(values[cells].min()), float(values[cells].max())
    levels = [level for level in (-tolerance, tolerance) if low < level < high]
    if levels:
        x, y, _ = positions.T
        halves = Triangulation(x, y, np.concatenate((cells[:, :3], cells[:, [0, 2, 3]])))
        axes.tricontour(halves, values, levels=levels, colors=INK, linewidths=0.9, linestyles="-", zorder=3)


def _side_by_side(place: Floats, positions: Floats, values: Floats, degrees: float) -> tuple[Floats, Floats]:
    """Formed place along the section and mean value of the nodes side by side, in order.

    With a cell on the axis the section runs between two rows of nodes, which would make a zigzag.
    """
    rows = np.unique(place.round(6), return_inverse=True)[1]
    count = np.maximum(np.bincount(rows), 1)
    here = positions[:, :2] @ along(degrees)
    return np.bincount(rows, here) / count, np.bincount(rows, values) / count


def _one(ink: str) -> Colormap:
    from matplotlib.colors import ListedColormap

    return ListedColormap([ink])


def _label(accuracy: Accuracy) -> str:
    return f"{accuracy.judge.measure} deviation [mm]   (+ upwards)"


def _bar(figure: Figure, scale: Normalize, colours: Colormap, accuracy: Accuracy) -> None:
    axes = figure.add_axes(PLAN_BAR)
    bar = figure.colorbar(ScalarMappable(scale, colours), cax=axes, extend="both")
    bar.outline.set_linewidth(0.4)
    dress(axes, y=_label(accuracy))
    reach, tolerance = float(scale.vmax or 1.0), accuracy.judge.tolerance
    ticks = {-reach, reach}
    # Ticks that would lie on each other are left out; zero is in the middle of the band anyway.
    if tolerance is None or not 0.06 * reach < tolerance < 0.12 * reach:
        ticks.add(0.0)
    if tolerance is not None and tolerance > 0.06 * reach:
        ticks |= {-tolerance, tolerance}
    ticks |= {sign * reach / 2 for sign in (-1, 1) if tolerance is None or abs(reach / 2 - tolerance) > 0.12 * reach}
    shown = sorted(ticks)
    # A band too narrow for two ticks is told at its middle.
    middle = "0" if tolerance is None or tolerance > 0.06 * reach else f"±{tolerance:.3g}"
    axes.set_yticks(shown, [f"{tick:+.3g}".replace("-", "−") if tick else middle for tick in shown])
    axes.minorticks_off()
