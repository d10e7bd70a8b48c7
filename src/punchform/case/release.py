"""The [release] section: what stays held after the press."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from punchform.case.parts import Angle, Count, Length, LengthFromZero, MisfitError, Part, PositiveLength


class HoldFrom(Part):
    """The outer part of the grid stays as the press left it, frames included."""

    from_radius: LengthFromZero = Field(description="nodes formed at or beyond this radius stay where they are [mm]")


class HoldRing(Part):
    """A ring keeps the heights of the crossings on it, which else move freely."""

    ring: PositiveLength = Field(description="crossings formed within half a step of this keep their height [mm]")


class HoldPoints(Part):
    """Single supports, evenly spaced on a ring: the crossing nearest to each keeps its place and turns freely."""

    points: Count = Field(description="how many supports")
    radius: PositiveLength = Field(description="radius of the ring they stand on [mm]")
    first: Angle = Field(default=0.0, description="angle of the first from the x axis [rad]")


class HoldNodes(Part):
    """Chosen crossings keep their place and turn freely."""

    nodes: tuple[tuple[int, int], ...] = Field(description="their numbers (i, j)", min_length=1)


def _hold_kind(value: Any) -> str:
    """Which kind of hold a table or an object is, by the key that only this kind has."""
    known = value if isinstance(value, dict) else getattr(value, "__dict__", None)
    if known is None:
        return "<word>"
    return next((key for key in ("ring", "points", "nodes") if key in known), "from_radius")


Hold = Annotated[
    Annotated[Literal["nothing", "rim"], Tag("<word>")]
    | Annotated[HoldFrom, Tag("from_radius")]
    | Annotated[HoldRing, Tag("ring")]
    | Annotated[HoldPoints, Tag("points")]
    | Annotated[HoldNodes, Tag("nodes")],
    Discriminator(_hold_kind),
]


class Rib(Part):
    """A line that holds heights: a hoop of one radius, or straight spokes from the axis outwards.

    The crossings within half a step of it stay at the height where the press left them, plus `lift`, or at `height`.
    """

    radius: PositiveLength | None = Field(default=None, description="a hoop of this radius [mm]")
    spokes: Count | None = Field(default=None, description="so many spokes, the first along the x axis")
    height: Length | None = Field(default=None, description="height of a hoop [mm]; as pressed when absent")
    lift: Length = Field(default=0.0, description="how far the rib stands above the pressed shape [mm]")

    @model_validator(mode="after")
    def _one_line(self) -> Self:
        if (self.radius is None) == (self.spokes is None):
            raise MisfitError("a rib is either a hoop with a radius or a number of spokes", key=())
        if self.height is not None and (self.spokes is not None or self.lift):
            raise MisfitError("a height is for a hoop, and stands instead of a lift", key=("height",))
        return self


class ReleaseCase(Part):
    """The punch leaves; what holds the grid keeps holding it."""

    hold: Hold = Field(
        default="nothing",
        description="nothing: taken out of the tool; rim: the wire ends keep their place and turn freely; "
        "{ from_radius = ... }, { ring = ... }, { points = ..., radius = ... } or { nodes = [[i, j], ...] }",
    )
    ribs: tuple[Rib, ...] = Field(default=(), description="hoops and spokes that hold heights besides")
    symmetry: Literal["as pressed", "full"] = Field(
        default="as pressed",
        description="as pressed: a quarter stays a quarter; full: the whole grid, which may then leave the symmetry",
    )
