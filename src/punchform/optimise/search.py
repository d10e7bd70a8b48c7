"""A design search: by gradients where all is smooth, else by a guess from all that was tried."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.asking import Answer, Ask, Asking
from punchform.optimise.downhill import downhill
from punchform.optimise.modelled import modelled
from punchform.optimise.pareto import front
from punchform.optimise.problem import Question
from punchform.optimise.slopes import Slopes

Way = Literal["gradient", "global"]
COMES_AND_GOES = ("grid.step", "grid.blank", "grid.subdivide", "release.", "punch.rim_radius", "stages", "press.hold")
"""Settings that decide which nodes there are or which are held: the figures jump where one comes or goes."""
NEAR = 0.01
"""A constraint binds, and a range is at its end, within this part of the limit or the range."""


@dataclass(frozen=True)
class Found:
    """What a search has found.

    way: how it searched, and why so; answers: all designs in the order in which they were asked for; front: those that
    no other beats, by the first objective; best: the one of them to look at first, see `best_of`; ended: why it ended.
    """

    question: Question
    way: Way
    why: str
    answers: tuple[Answer, ...]
    front: tuple[Answer, ...]
    best: Answer
    ended: str

    @property
    def binding(self) -> tuple[str, ...]:
        """The constraints that the best design just keeps."""
        merit = self.best.merit
        assert merit is not None, "the best design has figures"
        return tuple(
            one.words for one, excess in zip(self.question.limits, merit.excesses, strict=True) if excess > -NEAR
        )

    @property
    def at_end(self) -> tuple[tuple[str, str], ...]:
        """Variables at an end of their range in the best design, with that end: a wider range might do better."""
        ends = []
        for one, at in zip(self.question.space.variables, self.best.design, strict=True):
            where = at if one.continuous else one.positions[round(float(at))] if one.positions else 0.5
            if where < NEAR or where > 1 - NEAR:
                ends.append((one.place, "smallest" if where < NEAR else "largest"))
        return tuple(ends)


def way_of(question: Question) -> tuple[Way, str]:
    """How a question is searched, and why so. Raises InputError for a gradient where there is none."""
    asked, space = question.asked.method, question.space
    whole = [one.place for one in space.variables if not one.continuous]
    jumping = [one.place for one in space.variables if one.place.startswith(COMES_AND_GOES)]
    if asked == "gradient":
        if whole:
            raise InputError.of(
                f"`{whole[0]}` has no gradient: it goes in steps",
                where="optimise.method",
                hint='write method = "global"',
            )
        return "gradient", "as the case says"
    if asked == "global":
        return "global", "as the case says"
    if len(question.objectives) > 1:
        return "global", "several objectives have a front, not one way down"
    if whole:
        return "global", f"`{whole[0]}` goes in steps"
    if jumping:
        return "global", f"`{jumping[0]}` decides which crossings there are, so that figures jump"
    return "gradient", "all variables are continuous and no crossing comes or goes with them"


def search(
    question: Question,
    ask: Ask,
    *,
    slopes: Slopes | None = None,
    observe: Callable[[Answer], None] | None = None,
) -> Found:
    """Search for the best design, or the front of several objectives, with as many evaluations as the case allows.

    ask: evaluates designs; slopes: their derivatives, differences without it; observe: is told of every answer. The
    path depends on the question, the answers and the seed alone: asked again with a record it is gone through without
    computing, and goes on where the record ends. Raises InputError for a method that cannot be, NoEquilibrium when no
    design has figures.
    """
    way, why = way_of(question)
    asking = Asking(question, ask, observe=observe)
    start = question.space.of(question.case)
    if way == "gradient":
        middle = question.space.nearest(np.full((1, len(question.space.variables)), 0.5))[0]
        ended = downhill(asking, middle if start is None else start, slopes)
    else:
        ended = modelled(asking, start)
    best = best_of(question, asking.answers)
    return Found(question, way, why, tuple(asking.answers), tuple(front(asking.answers)), best, ended)


def best_of(question: Question, answers: Sequence[Answer]) -> Answer:
    """The best design; of a front the one nearest to the best of each objective, in units of the front's size; where
    no design keeps the constraints the one that misses them least. Raises NoEquilibrium when no design has figures.
    """
    found = front(answers)
    if found:
        objectives = np.array([one.merit.objectives for one in found if one.merit is not None])
        size = np.ptp(objectives, axis=0)
        away = (objectives - objectives.min(axis=0)) / np.where(size > 0, size, 1.0)
        return found[int(np.argmin(np.linalg.norm(away, axis=1)))]
    known = [(one, one.merit) for one in answers if one.merit is not None]
    if not known:
        first = f", the first of them: {answers[0].why}" if answers else ""
        raise NoEquilibrium(f"not one of {len(answers)} designs has figures{first}")
    return min(known, key=lambda pair: float(np.maximum(pair[1].excesses, 0.0).sum()))[0]
