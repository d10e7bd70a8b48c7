"""shape.vtp: the formed wires as VTK XML PolyData, for ParaView and everything else that reads VTK.

The file holds the wire elements as lines on the formed positions. Arrays are inline base64 (format "binary"),
the one encoding that is both valid XML and read by every VTK since version 5.
"""

from __future__ import annotations

import base64
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from punchform.accuracy import MEASURES, Accuracy, Aligned
from punchform.arrays import Floats, Ints
from punchform.export.told import released_on, spread
from punchform.whole import places_in

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Solved

Array = NDArray[np.float64] | NDArray[np.int64]
SHAPE = "shape.vtp"
_TYPES = {"float64": "Float64", "int64": "Int64"}


def vtp_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write shape.vtp: the wires formed, released and judged, all nodes of the grid that was pressed. Raises OSError."""
    whole = run.formed.whole
    judged = None if run.case.stages is None else places_in(run.final.whole.flat, whole.flat)
    path = folder / SHAPE
    write_vtp(path, run.formed, released_on(run, whole), run.accuracy, judged)
    return (path,)


def write_vtp(
    path: Path,
    formed: Solved,
    released: Floats | None = None,
    accuracy: Accuracy | None = None,
    judged: Ints | None = None,
) -> None:
    """Write the formed grid, and with `released` (N, 3) [mm] also where its nodes are after the release.

    Point data: i, j, flat, displacement (formed - flat), normal (of the node frame), contact_force [N], shear [rad]
    (mean of the cells around the node, NaN without a cell), and released, springback (released - formed) when given;
    with `accuracy` deviation_axial, deviation_normal and deviation_half_path in the alignment that is judged, also
    outside the aperture; lengths in mm. Cell data per element: family, axial_force F1 [N], axial_strain, energy [mJ];
    of wires that yield also stretch and plastic_strain.
    judged (N,): which of the nodes that the accuracy is told of each one is, -1 for none, when they are not the same.
    Raises OSError.
    """
    whole = formed.whole
    points: dict[str, Array] = {
        "i": whole.index[:, 0],
        "j": whole.index[:, 1],
        "flat": whole.flat,
        "displacement": whole.positions - whole.flat,
        "normal": whole.normals,
        "contact_force": whole.contact,
        "shear": node_shear(len(whole.positions), whole.cells, whole.cell_shear),
    }
    if released is not None:
        points |= {"released": released, "springback": released - whole.positions}
    if accuracy is not None:
        found = judging(accuracy).deviations
        shown = {measure: found.of(measure) for measure in MEASURES}
        if judged is not None:
            shown = {measure: spread(values, judged) for measure, values in shown.items()}
        points |= {f"deviation_{measure.replace('-', '_')}": values for measure, values in shown.items()}
    wires: dict[str, Array] = {
        "family": whole.family,
        "axial_force": whole.F[:, 0],
        "axial_strain": whole.axial_strain,
        "energy": whole.energy,
    }
    if formed.hardening is not None:
        wires |= {"stretch": whole.stretch, "plastic_strain": whole.plastic_strain}
    lines = np.column_stack((whole.start, whole.end))
    path.write_text(poly_lines(whole.positions, lines, points, wires), encoding="ascii", newline="\n")


def judging(accuracy: Accuracy) -> Aligned:
    """The alignment in which the shape is judged."""
    return accuracy.as_held if accuracy.judge.alignment == "as held" else accuracy.fitted


def node_shear(nodes: int, cells: Ints, cell_shear: Floats) -> Floats:
    """Mean shear (N,) [rad] of the cells (K, 4) around each node; NaN for a node without a cell."""
    corners = cells.ravel()
    total = np.bincount(corners, np.repeat(cell_shear, 4), nodes)
    count = np.bincount(corners, minlength=nodes)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def poly_lines(positions: Floats, lines: Ints, point_data: Mapping[str, Array], cell_data: Mapping[str, Array]) -> str:
    """The text of a VTK XML PolyData file with one two-point line per row of `lines` (M, 2) of node numbers.

    Parameters: positions (N, 3); named arrays (N,) or (N, 3) on the points and (M,) or (M, 3) on the lines.
    """
    ends = np.arange(2, 2 * len(lines) + 1, 2)
    return "\n".join(
        (
            '<?xml version="1.0"?>',
            '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            "<PolyData>",
            f'<Piece NumberOfPoints="{len(positions)}" NumberOfVerts="0" NumberOfLines="{len(lines)}"'
            ' NumberOfStrips="0" NumberOfPolys="0">',
            _section("PointData", point_data),
            _section("CellData", cell_data),
            _section("Points", {"Points": positions}),
            _section("Lines", {"connectivity": lines.ravel(), "offsets": ends}),
            "</Piece>",
            "</PolyData>",
            "</VTKFile>",
            "",
        )
    )


def _section(tag: str, arrays: Mapping[str, Array]) -> str:
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
