"""What scatter does to accuracy: designs drawn from the [scatter] of a case, and what their figures say together."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case, CircleBlank, PolygonBlank, RectangleBlank, WiresBlank, written
from punchform.case.scattering import Scattered, scattered
from punchform.errors import InputError
from punchform.optimise.evaluations import Evaluation

PERCENTILES = (5, 25, 50, 75, 95)
CONFIDENCE = 0.95
FEWEST = 10
"""Samples of which nothing can be said when there are fewer."""
HELD = ("clamped", "held")
NUMBERS = re.compile(r"[0-9]+(?:\.[0-9]+)?")
STEP, BLANK = "grid.step", "grid.blank"


@dataclass(frozen=True)
class Influence:
    """What one scattered number does to the rms.

    slope: standardised, Eq. (13.56): by how many of its own standard deviations the rms changes with one of this
    number; share: of the variance of the rms, its square; rank: correlation of the ranks, Eq. (13.57).
    """

    place: str
    slope: float
    share: float
    rank: float


@dataclass(frozen=True)
class Tolerances:
    """What the samples say.

    nominal: rms of the case itself, None when it fails; values (n,): rms of the samples that did not fail [mm];
    samples: of all; tolerance [mm]; within: samples that are; low and high: the interval of the yield, Eq. (13.55);
    influences: the numbers that matter most first, by the samples that hold the same crossings as the nominal case;
    empty where too few samples or no scatter of the rms tell it; explained: share of the variance that is linear in
    the numbers; failures: messages with how many samples have one like them; held_otherwise: samples that hold other
    crossings than the nominal case.
    """

    nominal: float | None
    values: Floats
    samples: int
    tolerance: float
    within: int
    low: float
    high: float
    influences: tuple[Influence, ...]
    explained: float | None
    failures: Mapping[str, int]
    held_otherwise: int

    @property
    def yielded(self) -> float:
        """Share of all samples within the tolerance; one that failed is not."""
        return self.within / self.samples

    @property
    def mean(self) -> float:
        """Mean rms [mm]."""
        return float(self.values.mean())

    @property
    def deviation(self) -> float:
        """Standard deviation of the rms [mm]."""
        return float(self.values.std(ddof=1)) if len(self.values) > 1 else 0.0

    @property
    def percentiles(self) -> dict[int, float]:
        """Percentiles of the rms [mm]."""
        return {p: float(value) for p, value in zip(PERCENTILES, np.percentile(self.values, PERCENTILES), strict=True)}


def draws(case: Case, count: int, rng: np.random.Generator) -> Iterator[Mapping[str, Any]]:
    """So many designs, independent of each other, Eqs. (13.52) and (13.53); the first of more are the same.

    Raises InputError when the case does not say what varies, or not how it is judged.
    """
    from scipy.special import ndtri

    numbers = scattered(case)
    if case.target is None:
        raise InputError.of("is missing, so no shape is out of tolerance", where="target", hint="add a table [target]")
    uniform = rng.random((count, len(numbers)))
    normal = ndtri(uniform)
    for row, deviates in zip(uniform, normal, strict=True):
        changes = {
            one.place: one.nominal + one.amount * float(z if one.kind == "normal" else 2 * u - 1)
            for one, u, z in zip(numbers, row, deviates, strict=True)
        }
        yield changes | _grown(case, changes)


def places(case: Case) -> tuple[str, ...]:
    """The numbers that vary."""
    return tuple(one.place for one in scattered(case))


def tolerances(case: Case, nominal: Evaluation, evaluations: Sequence[Evaluation]) -> Tolerances:
    """What the evaluations of the draws of a case say together.

    Raises InputError when fewer than FEWEST of them have an rms.
    """
    assert case.target is not None
    numbers = scattered(case)
    good = [one for one in evaluations if one.figures.get("rms") is not None]
    failures = _counted([one.failure for one in evaluations if one.failure is not None])
    if len(good) < FEWEST:
        most = max(failures, key=lambda message: failures[message], default="")
        raise InputError.of(
            f"only {len(good)} of {len(evaluations)} samples have an rms; {FEWEST} are needed"
            + (f". Most failed like this: {most}" if most else ""),
            where="--samples",
        )
    values = _rms(good)
    within = int((values <= case.target.tolerance).sum())
    # Where other crossings are held the rms jumps, which no slope tells.
    smooth = [one for one in good if not _holds_otherwise(one, nominal)]
    inputs = np.array([[one.changes[number.place] for number in numbers] for one in smooth], dtype=np.float64)
    influences, explained = influence(numbers, inputs, _rms(smooth))
    return Tolerances(
        nominal.figures.get("rms"),
        values,
        len(evaluations),
        case.target.tolerance,
        within,
        *wilson(within, len(evaluations)),
        influences,
        explained,
        failures,
        len(good) - len(smooth),
    )


def wilson(successes: int, count: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """The interval of a share that was seen so many times of so many, Eq. (13.55)."""
    from scipy.stats import binomtest

    interval = binomtest(successes, count).proportion_ci(confidence, method="wilson")
    return float(interval.low), float(interval.high)


def influence(
    numbers: Sequence[Scattered], inputs: Floats, values: Floats
) -> tuple[tuple[Influence, ...], float | None]:
    """What each number, a column of the inputs (n, k), does to the values (n,), the most important first; and the
    share of the variance that all explain together in a straight line, Eqs. (13.56) and (13.57)."""
    from scipy.stats import rankdata

    if len(values) <= len(numbers) + 1 or not values.std() > 0 or not (inputs.std(axis=0) > 0).all():
        return (), None
    x, y = _standardised(inputs), _standardised(values)
    slopes = np.linalg.lstsq(x, y, rcond=None)[0]
    rest = y - x @ slopes
    ranks = _standardised(rankdata(inputs, axis=0)).T @ _standardised(rankdata(values)) / len(values)
    each = [
        Influence(number.place, float(slope), float(slope) ** 2, float(rank))
        for number, slope, rank in zip(numbers, slopes, ranks, strict=True)
    ]
    return tuple(sorted(each, key=lambda one: -one.share)), float(1 - rest @ rest / (y @ y))


def _counted(messages: Sequence[str]) -> dict[str, int]:
    """Messages with how often they come, the most frequent first; those that differ in numbers only are one."""
    alike: dict[str, list[str]] = {}
    for message in messages:
        alike.setdefault(NUMBERS.sub("#", message), []).append(message)
    return {each[0]: len(each) for each in sorted(alike.values(), key=len, reverse=True)}


def _standardised(values: Floats) -> Floats:
    return np.asarray((values - values.mean(axis=0)) / values.std(axis=0))


def _grown(case: Case, changes: Mapping[str, float]) -> dict[str, Any]:
    """The blank of a grid whose step is another: it is cut along the same meshes, Eq. (13.53), so no crossing on its
    outline comes or goes."""
    if STEP not in changes or any(place.startswith(BLANK) for place in changes):
        return {}
    ratio = changes[STEP] / case.grid.step[0]
    match case.grid.blank:
        case CircleBlank(radius=radius):
            return {f"{BLANK}.radius": ratio * radius}
        case RectangleBlank(size=size):
            return {f"{BLANK}.size": [ratio * length for length in size]}
        case PolygonBlank(points=points):
            return {f"{BLANK}.points": [[ratio * length for length in point] for point in points]}
        case WiresBlank():
            wires = written(case, f"{BLANK}.wires")
            ends = ({"low": ratio * one.low, "high": ratio * one.high} for one in case.grid.blank.wires)
            return {f"{BLANK}.wires": [each | end for each, end in zip(wires, ends, strict=True)]}
    raise TypeError(f"unknown blank {case.grid.blank!r}")


def _rms(evaluations: Sequence[Evaluation]) -> Floats:
    return np.array([one.figures["rms"] for one in evaluations], dtype=np.float64)


def _holds_otherwise(one: Evaluation, nominal: Evaluation) -> bool:
    """Whether other crossings are held than in the nominal case, in the press or after it."""
    return not nominal.failed and any(one.figures[name] != nominal.figures[name] for name in HELD)
