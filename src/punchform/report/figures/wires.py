"""The wires alone, seen from the side and above: a grid that bends too much between its crossings for flat cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from punchform.report.figures.shape import TOWARDS_EYE, frame, seen
from punchform.report.figures.style import RELIEF, colour_bar, new_figure

if TYPE_CHECKING:
    from punchform.arrays import Floats
    from punchform.run import Run

NEAR, FAR = 2.6, 1.0
"""Width of the nearest and of the farthest wires [pt]."""


def draw_wires(run: Run) -> Figure:
    """Every element as a line coloured by its height, in parallel projection; near ones are thicker and on top."""
    whole = run.formed.whole
    lines = whole.positions[np.column_stack((whole.start, whole.end))]
    scale = Normalize(float(whole.positions[:, 2].min()), float(whole.positions[:, 2].max()))
    depth = (lines @ TOWARDS_EYE).mean(axis=1)
    order = np.argsort(depth)
    nearness = (depth[order] - depth.min()) / (np.ptp(depth) or 1.0)
    drawn = LineCollection(
        cast("Sequence[Floats]", seen(lines[order])),
        array=lines[order, :, 2].mean(axis=1),
        cmap=RELIEF,
        norm=scale,
        linewidths=FAR + (NEAR - FAR) * nearness,
        capstyle="round",
    )
    outline = seen(whole.positions)
    size = np.ptp(outline, axis=0)
    figure = new_figure(7.6, float(np.clip(0.4 + 6.4 * size[1] / size[0], 3.0, 8.0)))
    axes = figure.add_axes((0.01, 0.01, 0.86, 0.98))
    axes.add_collection(drawn)
    frame(axes, outline)
    colour_bar(figure, (0.895, 0.2, 0.018, 0.6), scale, RELIEF, "height z [mm]")
    return figure
