"""Dishes without wires: deviations that answer to the punch by a given linear response, for the iteration alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from punchform.arrays import Floats
from punchform.errors import NoEquilibrium
from punchform.optimise.correction_space import Kind, Space, Term, terms_of
from punchform.optimise.misfit import Misfit

RIM, APERTURE = 100.0, 90.0


def space_of(kind: Kind, degree: int = 8, *, mirrored: bool = True) -> Space:
    return Space(kind, terms_of(kind, degree, mirrored=mirrored), APERTURE, RIM, mirrored, 5.0)


def places() -> Floats:
    """Points on rings inside the aperture, (n, 2) [mm], on which waves around the axis are orthogonal."""
    radius = APERTURE * (np.arange(14) + 0.5) / 14
    angle = 2.0 * np.pi * np.arange(48) / 48
    rho, phi = (part.ravel() for part in np.meshgrid(radius, angle, indexing="ij"))
    return np.column_stack((rho * np.cos(phi), rho * np.sin(phi)))


@dataclass
class LinearDish:
    """A dish whose released deviation is `error` plus what it takes of a correction: `response` (k, k) of its numbers.

    fails: whether the grid cannot be pressed with these numbers; pressed: all that was asked for.
    """

    space: Space
    error: Callable[[Floats], Floats]
    response: Floats
    fails: Callable[[Floats], bool] = lambda numbers: False
    pressed: list[Floats] = field(default_factory=list)

    def press(self, numbers: Floats) -> Misfit:
        self.pressed.append(numbers.copy())
        if self.fails(numbers):
            raise NoEquilibrium("press: no way down")
        points = places()
        deviation = self.error(points) + self.space.columns(points) @ (self.response @ numbers)
        area = np.hypot(*points.T)
        area = area / area.sum()
        rms = float(np.sqrt(area @ deviation**2))
        size = np.abs(deviation)
        return Misfit(
            rms=rms,
            p95=float(np.quantile(size, 0.95)),
            largest=float(size.max()),
            places=points,
            lift=np.ones(len(points)),
            error=deviation,
            weights=area,
            judged=area,
            deviation=deviation,
        )


def sum_of(space: Space, numbers: Floats) -> Callable[[Floats], Floats]:
    """The error that is the sum of the shapes of a space with these numbers."""
    return lambda points: np.asarray(space.columns(points) @ numbers)


def only(space: Space, *wanted: tuple[Term, float]) -> Floats:
    """The numbers of a space that are nil but for these."""
    numbers = np.zeros(len(space.terms))
    for term, value in wanted:
        numbers[space.terms.index(term)] = value
    return numbers
