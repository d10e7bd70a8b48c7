"""How far points lie from a surface, in three measures: Eqs. (9.2)-(9.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from punchform.accuracy.target import Pose, Target
from punchform.arrays import Floats
from punchform.punch import Gap, Revolution

Measure = Literal["axial", "normal", "half-path"]
MEASURES: tuple[Measure, ...] = ("axial", "normal", "half-path")

STEEPEST = 1e-6
"""The least n_z of a wall whose slope is still used as such."""


@dataclass(frozen=True)
class Deviations:
    """Deviations of n points [mm], all positive upwards: on the outside of a dome, away from its focus.

    axial: along the axis of the surface; normal: to the orthogonal foot; half_path: normal times the n_z of the
    foot, which for a paraboloid is half of what the path of a ray from the focus grows by. All (n,).
    """

    axial: Floats
    normal: Floats
    half_path: Floats

    def of(self, measure: Measure) -> Floats:
        """The deviations (n,) in one measure."""
        return {"axial": self.axial, "normal": self.normal, "half-path": self.half_path}[measure]


def deviations(points: Floats, target: Target, pose: Pose | None = None) -> Deviations:
    """Deviations of points (n, 3) [mm] from the target as it stands in a pose, Eqs. (9.2)-(9.4)."""
    pose = pose or target.pose
    local, shape = target.local(points, pose), target.shape(pose)
    normal, gradient = shape.distance_gradient(local)
    axial = local[:, 2] - _height(shape, np.hypot(local[:, 0], local[:, 1]), target.end)[0]
    return Deviations(axial, normal, normal * gradient[:, 2])


def feet(points: Floats, target: Target, pose: Pose | None = None) -> Floats:
    """The nearest points (n, 3) [mm] of the target to points (n, 3) [mm]."""
    pose = pose or target.pose
    distance, gradient = target.shape(pose).distance_gradient(target.local(points, pose))
    return points - distance[:, None] * (gradient @ pose.rotation.T)


def offset(points: Floats, target: Target, distance: float) -> Floats:
    """Points (n, 3) [mm] moved by a distance [mm] along the normals of the target, upwards."""
    _, gradient = target.surface.distance_gradient(target.local(points, target.pose))
    return points + distance * gradient


class Slopes(NamedTuple):
    """A measure (n,) [mm] with its gradient (n, 3) in the axes of the surface and its slope (n,) by f."""

    value: Floats
    gradient: Floats
    by_f: Floats


def slopes(points: Floats, target: Target, pose: Pose, measure: Measure) -> tuple[Floats, Floats]:
    """A measure (n,) [mm] and its exact Jacobian (n, 6) by (u, v, w, alpha, beta, f), Eq. (9.5)."""
    local, shape = target.local(points, pose), target.shape(pose)
    found = _axial(local, shape, pose, target.end) if measure == "axial" else _normal(local, shape, pose, measure)
    jacobian = np.empty((len(points), 6))
    jacobian[:, :3] = -found.gradient @ pose.rotation.T
    lever = points - pose.shift - np.array([0.0, 0.0, target.apex_height])
    for column, turn in zip((3, 4), pose.rotation_slopes, strict=True):
        jacobian[:, column] = np.einsum("na,na->n", lever @ turn, found.gradient)
    jacobian[:, 5] = found.by_f
    return found.value, jacobian


def _axial(local: Floats, shape: Revolution, pose: Pose, end: float) -> Slopes:
    rho = np.hypot(local[:, 0], local[:, 1])
    height, slope = _height(shape, rho, end)
    away = np.where(rho > 0, slope / np.where(rho > 0, rho, 1.0), 0.0)
    gradient = np.column_stack((-away * local[:, 0], -away * local[:, 1], np.ones(len(rho))))
    by_f = np.zeros(len(rho)) if pose.f is None else -((0.5 * rho / pose.f) ** 2)
    return Slopes(local[:, 2] - height, gradient, by_f)


def _normal(local: Floats, shape: Revolution, pose: Pose, measure: Measure) -> Slopes:
    gap = shape.gap(local)
    sinking, turning = _by_focal_length(local, gap, pose.f)
    if measure == "normal":
        return Slopes(gap.value, gap.gradient, sinking)
    up = gap.gradient[:, 2]
    gradient = up[:, None] * gap.gradient + gap.value[:, None] * gap.hessian[:, :, 2]
    return Slopes(gap.value * up, gradient, up * sinking + gap.value * turning)


def _by_focal_length(local: Floats, gap: Gap, f: float | None) -> tuple[Floats, Floats]:
    """Slopes by f (n,) of the signed distance and of n_z at its foot; zero for other surfaces."""
    if f is None:
        return np.zeros(len(local)), np.zeros(len(local))
    foot = local - gap.value[:, None] * gap.gradient
    slope = np.hypot(foot[:, 0], foot[:, 1]) / (2 * f)
    long = 1 + slope**2
    spread = 1 + gap.value / (2 * f * long**1.5)
    return -(slope**2) / np.sqrt(long), slope**2 * (1 + long) / (2 * f * long**2.5 * spread)


def _height(shape: Revolution, rho: Floats, end: float) -> tuple[Floats, Floats]:
    """Height and slope of a surface over rho (n,), straight on beyond its end."""
    inside = np.minimum(rho, end)
    on_x = np.column_stack((inside, np.zeros(len(rho)), shape.chain.height(inside)))
    _, gradient = shape.distance_gradient(on_x)
    slope = -gradient[:, 0] / np.maximum(gradient[:, 2], STEEPEST)
    return on_x[:, 2] + slope * (rho - inside), slope
