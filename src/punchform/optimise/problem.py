"""What a design search asks: which designs there are, and how good each is by the figures of its run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from punchform.antenna import SPEED_OF_LIGHT, loss
from punchform.arrays import Floats
from punchform.case import Case, OptimiseCase, number, setting, varied
from punchform.case.places import dotted
from punchform.case.wording import meant
from punchform.errors import InputError, Problem
from punchform.optimise.figures import FIGURES
from punchform.optimise.space import Space, space_of
from punchform.punch.expression import Rule, rule

ROOM = 1e-6
"""How far a constraint may be missed, as a part of its limit, without being called missed."""
_MORE = {"gain_loss": "dB", "cost": ""}
Figures = Mapping[str, float | None]


@dataclass(frozen=True)
class Objective:
    """A figure to be made small (sign 1) or large (sign -1)."""

    figure: str
    sign: float

    @property
    def words(self) -> str:
        return self.figure if self.sign > 0 else f"{self.figure} (large)"


@dataclass(frozen=True)
class Limit:
    """A figure kept at or below (sign 1) or at or above (sign -1) a limit."""

    figure: str
    sign: float
    limit: float

    @property
    def words(self) -> str:
        side = "at most" if self.sign > 0 else "at least"
        return f"{self.figure} {side} {self.limit:g} {unit_of(self.figure)}".rstrip()

    def excess(self, value: float) -> float:
        """How far a value is beyond the limit, as a part of it; negative within."""
        return self.sign * (value - self.limit) / (abs(self.limit) or 1.0)


@dataclass(frozen=True)
class Merit:
    """What a search looks at in a design: objectives (p,), all to be made small, and excesses (q,), kept if <= 0."""

    objectives: Floats
    excesses: Floats

    @property
    def allowed(self) -> bool:
        return bool((self.excesses <= ROOM).all())


@dataclass(frozen=True)
class Question:
    """A design search as asked: the case without its section [optimise], and what that section says."""

    case: Case
    asked: OptimiseCase
    space: Space
    objectives: tuple[Objective, ...]
    limits: tuple[Limit, ...]
    cost: Rule | None

    @property
    def figures(self) -> tuple[str, ...]:
        """The figures that are asked for, objectives first, each once."""
        names = (*(one.figure for one in self.objectives), *(one.figure for one in self.limits))
        return tuple(dict.fromkeys(names))

    def told(self, changes: Mapping[str, object], figures: Figures) -> dict[str, float | None]:
        """The figures of a run with those that the question adds: gain loss at its frequency, and cost."""
        error = figures.get("rms_half_path_fitted")
        more: dict[str, float | None] = {}
        if self.asked.frequency is not None:
            more["gain_loss"] = None if error is None else loss(error, SPEED_OF_LIGHT / self.asked.frequency)
        if self.cost is not None:
            more["cost"] = self._cost(changes, {**figures, **more})
        return {**figures, **more}

    def merit(self, told: Figures) -> Merit | None:
        """What the search looks at, from `told`; None where a figure is not known."""
        values = {name: told.get(name) for name in self.figures}
        known = {name: value for name, value in values.items() if value is not None and math.isfinite(value)}
        if len(known) < len(values):
            return None
        return Merit(
            np.array([one.sign * known[one.figure] for one in self.objectives]),
            np.array([one.excess(known[one.figure]) for one in self.limits]),
        )

    def _cost(self, changes: Mapping[str, object], figures: Figures) -> float | None:
        assert self.cost is not None, "asked only where there is one"
        values: dict[str, float] = {}
        for name in self.cost.names:
            value = figures[name] if name in figures else number(varied(self.case, changes), name)
            if value is None:
                return None
            values[name] = value
        cost = self.cost(values)
        return cost if math.isfinite(cost) else None


def question_of(case: Case) -> Question:
    """The search that a case asks for. Raises InputError for all that is wrong with its section [optimise]."""
    asked = case.optimise
    if asked is None:
        raise InputError.of(
            "this section is missing",
            where="optimise",
            hint="say in [optimise] what may change and what is to be improved; `punchform new FILE` shows how",
        )
    plain = case.model_copy(update={"optimise": None})
    problems: list[Problem] = []
    known = (*FIGURES, *_MORE)
    named: list[tuple[tuple[str | int, ...], str]] = [
        *((("optimise", "objectives", k), one.figure) for k, one in enumerate(asked.objectives)),
        *((("optimise", "constraints", name), name) for name in asked.constraints),
    ]
    problems += [
        Problem(f"there is no figure `{name}`", dotted(path), meant(name, known))
        for path, name in named
        if name not in known
    ]
    cost, space = None, Space(())
    try:
        space = space_of(plain, asked.variables)
    except InputError as error:
        problems += error.problems
    try:
        cost = None if asked.cost is None else rule(asked.cost, _names(plain), where="optimise.cost")
    except InputError as error:
        problems += error.problems
    if cost is not None and "gain_loss" in cost.names and asked.frequency is None:
        told = "is missing: `gain_loss` in the cost needs it"
        problems.append(Problem(told, "optimise.frequency", "write frequency = 10.0, say"))
    if problems:
        raise InputError(problems)
    objectives = tuple(Objective(one.figure, 1.0 if one.maximise is None else -1.0) for one in asked.objectives)
    limits = tuple(
        Limit(name, sign, limit)
        for name, one in asked.constraints.items()
        for sign, limit in ((1.0, one.most), (-1.0, one.least))
        if limit is not None
    )
    return Question(plain, asked, space, objectives, limits, cost)


def unit_of(figure: str) -> str:
    """The unit of a figure, those of a search included."""
    return _MORE[figure] if figure in _MORE else FIGURES[figure].unit


def _names(case: Case) -> tuple[str, ...]:
    """What a cost may depend on: figures, and the numbers of the case by their places."""
    places = []

    def walk(table: Mapping[str, object], at: str) -> None:
        for key, inside in table.items():
            place = f"{at}.{key}" if at else key
            if isinstance(inside, Mapping):
                walk(inside, place)
            elif at:
                places.append(place)

    walk(case.model_dump(by_alias=True), "")
    numbers = []
    for place in places:
        value = setting(case, place)
        pair = isinstance(value, tuple) and len(value) == 2 and value[0] == value[1]
        if pair or (isinstance(value, int | float) and not isinstance(value, bool)):
            numbers.append(place)
    return (*(name for name in (*FIGURES, *_MORE) if name != "cost"), *numbers)
