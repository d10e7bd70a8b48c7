"""The wires alone, seen from the side and above: a grid that bends too much between its crossings for flat cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from punchform.report.figures.shape import TOWARDS_EYE, in_relief, seen
from punchform.report.figures.style import RELIEF

if TYPE_CHECKING:
    from punchform.arrays import Floats
    from punchform.run import Run
    from punchform.whole import Whole

NEAR, FAR = 2.6, 1.0
"""Width of the nearest and of the farthest wires [pt]."""


def draw_wires(run: Run) -> Figure:
    """The wires of the formed grid."""
    return draw_wires_of(run.formed.whole)


def draw_wires_of(whole: Whole) -> Figure:
    """Every element as a line coloured by its height, in parallel projection; near ones are thicker and on top."""
    lines = whole.positions[np.column_stack((whole.start, whole.end))]
    lines = lines[np.isfinite(lines).all(axis=(1, 2))]
    there = whole.positions[np.isfinite(whole.positions).all(axis=1)]
    scale = Normalize(float(there[:, 2].min()), float(there[:, 2].max()))
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
        rasterized=True,
    )
    return in_relief(drawn, there, scale)
