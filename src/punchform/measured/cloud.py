"""A cloud of measured points, in mm, with the names and uncertainties that its file gives."""

from __future__ import annotations

from dataclasses import dataclass

from punchform.arrays import Bools, Floats, Ints


@dataclass(frozen=True)
class Cloud:
    """Measured points.

    points (N, 3) [mm] in the axes of the measurement; names (N): as in the file, or 1, 2, ...; nodes (N, 2): the
    (i, j) that the name of a point spells, where `named` (N,) says so; sigma (N,): standard uncertainty [mm], or
    None; lines (N,): line in the file, 0 where a format has none; source: name of the file; unit: of the file's
    numbers, and whether the file or the user `stated` it; skipped: bad rows left out; notes: what the reader took
    for granted.
    """

    points: Floats
    names: tuple[str, ...]
    nodes: Ints
    named: Bools
    sigma: Floats | None
    lines: Ints
    source: str
    unit: str
    stated: bool
    skipped: int = 0
    notes: tuple[str, ...] = ()
