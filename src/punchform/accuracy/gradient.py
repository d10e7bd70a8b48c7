"""How an rms deviation changes when the points move: its exact gradient, best fit and weights included, Eq. (13.25)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.accuracy.deviation import Measure, slopes
from punchform.accuracy.fit import ALIGNMENTS, UNITS, Fit, best_fit
from punchform.accuracy.measure import Accuracy
from punchform.accuracy.target import PARAMETERS, Pose, place
from punchform.accuracy.weights import Aperture, tributary_areas
from punchform.arrays import Bools, Floats, Ints
from punchform.case import TargetCase

NUDGE = 1e-3
"""How far a pose is moved for a second derivative, in the units of its parameters: 0.001 mm, 0.001 mrad."""


@dataclass(frozen=True)
class Judged:
    """Deviations (n,) of the judged nodes [mm] and their weights (n,)."""

    deviations: Floats
    weights: Floats

    @property
    def rms(self) -> float:
        """Weighted root mean square [mm], Eq. (9.8)."""
        return float(np.sqrt(self.weights @ self.deviations**2 / self.weights.sum()))


def judged_at(
    points: Floats, cells: Ints, case: TargetCase, like: Accuracy, *, apex_height: float, measure: Measure, fitted: bool
) -> Judged:
    """The deviations of points (n, 3) [mm] from a target in one measure, as `like` judges: at the same nodes, and where
    fitted after the same kind of best fit."""
    target = place(case.profile, case.aperture_radius, apex_height=apex_height)
    aperture = Aperture(case.aperture_radius, case.inner_radius, case.taper or 0.0)
    inside, weights = points[like.mask], _weights(points, cells, aperture, like.mask)[like.mask]
    free = ALIGNMENTS[like.best_fit if fitted else "as held"]
    fit = best_fit(inside, weights, target, free, like.fit_measure)
    return Judged(slopes(inside, target, fit.pose, measure)[0], weights)


def rms_gradient(points: Floats, cells: Ints, accuracy: Accuracy, *, measure: Measure, fitted: bool) -> Floats:
    """Derivative of the rms of a measure by the points, (n, 3): 0 where they have no say, Eq. (13.25).

    points (n, 3) [mm] and cells (K, 4): of which `accuracy` tells; fitted: after its best fit, which moves along.
    """
    fit = (accuracy.fitted if fitted else accuracy.as_held).fit
    square, gradient = _square(points, cells, accuracy, fit.pose, measure)
    if fit.free and measure != fit.measure:
        gradient += _by_way_of_the_fit(points, cells, accuracy, fit, measure)
    return np.asarray(gradient / (2 * np.sqrt(square)))


def _weights(points: Floats, cells: Ints, aperture: Aperture, mask: Bools) -> Floats:
    known = np.where(mask[:, None], points, 0.0)
    return np.asarray(np.where(mask, tributary_areas(points, cells) * aperture.illumination(known), 0.0))


def _square(points: Floats, cells: Ints, accuracy: Accuracy, pose: Pose, measure: Measure) -> tuple[float, Floats]:
    """The mean square of a measure in a pose, and its derivative by the points (n, 3) at that pose."""
    mask, weights = accuracy.mask, accuracy.weights
    total, inside = weights.sum(), weights[accuracy.mask]
    value, jacobian = slopes(points[mask], accuracy.target, pose, measure)
    square = float(inside @ value**2) / total
    gradient = np.zeros(points.shape)
    # A point that moves one way is a target that moves the other.
    gradient[mask] = -2 * (inside * value / total)[:, None] * jacobian[:, :3]
    per_weight = np.zeros(len(points))
    per_weight[mask] = (value**2 - square) / total
    return square, gradient + _by_weights(points, cells, accuracy.aperture, mask, per_weight)


def _by_weights(points: Floats, cells: Ints, aperture: Aperture, mask: Bools, factor: Floats) -> Floats:
    """Derivative by the points (n, 3) of the sum of the weights times factors (n,), Eqs. (9.6) and (9.7)."""
    known = np.where(mask[:, None], points, 0.0)
    edge = 10.0 ** (-aperture.taper / 20.0)
    area = tributary_areas(points, cells)
    gradient = np.zeros(points.shape)
    inside = mask & (np.hypot(known[:, 0], known[:, 1]) < aperture.radius)
    fading = -2 * (1 - edge) / aperture.radius**2 * (factor * area * inside)
    gradient[:, :2] = fading[:, None] * known[:, :2]
    corner = points[cells][:, :, :2]
    whole = np.isfinite(corner).all(axis=(1, 2))
    corner, used = corner[whole], cells[whole]
    share = 0.25 * (factor * aperture.illumination(known))[used].sum(axis=1)
    across, other = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    share *= 0.5 * np.sign(across[:, 0] * other[:, 1] - across[:, 1] * other[:, 0])
    by_across = share[:, None] * np.column_stack((other[:, 1], -other[:, 0]))
    by_other = share[:, None] * np.column_stack((-across[:, 1], across[:, 0]))
    for number, part in enumerate((-by_across, -by_other, by_across, by_other)):
        np.add.at(gradient[:, :2], used[:, number], part)
    return gradient


def _by_way_of_the_fit(points: Floats, cells: Ints, accuracy: Accuracy, fit: Fit, measure: Measure) -> Floats:
    """What the points do to the mean square of another measure by moving the best fit, (n, 3)."""
    columns = [PARAMETERS.index(name) for name in fit.free]
    unit = np.array([UNITS[name] for name in fit.free])

    def moved(change: Floats) -> Pose:
        found = np.array([getattr(fit.pose, name) for name in fit.free])
        return fit.pose.moved(dict(zip(fit.free, (found + change * unit).tolist(), strict=True)))

    def by_pose(pose: Pose, of: Measure) -> Floats:
        value, jacobian = slopes(points[accuracy.mask], accuracy.target, pose, of)
        weights = accuracy.weights[accuracy.mask]
        return np.asarray(2 * (weights * value / weights.sum()) @ (jacobian[:, columns] * unit))

    nudges: list[Floats] = list(NUDGE * np.eye(len(unit)))
    bent = np.stack([by_pose(moved(one), fit.measure) - by_pose(moved(-one), fit.measure) for one in nudges])
    turn = np.asarray(-np.linalg.solve(0.5 * (bent + bent.T) / (2 * NUDGE), by_pose(fit.pose, measure)))
    long = NUDGE / max(float(np.abs(turn).max()), 1e-300)
    ahead, behind = (_square(points, cells, accuracy, moved(sign * long * turn), fit.measure)[1] for sign in (1, -1))
    return np.asarray((ahead - behind) / (2 * long))
