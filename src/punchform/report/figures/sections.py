"""Sections along 0 and 45 degrees: the formed grid on the punch, and the grid before and after the release."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from punchform.arrays import Bools, Floats
from punchform.report.figures.style import ACCENT, HALF, INK, PUNCH, SOFT, TEXT, dress, new_figure

if TYPE_CHECKING:
    from punchform.accuracy import Accuracy
    from punchform.run import Run

DIRECTIONS = (45, 0)
WIDTH, LEFT, PANEL = HALF[0], 0.6, 4.1
BELOW, ABOVE, TALLEST = 0.5, 0.4, 2.4


def draw_sections(run: Run) -> Figure:
    """Nodes within half a step of each section, the punch, and the flat blank; shallow heights are
    enlarged."""
    return _panels(run, (run.formed.whole.positions,), partial(_section, run=run))


def draw_overlay(run: Run) -> Figure:
    """The same nodes before and after the release, and the target inside its aperture."""
    assert run.released is not None
    return _panels(run, (run.formed.whole.positions, run.released.whole.positions), partial(_overlay, run=run))


def _panels(run: Run, shapes: tuple[Floats, ...], draw: Callable[..., None]) -> Figure:
    """One panel per direction; `draw(axes, degrees=..., reach=...)` fills it."""
    whole = run.formed.whole
    points = np.concatenate(shapes)
    ends = [
        float(np.abs(place[_near(run, at), :2] @ along(at)).max(initial=0.0))
        for at in DIRECTIONS
        for place in (whole.flat, *shapes)
    ]
    reach = 1.02 * max(*ends, run.case.tool.rim_radius)
    low, high = min(float(points[:, 2].min()), 0.0), max(float(points[:, 2].max()), 0.0)
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
        draw(axes, degrees=degrees, reach=reach)
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


def along(degrees: float) -> Floats:
    """The direction (2,) at so many degrees to x."""
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def _near(run: Run, degrees: float) -> Bools:
    return near_section(run.formed.whole.flat, degrees, 0.5 * min(run.case.grid.step))


def _section(axes: Axes, run: Run, degrees: float, reach: float) -> None:
    whole, near = run.formed.whole, _near(run, degrees)
    flat = whole.flat[near, :2] @ along(degrees)
    line = np.linspace(-reach, reach, 801)
    punch = run.formed.surface.height(line[:, None] * along(degrees))
    axes.plot(line, punch, color=PUNCH, linewidth=1.4, label="punch", zorder=1)
    axes.plot(flat, 0 * flat, "|", color=SOFT, markersize=5, markeredgewidth=0.6, label="flat blank", zorder=2)
    _nodes(axes, whole.positions[near], degrees, ACCENT, "formed nodes")


def _overlay(axes: Axes, run: Run, degrees: float, reach: float) -> None:
    assert run.released is not None
    near = _near(run, degrees)
    if run.accuracy is not None:
        edge = min(run.accuracy.aperture.radius, reach)
        line = np.linspace(-edge, edge, 401)
        axes.plot(line, _target_height(run.accuracy, line), color=PUNCH, linewidth=1.4, label="target", zorder=1)
    _nodes(axes, run.formed.whole.positions[near], degrees, SOFT, "in the tool")
    _nodes(axes, run.released.whole.positions[near], degrees, ACCENT, "released")


def _nodes(axes: Axes, points: Floats, degrees: float, ink: str, label: str) -> None:
    axes.plot(
        points[:, :2] @ along(degrees), points[:, 2], "o", color=ink, markersize=2.0, markeredgewidth=0,
        label=label, zorder=3,
    )  # fmt: skip


def _target_height(accuracy: Accuracy, places: Floats) -> Floats:
    surface = accuracy.target.surface
    heights: Floats = surface.chain.height(np.abs(places))
    return heights - surface.height_at_axis + accuracy.target.apex_height
