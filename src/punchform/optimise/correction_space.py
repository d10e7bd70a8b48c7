"""The corrections that a punch may be given: smooth shapes of few numbers, nil at the rim, Eqs. (13.1) and (13.2)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case
from punchform.errors import InputError
from punchform.punch import Corrected, uncorrected

Kind = Literal["field", "revolution", "lobes"]
KINDS: tuple[Kind, ...] = ("field", "revolution", "lobes")
WORDS = {
    "field": "a full height field",
    "revolution": "a surface of revolution, as a lathe makes it",
    "lobes": "a lathe's surface with four lobes",
}
"""What each kind of surface is."""

DEGREE = 16
"""The highest degree of the polynomials."""
NODES_PER_TERM = 4
"""Crossings that are judged per number that is looked for, at least."""
NARROWEST = 2.0
"""Width of the ring in which a correction dies out, in steps of the grid, at least."""
PER_STEP = 2
"""Points of the height field per step of the grid,"""
IN_RING = 8
"""and across the ring in which it dies out, at least;"""
MOST = 160
"""but no more than so many from the axis to the rim."""


@dataclass(frozen=True)
class Term:
    """One shape: the polynomial of degree n with m lobes around the axis, as a cosine or a sine."""

    n: int
    m: int
    sine: bool = False


@dataclass(frozen=True)
class Space:
    """Corrections c = T(rho) sum x_k Z_k(rho, phi), Eqs. (13.1), (13.2): Zernike polynomials up to the radius `end` of
    the rim, all of the size 1 in the mean square, times a taper T that falls from 1 at `start` to 0 at `end` [mm].

    mirrored: x = 0 and y = 0 are mirror planes; spacing [mm]: of the points that a case holds.
    """

    kind: Kind
    terms: tuple[Term, ...]
    start: float
    end: float
    mirrored: bool
    spacing: float

    def taper(self, radius: Floats) -> Floats:
        """T over radii (n,) [mm]: C², 1 inside `start`, 0 outside `end`."""
        t = np.clip((radius - self.start) / (self.end - self.start), 0.0, 1.0)
        return np.asarray(1.0 - t**3 * (10.0 - 15.0 * t + 6.0 * t * t))

    def columns(self, xy: Floats) -> Floats:
        """The shapes (n, k) over points (n, 2) [mm], each of which a unit of its number adds to the punch [mm]."""
        rho, phi = np.hypot(xy[:, 0], xy[:, 1]), np.arctan2(xy[:, 1], xy[:, 0])
        shapes = zernike(self.terms, np.minimum(rho / self.end, 1.0), phi)
        return np.asarray(self.taper(rho)[:, None] * shapes)

    def heights(self, numbers: Floats, xy: Floats) -> Floats:
        """The correction (n,) [mm] over points (n, 2) [mm]."""
        return np.asarray(self.columns(xy) @ numbers)

    def correction(self, numbers: Floats) -> dict[str, Any]:
        """The correction as the setting `punch.correction` of a case."""
        if self.kind == "revolution":
            rho = self._axis
            dz = self.heights(numbers, np.column_stack((rho, np.zeros(len(rho)))))
            return {"kind": "radial", "points": np.column_stack((rho, dz)).tolist()}
        return {"kind": "field", "points": np.column_stack((self._field, self.heights(numbers, self._field))).tolist()}

    @cached_property
    def _axis(self) -> Floats:
        """Radii from the axis to beyond the end: the last cell, in which a case leads all to nil, holds nothing."""
        cells = math.ceil(self.end / self.spacing) + 1
        return np.asarray(self.spacing * np.arange(cells + 1))

    @cached_property
    def _field(self) -> Floats:
        """Points (n, 2) of the field: a quarter where it is mirrored."""
        along = self._axis if self.mirrored else np.concatenate((-self._axis[:0:-1], self._axis))
        x, y = np.meshgrid(along, along, indexing="ij")
        return np.column_stack((x.ravel(), y.ravel()))


def zernike(terms: tuple[Term, ...], radius: Floats, angle: Floats) -> Floats:
    """Zernike polynomials (n, k) at radii (n,) from 0 to 1 and angles (n,) [rad], Eq. (13.2)."""
    from scipy.special import eval_jacobi

    columns = []
    for term in terms:
        along = radius**term.m * eval_jacobi((term.n - term.m) // 2, 0, term.m, 2.0 * radius * radius - 1.0)
        size = math.sqrt((term.n + 1) * (1 if term.m == 0 else 2))
        columns.append(size * along * (np.sin if term.sine else np.cos)(term.m * angle))
    return np.column_stack(columns)


def terms_of(kind: Kind, degree: int, *, mirrored: bool) -> tuple[Term, ...]:
    """The shapes of a kind of surface up to a degree; of a mirrored one those that are even in x and in y."""
    lobes = {"field": range(degree + 1), "revolution": (0,), "lobes": (0, 4)}[kind]
    return tuple(
        Term(n, m, sine)
        for m in lobes
        if not (mirrored and m % 2)
        for sine in ((False,) if mirrored or m == 0 else (False, True))
        for n in range(m, degree + 1, 2)
    )


def space(case: Case, kind: Kind, *, nodes: int, mirrored: bool) -> Space:
    """The corrections of a kind that fit a case: nodes: crossings that are judged and solved; mirrored: a quarter is.

    Inside the aperture nothing is held back; from there on, or from where a ring of two steps is left, the correction
    dies out towards the rim. Raises InputError for a punch whose fillet leaves no room, or without a target.
    """
    if case.target is None:
        raise InputError.of(
            "a punch is compensated for a target, and the case has none",
            where="target",
            hint="add a section [target] with profile, aperture_radius and tolerance",
        )
    end, step = case.tool.rim_radius, min(case.grid.step)
    start = min(case.target.aperture_radius, end - NARROWEST * step)
    if start <= NARROWEST * step:
        raise InputError.of(
            f"{end:g} mm leave no room for a correction on a grid with a step of {step:g} mm",
            where="punch.rim_radius",
            hint="take a finer grid",
        )
    degree = max(
        (n for n in range(0, DEGREE + 1, 2) if NODES_PER_TERM * len(terms_of("field", n, mirrored=mirrored)) <= nodes),
        default=0,
    )
    degree = max(degree, 4)
    spacing = max(min(step / PER_STEP, (end - start) / IN_RING), end / MOST)
    return Space(kind, terms_of(kind, degree, mirrored=mirrored), start, end, mirrored, spacing)


def numbers_of(case: Case, space: Space) -> Floats:
    """The numbers of the correction that a case already has, by least squares; nil without one."""
    from punchform.punch import corrected, correction_of

    tool = corrected(uncorrected(case.tool), correction_of(case.tool))
    if not isinstance(tool, Corrected):
        return np.zeros(len(space.terms))
    points = space._field
    points = points[np.hypot(points[:, 0], points[:, 1]) < space.end]
    return np.asarray(np.linalg.lstsq(space.columns(points), tool.correction.value(points), rcond=None)[0])
