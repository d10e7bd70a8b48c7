"""From a case without a punch to its gridshell: the wires, and their ends moved to where the case says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING

from punchform.case import Case, End, GridCase, WiresBlank
from punchform.drawing import drawing_room
from punchform.ends import nodes_of
from punchform.errors import InputError
from punchform.grid import lay
from punchform.gridshell import Gridshell, gridshell, straight_elements
from punchform.progress import Observer, silent
from punchform.wire import Element, pieces, round_section, stiffness
from punchform.wires import FlatWire, LaidWires, lay_wires, wires_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PreparedShell:
    """What a gridshell is made of: its wires, one element per kind of piece, and where the ends go."""

    laid: LaidWires
    elements: tuple[Element, ...]
    ends: tuple[End, ...]


@dataclass(frozen=True)
class Shell:
    """A case and the gridshell that became of it; `ends` in the order of `formed.ends` and `formed.reactions`."""

    case: Case
    ends: tuple[End, ...]
    formed: Gridshell
    seconds: float

    def plot(self) -> Figure:
        """A figure of the gridshell, seen from the side and above."""
        figure: Figure = drawing_room().plot_shell(self)
        return figure

    def _repr_html_(self) -> str:
        shown: str = drawing_room().html_of_shell(self)
        return shown


def prepare_shell(case: Case) -> PreparedShell:
    """Lay the wires of a case and find their ends.

    Raises InputError for a case without press.ends, wires that make no grid, and ends that they do not have.
    """
    if case.press.ends is None:
        raise InputError.of(
            "nobody says where the wire ends go", where="press", hint="give press.ends in place of [punch]"
        )
    if isinstance(case.grid.blank, WiresBlank):
        laid = _single_wires(case.grid, case.grid.blank)
        wire = case.wire
        section = round_section(
            wire.diameter, youngs_modulus=wire.youngs_modulus, poisson=wire.poisson, shear_factor=wire.shear_factor
        )
        elements = straight_elements(laid, section)
    else:
        # A quarter has no wires with two ends, and the ends need not keep its mirror planes.
        laid = wires_of(lay(case.grid.model_copy(update={"symmetry": "full"})))
        elements = pieces(stiffness(case.wire, case.grid.step), case.grid.subdivide)
    ends = tuple(end.given for end in case.press.ends)
    nodes_of(laid, ends)
    return PreparedShell(laid, elements, ends)


def form_shell(case: Case, *, observe: Observer = silent) -> Shell:
    """Move the wire ends of a case to their points: the grid arches up between them.

    Raises InputError when the case makes no gridshell, NoEquilibrium when no equilibrium is found.
    """
    begun = perf_counter()
    ready = prepare_shell(case)
    formed = gridshell(
        ready.laid,
        ready.elements,
        ready.ends,
        frame="chord" if case.press.chord else "O",
        crossing=case.grid.crossing,
        solver=case.solver,
        yield_strength=case.wire.yield_strength,
        observe=observe,
    )
    return Shell(case, ready.ends, formed, perf_counter() - begun)


def _single_wires(grid: GridCase, blank: WiresBlank) -> LaidWires:
    """Every wire at so many steps from the axis as its number says; a wire along x is a step along y from the next."""
    along_x, along_y = (
        [
            FlatWire(wire.wire * grid.step[2 - family], wire.low, wire.high)
            for wire in blank.wires
            if wire.family == family
        ]
        for family in (1, 2)
    )
    try:
        return lay_wires(along_x, along_y, subdivide=grid.subdivide)
    except InputError as error:
        raise InputError(replace(problem, where="grid.blank.wires") for problem in error.problems) from None
