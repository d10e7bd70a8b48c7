"""From a tensile test to a flow curve, Eqs. (12.30) and (12.34)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.wire.hardening import PLACE, Hardening, demand_plain, table

OFFSET = 1e-4
"""Plastic strain at which yielding is taken to begin: the 0.01 % proof stress."""

ELASTIC = (0.05, 0.25)
"""The parts of the largest load between which the elastic line is drawn: no wire yields below a quarter of it."""

LEAST_ROWS = 5
FEWEST_ON_LINE = 3
PER_DECADE = 12
"""Points of the flow curve per decade of plastic strain; what wiggles within is averaged."""

STIFFEST, SOFTEST = 1.5, 0.02
"""The slope of a test in its elastic part, as parts of Young's modulus: beyond them a unit is wrong."""


def from_tensile(rows: Sequence[tuple[float, float]], youngs_modulus: float, *, kinematic: float = 0.0) -> Hardening:
    """The flow curve in a tensile test.

    rows: engineering strain [-] and engineering stress [MPa] in the order of the test. What lies beyond the largest
    load is left out, where the wire necks; `breaks_at` is the true strain there. The elastic line of the test tells its
    foot and how soft the machine is, which do not count as strain; where too few rows show that line it has Young's
    modulus. Raises InputError for rows that are no such test.
    """
    where = f"{PLACE}.points"
    test = np.array(rows, dtype=np.float64)
    if test.ndim != 2 or test.shape[1] != 2 or len(test) < LEAST_ROWS:
        raise InputError.of(
            f"a tensile test needs at least {LEAST_ROWS} rows of strain and stress, not {len(test)}", where=where
        )
    demand_plain(test, where)
    last = int(np.argmax(test[:, 1]))
    test = test[: last + 1]
    # Where the strain goes back the grips slipped, or the wire was let go for a moment.
    test = test[test[:, 0] >= np.maximum.accumulate(test[:, 0])]
    if len(test) < LEAST_ROWS or test[-1, 0] <= test[0, 0] or test[0, 0] <= -1.0:
        raise InputError.of(
            f"the largest stress, {test[-1, 1]:g} MPa, comes after only {len(test)} rows of rising strain",
            where=where,
            hint="the first column is engineering strain, the second engineering stress, in the order of the test",
        )
    slope, foot = _elastic_line(test[:, 0], test[:, 1], youngs_modulus, where)
    # The strain of the wire itself, without the foot of the test, in which it has none, and what the machine gave way.
    own = np.maximum(test[:, 0] - foot - test[:, 1] * (1 / slope - 1 / youngs_modulus), 0.0)
    strain, stress = np.log1p(own), test[:, 1] * (1 + own)
    p = strain - stress / youngs_modulus
    curve = _cleaned(p, stress, where)
    made = table(curve, youngs_modulus, kinematic=kinematic)
    return Hardening(made.curve, made.kinematic, float(strain[-1]))


def _elastic_line(strain: Floats, load: Floats, youngs_modulus: float, where: str) -> tuple[float, float]:
    """Slope [MPa] of the elastic part of a test and the strain at which its line meets no stress.

    strain and load are engineering strain and stress, (M,).
    """
    low, high = (part * load[-1] for part in ELASTIC)
    beyond = int(np.argmax(load > high))
    on_line = np.flatnonzero(load[:beyond] >= low)
    if len(on_line) < FEWEST_ON_LINE or np.ptp(strain[on_line]) <= 0.0:
        slope, foot = youngs_modulus, min(0.0, float(strain[0] - load[0] / youngs_modulus))
    else:
        slope, height = np.polyfit(strain[on_line], load[on_line], 1)
        foot = float(-height / slope) if slope > 0 else 0.0
    if not SOFTEST * youngs_modulus <= slope <= STIFFEST * youngs_modulus:
        raise InputError.of(
            f"the test begins with a slope of {slope:.3g} MPa, but youngs_modulus is {youngs_modulus:g} MPa",
            where=where,
            hint="check the units: strain as a plain number (0.002 for 0.2 %), stress in MPa",
        )
    return float(slope), foot


def _cleaned(p: Floats, stress: Floats, where: str) -> list[tuple[float, float]]:
    """A rising flow curve from plastic strains and stresses that still have the elastic part and wiggles in them."""
    elastic = np.flatnonzero(p <= OFFSET)
    first = int(elastic[-1]) + 1 if len(elastic) else 0
    if first == len(p) or p[-1] <= OFFSET:
        raise InputError.of(
            f"the wire does not yield in this test: its plastic strain reaches {p[-1]:.2g}",
            where=where,
            hint="the test must go on beyond the elastic part; see that youngs_modulus is that of this wire",
        )
    begin = float(np.interp(OFFSET, p[first - 1 : first + 1], stress[first - 1 : first + 1])) if first else stress[0]
    beyond = slice(first, None)
    bins = np.floor(PER_DECADE * np.log10(p[beyond])).astype(np.int64)
    _, group, count = np.unique(bins, return_inverse=True, return_counts=True)
    mean_p, mean_stress = (np.bincount(group, weights=column[beyond]) / count for column in (p, stress))
    level = _rising(np.append(begin, mean_stress), np.append(1.0, count))
    curve = [(0.0, float(level[0])), *zip(mean_p.tolist(), level[1:].tolist(), strict=True)]
    end = (float(p[-1]), float(max(stress[-1], level[-1])))
    return [*curve, end] if end[0] > curve[-1][0] else curve


def _rising(values: Floats, weights: Floats) -> Floats:
    """The nearest values, by weighted least squares, that do not fall: the max-min formula of isotonic regression."""
    sums, totals = (np.concatenate(([0.0], np.cumsum(column))) for column in (values * weights, weights))
    width = totals[None, 1:] - totals[:-1, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        means = (sums[None, 1:] - sums[:-1, None]) / width
    means[np.tril_indices(len(values), -1)] = np.inf
    # Row i, column k: the least mean of a run from i that reaches at least to k.
    least = np.minimum.accumulate(means[:, ::-1], axis=1)[:, ::-1]
    least[np.tril_indices(len(values), -1)] = -np.inf
    return np.asarray(least.max(axis=0))
