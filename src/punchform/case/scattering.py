"""What a [scatter] section means for its case: each number with its nominal value and its spread in internal units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from punchform.case.findings import Finding
from punchform.case.scatter import PERCENT, Spread
from punchform.case.varying import number, setting, unit
from punchform.case.whole import Case
from punchform.errors import InputError, Problem
from punchform.units import UnitError, dimension_of, quantity

LARGEST_SHARE = 1.0
"""Beyond so much of its nominal value nothing is a tolerance any more."""


@dataclass(frozen=True)
class Scattered:
    """A number that varies: its place, nominal value and unit, and how: the standard deviation, or how far it goes to
    both sides."""

    place: str
    nominal: float
    unit: str
    kind: Literal["normal", "uniform"]
    amount: float


def scattered(case: Case) -> tuple[Scattered, ...]:
    """The numbers of a case that vary. Raises InputError, with all that is wrong, or when none does."""
    if case.scatter is None or not case.scatter.spreads:
        raise InputError.of(
            "the case does not say what varies",
            where="scatter",
            hint='add a table [scatter] with lines such as "wire.yield_strength" = "5 %"',
        )
    found = tuple(scatter_findings(case))
    if found:
        raise InputError(Problem(one.message, ".".join(map(str, one.key)), one.hint) for one in found)
    return tuple(_read(case, place, spread) for place, spread in case.scatter.spreads.items())


def scatter_findings(case: Case) -> Iterator[Finding]:
    """What of the section does not fit the case."""
    if case.scatter is None:
        return
    for place, spread in case.scatter.spreads.items():
        try:
            _read(case, place, spread)
        except InputError as error:
            problem = error.problems[0]
            yield Finding(("scatter", place), problem.message, problem.hint)
        except UnitError as error:
            yield Finding(("scatter", place), error.message, error.hint)


def _read(case: Case, place: str, spread: Spread) -> Scattered:
    nominal, own = number(case, place), unit(case, place)
    if isinstance(setting(case, place), int):
        raise InputError.of("is a whole number, which does not scatter", where=place)
    if place.startswith(("scatter.", "solver.", "grid.step[")):
        hint = 'both steps scatter together: write "grid.step"' if place.startswith("grid") else "leave it out"
        raise InputError.of("does not vary from piece to piece", where=place, hint=hint)
    amount = _size(nominal, own, spread.amount)
    if amount <= 0:
        raise InputError.of("varies by nothing", where=place, hint="give more than 0, or leave it out")
    if nominal and amount > LARGEST_SHARE * abs(nominal):
        raise InputError.of(f"varies by more than itself, {nominal:g} {own}".rstrip(), where=place)
    return Scattered(place, nominal, own, "uniform" if spread.normal is None else "normal", amount)


def _size(nominal: float, own: str, amount: str | float) -> float:
    share = PERCENT.fullmatch(amount) if isinstance(amount, str) else None
    if share is None:
        return quantity(amount, dimension_of(own))
    if not nominal:
        raise InputError.of("a share of a nominal value of zero is nothing", hint="give a quantity such as '0.1 mm'")
    return float(share[1]) / 100 * abs(nominal)
