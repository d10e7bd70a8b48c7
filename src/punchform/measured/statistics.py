"""The statistics and tolerance table that inspection software prints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats


@dataclass(frozen=True)
class Statistics:
    """Of n signed deviations [mm]; shares are of 1, None without a tolerance.

    rms is about zero; std and var [mm²] are about the average, with n - 1; plus_avg and minus_avg are the averages
    of the deviations above and below zero (0 when there are none). Out of tolerance is over it or under it.
    """

    n: int
    minimum: float
    maximum: float
    average: float
    rms: float
    std: float
    var: float
    plus_avg: float
    minus_avg: float
    tolerance: float | None
    in_tol: float | None
    out_tol: float | None
    over_tol: float | None
    under_tol: float | None

    @property
    def within(self) -> bool | None:
        """Whether the rms is within the tolerance, which is how a case judges; None without a tolerance."""
        return None if self.tolerance is None else self.rms <= self.tolerance


def statistics(deviations: Floats, tolerance: float | None = None) -> Statistics:
    """The table of deviations (n,) [mm], n >= 1, with a band of plus and minus the tolerance [mm].

    >>> table = statistics(np.array([-3.0, 1.0, 2.0]), 1.0)
    >>> table.average, table.plus_avg, table.minus_avg, table.within
    (0.0, 1.5, -3.0, False)
    """
    plus, minus = deviations[deviations > 0], deviations[deviations < 0]
    count = len(deviations)
    var = float(deviations.var(ddof=1)) if count > 1 else 0.0
    over = under = inside = None
    if tolerance is not None:
        over, under = float((deviations > tolerance).mean()), float((deviations < -tolerance).mean())
        inside = float((np.abs(deviations) <= tolerance).mean())
    return Statistics(
        n=count,
        minimum=float(deviations.min()),
        maximum=float(deviations.max()),
        average=float(deviations.mean()),
        rms=math.sqrt(float((deviations**2).mean())),
        std=math.sqrt(var),
        var=var,
        plus_avg=float(plus.mean()) if plus.size else 0.0,
        minus_avg=float(minus.mean()) if minus.size else 0.0,
        tolerance=tolerance,
        in_tol=inside,
        out_tol=None if inside is None else 1.0 - inside,
        over_tol=over,
        under_tol=under,
    )
