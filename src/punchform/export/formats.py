"""The formats of `punchform export`: one name, one module, one function that writes the files of a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from punchform.run import Run

Writer = Callable[["Run", Path], tuple[Path, ...]]


@dataclass(frozen=True)
class Format:
    """A format: what its files are for, and the module and function that write them, imported when it is asked for."""

    what: str
    place: str

    @property
    def write(self) -> Writer:
        """Writes the files of a run into a folder and returns them. Raises InputError for what a run does not have or
        an extra that is not installed, OSError."""
        module, _, function = self.place.partition(":")
        found: Writer = getattr(import_module(f"punchform.export.{module}"), function)
        return found


FORMATS = {
    "vtp": Format("the wires with all their fields, for ParaView", "vtp:vtp_files"),
    "ccx": Format("the wires as beams with the forces in them, a deck for CalculiX", "fe_deck:write_decks"),
    "grasp": Format("formed, released and wanted surface with their rim, for GRASP", "grasp:write_grasp"),
}
"""All formats by the names that the command line takes."""
