"""The [release] and [target] sections: what happens after the press, and what is aimed at."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from punchform.case.parts import LengthFromZero, Part, PositiveLength
from punchform.case.punch import Profile


class HoldFrom(Part):
    """The outer part of the grid stays as the press left it."""

    from_radius: LengthFromZero = Field(description="nodes formed at or beyond this radius stay where they are [mm]")


def _hold_kind(value: Any) -> str:
    return "<table>" if isinstance(value, dict | HoldFrom) else "<word>"


Hold = Annotated[
    Annotated[Literal["nothing"], Tag("<word>")] | Annotated[HoldFrom, Tag("<table>")],
    Discriminator(_hold_kind),
]


class ReleaseCase(Part):
    """The punch leaves; the rim keeps what it holds."""

    hold: Hold = Field(default="nothing", description="nothing: taken out of the tool; or { from_radius = ... } [mm]")


class TargetCase(Part):
    """The shape that is wanted, and how far from it the grid may be."""

    profile: Profile = Field(description="wanted shape inside the aperture")
    aperture_radius: PositiveLength = Field(description="accuracy is judged inside this radius [mm]")
    tolerance: PositiveLength = Field(description="largest rms deviation that passes [mm]")
