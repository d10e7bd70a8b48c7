"""The punch of a run as closed solids in STL files: as it is, and where it has a correction also as it was designed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from punchform.export.punch_files import EDGE, PLATE, TOLERANCE
from punchform.export.punch_mesh import punch_mesh, stl
from punchform.punch import Corrected, Tool, surface

if TYPE_CHECKING:
    from punchform.run import Run


def punches(run: Run) -> dict[str, Tool]:
    """The punch of a run, and with a correction also the one without it, by the names of their files."""
    tool = surface(run.case.tool)
    return {"punch": tool} | ({"punch_designed": tool.base} if isinstance(tool, Corrected) else {})


def stl_files(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write punch.stl, and with a correction punch_designed.stl: solids that end 10 mm below the flange.

    Facets are within 0.02 mm of the punch, as those of `punchform punch`. Raises OSError.
    """
    written = []
    for name, tool in punches(run).items():
        path = folder / f"{name}.stl"
        solid = punch_mesh(tool, radius=EDGE * tool.rim_radius, plate=PLATE, tolerance=TOLERANCE)
        path.write_bytes(stl(solid))
        written.append(path)
    return tuple(written)
