"""The files of a gridshell: the numbers of result.json, the tables, and the grid for ParaView."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform import __version__
from punchform.export.result import RESULT_SCHEMA, plain, stage_result
from punchform.export.tables import write_nodes, write_wires
from punchform.export.vtp import write_vtp

if TYPE_CHECKING:
    from punchform.shell import Shell


def shell_json(done: Shell) -> str:
    """The text of result.json of a gridshell; what is not known or not finite is null."""
    return json.dumps(shell_result(done), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def shell_result(done: Shell) -> dict[str, object]:
    """The content of result.json as plain Python values: as that of a run, with the ends and what holds them."""
    formed, whole = done.formed, done.formed.whole
    ends = [
        {
            "family": end.family,
            "wire": end.wire,
            "end": end.end,
            "point_mm": list(end.point),
            "reaction_N": reaction.tolist(),
        }
        for end, reaction in zip(done.ends, formed.reactions, strict=True)
    ]
    content: dict[str, object] = {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "case_title": done.case.title,
        "grid": {"nodes": whole.crossings, "elements": len(whole.family), "solved_nodes": formed.solved_nodes},
        "formed": stage_result(formed)
        | {
            "height_mm": formed.height,
            "largest_reaction_N": np.linalg.norm(formed.reactions, axis=1).max(),
            "ends": ends,
        },
        "released": None,
        "loaded": None,
        "accuracy": None,
        "notes": list(formed.notes),
    }
    filled = plain(content)
    assert isinstance(filled, dict)
    return filled


def write_shell_tables(done: Shell, *, nodes: Path, wires: Path, shape: Path) -> None:
    """Write nodes.csv, whose contact_force is zero, wires.csv and shape.vtp. Raises OSError."""
    write_nodes(nodes, done.formed)
    write_wires(wires, done.formed)
    write_vtp(shape, done.formed)
