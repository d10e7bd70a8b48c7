"""What matters most: the change of a figure by one per cent of each number, longest bar on top."""

from __future__ import annotations

from matplotlib.figure import Figure

from punchform.optimise.figures import FIGURES
from punchform.optimise.tolerance_table import Table
from punchform.report.figures.style import ACCENT, INK, PALE, PUNCH, TEXT, dress, new_figure

MOST = 20
"""More bars than this say nothing more."""
ROW = 0.46
"""Height of a bar with its name above it [inch]."""


def draw_tornado(table: Table) -> Figure:
    """Bars to the right where more of the number is more of the figure, to the left where it is less."""
    rows = [row for row in table.rows if row.effect is not None and row.matters][:MOST]
    high = 0.75 + ROW * max(len(rows), 1)
    figure = new_figure(5.6, high)
    axes = figure.add_axes((0.03, 0.55 / high, 0.94, 1 - 0.65 / high))
    effects = [row.effect or 0.0 for row in rows]
    places = range(len(rows), 0, -1)
    axes.barh(list(places), effects, height=0.36, color=[PUNCH if effect > 0 else ACCENT for effect in effects])
    axes.axvline(0.0, color=INK, linewidth=0.8)
    reach = 1.28 * max((abs(effect) for effect in effects), default=1.0)
    axes.set(xlim=(-reach, reach), ylim=(0.55, max(len(rows), 1) + 0.75), yticks=[])
    for place, row, effect in zip(places, rows, effects, strict=True):
        words = f"{effect:+.2g}".replace("-", "−")
        side, aside = ("left", 3) if effect > 0 else ("right", -3)
        axes.annotate(
            words, (effect, place), xytext=(aside, 0), textcoords="offset points", va="center", ha=side,
            fontsize=TEXT - 1, color=INK,
        )  # fmt: skip
        name = f"{row.of.place} = {row.of.value:.4g} {row.of.unit}".rstrip()
        axes.text(-0.98 * reach, place + 0.4, name, va="center", fontsize=TEXT, color=INK)
    axes.grid(axis="x", color=PALE, linewidth=0.5)
    axes.set_axisbelow(True)
    unit = FIGURES[table.figure].unit
    dress(axes, x=f"change of {table.figure}{f' [{unit}]' if unit else ''} by 1 % more of the number")
    return figure
