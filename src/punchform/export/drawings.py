"""What all DXF drawings have in common: mm, layers, fixed stamps, and what they say of themselves."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ezdxf.document import Drawing

VERSION = "R2000"
"""The oldest version of the format that knows units and light polylines."""


@contextmanager
def fixed_stamps() -> Iterator[None]:
    """The switch of ezdxf for files without the time of their making."""
    from ezdxf import options

    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def empty_drawing(layers: dict[str, int]) -> Drawing:
    """A drawing in mm with layers of these names and colour numbers. Call it and `drawing_bytes` within
    `fixed_stamps`."""
    import ezdxf
    from ezdxf import units

    document = ezdxf.new(VERSION)
    document.units = units.MM
    for name, colour in layers.items():
        document.layers.add(name, color=colour)
    return document


def drawing_bytes(document: Drawing, heading: Sequence[str] = ()) -> bytes:
    """The file of a drawing, with the lines of the heading as comments at its very beginning."""
    comments = "".join(f"999\n{' '.join(line.split())}\n" for line in heading)
    text = io.StringIO()
    document.write(text)
    # Letters that the code page of the file lacks are written as their numbers, which every reader knows.
    return document.encode(comments + text.getvalue())
