"""The tables of a run and of each of its stages as CSV files, and beside them what their columns are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.export.heading import heading
from punchform.export.tables import nodes_csv, rows_csv, wires_csv
from punchform.export.told import told, with_the_rest

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Shaped

NODES, WIRES, WIRES_RELEASED, TOLD = "nodes.csv", "wires.csv", "wires_released.csv", "tables.txt"
STAGE_COLUMNS = ("i", "j", "between", "x0", "y0", "x", "y", "z", "nx", "ny", "nz", "contact_force")
WIRE_WORDS = """\
Wires, one row per piece between two crossings: family 1 along x, 2 along y; i, j of its inner end; D1 to D6 [mm, rad],
F1 to F6 [N, N mm] in element axes; energy_mJ; axial_strain; stress_ratio over the yield strength; of wires that yield
stretch and plastic_strain."""
COLUMNS = f"""\
nodes.csv, wires.csv, wires_released.csv: as in the folder of the run. Nodes: i, j; x0, y0 flat; x, y, z formed;
xr, yr, zr released; contact_force of the tool, positive where the punch pushes.
{WIRE_WORDS}
nodes_1_press.csv, wires_1_press.csv, ...: the same of every stage in order. Here nodes between two crossings of a wire
are told too, by the crossing nearer to the centre and, in `between`, how many pieces away from it they are; nx, ny, nz
is the normal of the node. An empty cell is not known: what was cut off, or a stress without a yield strength."""


def csv_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write nodes.csv, wires.csv and wires_released.csv as the run folder has them, nodes and wires of every stage, and
    tables.txt, which tells columns, units and frame. Raises OSError."""
    released = told(run).released
    texts = {NODES: nodes_csv(*with_the_rest(run)), WIRES: wires_csv(run.formed)}
    if released is not None:
        texts[WIRES_RELEASED] = wires_csv(released)
    for number, stage in enumerate(run.stages, 1):
        texts[f"nodes_{number}_{stage.kind}.csv"] = stage_nodes_csv(stage.done)
        texts[f"wires_{number}_{stage.kind}.csv"] = wires_csv(stage.done)
    texts[TOLD] = "\n".join((*heading(run, "tables").lines, COLUMNS, ""))
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    return tuple(folder / name for name in texts)


def stage_nodes_csv(stage: Shaped) -> str:
    """The text of the table of the nodes of one stage: by i, j and between; see STAGE_COLUMNS."""
    whole = stage.whole
    order = np.lexsort((*whole.flat.T[1::-1], whole.between, whole.index[:, 1], whole.index[:, 0]))
    labels = np.column_stack((whole.index, whole.between))
    values = np.column_stack((whole.flat[:, :2], whole.positions, whole.normals, whole.contact))
    return rows_csv(STAGE_COLUMNS, labels[order], values[order])
