"""Where a cloud of unknown place roughly lies: robust fits on the punch from several starts.

A cloud may be metres away, tilted, upside down (a dish is often measured from inside), or hold the flange or not.
"""

from __future__ import annotations

import math

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.measured.fitting import descend
from punchform.measured.pose import Pose, rotation, shortest_turn, unmoved
from punchform.measured.target import Reference

SAMPLE = 400
STEPS = 25
BETTER = 0.8
"""A later start must leave this much less than the best one before it."""
NOISE = 1.4826
"""Sigma of a normal law over its median absolute deviation."""
TURNS = 24
ALIKE = 1.25


def rough_pose(points: Floats, punch: Reference) -> Pose:
    """The pose of a cloud (N, 3) [mm] to within what a best fit puts right.

    Starts: as measured; then each principal axis of the cloud taken for the axis of the punch, the flattest first,
    the way nearer to up before the other. The turn about the axis is the least that does it: the surface knows none.
    """
    some = points[np.linspace(0, len(points) - 1, min(SAMPLE, len(points))).astype(np.int64)]
    best, left = unmoved(), math.inf
    for start in _starts(some, punch):
        pose, _ = descend(some, punch, start, cauchy, steps=STEPS)
        score = float(np.median(np.abs(punch.distance_gradient(pose.to_run(some))[0])))
        if score < BETTER * left:
            best, left = pose, score
    return best


def best_turn(points: Floats, reference: Reference, pose: Pose, kept: Bools) -> tuple[Pose, tuple[float, ...]]:
    """The pose turned about the axis of the punch to where the cloud lies best on a surface that is not round.

    Returns it and the other turns [rad] that are about as good: what symmetry cannot tell. The smallest wins.
    """
    some = np.flatnonzero(kept)
    some = some[np.linspace(0, len(some) - 1, min(SAMPLE, len(some))).astype(np.int64)]
    turns = np.array([(-1) ** k * ((k + 1) // 2) for k in range(TURNS)]) * (2 * math.pi / TURNS)
    left = np.array([_left(points[some], reference, _turned(pose, turn)) for turn in turns])
    alike = np.flatnonzero(left <= ALIKE * left.min())
    lone = [k for k in alike if not _near_smaller(turns, alike, left, int(k))]
    first = min(lone, key=lambda k: (abs(float(turns[k])), int(k)))
    return _turned(pose, float(turns[first])), tuple(float(turns[k]) for k in lone if k != first)


def cauchy(residual: Floats) -> Floats:
    """Weights (n,) that fall off beyond three sigma of most of the residuals, so that strays pull little."""
    scale = 3 * NOISE * float(np.median(np.abs(residual)))
    return np.asarray(1.0 / (1.0 + (residual / max(scale, 1e-9)) ** 2))


def _starts(points: Floats, punch: Reference) -> list[Pose]:
    middle = np.median(points, axis=0)
    _, axes = np.linalg.eigh(np.cov((points - middle).T))
    starts = [unmoved()]
    for axis in axes.T:
        up = axis if axis[2] >= 0 else -axis
        starts += [_centred(points, punch, shortest_turn(way)) for way in (up, -up)]
    return starts


def _centred(points: Floats, punch: Reference, to_run: Floats) -> Pose:
    """The pose with the middle of the cloud's extent on the axis, and half of the points above the punch."""
    turned = points @ to_run.T
    low, high = np.quantile(turned, [0.02, 0.98], axis=0)
    middle = 0.5 * (low + high)
    placed = turned - np.array([middle[0], middle[1], low[2]])
    value, gradient = punch.distance_gradient(placed)
    steep = np.where(np.abs(gradient[:, 2]) > 0.1, gradient[:, 2], 0.1)
    middle[2] = low[2] + float(np.median(value / steep))
    return Pose(to_run.T, to_run.T @ middle)


def _turned(pose: Pose, turn: float) -> Pose:
    return Pose(pose.turn @ rotation(np.array([0.0, 0.0, turn])), pose.shift)


def _left(points: Floats, reference: Reference, pose: Pose) -> float:
    """Standard deviation of the distances: a turn does not know the height."""
    aligned = pose.to_run(points)
    over = reference.covers(aligned)
    return float(reference.distance_gradient(aligned[over])[0].std()) if over.sum() > 3 else math.inf


def _near_smaller(turns: Floats, alike: Ints, left: Floats, k: int) -> bool:
    """Whether a turn next to this one, among those that are alike, leaves less."""
    apart = np.abs(np.angle(np.exp(1j * (turns[alike] - turns[k]))))
    beside = alike[(apart > 0) & (apart < 1.5 * 2 * math.pi / TURNS)]
    return bool((left[beside] < left[k]).any())
