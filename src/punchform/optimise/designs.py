"""Which designs a sweep asks for: lists and ranges of settings, all their combinations or a Latin hypercube."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from punchform.case import Case, number, setting, unit, varied
from punchform.errors import InputError
from punchform.optimise.evaluations import internal
from punchform.units import UnitError, dimension_of, quantity

EXAMPLE = "write PLACE=VALUES, as in 'wire.diameter=0.5 mm,0.6 mm' or 'grid.step=5 mm:10 mm:6'"
MOST = 1_000_000
"""Designs that one sweep may have."""
DIGITS = 12
"""Significant digits of the numbers between the ends of a range."""


@dataclass(frozen=True)
class Choice:
    """A setting that takes one of several values: numbers in internal units, words."""

    place: str
    values: tuple[Any, ...]

    def at(self, share: float) -> Any:
        """The value at a share of the way through the list, 0 to 1."""
        return self.values[min(int(share * len(self.values)), len(self.values) - 1)]


@dataclass(frozen=True)
class Span:
    """A setting that takes any value between two, ends included; whole: whole numbers only."""

    place: str
    low: float
    high: float
    whole: bool = False

    def at(self, share: float) -> float | int:
        """The value at a share of the way from low to high, 0 to 1."""
        if self.whole:
            return int(self.low) + min(int(share * (self.high - self.low + 1)), int(self.high - self.low))
        return self.low + share * (self.high - self.low)


Variation = Choice | Span


def variation(case: Case, text: str) -> Variation:
    """What "PLACE=A,B,C", "PLACE=A:B:COUNT" or "PLACE=A:B" asks for. Raises InputError."""
    place, equals, values = (part.strip() for part in text.partition("="))
    if not place or not equals or not values:
        raise InputError.of(f"{text!r} does not say which setting takes which values", where="--over", hint=EXAMPLE)
    current = setting(case, place)
    each = [value.strip() for value in values.split(",")]
    if not all(each):
        raise InputError.of(f"a value is missing in {values!r}", where=place, hint=EXAMPLE)
    if ":" not in values:
        read = tuple(_value(case, place, value, current) for value in each)
        if len(set(map(repr, read))) < len(read):
            raise InputError.of(f"a value is given twice in {values!r}", where=place, hint="give each value once")
        return Choice(place, read)
    ends = [end.strip() for end in values.split(":")]
    if len(each) > 1 or len(ends) not in (2, 3) or not all(ends):
        raise InputError.of(
            f"{values!r} is neither a list nor a range", where=place, hint="a range is LOW:HIGH or LOW:HIGH:COUNT"
        )
    low, high = (_number(case, place, end, current) for end in ends[:2])
    if not low < high:
        raise InputError.of(f"a range rises: {ends[0]} is not less than {ends[1]}", where=place)
    whole = isinstance(current, int)
    if len(ends) == 2:
        return Span(place, low, high, whole)
    return Choice(place, _between(place, low, high, _count(place, ends[2]), whole))


def combinations(variations: Sequence[Variation]) -> Iterator[Mapping[str, Any]]:
    """All combinations, the last setting varying fastest. Raises InputError at once for a range without a count."""
    for one in variations:
        if isinstance(one, Span):
            raise InputError.of(
                "the range has no count, and no --samples are asked for",
                where=one.place,
                hint=f"write LOW:HIGH:COUNT, such as {one.low:g}:{one.high:g}:5, or give --samples",
            )
    _distinct(variations)
    lists = [one.values for one in variations if isinstance(one, Choice)]
    if math.prod(map(len, lists)) > MOST:
        raise InputError.of(f"these are {math.prod(map(len, lists))} designs; a sweep has at most {MOST}")
    places = [one.place for one in variations]
    return (dict(zip(places, values, strict=True)) for values in itertools.product(*lists))


def hypercube(variations: Sequence[Variation], count: int, rng: np.random.Generator) -> Iterator[Mapping[str, Any]]:
    """So many designs that fill the ranges evenly: a Latin hypercube, Eq. (13.51); lists are divided evenly too."""
    from scipy.stats import qmc

    _distinct(variations)
    if not 1 <= count <= MOST:
        raise InputError.of(f"{count} samples are asked for", where="--samples", hint=f"give 1 to {MOST}")
    shares = qmc.LatinHypercube(len(variations), seed=rng).random(count)
    return ({one.place: one.at(float(share)) for one, share in zip(variations, row, strict=True)} for row in shares)


def _distinct(variations: Sequence[Variation]) -> None:
    places = [one.place for one in variations]
    for place in places:
        if places.count(place) > 1:
            raise InputError.of("is varied twice", where=place, hint="give all its values in one --over")


def _value(case: Case, place: str, text: str, current: Any) -> Any:
    """One value of a list, as the setting takes it: a number, a whole number, yes or no, a word."""
    if isinstance(current, bool):
        if text not in ("true", "false"):
            raise InputError.of(f"expected true or false, not {text!r}", where=place)
        return text == "true"
    if isinstance(current, int) or unit(case, place) or isinstance(current, float):
        return _number(case, place, text, current)
    return _possible(case, place, text)


def _possible(case: Case, place: str, text: str) -> Any:
    """The value of a word, or of a setting that the case leaves out: it must be possible alone."""
    made = varied(case, {place: int(text) if text.lstrip("+-").isdecimal() else text})
    found = internal(made, place)
    return found if isinstance(found, int | float) else text


def _number(case: Case, place: str, text: str, current: Any) -> float | int:
    if isinstance(current, int) and not isinstance(current, bool):
        try:
            return int(text)
        except ValueError:
            raise InputError.of(f"expected a whole number, not {text!r}", where=place) from None
    if current is None:
        found = _possible(case, place, text)
        if not isinstance(found, int | float):
            raise InputError.of("is not a number that could vary", where=place)
        return found
    number(case, place)
    try:
        return quantity(text, dimension_of(unit(case, place)))
    except UnitError as error:
        raise InputError.of(error.message, where=place, hint=error.hint) from None


def _count(place: str, text: str) -> int:
    if not text.isdecimal() or not 2 <= int(text) <= MOST:
        raise InputError.of(f"the count of a range is 2 to {MOST}, not {text!r}", where=place, hint=EXAMPLE)
    return int(text)


def _between(place: str, low: float, high: float, count: int, whole: bool) -> tuple[float | int, ...]:
    values = [float(f"{value:.{DIGITS}g}") for value in np.linspace(low, high, count)]
    if not whole:
        return tuple(values)
    if any(value != int(value) for value in values):
        raise InputError.of(
            f"{count} values from {low:g} to {high:g} are no whole numbers", where=place, hint="change the count"
        )
    return tuple(int(value) for value in values)
