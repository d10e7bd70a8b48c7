"""The 3-2-1 datum at the rim: a plane through the rim points, the middle of their circle, and a direction."""

from __future__ import annotations

import math
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.errors import InputError
from punchform.measured.cloud import Cloud
from punchform.measured.fitting import Fit
from punchform.measured.pose import Pose, shortest_turn

FEWEST = 3
CIRCLE_STEPS = 50


def named_points(cloud: Cloud, names: str) -> Bools:
    """Which points (N,) a comma list of names means; `*` and `?` stand for any letters.

    Raises InputError for a name that no point has.
    """
    wanted = [part.strip() for part in names.split(",") if part.strip()]
    hits = [np.array([fnmatchcase(name, part) for name in cloud.names]) for part in wanted]
    lost = [part for part, hit in zip(wanted, hits, strict=True) if not hit.any()]
    if lost or not hits:
        raise InputError.of(
            f"no point has the name {', '.join(lost) or 'given'}", where=f"--rim-points {names}", hint=_some(cloud)
        )
    return np.asarray(np.any(hits, axis=0))


def point_named(cloud: Cloud, name: str, *, where: str) -> int:
    """The number of the point with this name. Raises InputError when there is none."""
    if name not in cloud.names:
        raise InputError.of(f"no point has the name {name}", where=where, hint=_some(cloud))
    return cloud.names.index(name)


def rim_band(aligned: Floats, rim_radius: float, half_width: float) -> Bools:
    """Points (N,) of a roughly aligned cloud (N, 3) [mm] whose distance from the axis is that of the rim."""
    return np.asarray(np.abs(np.hypot(aligned[:, 0], aligned[:, 1]) - rim_radius) <= half_width)


def fit_rim(points: Floats, rim: Bools, rough: Pose, *, rim_radius: float) -> tuple[Fit, float]:
    """The pose whose plane z = 0 and axis are those of the rim points, and the radius of their circle [mm].

    Parameters: points (N, 3) [mm] as measured; rim (N,): which are on the rim; rough: says which way is up and keeps
    its turn about the axis. Raises InputError for fewer than three rim points, or points on one line.
    """
    fit = fit_plane(points, rim, rough)
    flat = fit.pose.to_run(points[rim])[:, :2]
    centre, radius, spread = _circle(flat, rim_radius)
    away = flat - centre
    radial = np.column_stack((away / np.linalg.norm(away, axis=1)[:, None], np.ones(len(away))))
    covariance = fit.covariance.copy()
    covariance[:2, :2] = (spread**2 * np.linalg.pinv(radial.T @ radial))[:2, :2]
    pose = fit.pose.moved(np.array([*centre, 0.0, 0.0, 0.0, 0.0]))
    return replace(fit, pose=pose, covariance=covariance, determined=np.array([True] * 5 + [False])), radius


def fit_plane(points: Floats, rim: Bools, rough: Pose) -> Fit:
    """The rough pose with its plane z = 0 laid through the rim points: height and two tilts are determined.

    Raises InputError for fewer than three rim points, or points on one line.
    """
    aligned = rough.to_run(points[rim])
    count = len(aligned)
    if count < FEWEST:
        raise InputError.of(
            f"{count} points lie on the rim; the rim alignment needs at least {FEWEST}",
            where="--align rim",
            hint="name the points with --rim-points, or take --align best-fit",
        )
    middle = aligned.mean(axis=0)
    _, values, Vt = np.linalg.svd(aligned - middle, full_matrices=False)
    if values[1] < 1e-3 * values[0]:
        raise InputError.of("the rim points lie on one line", where="--align rim", hint="name others with --rim-points")
    normal = Vt[2] * (1.0 if Vt[2, 2] >= 0 else -1.0)
    level = shortest_turn(normal)
    # The axis of the plane goes through the point of it that was on the rough axis.
    origin = np.array([0.0, 0.0, float(middle @ normal) / float(normal[2])])
    pose = Pose(rough.turn @ level.T, rough.shift + rough.turn @ origin)
    flat = pose.to_run(points[rim])
    J = np.column_stack((np.ones(count), flat[:, 1], -flat[:, 0]))
    variance = float((flat[:, 2] ** 2).sum()) / max(count - 3, 1)
    covariance = np.zeros((6, 6))
    covariance[2:5, 2:5] = variance * np.linalg.inv(J.T @ J)
    determined = np.array([False, False, True, True, True, False])
    return Fit(pose, covariance, determined, math.sqrt(variance), float(np.linalg.cond(J / [1, *values[:2]])), rim)


def clocked(fit: Fit, turn: float, error: float) -> Fit:
    """The fit turned about its axis by `turn` [rad], known to a standard error [rad]."""
    covariance = fit.covariance.copy()
    covariance[5, 5] = error**2
    determined = fit.determined | np.array([False] * 5 + [True])
    return replace(fit, pose=fit.pose.moved(np.array([0.0] * 5 + [turn])), covariance=covariance, determined=determined)


def turn_between(aligned: Floats, known: Floats) -> tuple[float, float]:
    """The turn about z [rad] that brings points (n, 3) nearest to known ones, and its standard error.

    Turned by minus this angle the measured directions are the known ones.
    """
    cross = float((known[:, 0] * aligned[:, 1] - known[:, 1] * aligned[:, 0]).sum())
    along = float((known[:, :2] * aligned[:, :2]).sum())
    turn = math.atan2(cross, along)
    c, s = math.cos(turn), math.sin(turn)
    left = aligned[:, :2] - known[:, :2] @ np.array([[c, s], [-s, c]])
    free = max(2 * len(known) - 1, 1)
    return turn, math.sqrt(float((left**2).sum()) / free / float((known[:, :2] ** 2).sum()))


def _circle(plan: Floats, rim_radius: float) -> tuple[Floats, float, float]:
    """Centre (2,), radius and radial scatter of the circle nearest to points (n, 2), by Gauss-Newton."""
    centre, radius = plan.mean(axis=0), rim_radius
    for _ in range(CIRCLE_STEPS):
        away = plan - centre
        distance = np.linalg.norm(away, axis=1)
        J = -np.column_stack((away / distance[:, None], np.ones(len(plan))))
        step = np.linalg.lstsq(J, radius - distance, rcond=None)[0]
        centre, radius = centre + step[:2], radius + float(step[2])
        if float(np.abs(step).max()) < 1e-12 * rim_radius:
            break
    left = np.linalg.norm(plan - centre, axis=1) - radius
    return centre, radius, math.sqrt(float((left**2).sum()) / max(len(plan) - 3, 1))


def _some(cloud: Cloud) -> str:
    few = ", ".join(cloud.names[:5])
    return f"the file has {few}{', ...' if len(cloud.names) > 5 else ''}"
