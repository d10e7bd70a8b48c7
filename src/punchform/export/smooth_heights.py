"""A smooth surface through the crossings of a grid, as heights over x and y: also where the grid has none."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats

DEGREE, FEWEST = 4, 45
"""Degree of the polynomial that is taken off first, and how many points it needs; with fewer it is of degree 2."""
BEYOND = 3.0
"""Points so many steps beyond the radius still shape the surface."""
CALM = 1.5
"""At this part of the radius the surface has become the polynomial; the corners of its square lie inside."""
ROUND = 96
"""Places on the circle where it has."""
MOST = 100
"""Sweeps that find the slopes at the points, at most."""


def heights(points: Floats, places: Floats, *, radius: float, step: float) -> Floats:
    """Heights (n,) [mm] at places (n, 2) of the surface through points (N, 3), which a function z(x, y) describes.

    A polynomial is fitted to the points within the radius [mm]; what is left of them is interpolated by the piecewise
    cubics of Clough and Tocher, whose slopes are continuous, and goes to zero outside. The surface meets every point
    within the radius; step [mm]: how far points are apart.
    """
    from scipy.interpolate import CloughTocher2DInterpolator

    away = np.linalg.norm(points[:, :2], axis=1)
    judged = points[away <= radius]
    degree = DEGREE if len(judged) >= FEWEST else 2
    fit = np.linalg.lstsq(_powers(judged[:, :2] / radius, degree), judged[:, 2], rcond=None)[0]
    end = radius + BEYOND * step
    kept = points[away <= end]
    calm = max(CALM * radius, end + 2 * step)
    angles = 2 * np.pi * np.arange(ROUND) / ROUND
    around = calm * np.column_stack((np.cos(angles), np.sin(angles)))
    left = kept[:, 2] - _powers(kept[:, :2] / radius, degree) @ fit
    rest = CloughTocher2DInterpolator(
        np.concatenate((kept[:, :2], around)), np.concatenate((left, np.zeros(ROUND))), fill_value=0.0, maxiter=MOST
    )
    return np.asarray(_powers(places / radius, degree) @ fit + rest(places))


def _powers(places: Floats, degree: int) -> Floats:
    """All products x^a y^b of at most this degree, (n, terms)."""
    x, y = places.T
    return np.column_stack([x**a * y**b for a in range(degree + 1) for b in range(degree + 1 - a)])
