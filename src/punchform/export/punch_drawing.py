"""Sections of a punch as a DXF drawing, for the lathe or the laser."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from punchform.arrays import Floats

VERSION = "R2000"
"""The oldest version of the format that knows units and light polylines."""
AXIS = "AXIS"


def drawing(sections: Mapping[str, Floats]) -> str:
    """The text of a DXF drawing in mm: one polyline (n, 2) of (rho, z) per layer, and the axis on a layer of its own.

    The same sections give the same text: time stamps and identifiers are fixed ones.
    """
    import ezdxf
    from ezdxf import units

    with _fixed_stamps():
        document = ezdxf.new(VERSION)
        document.units = units.MM
        space = document.modelspace()
        for layer, line in sections.items():
            document.layers.add(layer, color=7)
            space.add_lwpolyline(line.tolist(), dxfattribs={"layer": layer})
        document.layers.add(AXIS, color=1)
        heights = [float(line[:, 1].max()) for line in sections.values()]
        space.add_line((0.0, 0.0), (0.0, max(heights)), dxfattribs={"layer": AXIS})
        text = io.StringIO()
        document.write(text)
    return text.getvalue()


@contextmanager
def _fixed_stamps() -> Iterator[None]:
    """The switch of ezdxf for files without the time of their making."""
    from ezdxf import options

    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before
