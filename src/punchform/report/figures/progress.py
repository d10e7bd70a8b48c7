"""How the solve went: energy and gradient against steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator
from numpy.typing import NDArray

from punchform.arrays import Floats
from punchform.report.figures.style import ACCENT, HALF, INK, PALE, PUNCH, TEXT, dress, new_figure

if TYPE_CHECKING:
    from punchform.run import Run

MARKERS = "osD^v"
MOST_MARKERS = 80


def draw_progress(run: Run) -> Figure:
    """Energy above its last value, and the gradient, on logarithmic scales; markers tell the kind of step."""
    history = run.formed.history
    number = np.array([step.number for step in history], dtype=np.float64)
    energy = np.array([step.energy for step in history])
    gradient = np.array([step.gradient for step in history])
    kinds = np.array([step.hessian for step in history])
    figure = new_figure(HALF[0], 3.6)
    above = figure.add_axes((0.155, 0.57, 0.82, 0.38))
    below = figure.add_axes((0.155, 0.125, 0.82, 0.38))
    _curve(above, number, energy - energy[-1], kinds, ACCENT)
    _curve(below, number, gradient, kinds, PUNCH)
    dress(above, y="E − last E [mJ]")
    dress(below, x="step", y="gradient [N, N mm]")
    above.tick_params(labelbottom=False)
    if above.get_legend_handles_labels()[1]:
        above.legend(loc="lower left", fontsize=TEXT - 1, frameon=False, labelcolor=INK)
    return figure


def _curve(axes: Axes, number: Floats, values: Floats, kinds: NDArray[np.str_], ink: str) -> None:
    """Positive values against step numbers; what is zero to rounding cannot be shown on a logarithmic
    scale."""
    shown = values > 0
    axes.plot(number[shown], values[shown], color=ink, linewidth=1.2)
    if len(number) <= MOST_MARKERS:
        names = [str(name) for name in dict.fromkeys(kinds) if name]
        for name, marker in zip(names, MARKERS, strict=False):
            mine = shown & (kinds == name)
            axes.plot(number[mine], values[mine], marker, color=ink, markersize=4, label=name)
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.minorticks_off()
    axes.set_xlim(number[0] - 0.3, number[-1] + 0.3)
    axes.grid(color=PALE, linewidth=0.5)
