"""A design search in pictures: how it came on, and the front of several objectives, pair by pair."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from punchform.arrays import Floats
from punchform.optimise.asking import Answer
from punchform.optimise.problem import unit_of
from punchform.optimise.search import Found
from punchform.report.figures.style import ACCENT, INK, PALE, PUNCH, SOFT, TEXT, dress, new_figure

FAINT = "#9aa6b2"
SPREAD = 20.0
"""Values that differ by more than this factor are shown on a logarithmic scale."""


def draw_search(found: Found) -> Figure:
    """Each objective against the number of the design: all designs, the front or the best so far, and the best."""
    objectives = found.question.objectives
    high = 0.9 + 2.1 * len(objectives)
    figure = new_figure(5.8, high)
    whole = [answer for answer in found.answers if answer.merit is not None]
    kept = {answer.number for answer in found.front}
    number = np.array([answer.number for answer in whole])
    allowed = np.array([answer.allowed for answer in whole])
    in_front = np.array([answer.number in kept for answer in whole])
    for k, objective in enumerate(objectives):
        axes = figure.add_axes((0.135, 1 - (2.1 * (k + 1) + 0.3) / high, 0.84, 1.75 / high))
        values = _values(whole, objective.figure)
        axes.plot(number[~allowed], values[~allowed], "x", color=SOFT, markersize=4, label="breaks a constraint")
        axes.plot(
            number[allowed & ~in_front], values[allowed & ~in_front], "o", color=FAINT, markersize=4, label="design"
        )
        if len(objectives) > 1:
            axes.plot(number[in_front], values[in_front], "o", color=ACCENT, markersize=4.5, label="of the front")
        elif allowed.any():
            best = objective.sign * np.minimum.accumulate(np.where(allowed, objective.sign * values, np.inf))
            axes.step(number, best, where="post", color=ACCENT, linewidth=1.4, label="best so far")
        _star(axes, found.best.number, found.best.told[objective.figure])
        _scaled(axes, values, "y")
        axes.set_xlim(0.5, max(len(found.answers), 2) + 0.5)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.grid(color=PALE, linewidth=0.5)
        axes.set_axisbelow(True)
        dress(
            axes,
            x="design, in the order in which it was tried" if objective is objectives[-1] else "",
            y=_label(objective.figure),
        )
        if k == 0:
            shown = axes.legend(
                loc="upper center", bbox_to_anchor=(0.5, 1.2), ncol=4, fontsize=TEXT - 1, frameon=False, labelcolor=INK
            )
            shown.set_zorder(5)
    return figure


def draw_front(found: Found) -> Figure:
    """Every pair of objectives: all designs that keep the constraints, the front, and the compromise."""
    names = [objective.figure for objective in found.question.objectives]
    pairs = list(combinations(names, 2))
    columns = min(len(pairs), 2)
    rows = -(-len(pairs) // columns)
    high = 0.45 + 3.2 * rows
    figure = new_figure(4.8 if columns == 1 else 6.4, high)
    behind = [answer for answer in found.answers if answer.allowed]
    for place, (across, up) in enumerate(pairs):
        row, column = divmod(place, columns)
        left, bottom = (column + 0.22) / columns, 1 - (0.4 + 3.2 * (row + 1) - 0.55) / high
        axes = figure.add_axes((left, bottom, 0.74 / columns, 2.55 / high))
        axes.plot(_values(behind, across), _values(behind, up), "o", color=FAINT, markersize=4, label="design")
        axes.plot(
            _values(found.front, across),
            _values(found.front, up),
            "o",
            color=ACCENT,
            markersize=4.5,
            label="of the front",
        )
        axes.plot(
            _values((found.best,), across),
            _values((found.best,), up),
            "*",
            color=PUNCH,
            markersize=12,
            label="compromise",
        )
        _scaled(axes, _values(behind, across), "x")
        _scaled(axes, _values(behind, up), "y")
        axes.grid(color=PALE, linewidth=0.5)
        axes.set_axisbelow(True)
        dress(axes, x=_label(across), y=_label(up))
        if place == 0:
            figure.legend(loc="upper center", ncol=3, fontsize=TEXT - 1, frameon=False, labelcolor=INK)
    return figure


def _star(axes: Axes, number: int, value: float | None) -> None:
    if value is not None:
        axes.plot([number], [value], "*", color=PUNCH, markersize=12, label="best", zorder=4)


def _values(answers: list[Answer] | tuple[Answer, ...], name: str) -> Floats:
    return np.array([answer.told.get(name) for answer in answers], dtype=np.float64)


def _scaled(axes: Axes, values: Floats, which: str) -> None:
    """A logarithmic scale where the values ask for one."""
    if len(values) and values.min() > 0 and values.max() > SPREAD * values.min():
        (axes.set_xscale if which == "x" else axes.set_yscale)("log")


def _label(name: str) -> str:
    unit = unit_of(name)
    return f"{name} [{unit}]" if unit else name
