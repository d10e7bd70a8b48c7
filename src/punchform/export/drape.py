"""The files of an inextensible net: the numbers of result.json, the tables, and the grid for ParaView."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from punchform import __version__
from punchform.arrays import Floats
from punchform.drape import Drape, placed
from punchform.export.result import RESULT_SCHEMA
from punchform.export.tables import write_nodes
from punchform.export.vtp import write_vtp

if TYPE_CHECKING:
    from punchform.solved import Solved

OUTLINE, LENGTHS = "outline.csv", "wire_lengths.csv"


def drape_json(done: Drape) -> str:
    """The text of result.json of a net."""
    return json.dumps(drape_result(done), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def drape_result(done: Drape) -> dict[str, object]:
    """The content of result.json; None for what is not known."""
    net, whole, rim = done.net, done.formed.whole, done.rim.radius
    known = rim[np.isfinite(rim)]
    return {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "case_title": done.case.title,
        "grid": {"nodes": len(whole.index), "elements": len(whole.family), "solved_nodes": done.grid.nodes},
        "drape": {
            "origin_mm": list(done.origin),
            "direction_deg": math.degrees(done.direction),
            "complete": net.complete,
            "reached_nodes": reached_nodes(done),
            "locked": bool(net.locked.any()),
            "shear_limit_deg": math.degrees(net.limit),
            "max_shear_deg": math.degrees(net.max_shear),
            "draw_in_mm": done.draw_in,
            "outline_min_mm": float(known.min()) if known.size else None,
            "outline_max_mm": float(known.max()) if known.size else None,
            "wires": len(done.wires.length),
            "wire_length_mm": float(done.wires.length.sum()),
            "seconds": done.seconds,
        },
        "notes": list(done.notes),
    }


def reached_nodes(done: Drape) -> int:
    """How many nodes of the whole grid the net reaches."""
    return int(np.isfinite(done.formed.whole.positions[:, 0]).sum())


def write_drape_tables(done: Drape, *, nodes: Path, shape: Path, outline: Path, lengths: Path) -> None:
    """Write nodes.csv (its contact_force is empty), shape.vtp, outline.csv and wire_lengths.csv. Raises OSError."""
    # The tables ask of a formed grid no more than positions here.
    write_nodes(nodes, cast("Solved", done.formed))
    write_vtp(shape, cast("Solved", placed(done.formed)))
    rim, wires = done.rim, done.wires
    rows = np.column_stack((np.degrees(rim.directions), rim.flat, rim.positions))
    _write_table(outline, "direction_deg,x0,y0,x,y,z", rows)
    columns = (wires.family, wires.number, wires.offset, wires.pieces, wires.length, wires.inside)
    _write_table(lengths, "family,number,offset,pieces,length,inside_rim", np.column_stack(columns))


def _write_table(path: Path, head: str, rows: Floats) -> None:
    """A CSV file of numbers; an unknown one is an empty cell."""
    lines = [",".join("" if math.isnan(cell) else f"{cell + 0.0:.15g}" for cell in row) for row in rows.tolist()]
    path.write_text("\n".join((head, *lines, "")), encoding="utf-8", newline="\n")
