"""nodes.csv and wires.csv: the numbers of a grid, one row per node and one per wire element."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints

if TYPE_CHECKING:
    from punchform.solved import Shaped, Solved

NODE_COLUMNS = ("i", "j", "x0", "y0", "x", "y", "z", "xr", "yr", "zr", "contact_force")
WIRE_COLUMNS = (
    *("family", "i", "j"),
    *(f"D{k}" for k in range(1, 7)),
    *(f"F{k}" for k in range(1, 7)),
    *("energy_mJ", "axial_strain", "stress_ratio"),
)
PLASTIC_COLUMNS = ("stretch", "plastic_strain")
"""Further columns of wires that yield."""
_ROWS_AT_ONCE = 20_000


def nodes_csv(formed: Solved, released: Floats | None = None) -> str:
    """The text of nodes.csv: all crossings and wire ends of the whole grid, sorted by i, then j.

    Parameters: the formed grid; released positions (N, 3) [mm] in the order of its nodes, None before a
    release. Columns: indices, flat x0, y0 [mm], formed x, y, z [mm], released xr, yr, zr [mm] (empty without
    a release), contact force of the tool on the node along the surface normal [N], positive where the punch
    pushes.
    """
    whole = formed.whole
    after = np.full_like(whole.positions, np.nan) if released is None else released
    order = np.lexsort((whole.index[:, 1], whole.index[:, 0]))
    order = order[whole.between[order] == 0]
    values = np.column_stack((whole.flat[:, :2], whole.positions, after, whole.contact))
    return rows_csv(NODE_COLUMNS, whole.index[order], values[order])


def wires_csv(stage: Shaped) -> str:
    """The text of wires.csv (formed) or wires_released.csv: one row per element, sorted by family and by the indices
    (i, j) of its end O; of a wire cut between crossings one row per piece, from O outwards, all with its (i, j).

    Columns: D1-D6 [mm, rad] and F1-F6 [N, N mm] in element axes (Eq. (2.1), P(3)), energy [mJ], axial strain,
    stress_ratio = largest stress over the yield strength (empty when either is unknown). Of wires that yield also
    stretch = length of the unloaded wire over that of the new one, and the largest plastic strain of a section.
    """
    whole = stage.whole
    start = whole.index[whole.start]
    outwards = np.sum(whole.flat[whole.end] - whole.flat[whole.start], axis=1) > 0
    order = np.lexsort((whole.between[whole.start], outwards, start[:, 1], start[:, 0], whole.family))
    labels = np.column_stack((whole.family, start))
    columns: tuple[str, ...] = WIRE_COLUMNS
    values = np.column_stack((whole.D, whole.F, whole.energy, whole.axial_strain, whole.stress_ratio))
    if stage.hardening is not None:
        columns += PLASTIC_COLUMNS
        values = np.column_stack((values, whole.stretch, whole.plastic_strain))
    return rows_csv(columns, labels[order], values[order])


def write_nodes(path: Path, formed: Solved, released: Floats | None = None) -> None:
    """Write nodes.csv; see `nodes_csv`. Raises OSError."""
    path.write_text(nodes_csv(formed, released), encoding="utf-8", newline="\n")


def write_wires(path: Path, stage: Shaped) -> None:
    """Write the wires of a stage; see `wires_csv`. Raises OSError."""
    path.write_text(wires_csv(stage), encoding="utf-8", newline="\n")


def rows_csv(columns: tuple[str, ...], labels: Ints, values: Floats) -> str:
    """Rows of integer labels (n, a) followed by numbers (n, b); a NaN becomes an empty cell.

    Fifteen digits keep every position to 1e-12 mm, and + 0.0 removes the sign of a negative zero.
    """
    row = ",".join(["%d"] * labels.shape[1] + ["%.15g"] * values.shape[1]) + "\n"
    cells = np.hstack((labels.astype(np.float64), values + 0.0))
    return ",".join(columns) + "\n" + formatted(row, cells).replace("nan", "")


def formatted(row: str, cells: Floats) -> str:
    """The rows (n, a) of numbers, each by the format `row`, which has a place for each of them and the end of its line.

    One format string over many rows is several times faster than a call per cell.
    """
    blocks = (cells[first : first + _ROWS_AT_ONCE] for first in range(0, len(cells), _ROWS_AT_ONCE))
    return "".join((row * len(block)) % tuple(block.ravel().tolist()) for block in blocks)
