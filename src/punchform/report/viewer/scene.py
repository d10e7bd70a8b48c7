"""What the viewer shows of a run: nodes, wires, the shapes they take one after the other, and figures in colour.

All arrays are of the whole grid as it was laid; NaN stands for what is not there, such as a crossing that was cut off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from punchform.arrays import Floats, Ints

Place = Literal["node", "wire"]


@dataclass(frozen=True)
class Figure:
    """One quantity in one shape: values (N,) at nodes or (M,) of wire pieces, in the unit of its `Quantity`."""

    key: str
    values: Floats


@dataclass(frozen=True)
class Mark:
    """A value that stands out on the scale of a quantity, such as the yield strength, and what it is called."""

    value: float
    label: str


@dataclass(frozen=True)
class Quantity:
    """What a figure means: its key, name, unit, whether it is told of nodes or of wire pieces, whether its colours part
    at zero, and what the signs mean.

    shown_over: the divisor and the name of a second quantity made from it, as the stress over the yield strength.
    """

    key: str
    label: str
    unit: str
    place: Place
    signed: bool = False
    note: str = ""
    marks: tuple[Mark, ...] = ()
    shown_over: tuple[float, str] | None = None


@dataclass(frozen=True)
class Pose:
    """One shape of the grid: its name, what it is, positions (N, 3) [mm], and the figures that are known of it.

    share: of the depth of the punch at which it lies; stroke: whether it is one on the way down;
    tool: whether the punch is still there. references: shapes from which moves can be magnified, by their
    names, (N, 3) [mm].
    """

    name: str
    told: str
    positions: Floats
    figures: tuple[Figure, ...] = ()
    references: tuple[tuple[str, Floats], ...] = ()
    share: float = 1.0
    stroke: bool = False
    tool: bool = True


@dataclass(frozen=True)
class Skin:
    """A surface as rings of points (rings, around, 3) [mm] from its axis outwards.

    falls: whether it goes down with the punch, its heights scaled by the share of the pose.
    """

    key: str
    label: str
    points: Floats
    falls: bool = False


@dataclass(frozen=True)
class Scene:
    """All that one viewer shows.

    index (N, 2): (i, j) of nodes, between (N,): 0 for crossings and wire ends; ends (M, 2): node numbers of wire
    pieces, family (M,): 1 along x, 2 along y. begin: the number of the pose that is shown first, colour: the key of the
    quantity.
    """

    title: str
    index: Ints
    between: Ints
    ends: Ints
    family: Ints
    diameter: float
    poses: tuple[Pose, ...]
    quantities: tuple[Quantity, ...]
    skins: tuple[Skin, ...]
    begin: int
    colour: str | None

    def __post_init__(self) -> None:
        nodes, pieces = len(self.index), len(self.ends)
        lengths = {quantity.key: nodes if quantity.place == "node" else pieces for quantity in self.quantities}
        for pose in self.poses:
            assert pose.positions.shape == (nodes, 3), pose.name
            assert all(places.shape == (nodes, 3) for _, places in pose.references), pose.name
            assert all(figure.values.shape == (lengths[figure.key],) for figure in pose.figures), pose.name
        assert 0 <= self.begin < len(self.poses)
        assert not len(self.ends) or int(np.max(self.ends)) < nodes
