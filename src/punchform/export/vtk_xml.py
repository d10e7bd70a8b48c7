"""What the XML files of VTK are made of: arrays inline in base64, and lines of text that every reader finds.

Base64 inside the arrays (format "binary") is the one encoding that is both valid XML and read by every VTK since
version 5.
"""

from __future__ import annotations

import base64
import struct
from collections.abc import Mapping, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64] | NDArray[np.int64] | NDArray[np.uint8]
HEADING = "heading"
"""Name of the field data that hold the lines of the heading."""
_TYPES = {"float64": "Float64", "int64": "Int64", "uint8": "UInt8"}


def vtk_file(kind: str, piece: str, sections: Sequence[str], heading: Sequence[str]) -> str:
    """The text of a file of one piece; kind: PolyData, UnstructuredGrid; piece: its counts as XML attributes."""
    return "\n".join(
        (
            '<?xml version="1.0"?>',
            f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            f"<{kind}>",
            *_field_data(heading),
            f"<Piece {piece}>",
            *sections,
            "</Piece>",
            f"</{kind}>",
            "</VTKFile>",
            "",
        )
    )


def section(tag: str, arrays: Mapping[str, Array]) -> str:
    """One section, such as PointData, with its named arrays (n,) or (n, k)."""
    return "\n".join((f"<{tag}>", *(_array(name, values) for name, values in arrays.items()), f"</{tag}>"))


def _array(name: str, values: Array) -> str:
    """One DataArray: the byte count as UInt64, then the little-endian numbers, in one base64 run."""
    numbers = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes()
    parts = values.shape[1] if values.ndim == 2 else 1
    text = base64.b64encode(struct.pack("<Q", len(numbers)) + numbers).decode("ascii")
    return (
        f'<DataArray type="{_TYPES[values.dtype.name]}" Name={quoteattr(name)}'
        f' NumberOfComponents="{parts}" format="binary">{text}</DataArray>'
    )


def _field_data(heading: Sequence[str]) -> tuple[str, ...]:
    """The lines as an array of strings: their bytes as numbers, with a zero at the end of each."""
    if not heading:
        return ()
    codes = " ".join(str(code) for line in heading for code in (*line.encode("utf-8"), 0))
    shape = f'NumberOfComponents="1" NumberOfTuples="{len(heading)}"'
    return (
        "<FieldData>",
        f'<DataArray type="String" Name="{HEADING}" {shape} format="ascii">{codes}</DataArray>',
        "</FieldData>",
    )
