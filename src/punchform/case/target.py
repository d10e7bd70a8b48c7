"""The [target] section: the shape that is wanted."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from punchform.case.parts import LengthFromZero, MisfitError, Part, PositiveLength, Quantity
from punchform.case.punch import Profile
from punchform.units import NUMBER


class TargetCase(Part):
    """The shape that is wanted, and how far from it the grid may be."""

    profile: Profile = Field(description="wanted shape inside the aperture")
    aperture_radius: PositiveLength = Field(description="accuracy is judged inside this radius [mm]")
    inner_radius: LengthFromZero = Field(default=0.0, description="and outside this one [mm]")
    tolerance: PositiveLength = Field(description="largest rms deviation that passes [mm]")
    measure: Literal["normal", "axial", "half-path"] = Field(
        default="normal",
        description="which deviation is judged; half-path: half of what the path of a ray from the focus grows by",
    )
    alignment: Literal["as held", "best fit"] = Field(
        default="as held",
        description="as held: from the target in its place; best fit: from the target moved and tilted to fit best, "
        "a paraboloid with its focal length",
    )
    taper: Annotated[float, Quantity(NUMBER, least=0.0, most=100.0)] | None = Field(
        default=None,
        description="how much weaker the feed lights the edge of the aperture than its middle [dB, of amplitude]; "
        "evenly when absent",
    )

    @model_validator(mode="after")
    def _aperture_is_a_ring(self) -> Self:
        if self.inner_radius >= self.aperture_radius:
            raise MisfitError(
                f"{self.inner_radius:g} mm leaves nothing of an aperture of {self.aperture_radius:g} mm",
                key=("inner_radius",),
            )
        return self
