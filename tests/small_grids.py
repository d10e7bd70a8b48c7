"""Small grids, surfaces and energies for the tests of mechanics and press."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.case import (
    CircleBlank,
    CosineLine,
    GridCase,
    ParaboloidProfile,
    PunchCase,
    RectangleBlank,
    StraightLine,
    WireCase,
)
from punchform.grid import Grid, lay
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Bars, Loads
from punchform.mechanics.differences import Differences
from punchform.mechanics.frames import State
from punchform.mechanics.friction import Friction
from punchform.mechanics.kinematics import FreeFrames, Kinematics
from punchform.mechanics.linear import upper_matrix
from punchform.mechanics.rigid import free_motions
from punchform.punch import Gap, Paraboloid, Surface, surface
from punchform.start import flat_start
from punchform.whole import Whole
from punchform.wire import Element, stiffness

STEP = 10.0
DISH = Paraboloid(60.0)
"""A bare paraboloid, smooth everywhere, steep enough to strain a grid of a few steps of 10 mm by some percent."""
PUNCH = surface(PunchCase(profile=ParaboloidProfile(focal_length=100.0), rim_radius=40.0, fillet=20.0))
"""A punch with its rim for grids of 5 steps of 10 mm: a whole grid cannot slide off it."""
SHALLOW = surface(PunchCase(profile=ParaboloidProfile(focal_length=400.0), rim_radius=40.0, fillet=20.0))
"""The same for clamped grids: the wires stay within the tension that Eq. (3.2) bears, about 3 EI / s²."""
BLANK = 5.2 * STEP


@dataclass(frozen=True)
class Plane:
    """The plane z = 0 as a tool."""

    rim_radius: float = np.inf
    mirror_planes: bool = True

    def gap(self, points: Floats) -> Gap:
        gradient = np.broadcast_to((0.0, 0.0, 1.0), points.shape)
        return Gap(points[:, 2], gradient, np.zeros((len(points), 3, 3)))

    def distance(self, points: Floats) -> Floats:
        return points[:, 2]

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        return self.distance(points), self.gap(points).gradient

    def height(self, xy: Floats) -> Floats:
        return np.zeros(len(xy))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along y, its top line in the plane z = 0: a tool with no axis of revolution."""

    radius: float
    rim_radius: float = np.inf
    mirror_planes: bool = True

    def _from_axis(self, points: Floats) -> tuple[Floats, Floats]:
        out = np.column_stack((points[:, 0], np.zeros(len(points)), points[:, 2] + self.radius))
        far = np.linalg.norm(out, axis=1)
        return far, out / far[:, None]

    def gap(self, points: Floats) -> Gap:
        far, out = self._from_axis(points)
        across = np.cross(out, (0.0, 1.0, 0.0))
        return Gap(far - self.radius, out, across[:, :, None] * across[:, None] / far[:, None, None])

    def distance(self, points: Floats) -> Floats:
        return self._from_axis(points)[0] - self.radius

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        far, out = self._from_axis(points)
        return far - self.radius, out

    def height(self, xy: Floats) -> Floats:
        return np.sqrt(self.radius**2 - xy[:, 0] ** 2) - self.radius


def grid_case(
    radius: float = 3.2 * STEP,
    *,
    step: tuple[float, float] = (STEP, STEP),
    size: tuple[float, float] | None = None,
    **settings: object,
) -> GridCase:
    """A round blank, or a rectangular one of the given size."""
    blank = CircleBlank(radius=radius) if size is None else RectangleBlank(size=size)
    return GridCase.model_validate({"step": step, "blank": blank} | settings)


def grid(radius: float = 3.2 * STEP, **settings: object) -> Grid:
    """The grid of `grid_case`, laid without a rim."""
    return lay(grid_case(radius, **settings))  # type: ignore[arg-type]


def wire_case(diameter: float = 1.0, *, height: float | None = None, straight: bool = False) -> WireCase:
    """A steel wire, woven with a crimp of its diameter or straight."""
    rise = diameter if height is None else height
    line = StraightLine(height=rise) if straight else CosineLine(height=rise, segments=32)
    return WireCase(diameter=diameter, youngs_modulus=210e3, poisson=0.25, centreline=line)


def wires(
    step: tuple[float, float] = (STEP, STEP),
    diameter: float = 1.0,
    *,
    height: float | None = None,
    straight: bool = False,
) -> tuple[Element, Element]:
    """The elements of both families."""
    return stiffness(wire_case(diameter, height=height, straight=straight), step)


def bars(elements: tuple[Element, Element], *, share: float = 0.5, chord: bool = False) -> Bars:
    """Elements with the offset e = share h of Eq. (3.1): centred 0.5, lower 1."""
    return Bars(
        C=np.stack([element.C for element in elements]),
        offset=np.array([share * element.height for element in elements]),
        length=np.array([element.length for element in elements]),
        rise=np.array([line.rise if (line := element.centreline) else element.height for element in elements]),
        chord=chord,
    )


def nobody(laid: Grid) -> Bools:
    """No node is held."""
    return np.zeros(laid.nodes, dtype=bool)


def beyond(laid: Grid, radius: float) -> Bools:
    """The nodes whose flat place is beyond a radius [mm]."""
    return np.asarray(np.linalg.norm(laid.flat, axis=1) >= radius)


def outline(laid: Grid) -> Bools:
    """The nodes at which a wire ends."""
    return np.asarray(laid.wire_ends.any(axis=(1, 2)))


def free_frames(
    laid: Grid, surface: Surface | None = DISH, *, held: Bools | None = None, welded: bool = False
) -> FreeFrames:
    """Free frames, by default on the dish with no node held."""
    return FreeFrames(laid, surface, nobody(laid) if held is None else held, welded=welded)


def differences(laid: Grid, surface: Surface = DISH, *, held: Bools | None = None) -> Differences:
    """The paper's kinematics, by default on the dish with no node held."""
    return Differences(laid, surface, nobody(laid) if held is None else held)


def energy_of(
    kinematics: FreeFrames | Differences,
    *,
    made_of: Bars | None = None,
    crossing: float = 0.0,
    loads: Loads | None = None,
    friction: Friction | None = None,
) -> Energy:
    """The energy of a grid of the default wire."""
    laid = kinematics.grid
    made_of = made_of or bars(wires(laid.step))
    return Energy(laid, made_of, kinematics, crossing=crossing, loads=loads, friction=friction)


def dead(laid: Grid, forces: Floats) -> Loads:
    """Dead forces (N, 3) whose work counts from the flat grid."""
    return Loads(forces, np.column_stack((laid.flat, np.zeros(laid.nodes))))


def pinned(energy: Energy, start: State) -> Energy:
    """The same energy without the unknowns that rigid motions make superfluous."""
    kinematics = energy.kinematics
    assert isinstance(kinematics, FreeFrames | Differences)
    pins = free_motions(energy.grid, kinematics, kinematics.chart(start))
    return replace(energy, kinematics=replace(kinematics, pins=pins))


def random_state(kinematics: Kinematics, laid: Grid, rng: np.random.Generator, *, amount: float = 0.2) -> State:
    """The paper's start on the dish, moved by `amount` [mm, rad] in every unknown: far from any equilibrium."""
    surface = getattr(kinematics, "surface", None) or DISH
    start = flat_start(laid, surface)
    return kinematics.chart(start).moved(amount * rng.uniform(-1.0, 1.0, kinematics.count))


def dense(energy: Energy, values: Floats) -> Floats:
    """The symmetric matrix with these upper values."""
    upper = upper_matrix(energy.pattern, values).toarray()
    return np.asarray(upper + upper.T - np.diag(np.diag(upper)))


def assert_equal_grids(one: Whole, other: Whole, tolerance: float = 1e-9) -> None:
    """Positions, frames, contact forces, D and F of two whole grids agree, each relative to its largest entry."""
    np.testing.assert_array_equal(one.index, other.index)
    for name in ("positions", "normals", "tangents", "contact"):
        mine, theirs = getattr(one, name), getattr(other, name)
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=tolerance * np.abs(theirs).max(), err_msg=name)
    order, other_order = (np.lexsort((whole.end, whole.start, whole.family)) for whole in (one, other))
    for name in ("family", "start", "end", "sigma"):
        np.testing.assert_array_equal(getattr(one, name)[order], getattr(other, name)[other_order], err_msg=name)
    for name in ("D", "F"):
        mine, theirs = getattr(one, name)[order], getattr(other, name)[other_order]
        for mode in range(6):
            size = np.abs(theirs[:, mode]).max()
            np.testing.assert_allclose(mine[:, mode], theirs[:, mode], rtol=0, atol=tolerance * size, err_msg=name)
    np.testing.assert_allclose(
        one.energy[order], other.energy[other_order], rtol=0, atol=tolerance * other.energy.max()
    )
