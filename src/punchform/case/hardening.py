"""How a wire yields, as [wire] says it: the laws of `hardening`, and how its section is followed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from punchform.case.parts import Count, Number, Part, PositiveStress, Quantity
from punchform.case.tables import points_in_place_of_file
from punchform.units import NUMBER, STRESS

PositiveNumber = Annotated[float, Quantity(NUMBER, above=0.0)]
NumberFromZero = Annotated[float, Quantity(NUMBER, least=0.0)]
Stress = Annotated[float, Quantity(STRESS)]
StressFromZero = Annotated[float, Quantity(STRESS, least=0.0)]
Share = Annotated[float, Quantity(NUMBER, least=0.0, most=1.0)]

KINEMATIC = "share of the hardening that moves the yield surface instead of widening it [-], Eq. (12.31)"


class LinearHardening(Part):
    """The tensile curve goes on straight beyond yield, Eq. (12.32)."""

    kind: Literal["linear"] = "linear"
    modulus: StressFromZero = Field(description="slope E_t of the tensile curve beyond yield [MPa]")
    kinematic: Share = Field(default=0.0, description=KINEMATIC)


class VoceHardening(Part):
    """The flow stress approaches a value, Eq. (12.33)."""

    kind: Literal["voce"] = "voce"
    saturation: PositiveStress = Field(description="true stress that the flow curve approaches [MPa]")
    rate: PositiveNumber = Field(description="how fast, per unit of plastic strain [-]")
    modulus: StressFromZero = Field(default=0.0, description="plastic slope that the curve keeps [MPa]")
    kinematic: Share = Field(default=0.0, description=KINEMATIC)


class PowerHardening(Part):
    """Hollomon's K strain^n, which starts at the yield strength, Eq. (12.33)."""

    kind: Literal["power"] = "power"
    strength: PositiveStress = Field(description="K, the true stress at a strain of 1 [MPa]")
    exponent: Annotated[float, Quantity(NUMBER, above=0.0, below=1.0)] = Field(description="n [-]")
    kinematic: Share = Field(default=0.0, description=KINEMATIC)


class TableHardening(Part):
    """A flow curve as it is, Eq. (12.30)."""

    kind: Literal["table"] = "table"
    points: tuple[tuple[NumberFromZero, PositiveStress], ...] = Field(
        description="plastic strain from 0 [-] and true stress [MPa]; the first stress is the yield strength",
        min_length=2,
    )
    kinematic: Share = Field(default=0.0, description=KINEMATIC)
    file: str | None = Field(
        default=None,
        description="CSV file with the points, relative to the case file; its points take its place",
    )

    _read_file = model_validator(mode="before")(points_in_place_of_file)


class TensileHardening(Part):
    """A tensile test, from which the flow curve follows, Eq. (12.30)."""

    kind: Literal["tensile"] = "tensile"
    points: tuple[tuple[Number, Stress], ...] = Field(
        description="engineering strain [-] and engineering stress [MPa], in the order of the test", min_length=2
    )
    kinematic: Share = Field(default=0.0, description=KINEMATIC)
    file: str | None = Field(
        default=None,
        description="CSV file with the rows of the test, relative to the case file; they take its place",
    )

    _read_file = model_validator(mode="before")(points_in_place_of_file)


def _word_or_table(value: Any) -> str:
    return "<table>" if isinstance(value, dict | Part) else "<word>"


Law = Annotated[
    LinearHardening | VoceHardening | PowerHardening | TableHardening | TensileHardening, Discriminator("kind")
]
Hardening = Annotated[
    Annotated[Literal["none", "perfect"], Tag("<word>")] | Annotated[Law, Tag("<table>")],
    Discriminator(_word_or_table),
]


class FibreSection(Part):
    """The section as fibres, each with its own stress: the reference for stress resultants."""

    rings: Annotated[Count, Field(le=64)] = Field(default=3, description="rings of fibres")
    sectors: Annotated[Count, Field(ge=4, le=256)] = Field(default=8, description="fibres in a ring, an even number")


SectionLaw = Annotated[
    Annotated[Literal["resultants", "fibres"], Tag("<word>")] | Annotated[FibreSection, Tag("<table>")],
    Discriminator(_word_or_table),
]
