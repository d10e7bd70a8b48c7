"""The [release] section: what stays held after the press."""

from __future__ import annotations

from difflib import get_close_matches
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


_KEYS = {"from_radius": "HoldFrom", "ring": "HoldRing", "points": "HoldPoints", "nodes": "HoldNodes"}
"""The key that only one kind of hold has."""


def _hold_kind(value: Any) -> str:
    """Which kind of hold a table or an object is meant to be, by its keys and those that they nearly are."""
    if isinstance(value, Part):
        return f"<{type(value).__name__}>"
    if not isinstance(value, dict):
        return "<word>"
    nearly = (near for key in value for near in get_close_matches(str(key), _KEYS, 1))
    likely = next(nearly, "points" if "radius" in value else "from_radius")
    return f"<{_KEYS[next((key for key in _KEYS if key in value), likely)]}>"


Hold = Annotated[
    Annotated[Literal["nothing", "rim"], Tag("<word>")]
    | Annotated[HoldFrom, Tag("<HoldFrom>")]
    | Annotated[HoldRing, Tag("<HoldRing>")]
    | Annotated[HoldPoints, Tag("<HoldPoints>")]
    | Annotated[HoldNodes, Tag("<HoldNodes>")],
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
