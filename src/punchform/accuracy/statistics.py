"""Weighted statistics of deviations: Eq. (9.8)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats


@dataclass(frozen=True)
class Statistics:
    """What is said of n deviations, all in mm.

    rms about zero (the mean is not taken away), mean, sigma: rms about the mean, all weighted; lowest and highest;
    p95: the size that 95 % of the weight stays within.
    """

    rms: float
    mean: float
    sigma: float
    lowest: float
    highest: float
    p95: float

    @property
    def peak_to_valley(self) -> float:
        """Highest less lowest [mm]."""
        return self.highest - self.lowest


def statistics(values: Floats, weights: Floats) -> Statistics:
    """Statistics of values (n,) [mm] with weights (n,) >= 0, Eq. (9.8). Raises ValueError without any weight."""
    total = float(weights.sum())
    if not total > 0:
        raise ValueError("statistics need at least one value with a weight")
    mean = float(weights @ values) / total
    sigma = math.sqrt(float(weights @ (values - mean) ** 2) / total)
    return Statistics(
        rms=math.sqrt(float(weights @ values**2) / total),
        mean=mean,
        sigma=sigma,
        lowest=float(values.min()),
        highest=float(values.max()),
        p95=_percentile(np.abs(values), weights, 0.95),
    )


def _percentile(values: Floats, weights: Floats, share: float) -> float:
    """The least value that this share of the weight does not exceed."""
    order = np.argsort(values)
    reached = np.cumsum(weights[order]) >= share * (1 - 1e-12) * weights.sum()
    return float(values[order][int(np.argmax(reached))])
