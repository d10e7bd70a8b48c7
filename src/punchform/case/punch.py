"""The [punch] section: the surface of revolution z = f(rho) that is pressed into the grid, P(1)."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, field_serializer, field_validator, model_validator

from punchform.case.correction import Correction, increasing
from punchform.case.parts import Length, LengthFromZero, Part, PositiveLength, WallAngle
from punchform.case.tables import points_in_place_of_file
from punchform.units import NUMBER, length_power, quantity, show

MOST_COEFFICIENTS = 40
"""Beyond this order a polynomial in floats says nothing about the shape any more."""


class ParaboloidProfile(Part):
    """z = -rho² / 4f, the dish of an antenna."""

    kind: Literal["paraboloid"] = "paraboloid"
    focal_length: PositiveLength = Field(description="focal length f [mm]")


class SphereProfile(Part):
    """A cap of a sphere, up to its equator."""

    kind: Literal["sphere"] = "sphere"
    radius: PositiveLength = Field(description="radius of the sphere [mm]")


class EllipsoidProfile(Part):
    """A cap of an ellipsoid of revolution, up to its equator."""

    kind: Literal["ellipsoid"] = "ellipsoid"
    radius: PositiveLength = Field(description="horizontal semi-axis [mm]")
    height: PositiveLength = Field(description="vertical semi-axis [mm]")


class ConeProfile(Part):
    """A cone whose tip is rounded by a sphere."""

    kind: Literal["cone"] = "cone"
    half_angle: WallAngle = Field(description="angle between the axis and the wall [rad]")
    nose_radius: PositiveLength = Field(description="radius of the rounded tip [mm]")


class FlatProfile(Part):
    """A flat bottom with a rounded edge and a straight wall."""

    kind: Literal["flat"] = "flat"
    height: PositiveLength = Field(description="height of the flat above the rim plane [mm]")
    edge_radius: PositiveLength = Field(description="radius of the rounded edge [mm]")


class PolynomialProfile(Part):
    """z = c_0 + c_1 rho + c_2 rho² + ...; the rim sets the height, so c_0 may be anything."""

    kind: Literal["polynomial"] = "polynomial"
    coefficients: tuple[float, ...] = Field(
        description="c_0, c_1, c_2, ... [mm^(1-k)], as bare numbers or with units such as '-0.001 mm^-1'",
        min_length=2,
        max_length=MOST_COEFFICIENTS,
    )

    @field_validator("coefficients", mode="before")
    @classmethod
    def _with_units(cls, values: Any) -> Any:
        if not isinstance(values, list | tuple):
            return values
        return tuple(quantity(value, length_power(1 - k)) for k, value in enumerate(values))

    @field_serializer("coefficients", when_used="json")
    def _write(self, values: tuple[float, ...]) -> list[str | float]:
        dimensions = [length_power(1 - k) for k in range(len(values))]
        return [
            value if dimension == NUMBER else show(value, dimension)
            for value, dimension in zip(values, dimensions, strict=True)
        ]


class TableProfile(Part):
    """A smooth curve (C² spline) through given points."""

    kind: Literal["table"] = "table"
    points: tuple[tuple[Length, Length], ...] = Field(
        description="points (rho, z) with rho increasing from the axis [mm]", min_length=3
    )
    file: str | None = Field(
        default=None,
        description="CSV file with the points [mm], relative to the case file; its points take its place",
    )

    _read_file = model_validator(mode="before")(points_in_place_of_file)

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        increasing(self.points)
        return self


class ExpressionProfile(Part):
    """A formula in rho; read by a parser that knows mathematics only, never executed as code."""

    kind: Literal["expression"] = "expression"
    z: str = Field(description="z as a formula in rho, both in mm, as in '-rho**2 / 1000'", max_length=1000)


Profile = Annotated[
    ParaboloidProfile
    | SphereProfile
    | EllipsoidProfile
    | ConeProfile
    | FlatProfile
    | PolynomialProfile
    | TableProfile
    | ExpressionProfile,
    Discriminator("kind"),
]


def _tenth_of_rim(known: dict[str, Any]) -> float:
    return 0.1 * float(known["rim_radius"])


class PunchCase(Part):
    """The punch: its profile, the rim it is pressed through, and the fillet between them."""

    profile: Profile = Field(description="shape of the punch inside the rim")
    rim_radius: PositiveLength = Field(description="radius R0 where the punch surface meets z = 0 [mm]")
    fillet: LengthFromZero = Field(
        default_factory=_tenth_of_rim,
        description="radius of the circle tangent to the profile and to z = 0 at the rim [mm]; "
        "a tenth of the rim radius when left out",
    )
    correction: Correction | None = Field(
        default=None, description="heights that are added to the profile, as `punchform compensate` finds them"
    )
