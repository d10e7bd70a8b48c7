"""The figures of wires that yield: maps of elongation and plastic strain, and the elongation along the middle wires."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.arrays import Floats, Ints
from punchform.report.figures.picture import Picture
from punchform.report.figures.stress import draw_pieces
from punchform.report.figures.style import ACCENT, PUNCH, SOFT, TEXT, dress, new_figure
from punchform.report.quantities import ELONGATION, PLASTIC

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.whole import Whole

SECTION = "yielding"
WIDE = (6.0, 2.9)


def yielding_pictures(run: Run) -> tuple[Picture, ...]:
    """What has flowed in the tool; none where the wires are elastic."""
    if run.formed.hardening is None:
        return ()
    return (
        Picture(
            "elongation",
            "Elongation of the wires",
            "Plan view. By how much each wire piece is longer in the tool than in the flat blank, both families. Where "
            "it is even the whole wire shares the stretch; where it is darkest the wire is thinnest and breaks first.",
            draw_elongation,
            section=SECTION,
        ),
        Picture(
            "plastic_strain",
            "Plastic strain",
            "Plan view. The largest plastic strain in a section of each wire piece, that of bends included: sharp "
            "bends, as over the fillet of the rim, show as dark rings. The palest wires stay elastic.",
            draw_plastic_strain,
            section=SECTION,
        ),
        Picture(
            "elongation_middle",
            "Elongation along the middle wires",
            "The wires next to the axis, from end to end. The broken line is what stays of the elongation when nothing "
            "pulls any more; the gap between the two is elastic. The dotted lines are the rim.",
            draw_along_middle,
            wide=True,
            section=SECTION,
        ),
    )


def draw_elongation(run: Run) -> Figure:
    """Every element of both families coloured by its elongation, from zero."""
    whole = run.formed.whole
    return draw_pieces(run, whole, ELONGATION)


def draw_plastic_strain(run: Run) -> Figure:
    """Every element of both families coloured by the largest plastic strain of its sections, from zero."""
    whole = run.formed.whole
    return draw_pieces(run, whole, PLASTIC)


def draw_along_middle(run: Run) -> Figure:
    """Elongation, and what stays of it, along the wire of each family that passes nearest to the axis."""
    whole = run.formed.whole
    figure = new_figure(*WIDE)
    axes = figure.add_axes((0.095, 0.16, 0.89, 0.79))
    for family, ink in ((1, ACCENT), (2, PUNCH)):
        wire = middle_wire(whole, family)
        ends = whole.flat[np.column_stack((whole.start, whole.end))[wire], family - 1]
        name = "xy"[family - 1]
        for values, line, label in (
            (whole.axial_strain, "-", f"wire along {name}"),
            (whole.stretch - 1.0, "--", f"what stays, along {name}"),
        ):
            axes.plot(*_stairs(ends, 100.0 * values[wire]), line, color=ink, linewidth=1.2, label=label)
    for side in (-1, 1):
        axes.axvline(side * run.case.tool.rim_radius, color=SOFT, linewidth=0.8, linestyle=":")
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    dress(axes, x="place in the flat blank [mm]", y="elongation [%]")
    axes.legend(fontsize=TEXT - 1, frameon=False, ncols=2)
    return figure


def middle_wire(whole: Whole, family: int) -> Ints:
    """The elements of the wire of a family that lies nearest to the axis, from end to end."""
    across, along = 2 - family, family - 1
    own = np.flatnonzero(whole.family == family)
    off = np.abs(whole.flat[whole.start[own], across])
    # Of two wires at the same distance the one on the positive side.
    side = whole.flat[whole.start[own], across] >= 0
    nearest = off.min()
    wire = own[np.isclose(off, nearest, rtol=0, atol=1e-9 * (1 + nearest)) & (side | (nearest == 0))]
    middles = whole.flat[whole.start[wire], along] + whole.flat[whole.end[wire], along]
    return np.asarray(wire[np.argsort(middles)])


def _stairs(ends: Floats, values: Floats) -> tuple[Floats, Floats]:
    """A level line over each piece: places and values, (2 n,) each."""
    return np.sort(ends, axis=1).ravel(), np.repeat(values, 2)
