"""The cases that the benchmarks form: dishes and hemispheres of the packaged wire mesh, 7.5 mm step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.case import CircleBlank, GridCase, ParaboloidProfile, PolygonBlank, PunchCase, read_case
from punchform.grid import Grid, lay
from punchform.mechanics.frames import State
from punchform.net import lay_net, start_state
from punchform.punch import Surface, surface
from punchform.punch.bare import Sphere
from punchform.wire import Element, stiffness

FLANGE = 1.15
"""Radius of a dish's blank over that of its rim, as in the check case."""
FINE = 0.04
"""Step of the net on the unit sphere whose nodes tell which blank lands on the equator."""
FLAT_AREA = 6.75
"""Area of the flat blank that covers the unit hemisphere, nearly: it only chooses the radius."""


@dataclass(frozen=True)
class Laid:
    """What a press needs: grid, one element per family, and the surface."""

    grid: Grid
    elements: tuple[Element, Element]
    surface: Surface

    @property
    def net_start(self) -> State:
        """The inextensible net as a state."""
        net = start_state(self.grid, self.surface)
        return State(net.positions, net.normals, net.tangents)


@dataclass(frozen=True)
class Dish:
    """A paraboloid dish [mm]; blank: radius of its blank."""

    rim_radius: float
    focal_length: float
    blank: float
    fillet: float = 30.0

    @property
    def name(self) -> str:
        """How a table calls it."""
        ratio = self.focal_length / (2 * self.rim_radius)
        return f"dish, D = {2 * self.rim_radius:g} mm, f/D = {ratio:.2f}"

    def laid(self) -> Laid:
        """A quarter of its grid on its punch."""
        case = read_case("packaged:check")
        profile = ParaboloidProfile(kind="paraboloid", focal_length=self.focal_length)
        punch = surface(PunchCase(profile=profile, rim_radius=self.rim_radius, fillet=self.fillet))
        grid_case = case.grid.model_copy(update={"blank": CircleBlank(radius=self.blank)})
        return Laid(lay(grid_case, rim_radius=self.rim_radius), stiffness(case.wire, case.grid.step), punch)


@dataclass(frozen=True)
class Hemisphere:
    """A hemisphere covered to its equator by about so many crossings; whole: without the use of mirror planes."""

    crossings: int
    whole: bool

    @property
    def name(self) -> str:
        """How a table calls it."""
        return f"hemisphere, {self.crossings} crossings, {'whole' if self.whole else 'a quarter'} solved"

    def laid(self) -> Laid:
        """Its grid on its sphere."""
        case = read_case("packaged:check")
        radius = case.grid.step[0] * math.sqrt(self.crossings / FLAT_AREA)
        points = tuple((float(x), float(y)) for x, y in radius * equator_outline())
        symmetry = "full" if self.whole else "quarter"
        grid_case = GridCase(step=case.grid.step, blank=PolygonBlank(points=points), symmetry=symmetry)
        return Laid(lay(grid_case), stiffness(case.wire, case.grid.step), Sphere(radius))


def dish_of(rim_radius: float, ratio: float) -> Dish:
    """A dish with the focal length ratio f/D and a flange like the check case's."""
    return Dish(rim_radius, 2 * ratio * rim_radius, FLANGE * rim_radius)


def equator_outline() -> Floats:
    """Corners (n, 2) of the flat blank that the net lands on the equator of the unit sphere."""
    grid = lay(GridCase(step=(FINE, FINE), blank=CircleBlank(radius=1.62)))
    height = np.full(grid.index.max(axis=0) + 1, -1.0)
    height[tuple(grid.index.T)] = lay_net(grid, Sphere(1.0)).positions[:, 2]
    points = []
    for i, row in enumerate(height):
        below = np.flatnonzero((row[:-1] >= 0.0) & (row[1:] < 0.0))
        if below.size and i <= below[0]:
            j = int(below[0])
            points.append((i * FINE, (j + row[j] / (row[j] - row[j + 1])) * FINE))
    octant = np.array(points)
    quarter = np.vstack((octant, octant[::-1, ::-1]))
    return np.vstack((quarter, quarter[-2::-1] * (1, -1), -quarter[1:], quarter[-2:0:-1] * (-1, 1)))
