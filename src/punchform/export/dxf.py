"""DXF drawings of a run: the flat blank with its cut list, and the wires of every shape in space."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from punchform.export.blank import COLOURS, WIRES, blank_drawing, rim_lines
from punchform.export.cut_list import cut_list, cut_list_csv
from punchform.export.drawings import drawing_bytes, empty_drawing, fixed_stamps
from punchform.export.heading import heading
from punchform.export.shapes import shapes
from punchform.export.strands import strands
from punchform.whole import Whole

if TYPE_CHECKING:
    from punchform.run import Run

BLANK, CUT_LIST = "blank.dxf", "cut_list.csv"


def dxf_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write blank.dxf, cut_list.csv, and formed.dxf, released.dxf, ... for the shapes that the run has.

    The same run gives the same bytes. Raises OSError.
    """
    cuts = cut_list(run)
    blank, listed = folder / BLANK, folder / CUT_LIST
    blank.write_bytes(blank_drawing(run.case, cuts, heading(run, "the flat blank").lines, rim_lines(run)))
    told = heading(run, "cut list of the flat blank; wires end at their last crossings inside its outline").lines
    listed.write_text(cut_list_csv(cuts, told), encoding="utf-8", newline="\n")
    written = [blank, listed]
    for name, stage in shapes(run).items():
        path = folder / f"{name}.dxf"
        path.write_bytes(wires_drawing(stage.whole, heading(run, f"the wires, {name}").lines))
        written.append(path)
    return tuple(written)


def wires_drawing(whole: Whole, heading: Sequence[str]) -> bytes:
    """The DXF file of a shape: one polyline in space [mm] per wire through its nodes, by rising x or y in the flat, on
    the layers WIRES_1 and WIRES_2 of the families."""
    with fixed_stamps():
        document = empty_drawing({layer: COLOURS[layer] for layer in WIRES})
        space = document.modelspace()
        for strand in strands(whole):
            points = whole.positions[strand.nodes].tolist()
            space.add_polyline3d(points, dxfattribs={"layer": WIRES[strand.family - 1]})
        return drawing_bytes(document, heading)
