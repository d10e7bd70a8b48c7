"""Lists of nominal points with normals for measuring machines: the crossings of every shape, and of the target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy.deviation import feet
from punchform.arrays import Floats, Ints
from punchform.export.heading import heading
from punchform.export.shapes import shapes
from punchform.export.tables import formatted
from punchform.measured import sheet
from punchform.press import Formed

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Shaped

COLUMNS = ("id", "x", "y", "z", "nx", "ny", "nz", "tolerance")
WHERE = {
    "centred": "points lie midway between the two wires of a crossing",
    "lower": "points lie on the lower wire of a crossing",
}
DIGITS = 6
"""Places behind the point: a nanometre."""


def point_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write points_formed.csv, points_released.csv, ... for the shapes that the run has, and points_target.csv where
    its case has a target: the nearest point of it to each crossing of the last shape inside the aperture.

    An id such as (3:-2) is the crossing i = 3, j = -2: `punchform compare` knows it again. Raises OSError.
    """
    limit = None if run.case.target is None else run.case.target.tolerance
    written = []
    for name, stage in shapes(run).items():
        count = stage.whole.crossings
        text = points_csv(
            stage.whole.index[:count],
            stage.whole.positions[:count],
            normals(stage),
            limit,
            _head(run, f"crossings of the wires, {name}", WHERE[run.case.press.offset], limit),
        )
        written.append(_written(folder / f"points_{name}.csv", text))
    if run.accuracy is not None:
        index, places, upright = target_points(run)
        meant = f"points of the surface that is wanted of the {run.accuracy.surface.name}"
        head = _head(run, "the target at the crossings inside its aperture", meant, limit)
        written.append(_written(folder / "points_target.csv", points_csv(index, places, upright, limit, head)))
    return tuple(written)


def points_csv(index: Ints, places: Floats, upright: Floats, tolerance: float | None, head: Sequence[str]) -> str:
    """The text of a list of points (n, 3) [mm] with unit normals (n, 3), sorted by their (i, j), under comments."""
    limit = "" if tolerance is None else f"{tolerance:.{DIGITS}g}"
    order = np.lexsort((index[:, 1], index[:, 0]))
    values = np.column_stack((places, upright))
    # What would be written as zero is written without a sign.
    values = np.where(np.abs(values) <= 0.5 * 10.0**-DIGITS, 0.0, values)
    row = "(%d:%d)" + f",%.{DIGITS}f" * values.shape[1] + f",{limit}\n"
    lines = "".join(f"# {line}\n" for line in head) + ",".join(COLUMNS) + "\n"
    return lines + formatted(row, np.column_stack((index.astype(np.float64), values))[order])


def normals(stage: Shaped) -> Floats:
    """Upward unit normals (n, 3) at the crossings of a shape: of the punch in the tool, else of the surface through
    them."""
    whole, count = stage.whole, stage.whole.crossings
    places = whole.positions[:count]
    if isinstance(stage, Formed):
        return stage.surface.distance_gradient(places)[1]
    return sheet(whole.index[:count], whole.flat[:count, :2], places).distance_gradient(places)[1]


def target_points(run: Run) -> tuple[Ints, Floats, Floats]:
    """Indices (n, 2), places (n, 3) [mm] and upward unit normals (n, 3) of the target at judged crossings."""
    assert run.accuracy is not None, "only what has a target was measured"
    target, whole = run.accuracy.target, run.final.whole
    judged = np.flatnonzero(run.accuracy.mask)
    places = feet(whole.positions[judged], target)
    upright = target.surface.distance_gradient(target.local(places, target.pose))[1]
    return whole.index[judged], places, upright


def _head(run: Run, what: str, where: str, limit: float | None) -> tuple[str, ...]:
    """The heading with the unit said as readers of points look for it."""
    head = replace(heading(run, what), units="mm")
    limited = () if limit is None else ("tolerance: the limit that the case sets to the rms deviation",)
    return (*head.lines[:-1], f"{where}; nx, ny, nz: unit normal, upwards", *limited, head.version)


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8", newline="\n")
    return path
