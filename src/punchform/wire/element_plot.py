"""The wire and its six deflections under the unit loads at its end: the paper's "graphic part"."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from punchform.arrays import Floats
from punchform.wire.centreline import Centreline
from punchform.wire.element import Element
from punchform.wire.flexibility import deflections

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLES = (
    "unit force along the wire",
    "unit force sideways in the surface",
    "unit force along the normal",
    "unit moment about the wire: twist",
    "unit moment that bends it up or down",
    "unit moment that bends it sideways",
)

MEMBER_GREY = (0.72, 0.72, 0.72)
MEMBER_BLUE = (0.16, 0.47, 0.71)
LOAD_COLOUR = "#c0392b"

AROUND = 32
"""Facets around the drawn wire; every fourth line along it is dark, so that twist can be seen."""

EYE = (np.radians(8.0), np.radians(27.0))
"""Where the eye is: turned from the wire's side towards its end A, and lifted above the surface."""

LIGHT = np.array([-0.25, -0.55, 0.80])
"""Where the light comes from."""

ROOM = (-0.08, 1.24, -0.32, 0.42)
"""Left, right, bottom and top of a panel, as parts of the step."""


def plot_element(element: Element, path: str | Path) -> None:
    """Draw the wire at rest and under each of the six unit loads into an image file.

    The format follows the suffix of `path` (png, svg, pdf). Displacements come from the unit-load
    integrals of Eq. (2.4), point by point; of an element given as a matrix only the motion of the end
    is known, and the wire is drawn as the smooth curve that fits its two ends. O is held, A is loaded.
    """
    from matplotlib.figure import Figure

    line, motions = drawn_line(element)
    radius = 0.5 * (element.section.diameter if element.section else 0.1 * element.length)
    figure = Figure(figsize=(11, 8.6), layout="constrained")
    figure.suptitle(_caption(element), fontsize=11)
    grid = figure.subplots(3, 2)
    # Loads that stay in the plane of the crimp on the left, those that leave it on the right.
    for axes, load in zip(grid.flat, (0, 1, 2, 5, 4, 3), strict=True):
        _panel(axes, line, motions[:, :, load], load, radius)
    figure.savefig(path, dpi=130)


def _caption(element: Element) -> str:
    lines = [
        f"One wire between two crossings, step {element.length:.4g} mm, height {element.height:.4g} mm",
        "grey: at rest; blue: end O held, unit load at end A, motion enlarged as said below each picture",
    ]
    if element.centreline is None:
        lines.append("the stiffness was given as a matrix: the curve between the ends is only a sketch")
    return "\n".join(lines)


def drawn_line(element: Element) -> tuple[Floats, Floats]:
    """Points (k, 3) of the line to draw and their motions under the unit loads (k, 6, 6)."""
    if element.section is None or element.centreline is None:
        return _between_ends(element)
    line = element.centreline
    if len(line.lengths) == 1:
        line = Centreline(np.linspace(line.points[0], line.points[1], 33))
    keep = np.unique(np.linspace(0, len(line.lengths), 65).round().astype(np.int64))
    motions = deflections(line, element.section)[keep]
    return line.points[keep], motions


def _between_ends(element: Element) -> tuple[Floats, Floats]:
    """The cubic through both ends, at rest and under each unit load, by its end values and slopes."""
    t = np.linspace(0.0, 1.0, 49)
    rise = t**2 * (3 - 2 * t)
    slope = t**2 * (t - 1) * element.length
    line = np.column_stack([element.length * t, 0 * t, element.height * rise])
    B = element.B
    motions = rise[:, None, None] * B
    motions[:, 0] = np.outer(t, B[0])
    motions[:, 1] += np.outer(slope, B[5])
    motions[:, 2] -= np.outer(slope, B[4])
    motions[:, 3:] = t[:, None, None] * B[3:]
    return line, motions


def _panel(axes: Axes, line: Floats, motion: Floats, load: int, radius: float) -> None:
    """One unit load: the wire at rest, the wire deflected, the load, and the scale below."""
    scale = enlargement(line, motion)
    moved = line + scale * motion[:, :3]
    turn = _rotations(scale * motion[:, 3:])
    rings = _rings(line, radius)
    _draw_tube(axes, line, rings, MEMBER_GREY, level=1)
    _draw_tube(axes, moved, rings @ turn.transpose(0, 2, 1), MEMBER_BLUE, level=2)
    # The rest of the wire may hide behind the deflected one: keep the outline of its end in sight.
    end = (line[-1] + rings[-1]) @ _view().T
    axes.plot(end[:, 0], end[:, 1], color="0.45", lw=0.8, ls="--", zorder=3)
    _draw_load(axes, moved[-1], load, 0.16 * float(line[-1, 0]))
    size = float(np.linalg.norm(motion[-1, :3]))
    angle = float(np.degrees(np.linalg.norm(motion[-1, 3:])))
    unit = "1 N" if load < 3 else "1 N mm"
    axes.set_title(f"{TITLES[load]} ({unit})", fontsize=10, fontweight="bold")
    axes.text(
        0.5,
        -0.02,
        f"A moves {size:.3g} mm and turns {angle:.3g}°; drawn × {scale:,.10g}",
        transform=axes.transAxes,
        ha="center",
        va="top",
        fontsize=9,
    )
    _name_ends(axes, line, moved, radius)
    axes.set_aspect("equal")
    axes.set_axis_off()
    left, right, bottom, top = (side * float(line[-1, 0]) for side in ROOM)
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)


def _view() -> Floats:
    """Rows: the picture's right, its up, and the way towards the eye, (3, 3) orthogonal."""
    turn, lift = EYE
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    ahead = np.array([-np.sin(turn), np.cos(turn), 0.0])
    high = np.array([0.0, 0.0, 1.0])
    return np.stack([right, np.sin(lift) * ahead + np.cos(lift) * high, np.sin(lift) * high - np.cos(lift) * ahead])


def _name_ends(axes: Axes, line: Floats, moved: Floats, radius: float) -> None:
    """O beside its end, A beside the end at rest, on the side that the deflected wire leaves free."""
    view = _view()
    start, rest, gone = (view @ point for point in (line[0], line[-1], moved[-1]))
    side = -1.0 if gone[1] >= rest[1] else 1.0
    style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 10, "color": "0.25"}
    axes.text(start[0] - 1.3 * radius, start[1], "O", **style)
    axes.text(rest[0] - 1.6 * radius, rest[1] + 1.7 * side * radius, "A", **style)


def enlargement(line: Floats, motion: Floats) -> float:
    """How many times a motion is drawn enlarged: 1, 1.5, 2, 3, 5 or 7 times a power of ten.

    The drawn displacement stays within a fifth of the step, the drawn rotation within 90 degrees.
    """
    s = float(line[-1, 0])
    most = min(
        0.2 * s / max(float(np.linalg.norm(motion[:, :3], axis=1).max()), 1e-300),
        np.radians(90) / max(float(np.linalg.norm(motion[:, 3:], axis=1).max()), 1e-300),
    )
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(step for step in (1.0, 1.5, 2.0, 3.0, 5.0, 7.0) if step * power <= most * (1 + 1e-12)) * power)


def _rotations(vectors: Floats) -> Floats:
    """Rotation matrices (k, 3, 3) of rotation vectors (k, 3): the rings must not swell as they turn."""
    angle = np.linalg.norm(vectors, axis=1)
    axis = vectors / np.maximum(angle, 1e-300)[:, None]
    spin = np.cross(np.eye(3), axis[:, None, :])
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    turned: Floats = np.eye(3) + sine * spin + (1 - cosine) * (spin @ spin)
    return turned


def _rings(line: Floats, radius: float) -> Floats:
    """Circles of the wire's surface about each point of the line, (k, AROUND + 1, 3)."""
    tangent = np.gradient(line, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    side = np.cross(np.array([0.0, 0.0, 1.0]), tangent)
    side /= np.linalg.norm(side, axis=1)[:, None]
    up = np.cross(tangent, side)
    angle = np.linspace(0, 2 * np.pi, AROUND + 1)
    circle: Floats = np.cos(angle)[None, :, None] * side[:, None, :] + np.sin(angle)[None, :, None] * up[:, None, :]
    return radius * circle


def _draw_tube(axes: Axes, line: Floats, rings: Floats, colour: tuple[float, ...], *, level: int) -> None:
    """The wire as shaded facets, far ones first."""
    from matplotlib.collections import PolyCollection

    view = _view()
    surface = (line[:, None, :] + rings) @ view.T
    corners = np.stack([surface[:-1, :-1], surface[1:, :-1], surface[1:, 1:], surface[:-1, 1:]], axis=2)
    facets = corners.reshape(-1, 4, 3)
    outward = (rings[:-1, :-1] + rings[1:, 1:]).reshape(-1, 3)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    light = 0.5 + 0.5 * np.clip(outward @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    stripe = np.tile(np.where(np.arange(AROUND) % 4 == 1, 0.6, 1.0), len(line) - 1)
    shade = np.array(colour) * (light * stripe)[:, None]
    facing = np.flatnonzero(outward @ view[2] > -0.05)
    order = facing[np.argsort(facets[facing, :, 2].mean(axis=1))]
    style = {"facecolors": shade[order], "edgecolors": shade[order], "linewidths": 0.3, "zorder": level}
    axes.add_collection(PolyCollection(list(facets[order, :, :2]), **style))
    face = tuple(0.5 + 0.5 * channel for channel in colour)
    edge = tuple(0.6 * channel for channel in colour)
    cap = [surface[-1, :, :2]]
    axes.add_collection(PolyCollection(cap, facecolors=face, edgecolors=edge, linewidths=0.8, zorder=level))


def _draw_load(axes: Axes, tip: Floats, load: int, size: float) -> None:
    """A red arrow for a force, a red arc about its axis for a moment, both at A."""
    style: dict[str, Any] = {"arrowstyle": "-|>", "color": LOAD_COLOUR, "lw": 2, "mutation_scale": 14}
    axis, view = np.eye(3)[load % 3], _view()
    if load < 3:
        start, end = (view @ tip)[:2], (view @ (tip + 1.2 * size * axis))[:2]
        axes.annotate("", xy=tuple(end), xytext=tuple(start), arrowprops=style, annotation_clip=False, zorder=5)
        return
    first, second = np.eye(3)[(load + 1) % 3], np.eye(3)[(load + 2) % 3]
    angle = np.linspace(np.radians(-140), np.radians(140), 60)[:, None]
    arc = (tip + 0.7 * size * (np.cos(angle) * first + np.sin(angle) * second)) @ view.T
    axes.plot(arc[:-3, 0], arc[:-3, 1], color=LOAD_COLOUR, lw=2, clip_on=False, zorder=5)
    axes.annotate(
        "",
        xy=tuple(arc[-1, :2]),
        xytext=tuple(arc[-6, :2]),
        arrowprops=style,
        annotation_clip=False,
        zorder=5,
    )
