"""Corrections c(x, y) of a punch: heights that are added to its profile, smooth and nil at their edge.

A correction is given by its values at points, Eq. (8.21): a C² cubic spline through them, which in the outermost cell
is led to exactly nil with its first two derivatives, Eq. (8.22). Lengths in mm.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.punch.dying_out import NIL, SAME, Axis, Window, axis

WHERE = "punch.correction.points"
"""Where a case holds the points of a correction."""


class Rise(NamedTuple):
    """A correction at n points in plan: value (n,) [mm], gradient (n, 2), Hessian (n, 2, 2) [1/mm]."""

    value: Floats
    gradient: Floats
    hessian: Floats


class Correction(ABC):
    """A height c(x, y) that is added to a punch; C² everywhere, nil outside its edge."""

    @property
    @abstractmethod
    def mirror_planes(self) -> bool:
        """Whether x = 0 and y = 0 are mirror planes of it."""

    @property
    @abstractmethod
    def reach(self) -> float:
        """Radius [mm] beyond which it is nil."""

    @property
    @abstractmethod
    def largest(self) -> float:
        """Its largest size at its points [mm]."""

    @property
    @abstractmethod
    def points(self) -> Floats:
        """Its points as a case holds them [mm]: rows (x, y, dz) or (rho, dz)."""

    @property
    @abstractmethod
    def setting(self) -> dict[str, object]:
        """What a case holds at `punch.correction` for it."""

    @abstractmethod
    def rise(self, xy: Floats) -> Rise:
        """Value, gradient and Hessian over points (n, 2) [mm] of the flat plane."""

    def value(self, xy: Floats) -> Floats:
        """Height c (n,) [mm] over points (n, 2) [mm]."""
        return self.rise(xy).value

    def gradient(self, xy: Floats) -> Floats:
        """Gradient (n, 2) over points (n, 2) [mm]."""
        return self.rise(xy).gradient

    def hessian(self, xy: Floats) -> Floats:
        """Second derivatives (n, 2, 2) [1/mm] over points (n, 2) [mm]."""
        return self.rise(xy).hessian


@dataclass(frozen=True, eq=False)
class HeightField(Correction):
    """Heights dz (n, m) [mm] over the regular grid x (n,), y (m,) [mm], whose steps may differ; a `Correction`.

    A field that starts at x = 0 is mirrored there, and likewise in y. Raises InputError when the heights do not fit the
    grid, are not finite, or are not nil at its outer edge.
    """

    x: Floats
    y: Floats
    dz: Floats

    def __post_init__(self) -> None:
        along_x, along_y = axis("x", self.x, where=WHERE), axis("y", self.y, where=WHERE)
        dz = np.asarray(self.dz, dtype=np.float64)
        if dz.shape != (along_x.points.size, along_y.points.size) or not np.isfinite(dz).all():
            raise InputError.of("the heights must be finite, one for every x and y", where=WHERE)
        for name, place in (("x", along_x.points), ("y", along_y.points), ("dz", dz)):
            object.__setattr__(self, name, place)
        self._nil_at_edges()

    @property
    def mirror_planes(self) -> bool:
        """Whether the field is the same on the other side of x = 0 and of y = 0."""
        return all(
            axis.mirrored or _even(axis.points, heights)
            for axis, heights in ((self._along_x, self.dz), (self._along_y, self.dz.T))
        )

    @property
    def reach(self) -> float:
        """Distance of the furthest corner from the axis [mm]."""
        return float(np.hypot(np.abs(self.x).max(), np.abs(self.y).max()))

    @property
    def largest(self) -> float:
        """Largest size of its heights [mm]."""
        return float(np.abs(self.dz).max())

    @property
    def points(self) -> Floats:
        """Rows (x, y, dz) [mm], (n m, 3)."""
        x, y = np.meshgrid(self.x, self.y, indexing="ij")
        return np.column_stack((x.ravel(), y.ravel(), self.dz.ravel()))

    @property
    def setting(self) -> dict[str, object]:
        """The table { kind = "field", points = [...] }."""
        return {"kind": "field", "points": self.points.tolist()}

    def rise(self, xy: Floats) -> Rise:
        """Value, gradient and Hessian over points (n, 2) [mm]."""
        x, y = self._along_x.cells(xy[:, 0]), self._along_y.cells(xy[:, 1])
        patch = self._patches[x.number, y.number]
        px, py = _powers(x.place), _powers(y.place)
        # s[a, b]: derivative of order a in x and b in y of the spline.
        along_y = [np.einsum("nij,nj->ni", patch, power) for power in py]
        s = {(a, b): np.einsum("ni,ni->n", px[a], along_y[b]) for a in range(3) for b in range(3 - a)}
        for (a, b), values in s.items():
            values *= x.sign ** (a % 2) * y.sign ** (b % 2)
        wx, wy = self._along_x.window(xy[:, 0]), self._along_y.window(xy[:, 1])
        return _windowed(s, wx, wy)

    def _nil_at_edges(self) -> None:
        edges = [("x", self.x, self.dz, -1), ("y", self.y, self.dz.T, -1)]
        edges += [("x", self.x, self.dz, 0)] if not self._along_x.mirrored else []
        edges += [("y", self.y, self.dz.T, 0)] if not self._along_y.mirrored else []
        for name, places, heights, end in edges:
            worst = float(np.abs(heights[end]).max())
            if worst > NIL:
                other = self.y if name == "x" else self.x
                along = float(other[int(np.argmax(np.abs(heights[end])))])
                raise _not_died_out(worst, f"{name} = {places[end]:g} mm, {'y' if name == 'x' else 'x'} = {along:g} mm")

    @cached_property
    def _along_x(self) -> Axis:
        return Axis(self.x)

    @cached_property
    def _along_y(self) -> Axis:
        return Axis(self.y)

    @cached_property
    def _patches(self) -> Floats:
        """Coefficients (n - 1, m - 1, 4, 4) of the cells' bicubics, highest power first, along x then along y."""
        from scipy.interpolate import CubicSpline

        # No slope at the ends: at 0 that is what mirroring the points gives, at the outer edge it has died out.
        rows = CubicSpline(self.x, self.dz, axis=0, bc_type="clamped").c
        both = CubicSpline(self.y, rows, axis=2, bc_type="clamped").c
        return np.ascontiguousarray(both.transpose(3, 1, 2, 0))


@dataclass(frozen=True, eq=False)
class RadialCorrection(Correction):
    """Heights dz (n,) [mm] over the distances rho (n,) [mm] from the axis, what a lathe can turn; a `Correction`.

    Raises InputError when rho does not begin at 0 and increase, or the heights are not finite or not nil at the end.
    """

    rho: Floats
    dz: Floats

    def __post_init__(self) -> None:
        rho = axis("rho", self.rho, where=WHERE).points
        dz = np.asarray(self.dz, dtype=np.float64)
        if dz.shape != rho.shape or not np.isfinite(dz).all():
            raise InputError.of("the heights must be finite, one for every rho", where=WHERE)
        if abs(rho[0]) > SAME:
            raise InputError.of(
                f"the correction starts at rho = {rho[0]:g} mm, not on the axis",
                where=WHERE,
                hint="add the point at rho = 0; points at negative rho are not needed, the correction is even",
            )
        if abs(dz[-1]) > NIL:
            raise _not_died_out(abs(float(dz[-1])), f"rho = {rho[-1]:g} mm")
        object.__setattr__(self, "rho", rho)
        object.__setattr__(self, "dz", dz)

    @property
    def mirror_planes(self) -> bool:
        """Always true for a correction of revolution."""
        return True

    @property
    def reach(self) -> float:
        """Where it ends [mm]."""
        return float(self.rho[-1])

    @property
    def largest(self) -> float:
        """Largest size of its heights [mm]."""
        return float(np.abs(self.dz).max())

    @property
    def points(self) -> Floats:
        """Rows (rho, dz) [mm], (n, 2)."""
        return np.column_stack((self.rho, self.dz))

    @property
    def setting(self) -> dict[str, object]:
        """The table { kind = "radial", points = [...] }."""
        return {"kind": "radial", "points": self.points.tolist()}

    def rise(self, xy: Floats) -> Rise:
        """Value, gradient and Hessian over points (n, 2) [mm]."""
        rho = np.hypot(xy[:, 0], xy[:, 1])
        cells, window = self._along.cells(rho), self._along.window(rho)
        rows = self._pieces[cells.number]
        s = [np.einsum("ni,ni->n", rows, power) for power in _powers(cells.place)]
        value = s[0] * window.value
        first = s[1] * window.value + s[0] * window.first
        second = s[2] * window.value + 2.0 * s[1] * window.first + s[0] * window.second
        at_axis = rho <= SAME
        length = np.where(at_axis, 1.0, rho)
        out = np.where(at_axis[:, None], (1.0, 0.0), xy / length[:, None])
        circle = np.where(at_axis, second, first / length)
        radial = out[:, :, None] * out[:, None]
        hessian = (second - circle)[:, None, None] * radial + circle[:, None, None] * np.eye(2)
        return Rise(value, first[:, None] * out, hessian)

    @cached_property
    def _along(self) -> Axis:
        return Axis(self.rho)

    @cached_property
    def _pieces(self) -> Floats:
        """Coefficients (n - 1, 4) of the cubics, highest power first."""
        from scipy.interpolate import CubicSpline

        return np.ascontiguousarray(CubicSpline(self.rho, self.dz, bc_type="clamped").c.T)


def _windowed(s: dict[tuple[int, int], Floats], wx: Window, wy: Window) -> Rise:
    """The product of a spline and its two windows, with its derivatives."""
    x0, x1 = s[0, 0] * wx.value, s[1, 0] * wx.value + s[0, 0] * wx.first
    x2 = s[2, 0] * wx.value + 2.0 * s[1, 0] * wx.first + s[0, 0] * wx.second
    y1, y2 = s[0, 1] * wx.value, s[0, 2] * wx.value
    xy = s[1, 1] * wx.value + s[0, 1] * wx.first
    gradient = np.column_stack((x1 * wy.value, y1 * wy.value + x0 * wy.first))
    hessian = np.empty((x0.size, 2, 2))
    hessian[:, 0, 0] = x2 * wy.value
    hessian[:, 1, 1] = y2 * wy.value + 2.0 * y1 * wy.first + x0 * wy.second
    hessian[:, 0, 1] = hessian[:, 1, 0] = xy * wy.value + x1 * wy.first
    return Rise(x0 * wy.value, gradient, hessian)


def _powers(u: Floats) -> tuple[Floats, Floats, Floats]:
    """(u³, u², u, 1) and their first two derivatives, each (n, 4)."""
    nil, one = np.zeros_like(u), np.ones_like(u)
    return (
        np.column_stack((u**3, u * u, u, one)),
        np.column_stack((3.0 * u * u, 2.0 * u, one, nil)),
        np.column_stack((6.0 * u, 2.0 * one, nil, nil)),
    )


def _even(points: Floats, heights: Floats) -> bool:
    """Whether heights (n, m) over points (n,) are the same on both sides of 0."""
    same = np.abs(points + points[::-1]).max() <= SAME
    return bool(same and np.abs(heights - heights[::-1]).max() <= SAME)


def _not_died_out(height: float, place: str) -> InputError:
    return InputError.of(
        f"the correction is still {height:.3g} mm at its edge, at {place}",
        where=WHERE,
        hint="let it die out before its edge: the punch goes on without a step; only an edge at 0 is mirrored",
    )
