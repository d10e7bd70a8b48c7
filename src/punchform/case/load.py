"""The [load] section: what acts on the grid after its release."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from punchform.case.parts import Force, MisfitError, Number, Part, PositiveStress, Quantity
from punchform.units import NUMBER, STRESS

Pressure = Annotated[float, Quantity(STRESS)]


class WindCase(Part):
    """Wind straight onto the shape: it presses along the normals, on the wires only."""

    dynamic_pressure: PositiveStress = Field(description="of the wind, half its density times its speed squared [MPa]")
    coefficient: Annotated[float, Quantity(NUMBER, above=0.0)] = Field(
        default=1.2, description="drag coefficient of the wires, of the area that they cover [-]"
    )


class PointForce(Part):
    """A force on one crossing."""

    node: tuple[int, int] = Field(description="its numbers (i, j)")
    force: tuple[Force, Force, Force] = Field(description="along x, y and z [N]")


class LoadCase(Part):
    """Dead loads on the released grid."""

    gravity: tuple[Number, Number, Number] | None = Field(
        default=None, description="acceleration along x, y and z in multiples of that on earth; (0, 0, -1) pulls down"
    )
    pressure: Pressure | None = Field(
        default=None, description="along the normals, on the whole surface, positive upwards [MPa]"
    )
    wind: WindCase | None = Field(default=None, description="wind from below: it presses upwards, on the wires only")
    forces: tuple[PointForce, ...] = Field(default=(), description="forces on single crossings")

    @model_validator(mode="after")
    def _something_acts(self) -> Self:
        if self.gravity is None and self.pressure is None and self.wind is None and not self.forces:
            raise MisfitError(
                "no load is given", key=(), hint="give gravity, pressure, wind or forces, or leave the section out"
            )
        return self
