"""A punch as files for the workshop: tables, a drawing of its sections, and a solid. All lengths in mm."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.export.punch_drawing import drawing
from punchform.export.punch_mesh import punch_mesh, stl
from punchform.punch import Corrected, Tool, is_turned, points_needed, section, section_angles

PROFILE, FIELD, CORRECTION = "punch_profile.csv", "punch_height_field.csv", "correction.csv"
DRAWING, SOLID = "punch_profile.dxf", "punch.stl"
TOLERANCE = 0.02
"""How far facets may be from the punch [mm]."""
PLATE = 10.0
"""Thickness of the solid below its flange [mm]."""
EDGE = 1.1
"""How far the files reach when nothing is said, in radii of the rim."""
SECTION_TOLERANCE = 0.05
"""The same of sections, as a share of it: points of a line cost little."""
FIELD_STEPS = 60
"""Steps of the height field from the axis to the radius, at least."""
FRAME = "lengths in mm; x along the first wires, z upwards along the axis of the punch, z = 0 is its flange"


def write_punch(
    folder: Path,
    surface: Tool,
    *,
    radius: float,
    step: float | None = None,
    tolerance: float = TOLERANCE,
    plate: float = PLATE,
) -> tuple[Path, ...]:
    """Write the files of a punch into a folder that exists, and say which.

    radius [mm]: how far the files go, flange included; step [mm] of the height field, a round one when not given;
    tolerance [mm] of the facets, of which sections keep a twentieth; plate [mm]: thickness of the solid below the
    flange. The same punch gives the same bytes. Raises InputError for sizes that cannot be, OSError.
    """
    step = _round_step(radius) if step is None else step
    _refuse(surface, radius=radius, step=step, tolerance=tolerance, plate=plate)
    sections = _sections(surface, radius, SECTION_TOLERANCE * tolerance)
    texts = {PROFILE: profile_csv(sections), FIELD: field_csv(surface, radius=radius, step=step)}
    if isinstance(surface, Corrected):
        texts[CORRECTION] = correction_csv(surface)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    lines = {_layer(surface, degrees): line for degrees, line in sections.items()}
    (folder / DRAWING).write_bytes(drawing(lines))
    (folder / SOLID).write_bytes(stl(punch_mesh(surface, radius=radius, plate=plate, tolerance=tolerance)))
    return tuple(folder / name for name in (*texts, DRAWING, SOLID))


def profile_csv(sections: dict[float, Floats]) -> str:
    """The text of punch_profile.csv: heights z over rho, in the directions (degrees to x) of the sections."""
    first = next(iter(sections.values()))
    heights = [line[:, 1] for line in sections.values()]
    names = ["z"] if len(sections) == 1 else [f"z_{degrees:g}deg" for degrees in sections]
    told = "all around" if len(sections) == 1 else "in directions at so many degrees to x"
    return _table(
        f"heights of the punch over the distance rho from its axis, {told}", ["rho", *names], [first[:, 0], *heights]
    )


def field_csv(surface: Tool, *, radius: float, step: float) -> str:
    """The text of punch_height_field.csv: x, y, z on a square grid through the axis that covers the radius."""
    count = math.ceil(radius / step * (1 - 1e-9))
    places = step * np.arange(-count, count + 1)
    x, y = (part.ravel() for part in np.meshgrid(places, places, indexing="ij"))
    z = surface.height(np.column_stack((x, y)))
    return _table(f"heights of the punch every {step:g} mm", ["x", "y", "z"], [x, y, z])


def correction_csv(surface: Corrected) -> str:
    """The text of correction.csv: the points of the correction to the last digit, as a case can name the file."""
    kind = "radial" if is_turned(surface) else "field"
    columns = ["rho", "dz"] if is_turned(surface) else ["x", "y", "dz"]
    rows = [",".join(map(repr, row)) for row in (surface.correction.points + 0.0).tolist()]
    head = [
        f"# heights that are added to the profile; {FRAME}",
        f'# in a case file: [punch] correction = {{ kind = "{kind}", file = "{CORRECTION}" }}',
        ",".join(columns),
    ]
    return "\n".join((*head, *rows)) + "\n"


def _sections(surface: Tool, radius: float, tolerance: float) -> dict[float, Floats]:
    count = points_needed(surface, radius, tolerance)
    return {degrees: section(surface, degrees, count=count, radius=radius) for degrees in section_angles(surface)}


def _round_step(radius: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that cuts the radius [mm] into enough steps."""
    most = radius / FIELD_STEPS
    if not 0.0 < most < math.inf:
        return math.nan
    power = 10.0 ** math.floor(math.log10(most) + 1e-9)
    return power * max(first for first in (1, 2, 5) if first == 1 or first * power <= most * (1 + 1e-9))


def _layer(surface: Tool, degrees: float) -> str:
    """The layer of a section: names of layers hold no points."""
    return "PROFILE" if is_turned(surface) else f"SECTION_{degrees:g}".replace(".", "_")


def _table(title: str, names: list[str], columns: list[Floats]) -> str:
    """Rows to the nanometre under two lines of comment; + 0.0 removes the sign of a negative zero."""
    values = np.round(np.column_stack(columns), 6) + 0.0
    row = ",".join(["%.12g"] * len(names))
    return "\n".join((f"# {title}", f"# {FRAME}", ",".join(names), *(row % tuple(line) for line in values))) + "\n"


def _refuse(surface: Tool, **sizes: float) -> None:
    for name, size in sizes.items():
        if not (math.isfinite(size) and size > 0.0):
            raise InputError.of(f"must be a length of more than 0, not {size:g} mm", where=name)
    end = surface.height(np.array([[sizes["radius"], 0.0]]))[0]
    if not math.isfinite(end):
        raise InputError.of(f"the punch ends inside the radius of {sizes['radius']:g} mm", where="radius")
