"""A smooth guess of a figure from the designs that were tried: a cubic radial interpolant, Eq. (13.42)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats

Map = Callable[[Floats], Floats]
_MAPS: tuple[tuple[Map, Map], ...] = (
    (lambda y: y, lambda z: z),
    (np.log, np.exp),
    (np.square, lambda z: np.sqrt(np.maximum(z, 0.0))),
)
"""Scales on which a figure may be smoothest, with the way back: as it is; a power law; the root of a sum of squares."""
_STRETCH = 1.6
_MOST_STRETCH = 30.0


@dataclass(frozen=True)
class Surrogate:
    """The interpolant of one figure.

    x (m, k): features of the designs, stretched; stretch (k,): by how much each, so that the figure changes about as
    fast along all; weights of the interpolant, the way back from its scale, and the ends of what it may say there.
    """

    x: Floats
    stretch: Floats
    weights: Floats
    back: Map
    low: float
    high: float
    missed: float

    def __call__(self, features: Floats) -> Floats:
        """The guess (n,) at features (n, k)."""
        x = features * self.stretch
        guess = np.hstack((_radial(x, self.x), _tail(x))) @ self.weights
        # Far from all that was tried a cubic runs away.
        return self.back(np.clip(guess, self.low, self.high))


def surrogate(features: Floats, values: Floats, stretch: Floats | None = None) -> Surrogate:
    """The interpolant of values (m,) at features (m, k) that foretells left-out values best, Eq. (13.43).

    It is looked for from a stretch (k,) on, by one round of changes to each part of it.
    """
    best = _stretched(features, values, np.ones(features.shape[1]) if stretch is None else stretch)
    for k in range(features.shape[1]):
        for factor in (_STRETCH, 1 / _STRETCH):
            changed = best.stretch.copy()
            changed[k] = np.clip(changed[k] * factor, 1 / _MOST_STRETCH, _MOST_STRETCH)
            other = _stretched(features, values, changed)
            if other.missed < best.missed:
                best = other
                break
    return best


def _stretched(features: Floats, values: Floats, stretch: Floats) -> Surrogate:
    x, count = features * stretch, len(values)
    system = _inverse(x)
    own = np.diag(system)[:count]
    own = np.where(np.abs(own) > 1e-300, own, np.inf)
    found: list[Surrogate] = []
    for there, back in _MAPS if (values > 0).all() else _MAPS[:1]:
        scaled = there(values)
        weights = system[:, :count] @ scaled
        low, high, spread = float(scaled.min()), float(scaled.max()), float(np.ptp(scaled))
        left_out = np.clip(scaled - weights[:count] / own, low, high)
        missed = float(np.abs(back(left_out) - values).mean())
        found.append(Surrogate(x, stretch, weights, back, low - spread, high + spread, missed))
    return min(found, key=lambda one: one.missed)


def _inverse(x: Floats) -> Floats:
    """The inverse of the system of Eq. (13.42), of least norm where designs are too few or too much alike."""
    count, tail = len(x), _tail(x)
    matrix = np.zeros((count + tail.shape[1],) * 2)
    matrix[:count, :count] = _radial(x, x)
    matrix[:count, count:], matrix[count:, :count] = tail, tail.T
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.full_like(matrix, np.nan)
    if np.abs(inverse @ matrix - np.eye(len(matrix))).max() < 1e-6:
        return np.asarray(inverse)
    return np.asarray(np.linalg.pinv(matrix, rcond=1e-12, hermitian=True))


def _radial(a: Floats, b: Floats) -> Floats:
    from scipy.spatial.distance import cdist

    return np.asarray(cdist(a, b) ** 3)


def _tail(x: Floats) -> Floats:
    return np.column_stack((np.ones(len(x)), x))
