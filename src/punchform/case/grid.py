"""The [grid] section: the flat grid of wires before it is pressed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, field_serializer, field_validator

from punchform.case.parts import Count, Length, Part, PositiveLength, PositiveRotaryStiffness
from punchform.units import LENGTH, show

MOST_PIECES = 64


class CircleBlank(Part):
    """A round blank: the crossings within a radius of the axis."""

    shape: Literal["circle"] = "circle"
    radius: PositiveLength = Field(description="radius of the blank [mm]")


class RectangleBlank(Part):
    """A rectangular blank with the axis in its middle."""

    shape: Literal["rectangle"] = "rectangle"
    size: tuple[PositiveLength, PositiveLength] = Field(description="full lengths along x and y [mm]")


class PolygonBlank(Part):
    """A blank cut along straight lines from point to point; the last joins the first."""

    shape: Literal["polygon"] = "polygon"
    points: tuple[tuple[Length, Length], ...] = Field(
        description="corners (x, y) in order, from the axis [mm]", min_length=3
    )


Blank = Annotated[CircleBlank | RectangleBlank | PolygonBlank, Discriminator("shape")]


class CrossingSpring(Part):
    """A crossing whose wires resist being turned against each other about the surface normal."""

    stiffness: PositiveRotaryStiffness = Field(description="rotational stiffness of one crossing [N mm/rad]")


def _crossing_kind(value: Any) -> str:
    return "<table>" if isinstance(value, dict | CrossingSpring) else "<word>"


Crossing = Annotated[
    Annotated[Literal["pinned", "welded"], Tag("<word>")] | Annotated[CrossingSpring, Tag("<table>")],
    Discriminator(_crossing_kind),
]


class GridCase(Part):
    """The flat grid: two families of wires, how they cross, and the outline they are cut to."""

    step: tuple[PositiveLength, PositiveLength] = Field(
        description="distance between crossings [mm]: one for both families, or one along x and one along y"
    )
    weave: Literal["plain", "same", "stacked"] = Field(
        default="plain",
        description="plain: wires rise and fall in turn; same: every sigma = +1, as in the paper; "
        "stacked: the first family lies below, the second above (welded mesh)",
    )
    blank: Blank = Field(description="outline of the flat grid")
    centre: Literal["node", "cell"] = Field(default="node", description="what sits on the axis: a node or a cell")
    symmetry: Literal["quarter", "full"] = Field(
        default="quarter", description="solve the first quadrant where mirror planes exist, or the whole grid"
    )
    subdivide: Count = Field(
        default=1,
        le=MOST_PIECES,
        description="into how many elements a wire is cut between two crossings: for coarse grids and sharp radii",
    )
    crossing: Crossing = Field(
        default="pinned",
        description="pinned: wires turn freely about the surface normal; welded: they turn together; "
        "or a spring { stiffness = ... } [N mm/rad]",
    )

    @field_validator("step", mode="before")
    @classmethod
    def _both_families(cls, value: Any) -> Any:
        return value if isinstance(value, list | tuple | dict) else (value, value)

    @field_serializer("step", when_used="json")
    def _one_if_equal(self, step: tuple[float, float]) -> str | list[str]:
        first, second = (show(length, LENGTH) for length in step)
        return first if first == second else [first, second]
