"""What matters most: the change of a figure by one per cent of each number, longest bar on top."""

from __future__ import annotations

from matplotlib.figure import Figure

from punchform.optimise.figures import FIGURES
from punchform.optimise.tolerance_table import Table
from punchform.report.figures.style import ACCENT, INK, PALE, PUNCH, TEXT, dress, new_figure

MOST = 20
"""More bars than this say nothing more."""


def draw_tornado(table: Table) -> Figure:
    """Bars to the right where more of the number is more of the figure, to the left where it is less."""
    rows = [row for row in table.rows if row.effect is not None and row.matters][:MOST]
    figure = new_figure(8.4, 1.1 + 0.3 * max(len(rows), 1))
    high = figure.get_figheight()
    axes = figure.add_axes((0.36, 0.62 / high, 0.6, 1 - 1.0 / high))
    effects = [row.effect or 0.0 for row in rows]
    places = range(len(rows), 0, -1)
    axes.barh(list(places), effects, height=0.62, color=[PUNCH if effect > 0 else ACCENT for effect in effects])
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.set_yticks(list(places), [f"{row.of.place} = {row.of.value:.4g} {row.of.unit}".rstrip() for row in rows])
    reach = 1.28 * max((abs(effect) for effect in effects), default=1.0)
    axes.set_xlim(-reach, reach)
    for place, effect in zip(places, effects, strict=True):
        aside = 0.012 * reach if effect > 0 else -0.012 * reach
        words = f"{effect:+.2g}".replace("-", "−")
        side = "left" if effect > 0 else "right"
        axes.text(effect + aside, place, words, va="center", ha=side, fontsize=TEXT - 1.5, color=INK)
    axes.grid(axis="x", color=PALE, linewidth=0.5)
    axes.set_axisbelow(True)
    unit = FIGURES[table.figure].unit
    dress(axes, x=f"change of {table.figure}{f' [{unit}]' if unit else ''} by 1 % more of the number")
    return figure
