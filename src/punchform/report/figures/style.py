"""How every figure looks: paper, ink, colour maps, plan axes, colour bars.

Figures are built on the object-oriented interface with the Agg canvas: no pyplot, no global settings changed.
Colour maps of sizes go from light to dark in even steps to the eye, so they survive colour blindness and a grey print;
those with a sign part at zero into two hues that colour-blind readers tell apart.
"""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap, FuncNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.ticker import FuncFormatter

from punchform.arrays import Floats

Place = tuple[float, float, float, float]
Colours = str | Colormap

DPI = 150
HALF = (4.8, 4.0)
PLAN, PLAN_BAR = (0.138, 0.115, 0.69, 0.855), (0.842, 0.165, 0.028, 0.755)
INK, SOFT, PALE, PAPER = "#1d2733", "#6b7785", "#d8dde3", "#f1f3f5"
PUNCH, ACCENT = "#b4491f", "#1f5f99"
SEQUENTIAL, DIVERGING, RELIEF = "viridis_r", "RdBu_r", "cividis"
TEXT = 9.0
DENSE = 3.5
"""Wires that lie less far apart [pt] are drawn touching."""


class Drawn(Figure):
    """A figure that notebooks show as it is, also where nothing has set up Matplotlib for them."""

    def _repr_png_(self) -> bytes:
        picture = BytesIO()
        self.savefig(picture, format="png")
        return picture.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """An empty white figure; width and height in inches."""
    figure = Drawn(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def dress(axes: Axes, *, x: str = "", y: str = "", title: str = "") -> None:
    """Labels and the common look of axes: thin grey frame, small figures."""
    axes.set_xlabel(x, fontsize=TEXT, color=INK)
    axes.set_ylabel(y, fontsize=TEXT, color=INK)
    # A given height keeps matplotlib from laying out all tick labels once more to place the title.
    axes.set_title(title, fontsize=TEXT + 1, color=INK, loc="left", y=1.0)
    axes.tick_params(labelsize=TEXT - 1, colors=SOFT, labelcolor=INK, width=0.6, length=3)
    for spine in axes.spines.values():
        spine.set_color(SOFT)
        spine.set_linewidth(0.6)


def plan_axes(figure: Figure, *, points: Floats, rim: float | None) -> Axes:
    """Axes seen from above, both in mm at the same scale, around points (n, 3), with the rim of a
    punch as a dashed circle."""
    axes = figure.add_axes(PLAN)
    reach = 1.04 * max(float(np.abs(points[:, :2]).max()), rim or 0.0)
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    if rim is not None:
        angle = np.linspace(0, 2 * np.pi, 181)
        axes.plot(rim * np.cos(angle), rim * np.sin(angle), "--", color=INK, linewidth=0.8, zorder=3)
    dress(axes, x="x [mm]", y="y [mm]")
    return axes


def in_colour(outlines: Floats, values: Floats, scale: Normalize, colours: Colours, width: float) -> PathCollection:
    """Lines (n, 2, 2) or cells (n, 4, 2) coloured by their values (n,); line width in points.

    Pieces of one shade (of 256) are one path, so the time hardly grows with their number. Right in plan
    views, where the order of drawing does not matter. Cells get edges of their own colour to close the seams.
    """
    corners = outlines.shape[1]
    filled = corners > 2
    shade = np.clip(np.nan_to_num(scale(values), nan=0.5) * 256, 0, 255).astype(np.int64)
    order = np.argsort(shade, kind="stable")
    shades, first = np.unique(shade[order], return_index=True)
    codes = [Path.MOVETO, *[Path.LINETO] * (corners - 1), *[Path.CLOSEPOLY] * filled]
    if filled:
        outlines = np.concatenate((outlines, outlines[:, :1]), axis=1)
    paths = [
        Path(piece.reshape(-1, 2), np.tile(np.array(codes, np.uint8), len(piece)))
        for piece in np.split(outlines[order], first[1:])
    ]
    inks = colormaps.get_cmap(colours)((shades + 0.5) / 256)
    return PathCollection(
        paths,
        facecolors=inks if filled else "none",
        edgecolors=inks,
        linewidths=width,
        capstyle="butt",
        zorder=2,
        rasterized=True,
    )


def points_per_mm(axes: Axes) -> float:
    """How many points (1/72 inch) of paper one millimetre of the plan takes."""
    low, high = axes.get_xlim()
    return float(axes.bbox.width) * 72 / DPI / (high - low)


def touching(axes: Axes, apart: float) -> bool:
    """Whether wires that lie so far apart [mm] are drawn without gaps, which would only make a moiré."""
    return apart * points_per_mm(axes) <= DENSE


def wire_width(axes: Axes, apart: float) -> float:
    """The width of lines [pt] for wires that lie so far apart [mm]."""
    points = apart * points_per_mm(axes)
    return 1.1 * points if touching(axes, apart) else min(0.75 * points, 2.5)


def squares(points: Floats, step: tuple[float, float]) -> Floats:
    """The squares (n, 4, 2) that belong to nodes (n, 3) of a grid; neighbours touch, so that no pattern of gaps
    appears."""
    half = 0.52 * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * step
    return np.asarray(points[:, None, :2] + half)


def colour_bar(figure: Figure, place: Place, scale: Normalize, colours: Colours, label: str) -> Axes:
    """A colour bar at `place` for a scale; returns its axes."""
    axes = figure.add_axes(place)
    bar: Any = figure.colorbar(ScalarMappable(scale, colours), cax=axes)
    bar.outline.set_linewidth(0.4)
    dress(axes, y=label)
    return axes


def force_bar(figure: Figure, scale: Normalize, label: str) -> None:
    """The colour bar of a plan of forces on the scale of `about_zero`, ticks where it has room."""
    most = round_down(float(scale.vmax or 1.0))
    axes = colour_bar(figure, PLAN_BAR, scale, DIVERGING, label)
    axes.set_yticks([sign * most / part for sign in (-1, 1) for part in (1, 5, 50)] + [0.0])
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−")))
    axes.minorticks_off()


def from_zero(values: Floats, reach: float | None = None) -> Normalize:
    """A scale from zero to the largest value, or to a given one that figures have in common."""
    return Normalize(0.0, reach or float(values.max(initial=0.0)) or 1.0)


def about_zero(values: Floats, reach: float | None = None) -> FuncNorm:
    """A scale symmetric about zero and with the root of the size.

    Forces at the rim are tens of times those elsewhere; on an even scale nothing else would be seen.
    reach: where it ends, when figures have it in common.
    """
    reach = reach or float(np.abs(values).max(initial=0.0)) or 1.0
    return FuncNorm((_signed_root, _signed_square), vmin=-reach, vmax=reach)


def even_about_zero(values: Floats, reach: float | None = None) -> Normalize:
    """An even scale symmetric about zero, to the largest size or to a given one that figures have in common."""
    reach = reach or float(np.abs(values).max(initial=0.0)) or 1.0
    return Normalize(-reach, reach)


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(part for part in (power, 2 * power, 5 * power) if part <= value))


def _signed_root(values: Floats) -> Floats:
    return np.sign(values) * np.sqrt(np.abs(values))


def _signed_square(values: Floats) -> Floats:
    return np.sign(values) * np.square(values)
