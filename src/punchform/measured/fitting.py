"""Rigid best fits: a cloud on a surface, Eq. (10.2), or on points that are known by name, Eq. (10.4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.measured.pose import Pose
from punchform.measured.target import Reference

STEPS, ROUNDS, HALVINGS = 60, 12, 12
SMALL = 1e-9
"""A step this small, relative to the size of the cloud, ends a fit."""
IDLE = 1e-10
"""A step that lowers the cost by less than this share ends a fit: far below what noise leaves open."""
CREEP, DIFFERENCE = 0.3, 1e-6
FEWEST = 4
ALL_MOTIONS = np.ones(6)
LARGEST_TURN = 0.5
EXACT, SMOOTH = 1e-6, 1e-3
"""Below this share of the best-determined motion one counts as undetermined: exact surfaces, a sheet of quadrics."""
LOST = 0.05

Weigh = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Fit:
    """A pose and how well it is known.

    covariance (6, 6): of shift [mm], then turn [rad], in the axes of the run, zero along motions that are not
    determined; determined (6,): which of the six are; scatter: sigma of a residual [mm]; condition: of the
    determined motions, turns taken at the size of the cloud; used (N,): the points fitted; settled: whether the
    steps died out.
    """

    pose: Pose
    covariance: Floats
    determined: Bools
    scatter: float
    condition: float
    used: Bools
    settled: bool = True

    @property
    def errors(self) -> Floats:
        """Standard errors (6,) of shift [mm] and turn [rad]; infinite where undetermined."""
        return np.where(self.determined, np.sqrt(np.diag(self.covariance)), np.inf)


def fit_to_surface(
    points: Floats,
    reference: Reference,
    start: Pose,
    *,
    kept: Bools,
    weights: Floats,
    least: float = EXACT,
    motions: Floats = ALL_MOTIONS,
) -> Fit:
    """The pose that makes the weighted squares of the distances to the reference least.

    Parameters: points (N, 3) [mm] as measured; start near enough to see the right part of the surface; kept (N,):
    points that may count; weights (N,); least: see EXACT; motions (6,): 1 for those that are free, 0 for the others.
    Only points that the reference covers count, so the fit is repeated until they stay the same, or come round again.
    """
    pose, settled, seen = start, False, set[bytes]()
    used = kept & reference.covers(pose.to_run(points))
    for _ in range(ROUNDS):
        if used.sum() < FEWEST:
            break
        seen.add(used.tobytes())
        weigh = _constant(weights[used])
        pose, still = descend(points[used], reference, pose, weigh, least=least, motions=motions)
        again = kept & reference.covers(pose.to_run(points))
        if still and again.tobytes() in seen:
            settled = True
            break
        used = again
    if used.sum() < FEWEST:
        return Fit(pose, np.zeros((6, 6)), np.zeros(6, np.bool_), np.nan, np.inf, used, False)
    view = _look(points[used], reference, pose, weights[used], motions)
    return _with_errors(pose, view, used, least, settled)


def descend(
    points: Floats,
    reference: Reference,
    pose: Pose,
    weigh: Weigh,
    *,
    least: float = EXACT,
    steps: int = STEPS,
    motions: Floats = ALL_MOTIONS,
) -> tuple[Pose, bool]:
    """The pose after steps down Eq. (10.2), with weights from the residuals (n,), and whether the steps died out.

    Gauss-Newton; where that creeps, which it does when shift and tilt are nearly the same motion and the residuals
    are no noise, Newton with the gradient differenced.
    """
    before = np.inf
    for _ in range(steps):
        weight = weigh(reference.distance_gradient(pose.to_run(points))[0])
        view = _look(points, reference, pose, weight, motions)
        step = _solved(view, least)[0]
        length = float(np.linalg.norm(step / view.scale))
        if length < SMALL * view.size:
            return pose, True
        if length > CREEP * before:
            step = _newton_step(points, reference, pose, view, motions, least)
        before = length
        step *= min(1.0, LARGEST_TURN / max(float(np.linalg.norm(step[3:])), 1e-300))
        new, cost = _downhill(points, reference, pose, view, step)
        if cost >= view.cost * (1 - IDLE):
            return (new if cost <= view.cost else pose), True
        pose = new
    return pose, False


def fit_to_points(points: Floats, known: Floats, *, weights: Floats) -> Fit:
    """The pose that brings measured points (n, 3) [mm] nearest to where they are known to be: Kabsch's solution.

    Eq. (10.4). All n points count; whether they do is the caller's choice. n >= 3 and not on one line.
    """
    share = weights / weights.sum()
    here, there = share @ points, share @ known
    U, _, Vt = np.linalg.svd((points - here).T @ (share[:, None] * (known - there)))
    sign = np.array([1.0, 1.0, float(np.sign(np.linalg.det(U @ Vt)))])
    turn = (U * sign) @ Vt
    pose = Pose(turn, here - turn @ there)
    residual = pose.to_run(points) - known
    aligned = pose.to_run(points)
    J = [_jacobian(aligned, np.tile(axis, (len(points), 1))) for axis in np.eye(3)]
    view = _View(np.concatenate(J), residual.T.ravel(), np.tile(weights, 3), _size(aligned))
    return _with_errors(pose, view, np.ones(len(points), np.bool_), EXACT, True)


@dataclass(frozen=True)
class _View:
    """Jacobian (n, 6), residuals (n,) and weights (n,) at one pose.

    size: rms distance of the points from the origin [mm], by which turns are measured.
    """

    J: Floats
    residual: Floats
    weight: Floats
    size: float

    @property
    def cost(self) -> float:
        return float(self.weight @ self.residual**2)

    @property
    def scale(self) -> Floats:
        """What makes turns as large as shifts, (6,)."""
        return np.array([1.0] * 3 + [1.0 / self.size] * 3)

    @property
    def gradient(self) -> Floats:
        """Half the gradient of the cost (6,)."""
        return np.asarray(self.J.T @ (self.weight * self.residual))


def _look(points: Floats, reference: Reference, pose: Pose, weight: Floats, motions: Floats) -> _View:
    aligned = pose.to_run(points)
    residual, gradient = reference.distance_gradient(aligned)
    return _View(_jacobian(aligned, gradient) * motions, residual, weight, _size(aligned))


def _size(aligned: Floats) -> float:
    return float(np.sqrt((aligned**2).sum(axis=1).mean())) or 1.0


def _jacobian(aligned: Floats, gradient: Floats) -> Floats:
    """Rows -(g, x cross g) (n, 6) of Eq. (10.2)."""
    return -np.hstack((gradient, np.cross(aligned, gradient)))


def _solved(view: _View, least: float) -> tuple[Floats, Floats, Floats]:
    """The least-squares step (6,), and singular values (r,) and directions (6, r) of the determined motions."""
    root = np.sqrt(view.weight)[:, None]
    U, values, Vt = np.linalg.svd(root * view.J * view.scale, full_matrices=False)
    rank = int((values > least * values[0]).sum()) if values[0] > 0 else 0
    V = Vt[:rank].T
    step = -view.scale * (V @ ((U[:, :rank].T @ (root[:, 0] * view.residual)) / values[:rank]))
    return step, values[:rank], V


def _newton_step(
    points: Floats, reference: Reference, pose: Pose, view: _View, motions: Floats, least: float
) -> Floats:
    """Newton's step (6,) along the determined motions; Gauss-Newton's where the Hessian is not positive there."""
    gauss, _, V = _solved(view, least)
    ways = view.scale[:, None] * V
    width = DIFFERENCE * view.size
    columns = [
        ways.T @ (_look(points, reference, pose.moved(width * way), view.weight, motions).gradient - view.gradient)
        for way in ways.T
    ]
    H = np.array(columns) / width
    values, axes = np.linalg.eigh(0.5 * (H + H.T))
    if values[0] <= 0:
        return gauss
    return np.asarray(-ways @ (axes @ ((axes.T @ (ways.T @ view.gradient)) / values)))


def _downhill(points: Floats, reference: Reference, pose: Pose, view: _View, step: Floats) -> tuple[Pose, float]:
    """The pose after the step, halved until the cost falls, and its cost; the last one tried when it never does."""
    for _ in range(HALVINGS):
        new = pose.moved(step)
        residual, _ = reference.distance_gradient(new.to_run(points))
        cost = float(view.weight @ residual**2)
        if cost <= view.cost:
            break
        step = 0.5 * step
    return new, cost


def _with_errors(pose: Pose, view: _View, used: Bools, least: float, settled: bool) -> Fit:
    """Covariance s^2 (J'WJ)^+ with s^2 from the residuals, Eq. (10.5)."""
    _, values, V = _solved(view, least)
    rank = len(values)
    spread = V / values
    variance = view.cost / max(len(view.residual) - rank, 1)
    lost = 1.0 - (V**2).sum(axis=1)
    return Fit(
        pose=pose,
        covariance=variance * (spread @ spread.T) * np.outer(view.scale, view.scale),
        determined=lost < LOST,
        scatter=float(np.sqrt(variance / view.weight.mean())),
        condition=float(values[0] / values[-1]) if rank else np.inf,
        used=used,
        settled=settled,
    )


def _constant(weights: Floats) -> Weigh:
    return lambda residual: weights
