"""The formats of `punchform export`: one name, one module, one function that writes the files of a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from punchform.run import Run

Writer = Callable[["Run", Path], tuple[Path, ...]]


@dataclass(frozen=True)
class Format:
    """A format: what its files are for, and the module and function that write them, imported when it is asked for.

    needs: the module of an extra that it cannot do without, none for most.
    """

    what: str
    place: str
    needs: str | None = None

    @property
    def there(self) -> bool:
        """Whether what it needs is installed."""
        if self.needs is None:
            return True
        return find_spec(self.needs.partition(".")[0]) is not None and find_spec(self.needs) is not None

    @property
    def write(self) -> Writer:
        """Writes the files of a run into a folder and returns them. Raises InputError for what a run does not have or
        an extra that is not installed, OSError."""
        module, _, function = self.place.partition(":")
        found: Writer = getattr(import_module(f"punchform.export.{module}"), function)
        return found


FORMATS = {
    "ccx": Format("the wires as beams with the forces in them, for CalculiX", "fe_deck:write_decks"),
    "csv": Format("nodes and wires of every stage as tables", "csv_tables:csv_files"),
    "dxf": Format("the flat blank with its cut list, and the wires in space", "dxf:dxf_files"),
    "grasp": Format("formed, released and wanted surface with their rim, for GRASP", "grasp:write_grasp"),
    "points": Format("crossings and target with normals, for measuring machines", "points:point_files"),
    "step": Format(
        "B-spline surfaces of the grid, and the punch as a solid", "step:step_files", needs="OCP.collections"
    ),
    "stl": Format("the punch as a closed solid of facets", "stl:stl_files"),
    "vtp": Format("the wires with all their fields, for ParaView", "vtp:vtp_files"),
    "vtu": Format("wires and cells of every shape with all that is known, for ParaView", "vtu:vtu_files"),
}
"""All formats by the names that the command line takes."""
