"""Moving points onto a surface along given directions: the retraction of the press."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.punch.protocol import Surface

CLOSE = 1e-10
"""A distance this small, relative to the largest coordinate, is rounding after one more Newton step."""
STEP_LIMIT = 60
STEEPEST = 10.0
"""Longest step in units of the distance: lines at less than 6 degrees to the surface approach it slowly."""


def project(surface: Surface, points: Floats, directions: Floats) -> Floats:
    """Points (n, 3) moved along their directions (n, 3), of any length and sign, onto the surface.

    A Newton iteration on the signed distance along each line, which halves steps that do not come closer;
    near the surface it takes two or three evaluations. Rows whose line does not meet the surface are NaN.
    """
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    along = directions / np.where(length == 0.0, np.nan, length)
    here = np.where(np.isfinite(along), points, np.nan)
    moved = np.full(points.shape, np.nan)
    index = np.flatnonzero(np.isfinite(here).all(axis=1))
    here, along = here[index], along[index]
    scale = np.abs(here).max(initial=0.0)
    value, slope = _along(surface, here, along)
    for _ in range(STEP_LIMIT):
        step = _newton_step(value, slope)
        close = np.abs(value) <= CLOSE * scale
        moved[index[close]] = here[close] + step[close, None] * along[close]
        going = ~close & np.isfinite(value)
        index, here, along, value, slope, step = (rows[going] for rows in (index, here, along, value, slope, step))
        if not index.size:
            break
        here, value, slope = _closer(surface, here, along, value, slope, step)
    return moved


def laid_onto(surface: Surface, near: Floats) -> Floats:
    """The points on the surface below or above those near to it (n, 3), along its normals; else straight up."""
    gradient = surface.gap(near).gradient
    points = project(surface, near, gradient / np.linalg.norm(gradient, axis=1)[:, None])
    lost = ~np.isfinite(points).all(axis=1)
    points[lost] = np.column_stack((near[lost, :2], surface.height(near[lost, :2])))
    return points


def _closer(
    surface: Surface, here: Floats, along: Floats, value: Floats, slope: Floats, step: Floats
) -> tuple[Floats, Floats, Floats]:
    """One step that brings every point closer, halved where needed; NaN values where none does."""
    new = here + step[:, None] * along
    new_value, new_slope = _along(surface, new, along)
    worse = np.flatnonzero(np.abs(new_value) >= np.abs(value))
    for _ in range(STEP_LIMIT):
        if not worse.size:
            break
        step[worse] *= 0.5
        new[worse] = here[worse] + step[worse, None] * along[worse]
        new_value[worse], new_slope[worse] = _along(surface, new[worse], along[worse])
        worse = worse[np.abs(new_value[worse]) >= np.abs(value[worse])]
    new_value[worse] = np.nan
    return new, new_value, new_slope


def _newton_step(value: Floats, slope: Floats) -> Floats:
    least = np.copysign(1.0 / STEEPEST, slope)
    return -value / np.where(np.abs(slope) < 1.0 / STEEPEST, least, slope)


def _along(surface: Surface, points: Floats, along: Floats) -> tuple[Floats, Floats]:
    """Signed distance and its derivative along the unit directions."""
    value, gradient = surface.distance_gradient(points)
    return value, np.einsum("ij,ij->i", gradient, along)
