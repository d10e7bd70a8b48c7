"""Corrections for the tests: smooth ones in closed form, as fields and of revolution, and punches that have them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from punches import PUNCHES

from punchform.arrays import Floats
from punchform.punch import Corrected, HeightField, Meridian, RadialCorrection, Revolution
from punchform.punch.curves import Graph, HeightFunction

REACH = 250.0
"""Where the corrections end [mm]; the punches have their fillets beyond."""
WIDE = 360.0
"""Where the wide one ends: on the flange, beyond the wall of a cup and the rim at 300 mm."""
Shape = Callable[[Floats, Floats], Floats]
"""Heights over rho and phi."""


def fading(rho: Floats, first: float = 0.0, last: float = REACH) -> Floats:
    """1 up to the first radius, 0 from the last on, with four continuous derivatives in between."""
    t = np.clip((last - rho) / (last - first), 0.0, 1.0)
    return np.asarray(t**5 * (126 - 420 * t + 540 * t**2 - 315 * t**3 + 70 * t**4))


def dome(rho: Floats, phi: Floats) -> Floats:
    """The same all around."""
    return 2.0 * fading(rho)


def lobed(rho: Floats, phi: Floats) -> Floats:
    """With the mirror planes of a quarter."""
    return fading(rho) * (1.5 + 2.0 * np.cos(4 * phi) * (rho / REACH) ** 4)


def wide(rho: Floats, phi: Floats) -> Floats:
    """The same lobes over the rim of a punch and onto its flange."""
    return lobed(REACH / WIDE * rho, phi)


def skew(rho: Floats, phi: Floats) -> Floats:
    """With no mirror plane."""
    return fading(rho) * (1.5 + np.sin(phi) * (rho / REACH) + np.cos(3 * phi + 1.0) * (rho / REACH) ** 3)


def field(shape: Shape, count: int = 51, *, whole: bool = False, reach: float = REACH) -> HeightField:
    """A shape at the points of a square grid, of a quarter or of the whole."""
    places = np.linspace(-reach if whole else 0.0, reach, 2 * count - 1 if whole else count)
    x, y = np.meshgrid(places, places, indexing="ij")
    return HeightField(places, places, shape(np.hypot(x, y), np.arctan2(y, x)))


def turned(shape: Shape, count: int = 51, reach: float = REACH) -> RadialCorrection:
    """A shape along x, for all directions."""
    rho = np.linspace(0.0, reach, count)
    return RadialCorrection(rho, shape(rho, np.zeros(count)))


CORRECTED: dict[str, Corrected] = {
    "quarter": Corrected(PUNCHES["paraboloid"], field(lobed)),
    "whole": Corrected(PUNCHES["paraboloid"], field(skew, whole=True)),
    "turned": Corrected(PUNCHES["sphere"], turned(dome)),
    "cone": Corrected(PUNCHES["cone"], field(lobed)),
    "over the wall": Corrected(PUNCHES["cup"], field(wide, reach=WIDE)),
}
"""Punches of rim radius 300 mm with corrections, one of which reaches over a wall onto the flange."""


@dataclass(frozen=True)
class Sum:
    """The height function of a graph with a correction of revolution added."""

    function: HeightFunction
    correction: RadialCorrection

    def __call__(self, rho: Floats) -> tuple[Floats, Floats, Floats]:
        f, f1, f2 = self.function(rho)
        rise = self.correction.rise(np.column_stack((rho, np.zeros_like(rho))))
        return f + rise.value, f1 + rise.gradient[:, 0], f2 + rise.hessian[:, 0, 0]


def as_revolution(base: Revolution, correction: RadialCorrection) -> Revolution:
    """The corrected punch as a surface of revolution with another graph; the correction ends before the fillet."""
    graph, *rest = base.chain.segments
    assert isinstance(graph, Graph)
    assert correction.reach <= graph.end
    knots = tuple(correction.rho.tolist())
    summed = Graph(Sum(graph.function, correction), graph.end, graph.lift, knots=knots)
    return Revolution(Meridian((summed, *rest)), base.rim_radius)
