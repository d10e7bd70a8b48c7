"""The punch whose released shape is the target: displacement adjustment, accelerated, safeguarded, Eqs. (13.3)-(13.7).

It knows nothing of files or of how a grid is pressed: it is given a function from a correction to its misfit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from time import perf_counter

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.acceleration import Tried, next_step
from punchform.optimise.correction_space import Space
from punchform.optimise.misfit import Misfit
from punchform.progress import Observer, Progress, silent

SOLVES = 6
"""Presses and releases at most, the one over the punch as it is included."""
WORTH = 0.9
"""A solve that leaves more than this part of the rms was not worth it."""
FOLLOWS = 0.25
"""A shape that takes less than this part of what the punch is changed by does not follow it."""
HALF = 0.5
"""One that gains little and takes less than this part has come to an end for the same reason."""
HALVINGS = 2
"""How often in a row a step is halved."""

Press = Callable[[Floats], Misfit]
"""Presses over the punch with these numbers of its correction, lets go and measures. Raises NoEquilibrium or
InputError for a punch over which that cannot be done."""


class Ending(Enum):
    """How a compensation ended. The text is what the user reads."""

    WITHIN = "within the tolerance"
    FLOOR = "this is the least: another solve would gain little on a punch of this kind"
    LIMIT = "the number of solves was reached; more of them (--solves) would go on"
    UNMOVED = "the released shape hardly follows the punch"
    UNPRESSED = "the grid could not be pressed over the punch that this asks for"


@dataclass(frozen=True)
class Limits:
    """When to stop: at the tolerance [mm], None for the least that can be reached, or after so many solves; relaxation:
    which part of the error a step answers."""

    tolerance: float | None = None
    solves: int = SOLVES
    relaxation: float = 1.0


@dataclass(frozen=True, eq=False)
class Solve:
    """One press and release: its number from 1, the numbers of the correction, and what came of it.

    misfit: None where the press failed, with the reason in `failure`; correction [mm]: the largest one at a crossing;
    follows: which part of the last change of the punch the released shape has taken, Eq. (13.7), None at first; kept:
    whether it was the best so far.
    """

    number: int
    numbers: Floats
    misfit: Misfit | None
    correction: float
    follows: float | None
    kept: bool
    seconds: float
    failure: str = ""


@dataclass(frozen=True, eq=False)
class Compensation:
    """A punch of one kind of surface that was compensated: all solves, and how it ended.

    floor [mm]: the rms that a punch of this kind would leave at least, as far as the best solve shows.
    """

    space: Space
    solves: tuple[Solve, ...]
    ending: Ending
    floor: float

    @property
    def first(self) -> Solve:
        """The solve that it began with."""
        return self.solves[0]

    @property
    def best(self) -> Solve:
        """The solve with the least rms."""
        return min((one for one in self.solves if one.misfit is not None), key=lambda one: one_rms(one))

    @property
    def gain(self) -> float:
        """How many times smaller the rms has become."""
        if self.best is self.first:
            return 1.0
        best = one_rms(self.best)
        return one_rms(self.first) / best if best > 0 else np.inf


def one_rms(solve: Solve) -> float:
    """The rms of a solve [mm]. Raises ValueError for one that failed."""
    if solve.misfit is None:
        raise ValueError("the press failed")
    return solve.misfit.rms


def compensate(
    press: Press,
    space: Space,
    limits: Limits,
    *,
    start: Floats | None = None,
    known: Misfit | None = None,
    observe: Observer = silent,
) -> Compensation:
    """Find the numbers of a correction whose released shape is the target.

    start (k,): numbers to begin with, nil if absent; known: what a solve there has given, if it is known; it counts as
    the first solve. Raises NoEquilibrium and InputError of the first press.
    """
    search = _Search(press, space, limits, observe)
    numbers = np.zeros(len(space.terms)) if start is None else start
    best = search.first(numbers, known)
    share, halved, step = 1.0, 0, np.zeros(0)
    while (ending := search.ended(best)) is None:
        if not halved:
            share, step = 1.0, search.step(best)
        found = search.solved(best.numbers + share * step, best)
        if found.misfit is not None and one_rms(found) < one_rms(best):
            gained = one_rms(found) <= WORTH * one_rms(best)
            best, halved = found, 0
            if not gained and search.ended(best) is not Ending.WITHIN:
                ending = stalled(best)
                break
            continue
        halved += 1
        if found.follows is not None and found.follows < FOLLOWS and best is search.solves[0]:
            ending = Ending.UNMOVED
            break
        if halved > HALVINGS:
            ending = given_up(search.solves[0], best, found)
            break
        share *= 0.5
    assert best.misfit is not None
    return Compensation(space, tuple(search.solves), ending, best.misfit.left(space))


class _Search:
    """The solves of a compensation so far, and what they say of the next."""

    def __init__(self, press: Press, space: Space, limits: Limits, observe: Observer) -> None:
        self.solves: list[Solve] = []
        self._press, self._space, self._limits, self._observe = press, space, limits, observe

    def first(self, numbers: Floats, known: Misfit | None) -> Solve:
        begun = perf_counter()
        misfit = self._press(numbers) if known is None else known
        return self._add(Solve(1, numbers, misfit, self._size(numbers, misfit), None, True, perf_counter() - begun))

    def solved(self, numbers: Floats, best: Solve) -> Solve:
        """Press over another punch; a failure is a solve too."""
        begun, number = perf_counter(), len(self.solves) + 1
        assert best.misfit is not None
        try:
            misfit = self._press(numbers)
        except (NoEquilibrium, InputError) as error:
            reason = str(error).removeprefix("error: ").partition("\n")[0]
            size = self._size(numbers, best.misfit)
            return self._add(Solve(number, numbers, None, size, None, False, perf_counter() - begun, reason))
        kept = misfit.rms < one_rms(best)
        follows = followed(best.misfit, misfit, self._space, numbers - best.numbers)
        size = self._size(numbers, misfit)
        return self._add(Solve(number, numbers, misfit, size, follows, kept, perf_counter() - begun))

    def step(self, best: Solve) -> Floats:
        """The step that the best solve asks for, with what the others have shown."""
        assert best.misfit is not None
        metric = np.sqrt(best.misfit.weights)[:, None] * best.misfit.shapes(self._space)
        others = [self._tried(one) for one in self.solves if one is not best and one.misfit is not None]
        return next_step(self._tried(best), others, metric, relaxation=self._limits.relaxation)

    def ended(self, best: Solve) -> Ending | None:
        """Whether nothing more is to be done."""
        misfit, tolerance = best.misfit, self._limits.tolerance
        assert misfit is not None
        if tolerance is not None and misfit.rms <= tolerance:
            return Ending.WITHIN
        if misfit.left(self._space) > WORTH * misfit.rms:
            return Ending.FLOOR
        return Ending.LIMIT if len(self.solves) >= self._limits.solves else None

    def _tried(self, solve: Solve) -> Tried:
        assert solve.misfit is not None
        return Tried(solve.numbers, -solve.misfit.answer(self._space))

    def _size(self, numbers: Floats, misfit: Misfit) -> float:
        return float(np.abs(self._space.heights(numbers, misfit.places)).max(initial=0.0))

    def _add(self, solve: Solve) -> Solve:
        self.solves.append(solve)
        told = f"{solve.misfit.rms:.4g} mm rms" if solve.misfit is not None else f"failed, {solve.failure}"
        at_most = f"solve {solve.number} of at most {max(self._limits.solves, solve.number)}"
        self._observe(
            Progress(
                "compensate",
                message=f"{self._space.kind}, {at_most}: {told}",
                done=solve.number,
                total=max(self._limits.solves, solve.number),
                limit=True,
            )
        )
        return solve


def stalled(solve: Solve) -> Ending:
    """Why a solve has gained little: its shape does not follow, or this kind of punch can do no more."""
    return Ending.UNMOVED if solve.follows is not None and solve.follows < HALF else Ending.FLOOR


def given_up(first: Solve, best: Solve, last: Solve) -> Ending:
    """Why shorter and shorter steps do not help."""
    if last.misfit is None:
        return Ending.UNPRESSED
    return Ending.UNMOVED if best is first else stalled(last)


def followed(before: Misfit, after: Misfit, space: Space, change: Floats) -> float | None:
    """Which part of a change (k,) of the punch the released shape has taken, Eq. (13.7); None without a change."""
    wanted = before.shapes(space) @ change
    size = float(before.weights @ wanted**2)
    if size == 0 or len(after.error) != len(before.error):
        return None
    return float(before.weights @ (wanted * (after.error - before.error))) / size


def continued(found: Compensation, others: tuple[Solve, ...]) -> Compensation:
    """A compensation whose solves follow on others, numbered on."""
    renumbered = tuple(replace(one, number=one.number + len(others)) for one in found.solves)
    return replace(found, solves=(*others, *renumbered))
