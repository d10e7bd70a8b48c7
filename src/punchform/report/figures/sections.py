"""Sections of the formed grid along 0 and 45 degrees, against the punch and the flat blank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from punchform.arrays import Bools, Floats
from punchform.report.figures.style import ACCENT, HALF, INK, PUNCH, SOFT, TEXT, dress, new_figure

if TYPE_CHECKING:
    from punchform.run import Run

DIRECTIONS = (45, 0)
WIDTH, LEFT, PANEL = HALF[0], 0.6, 4.9
BELOW, ABOVE, TALLEST = 0.5, 0.4, 2.4


def draw_sections(run: Run) -> Figure:
    """Nodes within half a step of each section, the punch, and the flat blank; shallow heights are
    enlarged."""
    whole = run.formed.whole
    ends = [float(np.abs(whole.flat[_near(run, at), :2] @ _along(at)).max(initial=0.0)) for at in DIRECTIONS]
    reach = 1.02 * max(*ends, run.case.punch.rim_radius)
    low, high = min(float(whole.positions[:, 2].min()), 0.0), max(float(whole.positions[:, 2].max()), 0.0)
    times = enlargement(2 * reach, high - low)
    margin = 0.08 * (high - low) + 0.004 * reach / times
    panel = min(PANEL * times * (high - low + 2 * margin) / (2 * reach), TALLEST)
    height = len(DIRECTIONS) * (panel + BELOW + ABOVE)
    figure = new_figure(WIDTH, height)
    for row, degrees in enumerate(DIRECTIONS):
        bottom = BELOW + row * (panel + BELOW + ABOVE)
        axes = figure.add_axes((LEFT / WIDTH, bottom / height, PANEL / WIDTH, panel / height))
        axes.set(xlim=(-reach, reach), ylim=(low - margin, high + margin))
        axes.set_aspect(times, adjustable="box", anchor="W")
        _section(axes, run, degrees, reach)
        enlarged = f"   (heights {times} times enlarged)" if times > 1 else ""
        dress(axes, x="along the section [mm]", y="z [mm]", title=f"Section at {degrees}°{enlarged}")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="upper right", fontsize=TEXT, frameon=False, labelcolor=INK, ncols=3,
        borderaxespad=0.1, columnspacing=1.0, handletextpad=0.4, numpoints=3,
    )  # fmt: skip
    return figure


def enlargement(width: float, height: float) -> int:
    """How many times heights are enlarged: 1 unless the section is lower than an eighth of its width."""
    return int(np.clip(width / (8 * max(height, 1e-3 * width)), 1, 20))


def near_section(flat: Floats, degrees: float, reach: float) -> Bools:
    """Which nodes (N,) lie flat within `reach` [mm] of the line through the axis at `degrees` to x."""
    angle = np.radians(degrees)
    off = flat[:, 1] * np.cos(angle) - flat[:, 0] * np.sin(angle)
    return np.asarray(np.abs(off) <= reach * (1 + 1e-9))


def _along(degrees: float) -> Floats:
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def _near(run: Run, degrees: float) -> Bools:
    return near_section(run.formed.whole.flat, degrees, 0.5 * min(run.case.grid.step))


def _section(axes: Axes, run: Run, degrees: float, reach: float) -> None:
    whole, along, near = run.formed.whole, _along(degrees), _near(run, degrees)
    flat, formed = whole.flat[near, :2] @ along, whole.positions[near, :2] @ along
    line = np.linspace(-reach, reach, 801)
    punch = run.formed.surface.height(line[:, None] * along)
    axes.plot(line, punch, color=PUNCH, linewidth=1.4, label="punch", zorder=1)
    axes.plot(flat, 0 * flat, "|", color=SOFT, markersize=5, markeredgewidth=0.6, label="flat blank", zorder=2)
    axes.plot(
        formed, whole.positions[near, 2], "o", color=ACCENT, markersize=2.0, markeredgewidth=0,
        label="formed nodes", zorder=3,
    )  # fmt: skip
