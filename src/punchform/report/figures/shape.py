"""The formed grid seen from the side and above: cells shaded by height, with wires drawn on them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import Collection, PolyCollection
from matplotlib.colors import Normalize, to_rgba
from matplotlib.figure import Figure

from punchform.arrays import Floats, Ints
from punchform.report.figures.style import INK, RELIEF, TEXT, colour_bar, new_figure, round_down
from punchform.report.quantities import HEIGHT

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole

AZIMUTH, ELEVATION = np.radians(-62.0), np.radians(30.0)
TOWARDS_EYE = np.array([np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)])
RIGHT = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
UP = np.cross(TOWARDS_EYE, RIGHT)
LIGHT = np.array([-0.45, -0.35, 0.82])
WIRES_ACROSS = 60


def draw_shape(run: Run) -> Figure:
    """The grid in the tool."""
    return draw_whole(run.formed.whole)


def draw_whole(whole: Whole) -> Figure:
    """Parallel projection, drawn from the back to the front so that near parts hide far ones.

    Our own projection instead of 3D axes: those draw wires through the surface and are slow on large grids.
    """
    corners, wires = whole.positions[whole.cells], whole.positions[some_wires(whole)]
    scale = Normalize(float(whole.positions[:, 2].min()), float(whole.positions[:, 2].max()))
    fills = _shaded(corners, scale)
    inks = np.tile(to_rgba(INK, 0.8), (len(wires), 1))
    # A wire lies between two cells and must follow both: it counts as half a cell nearer than it is.
    nearer = 0.5 * float(np.linalg.norm(corners[0, 2] - corners[0, 0]))
    depth = np.concatenate(((corners @ TOWARDS_EYE).mean(axis=1), (wires @ TOWARDS_EYE).mean(axis=1) + nearer))
    order = np.argsort(depth)
    pieces = np.concatenate((corners, wires[:, [0, 1, 1, 0]]))[order]
    drawn = PolyCollection(
        cast("Sequence[Floats]", seen(pieces)),
        facecolors=np.concatenate((fills, np.zeros_like(inks)))[order],
        edgecolors=np.concatenate((fills, inks))[order],
        linewidths=np.repeat([0.4, 0.35], [len(corners), len(wires)])[order],
        rasterized=True,
    )
    return in_relief(drawn, whole.positions, scale)


def in_relief(drawn: Collection, points: Floats, scale: Normalize) -> Figure:
    """The figure of what was drawn of a shape with these points (n, 3), as seen, with the colours of its heights."""
    outline = seen(points)
    size = np.ptp(outline, axis=0)
    figure = new_figure(6.2, float(np.clip(0.35 + 5.2 * size[1] / size[0], 2.6, 6.6)))
    axes = figure.add_axes((0.01, 0.01, 0.85, 0.98))
    axes.add_collection(drawn)
    frame(axes, outline)
    colour_bar(figure, (0.875, 0.16, 0.02, 0.68), scale, RELIEF, HEIGHT.legend)
    return figure


def seen(points: Floats) -> Floats:
    """The picture plane coordinates (..., 2) of points (..., 3)."""
    return np.stack((points @ RIGHT, points @ UP), axis=-1)


def some_wires(whole: Whole) -> Ints:
    """The ends (n, 2) of the elements of every k-th wire, so that at most WIRES_ACROSS wires lie side by
    side."""
    across = int(np.ptp(whole.index, axis=0).max()) + 1
    every = -(-across // WIRES_ACROSS)
    # The first family runs along i at constant j, the second along j at constant i.
    number = np.where(whole.family == 1, whole.index[whole.start, 1], whole.index[whole.start, 0])
    kept = number % every == 0
    return np.column_stack((whole.start[kept], whole.end[kept]))


def _shaded(corners: Floats, scale: Normalize) -> Floats:
    """Colours (K, 4) of cells (K, 4, 3): their height on the colour scale, darker away from the light."""
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    slope = np.abs(across @ LIGHT) / np.maximum(np.linalg.norm(across, axis=1), 1e-300)
    colours = np.array(colormaps[RELIEF](scale(corners[:, :, 2].mean(axis=1))))
    # Paler than the map itself, or dark wires would vanish on the dark end of it.
    light = np.clip(slope / np.linalg.norm(LIGHT), 0, 1)[:, None]
    colours[:, :3] = (0.38 + 0.62 * colours[:, :3]) * (0.5 + 0.5 * light)
    return colours


def frame(axes: Axes, outline: Floats) -> None:
    """Limits around the picture, the directions x, y, z, and a bar for the scale."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    size = float((high - low).max())
    axes.set(
        xlim=(low[0] - 0.02 * size, high[0] + 0.02 * size),
        ylim=(low[1] - 0.05 * size, high[1] + 0.03 * size),
        aspect="equal",
    )
    axes.set_axis_off()
    root = low + np.array([0.05, 0.05]) * size
    for name, direction in zip("xyz", seen(np.eye(3)), strict=True):
        tip = root + 0.07 * size * direction
        axes.annotate("", tip, root, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.8, "shrinkA": 0})
        x, y = root + 0.09 * size * direction
        axes.text(x, y, name, fontsize=TEXT, color=INK, ha="center", va="center")
    bar = round_down(0.2 * size)
    right, level = high[0], low[1]
    axes.plot((right - bar, right), (level, level), color=INK, linewidth=1.6, solid_capstyle="butt")
    axes.text(right - bar / 2, level, f"{bar:g} mm\n", fontsize=TEXT, color=INK, ha="center", va="center")
