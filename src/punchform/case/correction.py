"""Corrections of a punch: heights that are added to its profile, over points in plan or from the axis outwards."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, model_validator

from punchform.case.parts import Length, MisfitError, Part
from punchform.case.tables import points_in_place_of_file

DIGITS = 9
"""Coordinates that agree to so many digits behind the point [mm] are of one row of the grid."""
FILE = "CSV file with the points [mm], relative to the case file; its points take its place"


class FieldPoints(Part):
    """Heights over the points of a regular grid in plan, in any order; a grid that starts at 0 is mirrored there."""

    kind: Literal["field"] = "field"
    points: tuple[tuple[Length, Length, Length], ...] = Field(
        description="points (x, y, dz) of a full grid, its rows along x and along y; nil at its outer edge [mm]",
        min_length=16,
    )
    file: str | None = Field(default=None, description=FILE)

    _read_file = model_validator(mode="before")(points_in_place_of_file)

    @model_validator(mode="after")
    def _full_grid(self) -> Self:
        found: dict[tuple[float, float], int] = {}
        for number, (x, y, _) in enumerate(self.points, start=1):
            first = found.setdefault((round(x, DIGITS), round(y, DIGITS)), number)
            if first != number:
                raise MisfitError(
                    f"point {number} stands where point {first} does: x = {x:g} mm, y = {y:g} mm", key=("points",)
                )
        xs, ys = self._places()
        if len(found) < len(xs) * len(ys):
            x, y = next((x, y) for x in xs for y in ys if (x, y) not in found)
            raise MisfitError(
                f"{len(xs)} different x and {len(ys)} different y make a grid of {len(xs) * len(ys)} points, but "
                f"{len(found)} are given; the first that is missing is at x = {x:g} mm, y = {y:g} mm",
                key=("points",),
                hint="give a height for every x and y; nil where nothing is corrected",
            )
        return self

    def _places(self) -> tuple[list[float], list[float]]:
        xs = sorted({round(point[0], DIGITS) for point in self.points})
        return xs, sorted({round(point[1], DIGITS) for point in self.points})

    @property
    def grid(self) -> tuple[list[float], list[float], list[list[float]]]:
        """x (n), y (m) and the heights (n, m) [mm]."""
        xs, ys = self._places()
        heights = {(round(x, DIGITS), round(y, DIGITS)): dz for x, y, dz in self.points}
        return xs, ys, [[heights[x, y] for y in ys] for x in xs]


class RadialPoints(Part):
    """Heights from the axis outwards, the same all around: what a lathe can turn."""

    kind: Literal["radial"] = "radial"
    points: tuple[tuple[Length, Length], ...] = Field(
        description="points (rho, dz) with rho increasing from the axis; nil at the last [mm]", min_length=4
    )
    file: str | None = Field(default=None, description=FILE)

    _read_file = model_validator(mode="before")(points_in_place_of_file)

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        increasing(self.points)
        return self


Correction = Annotated[FieldPoints | RadialPoints, Discriminator("kind")]


def increasing(points: Sequence[tuple[float, float]]) -> None:
    """Raise MisfitError when the distance from the axis does not increase from point to point."""
    for number, ((before, _), (after, _)) in enumerate(pairwise(points), start=2):
        if after <= before:
            raise MisfitError(
                f"rho must increase from point to point: point {number} has {after:g} mm after {before:g} mm",
                key=("points",),
            )
