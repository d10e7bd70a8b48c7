"""shape.vtp: the formed wires as VTK XML PolyData, for ParaView and everything else that reads VTK.

The file holds the wire elements as lines on the formed positions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy import MEASURES, Accuracy
from punchform.arrays import Floats, Ints
from punchform.export.heading import heading
from punchform.export.told import released_on, spread
from punchform.export.vtk_xml import Array, section, vtk_file
from punchform.whole import node_shear, places_in

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Solved

SHAPE = "shape.vtp"


def vtp_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write shape.vtp: wires formed, released and judged, with all nodes of the pressed grid. Raises OSError."""
    whole = run.formed.whole
    judged = None if run.case.stages is None else places_in(run.final.whole.flat, whole.flat)
    path = folder / SHAPE
    head = heading(run, "the wires, formed; where they are after a release is in their data").lines
    write_vtp(path, run.formed, released_on(run, whole), run.accuracy, judged, head=head)
    return (path,)


def write_vtp(
    path: Path,
    formed: Solved,
    released: Floats | None = None,
    accuracy: Accuracy | None = None,
    judged: Ints | None = None,
    *,
    head: Sequence[str] = (),
) -> None:
    """Write the formed grid, and with `released` (N, 3) [mm] also where its nodes are after the release.

    Point data: i, j, flat, displacement (formed - flat), normal (of the node frame), contact_force [N], shear [rad]
    (mean of the cells around the node, NaN without a cell), and released, springback (released - formed) when given;
    with `accuracy` deviation_axial, deviation_normal and deviation_half_path in the alignment that is judged, also
    outside the aperture; lengths in mm. Cell data per element: family, axial_force F1 [N], axial_strain, energy [mJ];
    of wires that yield also stretch and plastic_strain.
    judged (N,): which of the nodes that the accuracy is told of each one is, -1 for none, when they are not the same.
    head: lines of text that the file carries. Raises OSError.
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
        shown = deviation_data(accuracy)
        points |= shown if judged is None else {name: spread(values, judged) for name, values in shown.items()}
    wires: dict[str, Array] = {
        "family": whole.family,
        "axial_force": whole.F[:, 0],
        "axial_strain": whole.axial_strain,
        "energy": whole.energy,
    }
    if formed.hardening is not None:
        wires |= {"stretch": whole.stretch, "plastic_strain": whole.plastic_strain}
    lines = np.column_stack((whole.start, whole.end))
    path.write_text(poly_lines(whole.positions, lines, points, wires, head), encoding="ascii", newline="\n")


def deviation_data(accuracy: Accuracy) -> dict[str, Floats]:
    """The deviations (N,) [mm] in the alignment that is judged, by the names that they have in files."""
    found = accuracy.aligned.deviations
    return {f"deviation_{measure.replace('-', '_')}": found.of(measure) for measure in MEASURES}


def poly_lines(
    positions: Floats,
    lines: Ints,
    point_data: Mapping[str, Array],
    cell_data: Mapping[str, Array],
    head: Sequence[str] = (),
) -> str:
    """The text of a VTK XML PolyData file with one two-point line per row of `lines` (M, 2) of node numbers.

    Parameters: positions (N, 3); named arrays (N,) or (N, 3) on the points and (M,) or (M, 3) on the lines;
    head: lines of text that the file carries.
    """
    ends = np.arange(2, 2 * len(lines) + 1, 2)
    others = 'NumberOfVerts="0" NumberOfStrips="0" NumberOfPolys="0"'
    return vtk_file(
        "PolyData",
        f'NumberOfPoints="{len(positions)}" NumberOfLines="{len(lines)}" {others}',
        (
            section("PointData", point_data),
            section("CellData", cell_data),
            section("Points", {"Points": positions}),
            section("Lines", {"connectivity": lines.ravel(), "offsets": ends}),
        ),
        head,
    )
