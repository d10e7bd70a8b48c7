"""Which surface of the wires a deviation is told of: their middle or a crown, Eq. (9.18)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class WireSurface:
    """A surface of the woven grid: its name, and how far it lies above the nodes along the normal [mm]."""

    name: str
    offset: float


MIDDLE = WireSurface("middle between the two wires", 0.0)
"""Where the nodes are in the centred convention of Eq. (3.1)."""


def wire_surface(
    which: Literal["middle", "outer crown", "inner crown"],
    *,
    height: float,
    diameter: float,
    convention: Literal["centred", "lower"] = "centred",
) -> WireSurface:
    """The surface of a grid with crimp height h and wire diameter d [mm], Eq. (9.18).

    middle: midway between the two wires of a crossing; outer, inner crown: where the wires reach highest and
    lowest, (|h| + d)/2 from the middle. convention: where the nodes are, on the middle or on the lower wire.
    """
    crown = 0.5 * (abs(height) + diameter)
    middle = 0.0 if convention == "centred" else 0.5 * abs(height)
    match which:
        case "middle":
            return WireSurface(MIDDLE.name, middle)
        case "outer crown":
            return WireSurface("outer crown of the wires", middle + crown)
        case "inner crown":
            return WireSurface("inner crown of the wires", middle - crown)
