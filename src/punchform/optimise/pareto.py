"""Which designs no other beats in all objectives, Eqs. (13.40) and (13.41)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.optimise.asking import Answer


def undominated(objectives: Floats) -> Bools:
    """Which rows (m, p) no other row dominates, Eq. (13.40); of equal rows the first."""
    free = np.ones(len(objectives), dtype=bool)
    for row, one in enumerate(objectives):
        alike = (objectives == one).all(axis=1)
        better = (objectives <= one).all(axis=1) & ~alike
        free[row] = not better.any() and not alike[:row].any()
    return free


def front(answers: Sequence[Answer]) -> list[Answer]:
    """The answers that keep the constraints and that no other such dominates, by the first objective."""
    allowed = [answer for answer in answers if answer.allowed]
    if not allowed:
        return []
    objectives = np.array([answer.merit.objectives for answer in allowed if answer.merit is not None])
    free = np.flatnonzero(undominated(objectives))
    return [allowed[row] for row in free[np.lexsort(objectives[free].T[::-1])]]


def gain(candidates: Floats, front: Floats) -> Floats:
    """How far each candidate (m, p) gets beyond a front (k, p), Eq. (13.41): negative for those it dominates."""
    beyond: Floats = (front[None, :, :] - candidates[:, None, :]).max(axis=2)
    return np.asarray(beyond.min(axis=1))


def push(candidates: Floats, front: Floats) -> Floats:
    """By how much each candidate (m, p) beats that row of a front (k, p) that it beats most, in the objective where it
    does so least, Eq. (13.41); negative for those that beat none."""
    ahead: Floats = (front[None, :, :] - candidates[:, None, :]).min(axis=2)
    return np.asarray(ahead.max(axis=1))
