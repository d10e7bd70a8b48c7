"""STEP files of a run: every shape as one B-spline face, the punch as a solid. Needs the extra `step`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from punchform import __version__
from punchform.export.heading import heading
from punchform.export.occt import demand_occt, step_data, trimmed_face
from punchform.export.punch_files import EDGE, PLATE
from punchform.export.shapes import shapes
from punchform.export.spline import Spline, spline_of
from punchform.export.step_punch import punch_solid
from punchform.export.stl import punches
from punchform.press import Formed

if TYPE_CHECKING:
    from punchform.run import Run

WHAT = {
    "punch": "the punch, up to the surface that the crossings lie on",
    "punch_designed": "the punch without its correction, up to the surface that the crossings lie on",
}
DIGITS = 1e-9
"""What digits of the file hold [mm]."""
NO_DATE = "1970-01-01T00:00:00"
"""A time of making is asked for in every STEP file: this one says nothing, and equal runs give equal files."""


def step_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write formed.step, released.step, ... for the shapes that the run has, and punch.step, with a correction also
    punch_designed.step; in mm, AP214.

    Faces go through every crossing and end at the hull of the flat crossings. By how much they miss crossings and, in
    the tool, the punch between them is in the header, as is by how much the solid misses the punch. Raises InputError
    without the extra `step`, OSError.
    """
    demand_occt()
    written = []
    for name, stage in shapes(run).items():
        spline = spline_of(stage.whole)
        face = trimmed_face(spline.poles, spline.degrees, spline.knots, spline.outline)
        told = f"one B-spline surface, within {no_more_than(spline.missed(stage.whole))} mm of every crossing"
        if isinstance(stage, Formed):
            told += f", in the middles of cells within {no_more_than(off_the_punch(spline, stage))} mm of the punch"
        path = folder / f"{name}.step"
        path.write_bytes(step_bytes(face, name, (*heading(run, f"the shape, {name}").lines, told)))
        written.append(path)
    for name, tool in punches(run).items():
        solid, missed = punch_solid(tool, radius=EDGE * tool.rim_radius, plate=PLATE)
        path = folder / f"{name}.step"
        told = f"within {no_more_than(missed)} mm of the punch"
        path.write_bytes(step_bytes(solid, name, (*heading(run, WHAT[name]).lines, told)))
        written.append(path)
    return tuple(written)


def off_the_punch(spline: Spline, formed: Formed) -> float:
    """Largest distance [mm] of the surface through the crossings from the punch in the middles of cells: what a grid of
    this step does not know of the punch."""
    middles = formed.whole.flat[formed.whole.cells, :2].mean(axis=1)
    return float(np.abs(formed.surface.distance(spline.at(middles))).max(initial=0.0))


def no_more_than(size: float) -> str:
    """A size to one digit, rounded up, and at least what the digits of the file hold."""
    power = 10.0 ** math.floor(math.log10(max(size, DIGITS)) + 1e-9)
    return f"{math.ceil(max(size, DIGITS) / power - 1e-9) * power:.0e}"


def step_bytes(shape: Any, name: str, heading: Sequence[str]) -> bytes:
    """The STEP file of a shape of the kernel, with the lines of the heading as its description."""
    schema, data = step_data(shape, name)
    lines = ",\n".join(f"'{_encoded(line)}'" for line in heading)
    head = (
        "ISO-10303-21;",
        "HEADER;",
        f"FILE_DESCRIPTION((\n{lines}),'2;1');",
        f"FILE_NAME('{name}.step','{NO_DATE}',(''),(''),'','punchform {__version__}','');",
        f"{schema};",
        "ENDSEC;",
        f"DATA;{data}",
    )
    return "\n".join(head).encode("ascii")


def _encoded(text: str) -> str:
    """A string as STEP writes it: apostrophes and backslashes twice, what is not ASCII as its number."""
    plain = text.replace("\\", "\\\\").replace("'", "''")
    return "".join(one if 32 <= ord(one) < 127 else f"\\X4\\{ord(one):08X}\\X0\\" for one in plain)
