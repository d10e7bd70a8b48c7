"""Every shape of a run as a VTK XML UnstructuredGrid: wires as lines, cells as quadrangles, with all that is known."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy import Accuracy
from punchform.arrays import Floats
from punchform.export.heading import heading
from punchform.export.shapes import shapes
from punchform.export.vtk_xml import Array, section, vtk_file
from punchform.export.vtp import deviation_data
from punchform.load import Loaded
from punchform.release import Released
from punchform.whole import node_shear

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Shaped

LINE, QUAD = 3, 9
"""What VTK calls cells of two and of four corners."""


def vtu_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write formed.vtu, released.vtu, ... for the shapes that the run has. Raises OSError."""
    written = []
    for name, stage in shapes(run).items():
        judged = run.accuracy if _same_nodes(stage, run) else None
        path = folder / f"{name}.vtu"
        text = unstructured(stage, judged, heading(run, f"wires and cells, {name}").lines)
        path.write_text(text, encoding="ascii", newline="\n")
        written.append(path)
    return tuple(written)


def unstructured(stage: Shaped, accuracy: Accuracy | None, head: Sequence[str]) -> str:
    """The text of the file of one shape.

    Point data: i, j, between, flat, displacement (from the flat), normal (of the node frames), contact_force [N], shear
    [rad] (mean of the cells around), of a release or load moved (from the stage before) and reaction [N], with
    `accuracy` the deviations that are judged. Cell data: family (1, 2; 0 for a quadrangle), sigma, D and F (6 each, in
    element axes), energy [mJ], axial_force [N], axial_strain, stress [MPa], stress_ratio, stretch, plastic_strain, NaN
    for quadrangles; shear [rad] of quadrangles, NaN for wires. Lengths in mm.
    """
    whole = stage.whole
    points: dict[str, Array] = {
        "i": whole.index[:, 0],
        "j": whole.index[:, 1],
        "between": whole.between,
        "flat": whole.flat,
        "displacement": whole.positions - whole.flat,
        "normal": whole.normals,
        "contact_force": whole.contact,
        "shear": node_shear(len(whole.positions), whole.cells, whole.cell_shear),
    }
    if isinstance(stage, Released | Loaded):
        points |= {"moved": stage.moved, "reaction": stage.reactions}
    if accuracy is not None:
        points |= deviation_data(accuracy)
    wires, quads = len(whole.family), len(whole.cells)
    of_wires = {
        "sigma": whole.sigma.astype(np.float64),
        "D": whole.D,
        "F": whole.F,
        "energy": whole.energy,
        "axial_force": whole.F[:, 0],
        "axial_strain": whole.axial_strain,
        "stress": whole.stress,
        "stress_ratio": whole.stress_ratio,
        "stretch": whole.stretch,
        "plastic_strain": whole.plastic_strain,
    }
    cells: dict[str, Array] = {"family": np.append(whole.family, np.zeros(quads, dtype=np.int64))}
    cells |= {name: _followed(values, quads) for name, values in of_wires.items()}
    cells["shear"] = np.append(np.full(wires, np.nan), whole.cell_shear)
    corners = np.append(np.column_stack((whole.start, whole.end)).ravel(), whole.cells.ravel())
    sizes = np.append(np.full(wires, 2), np.full(quads, 4))
    kinds = np.append(np.full(wires, LINE), np.full(quads, QUAD)).astype(np.uint8)
    return vtk_file(
        "UnstructuredGrid",
        f'NumberOfPoints="{len(whole.positions)}" NumberOfCells="{wires + quads}"',
        (
            section("PointData", points),
            section("CellData", cells),
            section("Points", {"Points": whole.positions}),
            section("Cells", {"connectivity": corners, "offsets": np.cumsum(sizes), "types": kinds}),
        ),
        head,
    )


def _followed(values: Floats, count: int) -> Floats:
    """Values (n, ...) and as many rows of NaN."""
    return np.concatenate((values, np.full((count, *values.shape[1:]), np.nan)))


def _same_nodes(stage: Shaped, run: Run) -> bool:
    """Whether a shape is the one that the accuracy of the run is told of."""
    return stage is run.final or stage.whole is run.final.whole
