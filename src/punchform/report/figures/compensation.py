"""Figures of a compensation: how it went, the correction of the punch, the deviation before and after, the reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator

from punchform.arrays import Floats
from punchform.optimise.compensation import Ending
from punchform.report.compensate_words import NAMES, all_found
from punchform.report.figures.style import (
    ACCENT,
    DIVERGING,
    HALF,
    INK,
    PAPER,
    PLAN_BAR,
    PUNCH,
    SOFT,
    TEXT,
    colour_bar,
    dress,
    even_about_zero,
    in_colour,
    new_figure,
    plan_axes,
    squares,
)

if TYPE_CHECKING:
    from punchform.optimise.compensated import Compensated
    from punchform.optimise.correction_space import Kind, Space
    from punchform.optimise.misfit import Misfit

LINES: dict[Kind, tuple[str, str, str]] = {
    "field": (ACCENT, "-", "o"),
    "revolution": (PUNCH, "--", "s"),
    "lobes": (SOFT, "-.", "^"),
}
"""Colour, line and mark of each kind of surface."""
POINTS = 161
MANY_DECADES = 1000.0
"""From this ratio of the largest to the smallest rms on, only powers of ten are named."""
SECTIONS = (0.0, 22.5, 45.0)


def draw_convergence(done: Compensated) -> Figure:
    """The rms of every solve on a logarithmic scale, the floors dotted, the tolerance as a line."""
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.15, 0.135, 0.82, 0.77))
    most = 0
    for kind, found in all_found(done).items():
        ink, line, mark = LINES[kind]
        # The other kinds begin where the one that was asked for ended.
        before = 0 if kind == done.kind else len(done.found.solves)
        known = [(before + one.number, one.misfit.rms) for one in found.solves if one.misfit is not None]
        most = max(most, before + len(found.solves))
        numbers, rms = np.array([n for n, _ in known]), np.array([r for _, r in known])
        axes.plot(numbers, rms, line, color=ink, marker=mark, markersize=5, linewidth=1.4, label=NAMES[kind], zorder=4)
        for one in found.solves:
            if one.misfit is None:
                axes.axvline(before + one.number, color=ink, linewidth=0.8, linestyle=":", zorder=1)
        if done.moved and found.ending is not Ending.UNMOVED:
            axes.axhline(found.floor, color=ink, linewidth=0.7, linestyle=":", zorder=2)
    if done.tolerance is not None:
        axes.axhline(done.tolerance, color=INK, linewidth=1.0, zorder=3)
        axes.annotate(
            f"asked for: {done.tolerance:g} mm", (0.0, done.tolerance), xycoords=("axes fraction", "data"),
            xytext=(4, 3), textcoords="offset points", fontsize=TEXT - 1, color=INK, ha="left",
        )  # fmt: skip
    axes.set_yscale("log")
    axes.set_xlim(0.7, most + 0.3 if most > 1 else 1.6)
    low, high = axes.get_ylim()
    axes.set_ylim(0.7 * low, 1.4 * high)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < MANY_DECADES * low else (1.0,)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
    axes.grid(visible=True, which="both", axis="y", color=SOFT, alpha=0.18, linewidth=0.5)
    dress(axes, x="press and release", y="rms deviation [mm]")
    figure.legend(
        loc="upper right", fontsize=TEXT, frameon=False, labelcolor=INK, ncols=3, borderaxespad=0.1, columnspacing=1.0
    )
    return figure


def draw_correction(done: Compensated) -> Figure:
    """The heights that are added to the punch, seen from above."""
    space, numbers = done.found.space, done.found.best.numbers
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=_corners(space.end), rim=done.given.tool.rim_radius)
    along = np.linspace(-space.end, space.end, POINTS)
    x, y = np.meshgrid(along, along, indexing="ij")
    heights = space.heights(numbers, np.column_stack((x.ravel(), y.ravel()))).reshape(x.shape)
    heights[np.hypot(x, y) > space.end] = np.nan
    scale = even_about_zero(heights[np.isfinite(heights)])
    axes.pcolormesh(x, y, heights, cmap=DIVERGING, norm=scale, shading="nearest", rasterized=True, zorder=1)
    levels = _levels(float(scale.vmax or 1.0))
    lines = axes.contour(x, y, heights, levels=levels, colors=INK, linewidths=0.5, zorder=2)
    axes.clabel(lines, fontsize=TEXT - 2, fmt=lambda value: f"{value:g}".replace("-", "−"))
    _circle(axes, space.start)
    colour_bar(figure, PLAN_BAR, scale, DIVERGING, "added to the punch [mm]   (+ higher)")
    return figure


def draw_sections(done: Compensated) -> Figure:
    """The correction along three directions, and that of a turned punch beside it."""
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.15, 0.135, 0.82, 0.775))
    found = done.found
    rho = np.linspace(0.0, found.space.end, POINTS)
    turned = found.space.kind == "revolution"
    inks = ((INK, "-"), (ACCENT, "-"), (ACCENT, "--"))
    for degrees, (ink, line) in zip(SECTIONS[: 1 if turned else 3], inks, strict=False):
        values = _along(found.space, found.best.numbers, rho, degrees)
        name = "all round" if turned else f"{NAMES[done.kind]}, {degrees:g}°"
        axes.plot(rho, values, line, color=ink, linewidth=1.4, label=name)
    if "revolution" in done.others:
        lathe = done.others["revolution"]
        axes.plot(
            rho, _along(lathe.space, lathe.best.numbers, rho, 0.0), "-.", color=PUNCH, linewidth=1.4, label="lathe"
        )
    axes.axhline(0.0, color=SOFT, linewidth=0.6)
    axes.axvline(found.space.start, color=SOFT, linewidth=0.8, linestyle="--")
    axes.set_xlim(0.0, found.space.end)
    dress(axes, x="distance from the axis [mm]", y="added to the punch [mm]   (+ higher)")
    axes.legend(loc="best", fontsize=TEXT - 1, frameon=False, labelcolor=INK)
    return figure


def draw_before_and_after(done: Compensated) -> Figure:
    """The deviation of the judged crossings over the punch as it was and over the corrected one, on one scale."""
    figure = new_figure(6.6, 3.3)
    scale = even_about_zero(done.before.deviation[done.before.judged > 0])
    for column, (misfit, title) in enumerate(((done.before, "before"), (done.after, "after"))):
        axes = figure.add_axes((0.1 + 0.415 * column, 0.135, 0.355, 0.79))
        _deviations(axes, misfit, scale, done)
        dress(axes, x="x [mm]", y="" if column else "y [mm]", title=f"{title}: {misfit.rms:.3g} mm rms")
    colour_bar(figure, (0.885, 0.18, 0.018, 0.68), scale, DIVERGING, "normal deviation [mm]   (+ upwards)")
    return figure


def draw_after(done: Compensated) -> Figure:
    """The deviation over the corrected punch, on a scale of its own."""
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=_corners(done.found.space.end), rim=done.given.tool.rim_radius)
    scale = even_about_zero(done.after.deviation[done.after.judged > 0])
    _deviations(axes, done.after, scale, done)
    colour_bar(figure, PLAN_BAR, scale, DIVERGING, "normal deviation [mm]   (+ upwards)")
    return figure


def draw_reach(done: Compensated) -> Figure:
    """The singular values of the response, and the share of the squared error that lies in each of their shapes."""
    reach = done.reach
    assert reach is not None
    figure = new_figure(*HALF)
    axes = figure.add_axes((0.13, 0.135, 0.735, 0.77))
    places = np.arange(1, len(reach.values) + 1)
    axes.bar(places, 100 * reach.shares, width=0.6, color=SOFT, alpha=0.5, label="share of the squared error", zorder=2)
    other = max(0.0, 100 * (1 - float(reach.shares.sum())))
    axes.bar([len(places) + 1], [other], width=0.6, color=SOFT, alpha=0.25, zorder=2)
    axes.set_xticks([*places, len(places) + 1], [*(f"{n}" for n in places), "others"])
    dress(axes, x="shapes that small changes of the punch make", y="share of the squared error [%]")
    right = axes.twinx()
    right.plot(places, reach.values, "o-", color=ACCENT, linewidth=1.2, markersize=5, label="how far the shape follows")
    right.axhline(1.0, color=ACCENT, linewidth=0.7, linestyle="--")
    right.axhline(0.5, color=ACCENT, linewidth=0.7, linestyle=":")
    right.set_ylim(bottom=0.0)
    dress(right, y="singular value of the response: 1 follows, 0 does not")
    figure.legend(
        loc="upper right",
        fontsize=TEXT - 1.5,
        frameon=False,
        labelcolor=INK,
        ncols=2,
        borderaxespad=0.1,
        columnspacing=1.0,
    )
    return figure


def _deviations(axes: Axes, misfit: Misfit, scale: Normalize, done: Compensated) -> None:
    rim = done.found.space.end
    reach = 1.04 * rim
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", facecolor=PAPER)
    seen = misfit.judged > 0
    places = np.column_stack((misfit.places[seen], np.zeros(int(seen.sum()))))
    cells = squares(places, done.given.grid.step)
    axes.add_collection(in_colour(cells, misfit.deviation[seen], scale, DIVERGING, width=0.0))
    _circle(axes, rim)


def _circle(axes: Axes, radius: float) -> None:
    angle = np.linspace(0, 2 * np.pi, 181)
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), color=INK, linewidth=0.6, linestyle="--", zorder=3)


def _corners(reach: float) -> Floats:
    return np.array([[-reach, -reach, 0.0], [reach, reach, 0.0]])


def _along(space: Space, numbers: Floats, rho: Floats, degrees: float) -> Floats:
    angle = np.radians(degrees)
    return space.heights(numbers, rho[:, None] * np.array([np.cos(angle), np.sin(angle)]))


def _levels(reach: float) -> list[float]:
    """Round heights for the contour lines, about four on either side."""
    power = 10.0 ** np.floor(np.log10(reach / 4))
    step = min((part * power for part in (1, 2, 5, 10)), key=lambda part: abs(reach / part - 4))
    count = int(reach / step)
    return [round(step * n, 12) for n in range(-count, count + 1) if n]
