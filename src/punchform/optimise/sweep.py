"""Many designs of one case, each evaluated once, on whatever executor there is; the record is what goes on.

The parent alone writes: workers get texts and numbers, and give an evaluation back.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from itertools import islice

from punchform import __version__
from punchform.case import Case
from punchform.errors import InputError
from punchform.mechanics.compiled import kernels_are_compiled
from punchform.optimise.evaluations import Design, Evaluation, Record, Task, designed, sent, told, work
from punchform.optimise.pools import Workers, given, processes, stop

LOST = "the process that computed it died: killed, or out of memory"


def sweep(
    case: Case,
    designs: Iterable[Mapping[str, object]],
    *,
    executor: Executor | Workers | None = None,
    record: Record | None = None,
    keys: list[str] | None = None,
) -> Generator[Evaluation, None, None]:
    """Evaluate designs (changes of the case), each distinct one once, and yield them as they come.

    executor: anything of `concurrent.futures`, None for new processes on all cores of this machine (a script that
    begins them needs the usual `if __name__ == "__main__"`); record: what is in it already is yielded and not computed
    again, what is new is in it before it is yielded; keys: a list that receives the key of every distinct design, in
    their order. A design that fails is yielded with its message. The figures are the same to the last bit on every
    executor.

    Raises InputError when the workers cannot evaluate at all, BrokenExecutor when somebody else's executor breaks.
    """
    kept = Record() if record is None else record
    workers = processes() if executor is None else executor if isinstance(executor, Workers) else given(executor)
    todo = _new(case, designs, kept, [] if keys is None else keys)
    with _Crew(workers) as crew:
        if workers.again and not kernels_are_compiled(yields=case.wire.yields):
            # The first design alone compiles the kernels, which all others find on the disk.
            yield from _computed(crew, islice(todo, 1), kept)
        yield from _computed(crew, todo, kept)


@dataclass(frozen=True)
class _Asked:
    """A design on its way to a worker."""

    design: Design
    task: Task


def _new(
    case: Case, designs: Iterable[Mapping[str, object]], record: Record, keys: list[str]
) -> Iterator[Evaluation | _Asked]:
    """Each distinct design: its evaluation where there is one, else what a worker needs."""
    seen: set[str] = set()
    text = sent(case)
    for changes in designs:
        design = designed(case, changes)
        if design.key in seen:
            continue
        seen.add(design.key)
        keys.append(design.key)
        if design.key in record:
            yield record[design.key]
        elif design.case is None:
            yield Evaluation(design.key, design.changes, failure=design.failure)
        else:
            yield _Asked(design, Task(text, dict(changes)))


def _computed(crew: _Crew, todo: Iterator[Evaluation | _Asked], record: Record) -> Iterator[Evaluation]:
    """The evaluations as they come: never more designs under way than the workers can take."""
    more = True
    while more or crew.under_way:
        while more and len(crew.under_way) < crew.workers.at_once:
            one = next(todo, None)
            if one is None:
                more = False
            elif isinstance(one, _Asked):
                crew.ask(one)
            else:
                record.add(one)
                yield one
        for evaluation in crew.answers():
            record.add(evaluation)
            yield evaluation


class _Crew:
    """An executor with the designs under way; a broken one of our own is replaced."""

    def __init__(self, workers: Workers) -> None:
        self.workers = workers
        self.executor = workers.open(workers.count)
        self.under_way: dict[Future[Evaluation], _Asked] = {}

    def __enter__(self) -> _Crew:
        return self

    def __exit__(self, *_: object) -> None:
        for future in self.under_way:
            future.cancel()
        if self.workers.again:
            stop(self.executor)

    def ask(self, asked: _Asked) -> None:
        """Send a design off."""
        try:
            self.under_way[self.executor.submit(work, asked.task)] = asked
        except BrokenExecutor:
            if not self.workers.again:
                raise
            # Its failure comes to light among the answers.
            lost: Future[Evaluation] = Future()
            lost.set_exception(BrokenExecutor())
            self.under_way[lost] = asked

    def answers(self) -> Iterator[Evaluation]:
        """What has come back since, at least one when anything is under way."""
        if not self.under_way:
            return
        done, _ = wait(self.under_way, return_when=FIRST_COMPLETED)
        broken = False
        for future in done:
            try:
                evaluation = self._answer(future, self.under_way[future])
            except BrokenExecutor:
                if not self.workers.again:
                    raise
                broken = True
            else:
                del self.under_way[future]
                yield evaluation
        if broken:
            yield from self._once_more()

    def _answer(self, future: Future[Evaluation], asked: _Asked) -> Evaluation:
        try:
            evaluation = future.result()
        except BrokenExecutor:
            raise
        except Exception as error:
            if type(error).__name__ == "KilledWorker":
                return _lost(asked)
            raise InputError.of(
                f"the workers cannot evaluate designs: {told(error)}",
                hint=f"every worker needs punchform {__version__} and what it depends on",
            ) from error
        if evaluation.key != asked.design.key:
            raise InputError.of(
                "a worker computes something else than what was asked: it has another version of punchform",
                hint=f"install punchform {__version__} where the workers run",
            )
        return evaluation

    def _once_more(self) -> Iterator[Evaluation]:
        """Those under way when a process died, one after the other in a process of their own: the one that kills it
        again has failed."""
        wait(self.under_way, timeout=1.0)
        suspects = tuple(self.under_way.items())
        stop(self.executor)
        alone: Executor | None = None
        try:
            for future, asked in suspects:
                evaluation: Evaluation | None = None
                if future.done() and not future.cancelled() and future.exception() is None:
                    evaluation = self._answer(future, asked)
                else:
                    alone = alone or self.workers.open(1)
                    try:
                        evaluation = self._answer(alone.submit(work, asked.task), asked)
                    except BrokenExecutor:
                        stop(alone)
                        alone, evaluation = None, _lost(asked)
                del self.under_way[future]
                yield evaluation
        finally:
            if alone is not None:
                stop(alone)
        self.executor = self.workers.open(self.workers.count)


def _lost(asked: _Asked) -> Evaluation:
    return Evaluation(asked.design.key, asked.design.changes, failure=LOST)
