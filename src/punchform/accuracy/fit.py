"""Best fits: the pose of the target that comes nearest to the points, Eqs. (9.9)-(9.12)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from punchform.accuracy.deviation import Measure, slopes
from punchform.accuracy.target import PARAMETERS, Pose, Target
from punchform.arrays import Floats
from punchform.errors import InputError

ALIGNMENTS: MappingProxyType[str, tuple[str, ...]] = MappingProxyType(
    {
        "as held": (),
        "3-parameter": ("w", "alpha", "beta"),
        "4-parameter": ("w", "alpha", "beta", "f"),
        "5-parameter": ("u", "v", "w", "alpha", "beta"),
        "6-parameter": ("u", "v", "w", "alpha", "beta", "f"),
    }
)
"""What each alignment may move. Those without f are rigid: for targets that are no paraboloid, or whose f is fixed."""

UNITS = MappingProxyType({"u": 1.0, "v": 1.0, "w": 1.0, "alpha": 1e-3, "beta": 1e-3, "f": 1.0})
"""One millimetre, one milliradian: the scale of the columns of the Jacobian."""

SINGULAR = 1e10
"""A condition number beyond which parameters cannot be told apart in double precision."""
POLISH, NEARBY = 4, 1e-3
"""How many steps polish a pose that has been found, and the largest that still does so [mm, mrad]."""


@dataclass(frozen=True)
class Fit:
    """A best fit: the pose, how well it is determined, and whether it settled.

    free: the parameters that moved; rms [mm] of the minimised measure; condition: of the Jacobian in mm and mrad,
    Eq. (9.10), 1 when nothing moves, infinite when parameters cannot be told apart; sigmas: standard error of each
    moved parameter [mm, rad], Eq. (9.11), from the scatter of the points, NaN when they cannot be told apart.
    """

    free: tuple[str, ...]
    measure: Measure
    pose: Pose
    rms: float
    condition: float
    sigmas: dict[str, float]
    converged: bool


def best_fit(points: Floats, weights: Floats, target: Target, free: tuple[str, ...], measure: Measure) -> Fit:
    """The pose of the target with the least weighted rms of a measure over points (n, 3) [mm], Eq. (9.9).

    weights (n,) >= 0; free: the parameters that may move, such as ALIGNMENTS["4-parameter"]. Nothing is linearised:
    feet and turns are exact. Raises InputError when there are too few points, or f is to be fitted to a surface
    that has none.
    """
    _demand_enough(weights, target, free)
    start, share = target.pose, weights / weights.sum()
    if not free:
        value, _ = slopes(points, target, start, measure)
        return Fit(free, measure, start, math.sqrt(float(share @ value**2)), 1.0, {}, True)
    from scipy.optimize import least_squares

    columns = [PARAMETERS.index(name) for name in free]
    unit = np.array([UNITS[name] for name in free])
    begin = np.array([getattr(start, name) for name in free])
    root = np.sqrt(share)

    def pose(x: Floats) -> Pose:
        return start.moved(dict(zip(free, (begin + x * unit).tolist(), strict=True)))

    def residual(x: Floats) -> Floats:
        return np.asarray(root * slopes(points, target, pose(x), measure)[0])

    def jacobian(x: Floats) -> Floats:
        return np.asarray(root[:, None] * slopes(points, target, pose(x), measure)[1][:, columns] * unit)

    bounds = np.where(np.array(free) == "f", -0.9 * begin, -np.inf), np.full(len(free), np.inf)
    found = least_squares(
        residual, np.zeros(len(free)), jacobian, bounds, ftol=1e-15, xtol=1e-11, gtol=1e-15, max_nfev=200
    )
    best = pose(_polished(found.x, residual, jacobian))
    value, full = slopes(points, target, best, measure)
    scaled = full[:, columns] * unit
    condition = _condition(root[:, None] * scaled)
    sigmas = _sigmas(scaled, share, value, condition) * unit
    rms = math.sqrt(float(share @ value**2))
    return Fit(free, measure, best, rms, condition, dict(zip(free, sigmas.tolist(), strict=True)), found.success)


def _polished(x: Floats, residual: Callable[[Floats], Floats], jacobian: Callable[[Floats], Floats]) -> Floats:
    """A few more steps of Gauss and Newton: an rms that no longer falls leaves its pose half of the digits."""
    for _ in range(POLISH):
        step = np.linalg.lstsq(jacobian(x), residual(x), rcond=1.0 / SINGULAR)[0]
        if not np.linalg.norm(step) <= NEARBY:
            break
        x = x - step
    return x


def implied_shift(target: Target, pose: Pose) -> Floats:
    """How far a pose moves the focus of a paraboloid, or the vertex of another surface (3,) [mm], Eq. (9.12)."""
    if pose.f is None:
        return pose.shift
    return target.focus(pose) - target.focus(target.pose)


def _demand_enough(weights: Floats, target: Target, free: tuple[str, ...]) -> None:
    count = int((weights > 0).sum())
    if count <= len(free):
        raise InputError.of(
            f"the aperture holds {count} nodes with an area, too few to fit {len(free)} parameters",
            where="target.aperture_radius",
            hint="take a larger aperture or a finer grid",
        )
    if "f" in free and target.focal_length is None:
        raise InputError.of(
            "the target is no paraboloid and has no focal length to be fitted",
            where="target.profile",
            hint="use the 3-parameter or the 5-parameter alignment",
        )


def _condition(scaled: Floats) -> float:
    singular = np.linalg.svd(scaled, compute_uv=False)
    return math.inf if singular[-1] * SINGULAR <= singular[0] else float(singular[0] / singular[-1])


def _sigmas(scaled: Floats, share: Floats, value: Floats, condition: float) -> Floats:
    """Eq. (9.11): the scatter of a single point, carried through the weighted fit."""
    if math.isinf(condition):
        return np.full(scaled.shape[1], np.nan)
    inverse = np.linalg.inv(scaled.T @ (share[:, None] * scaled))
    doubled = inverse @ (scaled.T @ (share[:, None] ** 2 * scaled))
    freedom = 1.0 - float(np.trace(doubled))
    variance = float(share @ value**2) / freedom if freedom > 0 else math.nan
    return np.asarray(np.sqrt(variance * np.diag(doubled @ inverse)))
