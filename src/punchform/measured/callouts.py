"""Which points are labelled one by one: some of the worst, well apart, and some that are spread evenly."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Bools, Floats, Ints

FEWEST, MOST = 8, 20
WORST = 0.1
"""The share of the points from which the worst are taken."""


def call_outs(points: Floats, deviations: Floats, inside: Bools, *, count: int = 14) -> Ints:
    """Numbers of the points to label, largest deviation first.

    Parameters: points (N, 3) [mm], deviations (N,) [mm], inside (N,): those that may be labelled; count, kept within
    8 to 20 where there are as many. Half of them lie among the tenth that deviates most, each as far as possible
    from those before; the other half goes where there is no label yet.
    """
    rows = np.flatnonzero(inside)
    wanted = min(int(np.clip(count, FEWEST, MOST)), len(rows))
    if not wanted:
        return rows
    size = np.abs(deviations[rows])
    worst = rows[np.argsort(-size, kind="stable")[: max(round(WORST * len(rows)), wanted // 2)]]
    chosen = [int(worst[0])]
    _add_farthest(chosen, points, worst, (wanted + 1) // 2)
    _add_farthest(chosen, points, rows, wanted)
    return np.array(sorted(chosen, key=lambda row: -abs(deviations[row])), dtype=np.int64)


def _add_farthest(chosen: list[int], points: Floats, rows: Ints, wanted: int) -> None:
    """Add to `chosen` the row that is farthest from all in it, until there are `wanted`."""
    away = np.min([np.linalg.norm(points[rows] - points[row], axis=1) for row in chosen], axis=0)
    while len(chosen) < wanted and away.max(initial=0.0) > 0:
        row = int(rows[np.argmax(away)])
        chosen.append(row)
        away = np.minimum(away, np.linalg.norm(points[rows] - points[row], axis=1))
