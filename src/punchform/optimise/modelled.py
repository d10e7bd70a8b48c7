"""The search for all that is not smooth: a guess is made from all that was tried, and asks where it promises most."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.optimise.asking import Asking, SpentError
from punchform.optimise.pareto import gain, push, undominated
from punchform.optimise.surrogate import Surrogate, surrogate

Worth = Callable[[Floats, Floats], Floats]
AT_ONCE: tuple[tuple[Worth, float], ...] = ((push, 0.0), (gain, 0.0), (push, 0.01), (gain, 0.1))
"""Designs asked for at once, as many on one core as on many, so that the path does not depend on the machine: what
each is chosen for, and how far it keeps from all that was tried, in ranges."""
WIDTHS = (0.3, 0.1, 0.03, 0.01)
CLOSER = (0.03, 0.01, 0.003, 0.001)
POOL, BREED = 1600, 200
REFUSED = 1e6
DECADE = 10.0
MOST_KNOWN = 400
"""Designs that a surrogate is made of at most: its cost grows with their third power."""


def modelled(asking: Asking, start: Floats | None) -> str:
    """Ask until all evaluations are spent, or all designs known; returns which. start (n,): a design to begin with."""
    question = asking.question
    space = question.space
    rng = np.random.default_rng(question.asked.seed)
    before: list[Surrogate] = []
    try:
        if start is not None:
            asking(start[None, :])
        asking(space.scattered(_first(asking), rng))
        while len(asking.answers) < space.size:
            batch, before = _promising(asking, before, rng)
            if not len(batch):
                return "nothing new could be thought of"
            asking(batch)
    except SpentError:
        return "all evaluations are spent"
    return "all designs are known"


def _first(asking: Asking) -> int:
    """How many designs are scattered before a guess is made: a fifth of all, and some more than there are features."""
    space = asking.question.space
    features = int(space.features(np.zeros((1, len(space.variables)))).shape[1])
    return max(2 * features + 2, asking.question.asked.evaluations // 5)


@dataclass
class _Guess:
    """What is known (objectives in units of the front's size), and what a surrogate makes of it elsewhere."""

    surrogates: list[Surrogate]
    decades: Bools
    scale: Floats
    reached: Floats
    tried: Floats
    failed: Bools

    def promise(self, features: Floats, worth: Worth, apart: float) -> tuple[Floats, Floats]:
        """How much each design with such features (n, k) promises (n,), and its objectives (n, p)."""
        from scipy.spatial.distance import cdist

        guess = np.column_stack([each(features) for each in self.surrogates])
        objectives = _in_decades(guess[:, : len(self.scale)], self.decades) / self.scale
        missed = np.maximum(guess[:, len(self.scale) :], 0.0).sum(axis=1)
        promise = worth(objectives, self.reached) if len(self.reached) else -objectives.sum(axis=1)
        promise = np.where(missed <= 0, promise, -1e3 * (1 + missed))
        far = cdist(features, self.tried)
        refused = (far.min(axis=1) < apart) | self.failed[far.argmin(axis=1)]
        return np.where(refused, -REFUSED, promise), objectives


def _promising(asking: Asking, before: list[Surrogate], rng: np.random.Generator) -> tuple[Floats, list[Surrogate]]:
    """The designs to ask for next (m, n), Eq. (13.44), and the surrogates that told so."""
    space = asking.question.space
    known = [answer for answer in asking.answers if answer.merit is not None]
    width = space.features(asking.designs).shape[1]
    if len(known) <= width + 1:
        return _unknown(asking, space.scattered(len(AT_ONCE), rng)), before
    guess, best = _guess(asking, before)
    pool = _pool(asking, asking.designs[best], rng)
    chosen: list[Floats] = []
    for worth, apart in AT_ONCE:
        if not len(pool):
            break
        pool, promise, objectives = _bred(asking, guess, pool, worth, apart, rng)
        pick = int(np.argmax(promise))
        if promise[pick] <= -REFUSED:
            continue
        chosen.append(pool[pick])
        guess.tried = np.vstack((guess.tried, space.features(pool[pick : pick + 1])))
        guess.failed = np.append(guess.failed, False)
        if promise[pick] > -1e3:
            reached = np.vstack((guess.reached, objectives[pick]))
            guess.reached = reached[undominated(reached)]
        pool = np.delete(pool, pick, axis=0)
    return np.array(chosen), guess.surrogates


def _guess(asking: Asking, before: list[Surrogate]) -> tuple[_Guess, Ints]:
    """The guess from all answers, and which of them (numbers) are best so far."""
    space, answers = asking.question.space, asking.answers
    rows = np.array([row for row, answer in enumerate(answers) if answer.merit is not None])
    merits = [answer.merit for answer in answers if answer.merit is not None]
    objectives = np.array([one.objectives for one in merits])
    excesses = np.array([one.excesses for one in merits]).reshape(len(merits), -1)
    allowed = np.array([one.allowed for one in merits])
    tried = space.features(asking.designs)
    best = _best(objectives, excesses, allowed)
    decades = (objectives > 0).all(axis=0) & (objectives[best].max(axis=0) > DECADE * objectives[best].min(axis=0))
    measured = _in_decades(objectives, decades)
    scale = np.ptp(measured[best], axis=0)
    scale = np.where(scale > 0, scale, np.ptp(measured, axis=0))
    scale = np.where(scale > 0, scale, 1.0)
    reached = measured[best] / scale if allowed.any() else np.zeros((0, objectives.shape[1]))
    columns = np.hstack((objectives, excesses))
    seen = _worth_knowing(len(rows), best)
    stretches: list[Floats | None] = [one.stretch for one in before] or [None] * columns.shape[1]
    pairs = zip(columns[seen].T, stretches, strict=True)
    foretell = [surrogate(tried[rows[seen]], column, stretch) for column, stretch in pairs]
    failed = np.array([answer.merit is None for answer in answers])
    return _Guess(foretell, decades, scale, reached, tried, failed), rows[best]


def _worth_knowing(count: int, best: Ints) -> Ints:
    """Rows that the surrogates are made of: all, or of very many the best and the latest."""
    order = np.concatenate((best, np.setdiff1d(np.arange(count), best)[::-1]))
    return np.sort(order[:MOST_KNOWN])


def _in_decades(objectives: Floats, decades: Bools) -> Floats:
    """Objectives (m, p), those that spread over decades by their logarithms: what beats what stays the same."""
    return np.where(decades, np.log(np.where(decades, np.maximum(objectives, 1e-300), 1.0)), objectives)


def _best(objectives: Floats, excesses: Floats, allowed: Bools) -> Ints:
    """Rows of the front, or while nothing is allowed of the ten that miss the constraints least."""
    if allowed.any():
        rows = np.flatnonzero(allowed)
        return np.asarray(rows[undominated(objectives[rows])])
    return np.asarray(np.argsort(np.maximum(excesses, 0.0).sum(axis=1), kind="stable")[:10])


def _bred(
    asking: Asking, guess: _Guess, pool: Floats, worth: Worth, apart: float, rng: np.random.Generator
) -> tuple[Floats, Floats, Floats]:
    """The pool with better designs bred from its best, step by step closer to them; with promises and objectives."""
    space = asking.question.space
    for width in CLOSER:
        promise, _ = guess.promise(space.features(pool), worth, apart)
        parents = pool[np.argsort(-promise, kind="stable")[: BREED // 10]]
        children = _unknown(asking, space.near(np.repeat(parents, 10, axis=0), width, rng))
        pool = np.unique(np.vstack((pool, children)), axis=0)
    return pool, *guess.promise(space.features(pool), worth, apart)


def _pool(asking: Asking, best: Floats, rng: np.random.Generator) -> Floats:
    """Designs not asked for yet: half scattered over the whole space, half near the best, from far to close."""
    space = asking.question.space
    each = POOL // (2 * len(WIDTHS))
    near = [space.near(best[rng.integers(len(best), size=each)], width, rng) for width in WIDTHS]
    return _unknown(asking, np.vstack((space.scattered(POOL // 2, rng), *near)))


def _unknown(asking: Asking, designs: Floats) -> Floats:
    alike = np.unique(designs, axis=0)
    return alike[[not asking.known(design) for design in alike]]
