"""The formats of `punchform export`: one name, one module, one function that writes the files of a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from punchform.errors import InputError

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.shell import Shell

Files = tuple[Path, ...]


@dataclass(frozen=True)
class Format:
    """A format: what its files are for, and the module and function that write them, imported when it is asked for.

    shells: the module and function for gridshells, None where the format shows what they do not have.
    """

    what: str
    place: str
    shells: str | None = None

    def write(self, run: Run | Shell, folder: Path) -> Files:
        """Write the files of a run or a gridshell into a folder and return them. Raises InputError for what it does not
        have, an extra that is not installed, OSError."""
        place = self.place if run.case.punch is not None else self.shells
        if place is None:
            raise InputError.of("the format shows a grid on a punch; the folder holds a gridshell", where="--to")
        module, _, function = place.partition(":")
        found: Callable[[Run | Shell, Path], Files] = getattr(import_module(f"punchform.export.{module}"), function)
        return found(run, folder)


FORMATS = {
    "ccx": Format("the wires as beams with the forces in them, for CalculiX", "fe_deck:write_decks"),
    "csv": Format("nodes and wires of every stage as tables", "csv_tables:csv_files", "shell_files:shell_csv"),
    "dxf": Format("the flat blank, its cut list, and the wires in space", "dxf:dxf_files", "shell_files:shell_dxf"),
    "grasp": Format("formed, released and wanted surface with their rim, for GRASP", "grasp:write_grasp"),
    "points": Format("crossings and target with normals, for measuring machines", "points:point_files"),
    "step": Format("B-spline surfaces of the grid, and the punch as a solid", "step:step_files"),
    "stl": Format("the punch as a closed solid of facets", "stl:stl_files"),
    "vtp": Format("the wires with all their fields, for ParaView", "vtp:vtp_files", "shell_files:shell_vtp"),
    "vtu": Format("wires and cells of every shape, all fields", "vtu:vtu_files", "shell_files:shell_vtu"),
}
"""All formats by the names that the command line takes."""
