"""The punch and the target as the viewer draws them: rings of points around the axis, closer where a surface bends."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from punchform.accuracy import Pose as Place
from punchform.accuracy import Target
from punchform.arrays import Floats
from punchform.report.viewer.scene import Skin

RINGS, AROUND = 64, 96
FINE = 4001
"""Points at which a section is looked at to place the rings."""
BEND = 0.25
"""A turn by one radian gets as many rings as this share of the whole length of the section."""


class Heights(Protocol):
    """What is asked of a punch: its height z (n,) [mm] over points (n, 2) of the plane, NaN where it has ended."""

    def height(self, xy: Floats) -> Floats:
        """Height z (n,) [mm]."""
        ...


def punch_skin(surface: Heights, radius: float) -> Skin:
    """The punch out to a radius [mm]."""
    return Skin("punch", "punch", _around(surface, radius), falls=True)


def target_skin(target: Target, pose: Place, radius: float) -> Skin:
    """The target out to a radius [mm], standing in a pose, Eq. (9.1)."""
    local = _around(target.shape(pose), radius)
    local[:, :, 2] -= target.surface.height_at_axis
    vertex = pose.shift + np.array([0.0, 0.0, target.apex_height])
    return Skin("target", "target", local @ pose.rotation.T + vertex)


def _around(surface: Heights, radius: float) -> Floats:
    """Points (rings, AROUND, 3) [mm] of a surface over circles that lie closer where its section bends or falls."""
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    circles = _radii(surface, radius)[:, None, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    height = surface.height(circles.reshape(-1, 2)).reshape(circles.shape[:2])
    there = np.isfinite(height).all(axis=1)
    return np.concatenate((circles, height[:, :, None]), axis=2)[there]


def _radii(surface: Heights, radius: float) -> Floats:
    """Radii (RINGS,) [mm] from 0 outwards, evenly spread over the length of the section and over its turns."""
    rho = np.linspace(0.0, radius, FINE)
    height = surface.height(np.column_stack((rho, np.zeros(FINE))))
    known = np.isfinite(height)
    rho, height = rho[known], height[known]
    run, rise = np.diff(rho), np.diff(height)
    length = np.hypot(run, rise)
    turn = np.abs(np.diff(np.arctan2(rise, run), prepend=0.0))
    weight = length / length.sum() + BEND * turn
    along = np.concatenate(([0.0], np.cumsum(weight)))
    return np.asarray(np.interp(np.linspace(0.0, along[-1], RINGS), along, rho))
