"""What is read of a shape of the grid and shown in colours: one name, unit and sign of each, wherever it is shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from punchform.arrays import Floats

if TYPE_CHECKING:
    from punchform.whole import Whole

Place = Literal["node", "wire", "cell"]


@dataclass(frozen=True)
class Reading:
    """A quantity of a shape of the grid: its key as in the files, its name and unit, and how it is read.

    place: at nodes (N,), wire pieces (M,) or cells (K,) of the grid; of: reads the values in that unit, NaN where they
    are not known; signed: whether zero is in the middle of its scale; signs: what they mean; force: whether it is a
    force, which at the rim is tens of times that elsewhere; in_tool: whether only a shape in the tool has it.
    """

    key: str
    label: str
    unit: str
    place: Place
    of: Callable[[Whole], Floats]
    signed: bool = False
    signs: str = ""
    force: bool = False
    in_tool: bool = False

    @property
    def legend(self) -> str:
        """Name and unit, as on a scale."""
        return with_unit(self.label, self.unit)

    @property
    def signed_legend(self) -> str:
        """Name, unit, and what the signs mean."""
        return f"{self.legend}   ({self.signs})"


HEIGHT = Reading("height", "height z", "mm", "node", lambda whole: whole.positions[:, 2])
SHEAR = Reading(
    "shear",
    "shear angle",
    "°",
    "cell",
    lambda whole: np.degrees(whole.cell_shear),
    signed=True,
    signs="+ where the corner of +x and +y closes",
)
AXIAL = Reading(
    "axial_force",
    "axial force F1",
    "N",
    "wire",
    lambda whole: whole.F[:, 0],
    signed=True,
    signs="+ tension",
    force=True,
)
MOMENT = Reading(
    "moment", "bending moment F5, out of the surface", "N mm", "wire", lambda whole: whole.F[:, 4], signed=True
)
STRESS = Reading("stress", "largest stress in the wire", "MPa", "wire", lambda whole: whole.stress)
RATIO = Reading("stress_ratio", "largest stress / yield strength", "", "wire", lambda whole: whole.stress_ratio)
STRAIN = Reading(
    "axial_strain",
    "strain of the wire by its pull",
    "%",
    "wire",
    lambda whole: 100.0 * whole.axial_strain,
    signed=True,
    signs="+ longer",
)
ELONGATION = Reading(
    "axial_strain",
    "elongation of the wire",
    "%",
    "wire",
    lambda whole: 100.0 * whole.axial_strain,
    signed=True,
    signs="+ longer than in the blank",
)
ENERGY = Reading("energy", "elastic energy of a wire piece", "mJ", "wire", lambda whole: whole.energy)
PLASTIC = Reading(
    "plastic_strain", "largest plastic strain in the wire", "%", "wire", lambda whole: 100.0 * whole.plastic_strain
)
CONTACT = Reading(
    "contact_force",
    "contact force",
    "N",
    "node",
    lambda whole: whole.contact,
    signed=True,
    signs="+ punch pushes, − held down",
    force=True,
    in_tool=True,
)


RISE = "vertical move by the release"
DEFLECTION = "move by the load, along the normal"
"""Names of moves [mm] between two shapes."""


def strain(*, yields: bool) -> Reading:
    """What the axial strain of a wire means, Eq. (3.9): of one that yields it is how much longer it is."""
    return ELONGATION if yields else STRAIN


def readings(*, yields: bool) -> tuple[Reading, ...]:
    """All that may be known of a shape of elastic wires, or of wires that yield; its keys are those of a table."""
    flown = (PLASTIC,) if yields else ()
    return (HEIGHT, SHEAR, AXIAL, MOMENT, STRESS, RATIO, strain(yields=yields), *flown, ENERGY, CONTACT)


def deviation_label(measure: str, alignment: str) -> str:
    """The name of a deviation from the target [mm], of that measure in that alignment."""
    return f"{measure} deviation from the target, {alignment}"


def with_unit(label: str, unit: str) -> str:
    """A name with its unit, if it has one."""
    return f"{label} [{unit}]" if unit else label
