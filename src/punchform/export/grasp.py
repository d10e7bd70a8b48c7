"""GRASP files of a dish: surfaces on a regular grid (.sfc), the rim (.rim), and the objects that name them (.tor).

GRASP reads a reflector in the frame of its vertex, whose z axis points to the focus. Here it hangs below the apex::

    x' = x,   y' = -y,   z' = apex - z        (a half turn about x: the wires' x axis stays)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy import Pose, Target
from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.export.heading import Heading, heading
from punchform.export.shapes import shapes
from punchform.export.smooth_heights import heights
from punchform.prepare import prepare

if TYPE_CHECKING:
    from punchform.run import Run

FINER = 2.0
"""How many times finer than the wires the grid of a surface is."""
ROUGH = 0.1
"""Crossings this far from the heights that are written, as a part of the step, are not what they show."""
NEAR = 1e-3
"""The part of the radius from the rim inwards that tells how a surface ends there."""
SHOWN = ("formed", "released")
"""Shapes of which there is a surface."""
CORNERS = 360
"""Points of the rim."""
RIM, OBJECTS = "dish.rim", "dish.tor"
FLIP = np.array([1.0, -1.0, -1.0])
FRAME = "vertex frame: x along the first wires, z from the apex to the focus, y' = -y and z' = apex - z of the punch"


@dataclass(frozen=True)
class Surface:
    """Heights z (n, n) [mm] over the square |x|, |y| <= radius [mm], rows along x, in the vertex frame.

    missed: the largest distance along z of a crossing within the radius from the cubic spline through them [mm].
    """

    name: str
    z: Floats
    radius: float
    missed: float = 0.0

    @property
    def file(self) -> str:
        """The name of its file."""
        return f"{self.name}.sfc"


def write_grasp(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write the formed surface, the released one and the target of a run, those that there are, with rim and objects.

    The rim is the aperture of the target, or that of the punch. Raises InputError for a rim without enough crossings
    or with a steep edge, OSError.
    """
    target = None if run.accuracy is None else run.accuracy.target
    found = surfaces(run, target)
    texts = {one.file: sfc(_head(run, one), one) for one in found}
    texts[RIM] = rim(_words(heading(run, "rim of the dish")), found[0].radius)
    pose = None if run.accuracy is None else run.accuracy.fitted.fit.pose
    texts[OBJECTS] = objects(heading(run, "reflectors for GRASP"), [(one.name, one.file) for one in found], pose)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    return tuple(folder / name for name in texts)


def surfaces(run: Run, target: Target | None) -> list[Surface]:
    """The surfaces of a run in the vertex frame. Raises InputError for one too steep, or with few crossings."""
    radius = run.case.tool.rim_radius if run.case.target is None else run.case.target.aperture_radius
    apex = prepare(run.case).punch.height_at_axis if target is None else target.apex_height
    step = max(run.case.grid.step)
    count = 2 * int(np.ceil(FINER * radius / step)) + 1
    line = np.linspace(-radius, radius, count)
    x, y = np.meshgrid(line, line, indexing="ij")
    places = np.column_stack((x.ravel(), y.ravel()))
    found = []
    for name, stage in shapes(run).items():
        if name not in SHOWN:
            continue
        whole = stage.whole
        points = (whole.positions[whole.between == 0] - (0.0, 0.0, apex)) * FLIP
        inside = points[np.linalg.norm(points[:, :2], axis=1) <= radius]
        if len(inside) < 9:
            raise InputError.of(
                f"the {name} grid has {len(inside)} crossings within the rim of {radius:g} mm, too few for a surface",
                where="grasp",
            )
        z = heights(points, places, radius=radius, step=step).reshape(count, count)
        found.append(Surface(name, z, radius, _missed(line, z, inside)))
        if found[-1].missed > ROUGH * step:
            raise InputError.of(
                f"the {name} grid is too steep or too rough for heights over x and y within {radius:g} mm: they miss "
                f"crossings by {found[-1].missed:.2g} mm",
                where="grasp",
                hint="give the case a [target] with a smaller aperture_radius",
            )
    if target is not None:
        shape = target.shape(target.pose)
        below = shape.height_at_axis - _wherever(shape.height, places * FLIP[:2], radius)
        found.append(Surface("target", below.reshape(count, count), radius))
    return found


def _wherever(height: Callable[[Floats], Floats], places: Floats, radius: float) -> Floats:
    """Heights (n,) at places (n, 2); beyond the rim, where a surface may have none, straight on as it ends there.

    The corners of a grid want a number, though no reflector reaches them.
    """
    found = height(places)
    gone = ~np.isfinite(found)
    away = np.linalg.norm(places[gone], axis=1)
    outwards = places[gone] / away[:, None]
    edge, before = (height(share * radius * outwards) for share in (1.0, 1.0 - NEAR))
    found[gone] = edge + (edge - before) * (away / radius - 1.0) / NEAR
    return found


def sfc(head: str, surface: Surface) -> str:
    """The text of a .sfc file: a line of words, the corners xs ys xe ye, nx ny, then the heights, y fastest."""
    r, (nx, ny) = surface.radius, surface.z.shape
    rows = [head, f"{-r:.9g} {-r:.9g} {r:.9g} {r:.9g}", f"{nx} {ny}"]
    rows += [" ".join(f"{z:.7f}" for z in row) for row in (np.round(surface.z, 7) + 0.0).tolist()]
    return "\n".join(rows) + "\n"


def rim(head: str, radius: float) -> str:
    """The text of a .rim file: a line of words, how many points, then x y of each, counter-clockwise."""
    angles = 2 * np.pi * np.arange(CORNERS) / CORNERS
    points = np.round(radius * np.column_stack((np.cos(angles), np.sin(angles))), 7) + 0.0
    return "\n".join([head, f"{CORNERS}", *(f"{x:.7f} {y:.7f}" for x, y in points.tolist())]) + "\n"


def objects(head: Heading, named: Sequence[tuple[str, str]], pose: Pose | None) -> str:
    """The text of the .tor file: frames, rim, and a surface and a reflector for each (name, file).

    pose: of the best fit, which becomes a frame of its own with the focus on its z axis.
    """
    parts = [_object("vertex_frame", "coor_sys", {})]
    if pose is not None:
        origin, turn = pose.shift * FLIP, pose.rotation * FLIP[:, None]
        frame = {
            "origin": _struct(origin, " mm"),
            "x_axis": _struct(turn[:, 0]),
            "y_axis": _struct(-turn[:, 1]),
            "base": "ref(vertex_frame)",
        }
        told = f"{head.title}: the best fit of the last shape"
        focus = "" if pose.f is None else f"; its focus lies at z = {pose.f:.6f} mm"
        parts.append(f"// {told}{focus}\n" + _object("fitted_frame", "coor_sys", frame))
    edge = {"file_name": RIM, "unit": "mm", "number_of_points": str(CORNERS)}
    parts.append(_object("dish_rim", "tabulated_rim_xy", edge))
    for name, file in named:
        place = {"file_name": file, "xy_unit": "mm", "z_unit": "mm"}
        parts.append(_object(f"{name}_surface", "regular_xy_grid", place))
        surfaces = f"sequence(ref({name}_surface))"
        members = {"coor_sys": "ref(vertex_frame)", "surfaces": surfaces, "rim": "ref(dish_rim)"}
        parts.append(_object(f"{name}_reflector", "reflector", members))
    return "\n".join((*(f"// {line}" for line in (*head.lines[:2], FRAME, head.version)), "", *parts))


def _head(run: Run, surface: Surface) -> str:
    """The one line that a surface has for words."""
    met = "" if surface.name == "target" else f"; crossings within {surface.missed:.2g} mm of its spline"
    return _words(heading(run, f"{surface.name} surface"), met)


def _words(head: Heading, more: str = "") -> str:
    """A heading in one line."""
    return f"{head.first}; mm; {FRAME}{more}; {head.version}"


def _object(name: str, kind: str, members: dict[str, str]) -> str:
    width = max(map(len, members), default=0)
    body = ",\n".join(f"  {member:<{width}} : {value}" for member, value in members.items())
    return f"{name}  {kind}\n(\n{body}{chr(10) if body else ''})\n"


def _struct(values: Floats, unit: str = "") -> str:
    x, y, z = (np.round(values, 12) + 0.0).tolist()
    return f"struct(x: {x:.12g}{unit}, y: {y:.12g}{unit}, z: {z:.12g}{unit})"


def _missed(line: Floats, z: Floats, points: Floats) -> float:
    """How far the points (n, 3) lie from the cubic spline through the heights on a square grid [mm]."""
    from scipy.interpolate import RectBivariateSpline

    return float(np.abs(RectBivariateSpline(line, line, z).ev(points[:, 0], points[:, 1]) - points[:, 2]).max())
