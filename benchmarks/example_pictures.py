"""The pictures of docs/examples/: every packaged example, run, and drawn with what matters in it as colour.

    python benchmarks/example_pictures.py [--only NAME ...] [--write docs/examples/images]

A picture for each example, which the gallery shows small, and two curves that hold a run against a closed form.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from PIL import Image
from scipy.integrate import solve_ivp

from punchform import Run, read_case, run
from punchform.arrays import Bools, Floats, Ints
from punchform.case import ConeProfile
from punchform.punch import surface, uncorrected
from punchform.whole import Whole

AZIMUTH, ELEVATION = math.radians(-62.0), math.radians(33.0)
EYE = np.array([math.cos(ELEVATION) * math.cos(AZIMUTH), math.cos(ELEVATION) * math.sin(AZIMUTH), math.sin(ELEVATION)])
RIGHT = np.array([-math.sin(AZIMUTH), math.cos(AZIMUTH), 0.0])
UP = np.cross(EYE, RIGHT)
WIRES_ACROSS = 45
INK, UNKNOWN = "#26323d", "#d9dde1"
WIDTH, HEIGHT, DOTS = 5.6, 3.5, 110
"""Of a picture [inch], and dots per inch."""
HEMISPHERE, EQUATOR = 100.0, 0.98050675
"""Radius of the packaged hemisphere [mm]; threads over the radius from the pole to the equator along the bias."""
NEAR_NIL = 1e-9
COLOURS = 128
SMALL = (236, 180)
"""Of a picture in the gallery [pixels]."""


@dataclass(frozen=True)
class Picture:
    """What is drawn of an example: released or formed, the colour of its cells (K,), and what the colour tells.

    centre: of a diverging scale, None for one that goes up; least: where that begins, the least value when None."""

    colour: Callable[[Run], Floats]
    told: str
    released: bool = True
    centre: float | None = None
    least: float | None = 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=sorted(PICTURES), default=sorted(PICTURES))
    parser.add_argument("--write", type=Path, default=Path("docs/examples/images"))
    asked = parser.parse_args()
    asked.write.mkdir(parents=True, exist_ok=True)
    for name in asked.only:
        done = run(read_case(f"packaged:{name}"))
        _save(drawn(done, PICTURES[name]), asked.write / f"{name}.png", small=asked.write / f"{name}_small.png")
        if name in CURVES:
            _save(CURVES[name](done), asked.write / f"{name}_curve.png")


def drawn(done: Run, picture: Picture) -> Figure:
    """The grid in parallel projection, far cells first, with every few wires and a colour bar."""
    assert done.released is not None or not picture.released
    whole = done.released.whole if picture.released and done.released is not None else done.formed.whole
    values = picture.colour(done)
    known = np.isfinite(values)
    order = np.argsort((whole.positions[whole.cells] @ EYE).mean(axis=1))
    figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DOTS)
    axes = figure.add_axes((0.01, 0.01, 0.80, 0.98))
    plane = np.stack((whole.positions @ RIGHT, whole.positions @ UP), axis=-1)
    scale = _scale(values[known], picture)
    shown = PolyCollection(
        plane[whole.cells[order]],
        cmap=colormaps["cividis" if picture.centre is None else "RdBu_r"].with_extremes(bad=UNKNOWN),
        norm=scale,
        linewidths=0.2,
        edgecolors="face",
        zorder=1,
    )
    shown.set_array(np.where(known, values, np.nan)[order])
    axes.add_collection(shown)
    towards = (whole.normals @ EYE > 0.0)[whole.start]
    pieces = _some_wires(whole) & towards
    ends = np.stack((plane[whole.start[pieces]], plane[whole.end[pieces]]), axis=1)
    axes.add_collection(LineCollection(list(ends), colors=INK, linewidths=0.35, alpha=0.75, zorder=2))
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()
    bar = figure.colorbar(shown, cax=figure.add_axes((0.845, 0.14, 0.022, 0.72)))
    bar.set_label(picture.told, fontsize=9, color=INK)
    bar.ax.tick_params(labelsize=8, colors=INK)
    return figure


def _scale(values: Floats, picture: Picture) -> Normalize:
    if picture.centre is None:
        return Normalize(float(values.min()) if picture.least is None else picture.least, float(values.max()))
    far = float(np.abs(values - picture.centre).max())
    return Normalize(picture.centre - far, picture.centre + far)


def _some_wires(whole: Whole) -> Bools:
    number = np.where(whole.family == 1, whole.index[whole.start, 1], whole.index[whole.start, 0])
    every = -(-(int(np.ptp(whole.index, axis=0).max()) + 1) // WIRES_ACROSS)
    return np.asarray(number % every == 0)


def shear(done: Run) -> Floats:
    """Shear of the formed cells without its sign [deg]."""
    return np.degrees(np.abs(done.formed.whole.cell_shear))


def deviation(done: Run) -> Floats:
    """The judged deviation of the cells inside the aperture [mm], NaN outside."""
    found = done.accuracy
    assert found is not None
    aligned = found.as_held if found.judge.alignment == "as held" else found.fitted
    at = np.where(found.mask, aligned.deviations.of(found.judge.measure), np.nan)
    return np.asarray(at[done.final.whole.cells].mean(axis=1))


def plastic(done: Run) -> Floats:
    """Plastic strain of the wires around each cell, their mean [%]."""
    return 100.0 * _of_wires(done.final.whole, done.final.whole.plastic_strain)


def opening(done: Run) -> Floats:
    """The longer side of a cell without its wires: what passes through it [mm]."""
    whole, wire = done.final.whole, done.case.wire.diameter
    corners = whole.positions[whole.cells]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    thickness = wire / np.sqrt(_of_wires(whole, whole.stretch))
    return np.asarray(sides.max(axis=1) - thickness)


def height_field(done: Run) -> Floats:
    """How far the formed cells lie from the round dish under the height field [mm]."""
    middle = done.formed.whole.positions[done.formed.whole.cells].mean(axis=1)[:, :2]
    tool = done.case.tool
    return np.asarray(surface(tool).height(middle) - uncorrected(tool).height(middle))


def _of_wires(whole: Whole, values: Floats) -> Floats:
    """The mean over the wires at the corners of each cell, (K,)."""
    nodes = len(whole.index)
    total = np.bincount(whole.start, values, nodes) + np.bincount(whole.end, values, nodes)
    count = np.bincount(whole.start, minlength=nodes) + np.bincount(whole.end, minlength=nodes)
    return np.asarray((total / np.maximum(count, 1))[whole.cells].mean(axis=1))


def hemisphere_curve(done: Run) -> Figure:
    """Shear along the bias against Eq. (6.4)."""
    whole = done.formed.whole
    along, angle = along_bias(whole)
    u = np.linspace(0.0, EQUATOR * HEMISPHERE, 200)
    figure = _curve("thread length from the middle along both families [mm]")
    axes = figure.axes[0]
    axes.plot(u, net_on_sphere(u / HEMISPHERE), color=INK, linewidth=1.2, label="closed form, on the sphere")
    axes.plot(along, angle, "o", color="#c8553d", markersize=4, label="cells of the pressed fabric on the bias")
    axes.axvline(EQUATOR * HEMISPHERE, color="#8a949e", linewidth=0.8, linestyle="--")
    axes.text(EQUATOR * HEMISPHERE + 1.0, 4.0, "equator", fontsize=8, color="#5a646e")
    axes.legend(fontsize=8, frameon=False, loc="upper left")
    return figure


def cone_curve(done: Run) -> Figure:
    """Shear along the bias against that of the sphere of the nose and of the cone that develops."""
    whole, profile = done.formed.whole, done.case.tool.profile
    assert isinstance(profile, ConeProfile)
    angle = along_bias(whole)[1]
    middles = np.linalg.norm(_bias(whole)[0][:, :2], axis=1)
    figure = _curve("distance from the axis along the bias [mm]")
    axes = figure.axes[0]
    nose = profile.nose_radius * math.cos(profile.half_angle)
    wall = 90.0 * (1.0 - math.sin(profile.half_angle))
    axes.plot((nose, done.case.tool.rim_radius), (wall, wall), color=INK, linewidth=1.2, label="cone without a nose")
    axes.plot(middles, angle, "o", color="#c8553d", markersize=4, label="cells of the pressed mesh on the bias")
    axes.axvspan(0.0, nose, color="#e8ecef", zorder=0)
    axes.text(0.5 * nose, 0.5, "nose", fontsize=8, color="#5a646e", ha="center")
    axes.legend(fontsize=8, frameon=False, loc="lower right")
    return figure


def net_on_sphere(u: Floats) -> Floats:
    """Shear [deg] where u threads of either family have been laid from the middle, u (n,) in radii, Eq. (6.4)."""
    p = np.maximum(u * u, NEAR_NIL)
    found = solve_ivp(
        lambda t, y: (y[1], -(y[1] + math.sin(y[0])) / t),
        (NEAR_NIL, max(1.0, float(p.max()))),
        (0.5 * math.pi, -1.0),
        t_eval=p,
        rtol=1e-9,
        atol=1e-11,
    )
    return np.asarray(90.0 - np.degrees(found.y[0]))


def along_bias(whole: Whole) -> tuple[Floats, Floats]:
    """Flat distance of the middles from either thread through the axis (n,) [mm] and shear (n,) [deg] of the formed
    cells on the diagonal, from the axis outwards."""
    cells = _bias(whole)[1]
    return whole.flat[whole.cells[cells], 0].mean(axis=1), np.degrees(np.abs(whole.cell_shear[cells]))


def _bias(whole: Whole) -> tuple[Floats, Ints]:
    """Middles (n, 3) [mm] and numbers (n,) of the cells with corners (k, k) and (k + 1, k + 1), k from 0 on."""
    low = whole.index[whole.cells].min(axis=1)
    cells = np.flatnonzero((low[:, 0] == low[:, 1]) & (low[:, 0] >= 0))
    cells = cells[np.argsort(low[cells, 0])]
    return whole.positions[whole.cells[cells]].mean(axis=1), cells


def _curve(across: str) -> Figure:
    figure = Figure(figsize=(WIDTH, 3.2), dpi=DOTS)
    axes = figure.add_axes((0.11, 0.16, 0.86, 0.80))
    axes.set_xlabel(across, fontsize=9)
    axes.set_ylabel("shear [deg]", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def _save(figure: Figure, file: Path, *, small: Path | None = None) -> None:
    """Write a picture with few colours, which makes it a quarter as large; and once more for the gallery."""
    drawn = BytesIO()
    figure.savefig(drawn, format="png")
    image = Image.open(drawn).convert("RGB")
    _few_colours(image).save(file, optimize=True)
    if small is not None:
        without_scale = image.crop((0, 0, int(0.82 * image.width), image.height))
        _few_colours(without_scale.resize(SMALL, Image.Resampling.LANCZOS)).save(small, optimize=True)


def _few_colours(image: Image.Image) -> Image.Image:
    return image.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)


PICTURES = {
    "check": Picture(deviation, "normal deviation, released [mm]", centre=0.0),
    "dish600": Picture(plastic, "plastic strain [%]"),
    "dish1200": Picture(deviation, "half-path deviation\nafter the best fit [mm]", centre=0.0),
    "hemisphere": Picture(shear, "shear [deg]", released=False),
    "cone": Picture(shear, "shear [deg]", released=False),
    "offset": Picture(height_field, "height field under the mesh [mm]", released=False, centre=0.0),
    "mask": Picture(opening, "opening [mm]", least=None),
}
CURVES = {"hemisphere": hemisphere_curve, "cone": cone_curve}


if __name__ == "__main__":
    main()
