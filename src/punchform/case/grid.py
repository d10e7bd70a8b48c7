"""The [grid] section: the flat grid of wires before it is pressed."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, field_serializer, field_validator, model_validator

from punchform.case.parts import Count, Length, MisfitError, Part, PositiveLength, PositiveRotaryStiffness
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


class SingleWire(Part):
    """One straight wire, so many steps from the axis it is parallel to."""

    family: Literal[1, 2] = Field(description="1: along x; 2: along y")
    wire: int = Field(strict=True, description="its number: 0 on the axis, and one more with every step")
    low: Length = Field(description="where it begins, along itself from the other axis [mm]")
    high: Length = Field(description="where it ends [mm]")

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if self.low >= self.high:
            raise MisfitError(f"from {self.low:g} mm to {self.high:g} mm a wire has no length", key=("high",))
        return self


class WiresBlank(Part):
    """No outline but single wires, each with its own ends: for a gridshell."""

    shape: Literal["wires"] = "wires"
    wires: tuple[SingleWire, ...] = Field(description="the wires of both families")

    @model_validator(mode="after")
    def _numbered(self) -> Self:
        for family in (1, 2):
            numbers = sorted(wire.wire for wire in self.wires if wire.family == family)
            if 0 not in numbers or numbers != list(range(numbers[0], numbers[-1] + 1)):
                given = ", ".join(map(str, numbers)) or "none"
                raise MisfitError(
                    f"the wires of family {family} are numbered without a gap, 0 among them, each once: not {given}",
                    key=("wires",),
                )
        return self


Blank = Annotated[CircleBlank | RectangleBlank | PolygonBlank | WiresBlank, Discriminator("shape")]


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
