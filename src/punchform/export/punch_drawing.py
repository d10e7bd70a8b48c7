"""Sections of a punch as a DXF drawing, for the lathe or the laser."""

from __future__ import annotations

from collections.abc import Mapping

from punchform.arrays import Floats
from punchform.export.drawings import drawing_bytes, empty_drawing, fixed_stamps

AXIS = "AXIS"
PLAIN, RED = 7, 1


def drawing(sections: Mapping[str, Floats]) -> bytes:
    """The file of a DXF drawing in mm: one polyline (n, 2) of (rho, z) per layer, and the axis on a layer of its own.

    The same sections give the same bytes: time stamps and identifiers are fixed ones.
    """
    with fixed_stamps():
        document = empty_drawing(dict.fromkeys(sections, PLAIN) | {AXIS: RED})
        space = document.modelspace()
        for layer, line in sections.items():
            space.add_lwpolyline(line.tolist(), dxfattribs={"layer": layer})
        heights = [float(line[:, 1].max()) for line in sections.values()]
        space.add_line((0.0, 0.0), (0.0, max(heights)), dxfattribs={"layer": AXIS})
        return drawing_bytes(document)
