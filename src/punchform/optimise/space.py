"""What a design search may change: variables with their values, and designs as points among them.

A design is a row of one number per variable: the position from 0 to 1 in the range of a continuous variable, the number
of the level of any other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case, Contradiction, VariableCase, number, setting, unit, varied
from punchform.case.places import dotted
from punchform.errors import InputError, Problem
from punchform.units import as_written, dimension_of, quantity

STEPS = 1e-6
"""Values of a continuous variable are told to this part of its range, so that a case file reads well."""
MOST_LEVELS = 10_000


@dataclass(frozen=True)
class Variable:
    """One setting that may change.

    low, high: the ends of its range in internal units, of levels the smallest and the largest where they are numbers;
    levels: what may stand at the place, empty for a continuous variable; places: where the levels lie between 0 and 1,
    empty where they have no order, as words.
    """

    place: str
    unit: str
    low: float
    high: float
    levels: tuple[object, ...] = ()
    positions: tuple[float, ...] = ()

    @property
    def continuous(self) -> bool:
        return not self.levels

    def value(self, at: float) -> object:
        """What stands at the place: a number in internal units, or a level as the case file gives it."""
        if self.levels:
            return self.levels[round(at)]
        value = self.low + at * (self.high - self.low)
        return min(max(round(value, self._digits), self.low), self.high)

    @property
    def _digits(self) -> int:
        return math.ceil(-math.log10(STEPS * (self.high - self.low)))

    def _told(self, at: Floats) -> Floats:
        """Where values lie when they are told to `STEPS` of the range."""
        values = np.round(self.low + at * (self.high - self.low), self._digits)
        return np.clip((values - self.low) / (self.high - self.low), 0.0, 1.0)

    def nearest(self, at: Floats) -> Floats:
        """The levels nearest to positions between 0 and 1 (m,); of levels without order equal shares."""
        if self.continuous:
            return self._told(np.clip(at, 0.0, 1.0))
        if not self.positions:
            return np.asarray(np.minimum(np.floor(np.clip(at, 0.0, 1.0) * len(self.levels)), len(self.levels) - 1.0))
        away = np.abs(np.asarray(at)[:, None] - np.array(self.positions))
        return np.asarray(away.argmin(axis=1), dtype=np.float64)

    def features(self, at: Floats) -> Floats:
        """Coordinates (m, k) in which near means alike: words lie equally far, by 1, from each other."""
        if self.continuous:
            return at[:, None]
        if self.positions:
            return np.array(self.positions)[at.astype(np.int64)][:, None]
        return _simplex(len(self.levels))[at.astype(np.int64)]


@dataclass(frozen=True)
class Space:
    """All variables of a search."""

    variables: tuple[Variable, ...]

    @property
    def continuous(self) -> bool:
        """Whether all variables are."""
        return all(variable.continuous for variable in self.variables)

    @property
    def size(self) -> float:
        """How many designs there are, inf with a continuous variable."""
        return math.prod(len(variable.levels) or math.inf for variable in self.variables)

    def changes(self, design: Floats) -> dict[str, object]:
        """What a design (n,) puts at which place."""
        return {one.place: one.value(float(at)) for one, at in zip(self.variables, design, strict=True)}

    def nearest(self, positions: Floats) -> Floats:
        """The designs (m, n) nearest to positions (m, n) between 0 and 1."""
        return np.column_stack([one.nearest(positions[:, k]) for k, one in enumerate(self.variables)])

    def features(self, designs: Floats) -> Floats:
        """Coordinates (m, k) of designs (m, n) in which near means alike."""
        return np.hstack([one.features(designs[:, k]) for k, one in enumerate(self.variables)])

    def scattered(self, count: int, rng: np.random.Generator) -> Floats:
        """Designs (count, n) of a Latin hypercube: every range and every list is covered evenly."""
        from scipy.stats import qmc

        return self.nearest(qmc.LatinHypercube(len(self.variables), rng=rng).random(count))

    def near(self, designs: Floats, width: float, rng: np.random.Generator) -> Floats:
        """A neighbour of each design (m, n): some of its variables moved by about `width` of their ranges."""
        moved = designs.copy()
        chosen = rng.random(designs.shape) < max(0.5, 1.0 / len(self.variables))
        lone = rng.integers(len(self.variables), size=len(designs))
        chosen[np.arange(len(designs)), lone] = True
        for k, one in enumerate(self.variables):
            rows = np.flatnonzero(chosen[:, k])
            if one.continuous or one.positions:
                at = one.features(designs[rows, k : k + 1].ravel())[:, 0]
                moved[rows, k] = one.nearest(np.clip(at + width * rng.normal(size=len(rows)), 0.0, 1.0))
            else:
                rows = rows[rng.random(len(rows)) < max(width, 0.1)]
                moved[rows, k] = rng.integers(len(one.levels), size=len(rows))
        return moved

    def of(self, case: Case) -> Floats | None:
        """The design (n,) that a case has as it stands, None where it lies outside of the ranges and lists."""
        design = []
        for one in self.variables:
            if one.levels and not one.positions:
                here = setting(case, one.place)
                alike = [
                    k
                    for k, level in enumerate(one.levels)
                    if setting(varied(case, {one.place: level}), one.place) == here
                ]
                if not alike:
                    return None
                design.append(float(alike[0]))
                continue
            try:
                at = (number(case, one.place) - one.low) / (one.high - one.low)
            except InputError:
                return None
            if not -1e-9 <= at <= 1 + 1e-9:
                return None
            design.append(float(one.nearest(np.array([at]))[0]))
        return np.array(design)


def space_of(case: Case, variables: Mapping[str, VariableCase]) -> Space:
    """The space of the variables of a case. Raises InputError for places and values that cannot be, all at once."""
    found: list[Variable] = []
    problems: list[Problem] = []
    for place, asked in variables.items():
        try:
            found.append(_variable(case, place, asked))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return Space(tuple(found))


def _variable(case: Case, place: str, asked: VariableCase) -> Variable:
    where = ("optimise", "variables", place)
    try:
        here = setting(case, place)
    except InputError as error:
        raise InputError(Problem(one.message, dotted(where), one.hint) for one in error.problems) from None
    named = unit(case, place)
    if asked.among is not None:
        numbers = [
            _number(case, place, level, (*where, "among", k), needed=False) for k, level in enumerate(asked.among)
        ]
        if any(one is None for one in numbers):
            return Variable(place, "", 0.0, 1.0, asked.among)
        pairs = sorted(
            zip((one for one in numbers if one is not None), asked.among, strict=True), key=lambda pair: pair[0]
        )
        return _ordered(place, named, tuple(one for one, _ in pairs), tuple(level for _, level in pairs), where)
    low = _number(case, place, asked.least, (*where, "from"), needed=True)
    high = _number(case, place, asked.most, (*where, "to"), needed=True)
    if low is None or high is None:
        raise InputError.of(
            "the ends are not numbers", where=dotted(where), hint="write { among = [...] } for a choice"
        )
    if not low < high:
        raise InputError.of(
            f"from {as_written(asked.least)} to {as_written(asked.most)} there is nothing", where=dotted((*where, "to"))
        )
    if isinstance(here, int) and not isinstance(here, bool):
        if not (low.is_integer() and high.is_integer() and high - low < MOST_LEVELS):
            raise InputError.of("a whole number varies between whole numbers", where=dotted(where))
        levels = tuple(range(int(low), int(high) + 1))
        return _ordered(place, named, tuple(map(float, levels)), levels, where)
    return Variable(place, named, low, high)


def _ordered(
    place: str, named: str, numbers: tuple[float, ...], levels: tuple[object, ...], where: tuple[str, ...]
) -> Variable:
    low, high = numbers[0], numbers[-1]
    if len(set(numbers)) < len(numbers):
        raise InputError.of("holds the same value twice", where=dotted(where))
    return Variable(place, named, low, high, levels, tuple((one - low) / (high - low) for one in numbers))


def _number(case: Case, place: str, value: object, where: tuple[str | int, ...], *, needed: bool) -> float | None:
    """The number in internal units that a value would be at its place; None for a word or a table, if that may be.

    A value that the place takes but the rest of the case does not is allowed: other variables may mend that.
    Raises InputError for all else.
    """
    try:
        with_it = varied(case, {place: value})
    except Contradiction:
        try:
            return quantity(value, dimension_of(unit(case, place)))
        except ValueError:
            return None
    except InputError as error:
        raise InputError(Problem(one.message, dotted(where), one.hint) for one in error.problems) from None
    try:
        return number(with_it, place)
    except InputError:
        if not needed:
            return None
        raise InputError.of(
            "is not a number that could vary", where=dotted(where), hint="write { among = [...] } for a choice"
        ) from None


def _simplex(corners: int) -> Floats:
    """Corners (n, n - 1) that lie by 1 apart, each from each."""
    spread = np.linalg.svd(np.eye(corners) - 1.0 / corners)[0][:, : corners - 1]
    return np.asarray(spread / math.sqrt(2.0))
