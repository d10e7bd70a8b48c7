"""Which nodes count, and how much: Eqs. (9.6) and (9.7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.errors import InputError


@dataclass(frozen=True)
class Aperture:
    """Where the shape is judged: inner_radius <= rho <= radius [mm], rho from the axis of the target.

    taper: how much weaker the feed lights the edge than the middle, as an amplitude in dB; 0 lights it evenly.
    Raises InputError for radii that enclose nothing and for a negative taper.
    """

    radius: float
    inner_radius: float = 0.0
    taper: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.inner_radius < self.radius:
            raise InputError.of(
                f"must be at least 0 and less than the aperture radius of {self.radius:g} mm, "
                f"not {self.inner_radius:g} mm",
                where="target.inner_radius",
            )
        if not self.taper >= 0:
            raise InputError.of(f"must be at least 0 dB, not {self.taper:g}", where="target.taper")

    def mask(self, points: Floats) -> Bools:
        """Which of the points (n, 3) [mm] are judged; points without a place (NaN) are not."""
        rho = np.hypot(points[:, 0], points[:, 1])
        known = np.isfinite(points).all(axis=1)
        return np.asarray(known & (rho >= self.inner_radius) & (rho <= self.radius))

    def illumination(self, points: Floats) -> Floats:
        """Amplitude of the feed (n,) over points (n, 2 or 3) [mm], 1 in the middle: Eq. (9.7)."""
        edge = 10.0 ** (-self.taper / 20.0)
        squared = (points[:, 0] ** 2 + points[:, 1] ** 2) / self.radius**2
        return np.asarray(edge + (1.0 - edge) * np.clip(1.0 - squared, 0.0, 1.0))


def tributary_areas(points: Floats, cells: Ints) -> Floats:
    """Area (n,) [mm²] that belongs to each point (n, 3): a quarter of each of its cells (K, 4) seen along z, Eq. (9.6).

    A node of no cell has none; a cell with a corner that has no place is left out.
    """
    corner = points[cells][:, :, :2]
    across, other = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    area = 0.5 * np.abs(across[:, 0] * other[:, 1] - across[:, 1] * other[:, 0])
    area = np.where(np.isfinite(area), area, 0.0)
    share: Floats = np.bincount(cells.ravel(), np.repeat(0.25 * area, 4), minlength=len(points)).astype(np.float64)
    return share
