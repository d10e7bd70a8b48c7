"""A gridshell as files for the workshop and other programs: wires to cut, where they lie, and all that is known."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.export.blank import blank_drawing
from punchform.export.csv_tables import STAGE_COLUMNS, TOLD, WIRE_WORDS, stage_nodes_csv
from punchform.export.cut_list import cut_list_csv, cuts_of
from punchform.export.dxf import BLANK, CUT_LIST, wires_drawing
from punchform.export.heading import heading
from punchform.export.tables import wires_csv
from punchform.export.vtp import SHAPE, write_vtp
from punchform.export.vtu import unstructured
from punchform.shell import prepare_shell

if TYPE_CHECKING:
    from punchform.shell import Shell

FORMED = "formed"


def shell_csv(shell: Shell, folder: Path) -> tuple[Path, ...]:
    """Write nodes.csv, wires.csv, ends.csv with the forces that hold the ends [N], and tables.txt, which tells columns,
    units and frame. Raises OSError."""
    rows = ["family,wire,end,x,y,z,Fx,Fy,Fz"]
    for end, force in zip(shell.ends, shell.formed.reactions, strict=True):
        numbers = ",".join(f"{number:.12g}" for number in (*end.point, *force.tolist()))
        rows.append(f"{end.family},{end.wire},{end.end},{numbers}")
    columns = f"nodes.csv: {', '.join(STAGE_COLUMNS)}; ends.csv: where an end of a wire is held, and by which force."
    texts = {
        "nodes.csv": stage_nodes_csv(shell.formed),
        "wires.csv": wires_csv(shell.formed),
        "ends.csv": "\n".join((*rows, "")),
        TOLD: "\n".join((*heading(shell, "tables").lines, columns, WIRE_WORDS, "")),
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    return tuple(folder / name for name in texts)


def shell_dxf(shell: Shell, folder: Path) -> tuple[Path, ...]:
    """Write blank.dxf with the flat wires, cut_list.csv, and formed.dxf with the wires in space. Raises OSError."""
    whole = shell.formed.whole
    cuts = cuts_of(whole, prepare_shell(shell.case).elements, np.zeros(len(whole.family), dtype=bool))
    blank, listed, formed = folder / BLANK, folder / CUT_LIST, folder / f"{FORMED}.dxf"
    blank.write_bytes(blank_drawing(shell.case, cuts, heading(shell, "the flat wires").lines))
    told = heading(shell, "cut list of the flat wires").lines
    listed.write_text(cut_list_csv(cuts, told), encoding="utf-8", newline="\n")
    formed.write_bytes(wires_drawing(whole, heading(shell, "the wires, arched up").lines))
    return blank, listed, formed


def shell_vtp(shell: Shell, folder: Path) -> tuple[Path, ...]:
    """Write shape.vtp: the wires with their fields. Raises OSError."""
    write_vtp(folder / SHAPE, shell.formed, head=heading(shell, "the wires, arched up").lines)
    return (folder / SHAPE,)


def shell_vtu(shell: Shell, folder: Path) -> tuple[Path, ...]:
    """Write formed.vtu: wires and cells with all that is known. Raises OSError."""
    path = folder / f"{FORMED}.vtu"
    text = unstructured(shell.formed, None, heading(shell, "wires and cells, arched up").lines)
    path.write_text(text, encoding="ascii", newline="\n")
    return (path,)
