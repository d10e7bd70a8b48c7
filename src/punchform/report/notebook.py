"""Results in notebooks: tables with a verdict and a small figure, and figures of any field of any stage."""

from __future__ import annotations

import base64
import io
import math
from html import escape
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from punchform.arrays import Bools, Floats
from punchform.errors import InputError
from punchform.export.result import all_notes, largest
from punchform.export.told import told
from punchform.report.accuracy_words import judgement
from punchform.report.fields import Field, field_of, stage_of
from punchform.report.figures.shape import draw_whole
from punchform.report.figures.style import (
    ACCENT,
    DIVERGING,
    HALF,
    PALE,
    PAPER,
    PLAN_BAR,
    PUNCH,
    SEQUENTIAL,
    about_zero,
    colour_bar,
    even_about_zero,
    force_bar,
    in_colour,
    new_figure,
    plan_axes,
    squares,
    wire_width,
)
from punchform.report.figures.wires import draw_wires_of
from punchform.report.quantities import strain
from punchform.report.words import energy, percent, size
from punchform.run import Run
from punchform.whole import part_of

if TYPE_CHECKING:
    from punchform.drape import Drape
    from punchform.grid import Grid
    from punchform.shell import Shell
    from punchform.whole import Whole

SMALL = 72
"""Dots per inch of the figure in a table."""
Lines = dict[str, str]
"""What a table tells, by its names."""


def plot_run(run: Run, field: str, stage: str) -> Figure:
    """The shape of a stage, or one of its fields in plan; colours as in the report.

    Raises ValueError for a field or a stage that the run has not, with those that it has.
    """
    whole = stage_of(run, stage).whole
    if field == "shape":
        return draw_shape_of(whole)
    shown = field_of(run, field, stage)
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=whole.positions, rim=run.case.rim_radius)
    axes.set_facecolor(PAPER)
    outlines, values, width = _drawn(run, whole, shown, wire_width(axes, min(run.case.grid.step)))
    colours = DIVERGING if shown.signed else SEQUENTIAL
    scale = about_zero(values) if shown.force else even_about_zero(values) if shown.signed else _upwards(values)
    axes.add_collection(in_colour(outlines, values, scale, colours, width=width))
    if shown.force:
        force_bar(figure, scale, shown.label)
    else:
        colour_bar(figure, PLAN_BAR, scale, colours, shown.label)
    return figure


def plot_run_3d(run: Run, field: str, stage: str, off_screen: bool) -> Any:
    """A PyVista plotter with the grid of a stage, its wires, cells or crossings coloured by a field; what has a corner
    without a place is left out.

    Raises InputError where PyVista is not installed, ValueError as `plot_run` does.
    """
    whole = stage_of(run, stage).whole
    shown = field_of(run, "height" if field == "shape" else field, stage)
    if find_spec("pyvista") is None:
        raise InputError.of("PyVista is not installed, which plot3d needs", hint="pip install 'punchform[pyvista]'")
    pyvista: Any = import_module("pyvista")
    whole, values = _placed(whole, shown)
    wires = np.column_stack((np.full(len(whole.start), 2), whole.start, whole.end))
    mesh = pyvista.PolyData(whole.positions, lines=wires.ravel())
    if shown.place == "cell":
        faces = np.column_stack((np.full(len(whole.cells), 4), whole.cells))
        mesh = pyvista.PolyData(whole.positions, faces=faces.ravel())
    data = mesh.point_data if shown.place == "node" else mesh.cell_data
    data[shown.label] = values
    plotter = pyvista.Plotter(off_screen=off_screen)
    reach = float(np.nanmax(np.abs(values)))
    least = -reach if shown.signed else float(np.nanmin(values))
    plotter.add_mesh(
        mesh,
        scalars=shown.label,
        cmap=DIVERGING if shown.signed else SEQUENTIAL,
        clim=(least, reach if shown.signed else float(np.nanmax(values))),
        line_width=3,
        scalar_bar_args={"fmt": "%.3g", "title": shown.label},
        show_edges=shown.place == "cell",
    )
    return plotter


def plot_grid(grid: Grid) -> Figure:
    """The flat grid in plan: what is solved in the colours of its families, its mirror images pale."""
    lines = grid.flat[np.column_stack((grid.start, grid.end))]
    figure = new_figure(*HALF)
    axes = plan_axes(figure, points=np.column_stack((grid.flat, np.zeros(grid.nodes))), rim=None)
    width = min(1.2, 0.6 * wire_width(axes, min(grid.step)))
    images = ((-1, 1), (1, -1), (-1, -1)) if grid.quarter else ()
    for image in images:
        axes.add_collection(LineCollection(list(lines * image), colors=PALE, linewidths=width))
    for family, colour in enumerate((ACCENT, PUNCH)):
        axes.add_collection(LineCollection(list(lines[grid.family == family]), colors=colour, linewidths=width))
    pale = " of a quarter; pale: its mirror images" if grid.quarter else ""
    title = f"{grid.nodes} nodes, {grid.elements} wire pieces{pale}"
    axes.set_title(title, fontsize=9.0, loc="left", y=1.0)
    return figure


def plot_shell(shell: Shell) -> Figure:
    """The rods of a gridshell, seen from the side and above."""
    return draw_wires_of(shell.formed.whole)


def plot_drape(drape: Drape) -> Figure:
    """The net on its surface, seen from the side and above."""
    return draw_shape_of(drape.formed.whole)


def draw_shape_of(whole: Whole) -> Figure:
    """A grid seen from the side and above; its wires alone where it has no cells, or nodes without a place."""
    return draw_whole(whole) if len(whole.cells) and np.isfinite(whole.positions).all() else draw_wires_of(whole)


def html_of_run(run: Run) -> str:
    """A table of a run with its verdict, and its last shape; of what a later press has undone it says nothing."""
    left = told(run)
    formed, accuracy = left.formed, left.accuracy
    rows = {
        "outcome": formed.outcome.value,
        "grid": f"{formed.whole.crossings} crossings, {len(formed.whole.family)} wire pieces",
        "energy in the tool": energy(formed.energy),
        "largest shear": size(math.degrees(formed.max_shear), "°", 3),
        f"largest {strain(yields=formed.hardening is not None).label}": percent(formed.max_axial_strain),
    }
    stress = largest(formed.whole.stress)
    if stress is not None:
        rows["largest stress"] = size(stress, "MPa")
    if left.released is not None:
        apex, lowest = size(left.released.apex, "mm", 3), size(left.released.max_sag, "mm", 3)
        rows["springback"] = f"{apex} at the apex, {lowest} where it sinks most"
    if left.loaded is not None:
        rows["under load"] = f"{size(left.loaded.rms_deflection, 'mm', 3)} rms deflection"
    if accuracy is not None:
        rows["accuracy"] = judgement(accuracy)
    notes = all_notes(run)
    if notes:
        rows["notes"] = f"{len(notes)}; the first: {notes[0]}"
    good = None if accuracy is None else accuracy.within
    return _card(run.case.title or "Formed grid", rows, good, draw_shape_of(run.final.whole))


def html_of_grid(grid: Grid) -> str:
    """A table of a flat grid, and its plan."""
    rows = {
        "step": " × ".join(size(step, "mm") for step in dict.fromkeys(grid.step)),
        "solved": f"{grid.nodes} nodes, {grid.elements} wire pieces" + (", a quarter" if grid.quarter else ", all"),
        "cut": f"{grid.subdivide} pieces between two crossings" if grid.subdivide > 1 else "",
        "notes": "; ".join(grid.notes),
    }
    return _card("Flat grid", {name: words for name, words in rows.items() if words}, None, plot_grid(grid))


def html_of_shell(shell: Shell) -> str:
    """A table of a gridshell, and its rods."""
    formed = shell.formed
    rows = {
        "outcome": formed.outcome.value,
        "grid": f"{formed.whole.crossings} crossings and ends, {len(shell.ends)} ends held",
        "energy": energy(formed.energy),
        "height": size(formed.height, "mm"),
        "largest reaction": size(float(np.linalg.norm(formed.reactions, axis=1).max()), "N"),
    }
    return _card(shell.case.title or "Gridshell", rows, None, plot_shell(shell))


def html_of_drape(drape: Drape) -> str:
    """A table of a net, and its shape."""
    net = drape.net
    good = bool(net.complete and not net.locked.any())
    shear, limit = (size(math.degrees(angle), "°", 3) for angle in (net.max_shear, net.limit))
    rows = {
        "net": "complete, and locks nowhere" if good else "locks, or ends before the blank does",
        "largest shear": f"{shear}; locks at {limit}",
        "draw-in": size(drape.draw_in, "mm", 3),
    }
    if drape.notes:
        rows["notes"] = f"{len(drape.notes)}; the first: {drape.notes[0]}"
    return _card(drape.case.title or "Net", rows, good, plot_drape(drape))


def _upwards(values: Floats) -> Normalize:
    """A scale from zero, or from what is below it, to the largest value."""
    least, most = min(float(values.min(initial=0.0)), 0.0), float(values.max(initial=0.0))
    return Normalize(least, most if most > least else least + 1.0)


def _drawn(run: Run, whole: Whole, shown: Field, width: float) -> tuple[Any, Any, float]:
    """Outlines, values and line width [pt] of what is known of a field."""
    known = np.isfinite(shown.values)
    if shown.place == "cell":
        return whole.positions[whole.cells[known]][:, :, :2], shown.values[known], 0.3
    if shown.place == "wire":
        ends = np.column_stack((whole.start, whole.end))[known]
        return whole.positions[ends][:, :, :2], shown.values[known], 0.6 * width
    known &= whole.between == 0
    return squares(whole.positions[known], run.case.grid.step), shown.values[known], 0.0


def _placed(whole: Whole, shown: Field) -> tuple[Whole, Floats]:
    """The part of a grid whose nodes have a place, and the values of a field there."""
    nodes: Bools = np.asarray(np.isfinite(whole.positions).all(axis=1))
    kept = {
        "node": nodes,
        "wire": nodes[whole.start] & nodes[whole.end],
        "cell": nodes[whole.cells].all(axis=1),
    }
    return part_of(whole, nodes), shown.values[kept[shown.place]]


def _card(title: str, rows: Lines, good: bool | None, figure: Figure) -> str:
    """A table beside a figure. Its text has the colour of the notebook, dark or light; the figure brings its paper."""
    verdict = {None: "", True: "✔ ", False: "✘ "}[good]
    lines = "".join(
        f'<tr><th style="text-align:left;padding-right:1em">{escape(name)}</th>'
        f'<td style="text-align:left">{escape(words)}</td></tr>'
        for name, words in rows.items()
    )
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start">'
        f'<table><caption style="text-align:left;font-weight:bold">{verdict}{escape(title)}</caption>'
        f"<tbody>{lines}</tbody></table>"
        f'<img alt="{escape(title)}" style="max-width:100%;background:white" src="{_embedded(figure)}"/></div>'
    )


def _embedded(figure: Figure) -> str:
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=SMALL)
    return "data:image/png;base64," + base64.b64encode(picture.getvalue()).decode("ascii")
