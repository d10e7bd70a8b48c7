"""How a search asks for designs: each once, counted honestly, none beyond what it may spend."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case
from punchform.optimise.evaluations import Evaluation, Record, designed
from punchform.optimise.pools import Workers, given, stop
from punchform.optimise.problem import Merit, Question
from punchform.optimise.sweep import sweep

Ask = Callable[[Sequence[Mapping[str, object]]], Sequence[Evaluation]]
"""What evaluates designs, given by their changes, in their order."""


class SpentError(Exception):
    """All evaluations that a search may make are made."""


@dataclass(frozen=True)
class Answer:
    """What came of a design that the search asked for.

    number: the how many-th it was, from 1; design (n,): a row of the space; told: all its figures; merit: what the
    search looks at, None of a design that failed; why: why it has none.
    """

    number: int
    design: Floats
    evaluation: Evaluation
    told: Mapping[str, float | None]
    merit: Merit | None
    why: str | None

    @property
    def allowed(self) -> bool:
        """Whether it has all figures and keeps all constraints."""
        return self.merit is not None and self.merit.allowed


class Asking:
    """The designs that one search has asked for, in order."""

    def __init__(self, question: Question, ask: Ask, *, observe: Callable[[Answer], None] | None = None) -> None:
        self.question = question
        self.answers: list[Answer] = []
        self._ask = ask
        self._observe = observe
        self._known: dict[bytes, Answer] = {}

    @property
    def left(self) -> int:
        """How many more designs may be asked for."""
        return self.question.asked.evaluations - len(self.answers)

    @property
    def designs(self) -> Floats:
        """All designs that were asked for (m, n)."""
        return np.array([answer.design for answer in self.answers]).reshape(-1, len(self.question.space.variables))

    def known(self, design: Floats) -> bool:
        """Whether a design was asked for already."""
        return self._name(design) in self._known

    def __call__(self, designs: Floats) -> list[Answer]:
        """The answers to designs (m, n); only those not asked for before are evaluated, and count.

        Raises SpentError when there are more new ones than may be asked for, after as many as may.
        """
        changes = {self._name(design): design for design in designs}
        new = [name for name in changes if name not in self._known]
        now = new[: self.left]
        each = [self.question.space.changes(changes[name]) for name in now]
        for name, change, evaluation in zip(now, each, self._ask(each) if each else (), strict=True):
            answer = self._answer(changes[name], change, evaluation)
            self._known[name] = answer
            self.answers.append(answer)
            if self._observe is not None:
                self._observe(answer)
        if len(now) < len(new):
            raise SpentError
        return [self._known[self._name(design)] for design in designs]

    def _name(self, design: Floats) -> bytes:
        # What a space tells as `nearest` is the same number for the same setting; -0.0 is 0.0.
        return (design + 0.0).tobytes()

    def _answer(self, design: Floats, changes: Mapping[str, object], evaluation: Evaluation) -> Answer:
        told = {} if evaluation.failed else self.question.told(changes, evaluation.figures)
        merit = None if evaluation.failed else self.question.merit(told)
        lacking = [name for name in self.question.figures if told.get(name) is None]
        why = None if merit is not None else evaluation.failure or f"the run has no {', '.join(lacking)}"
        return Answer(len(self.answers) + 1, design, evaluation, told, merit, why)


@contextmanager
def evaluator(case: Case, record: Record, workers: Workers) -> Iterator[Ask]:
    """What evaluates designs of a case that the record does not hold, by workers, and adds them to it as they come.

    The workers stay from one question to the next; those that die are replaced.
    """
    standing = workers.open(workers.count)

    def ask(each: Sequence[Mapping[str, object]]) -> list[Evaluation]:
        nonlocal standing
        try:
            _exhaust(sweep(case, each, executor=given(standing, workers.at_once), record=record))
        except BrokenExecutor:
            if not workers.again:
                raise
            _exhaust(sweep(case, each, executor=workers, record=record))
            stop(standing)
            standing = workers.open(workers.count)
        # With the changes as they were asked: the same design may stand there in other words.
        return [replace(record[designed(case, changes).key], changes=dict(changes)) for changes in each]

    try:
        yield ask
    finally:
        if workers.again:
            stop(standing)


def _exhaust(evaluations: Iterator[Evaluation]) -> None:
    for _ in evaluations:
        pass
