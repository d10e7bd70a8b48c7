"""What is read of a run for its sensitivities, and who makes the runs: this process or many."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass

from punchform.accuracy import Judged
from punchform.case import Case
from punchform.errors import InputError, NoEquilibrium
from punchform.mechanics.cores import at_most
from punchform.optimise.evaluations import told
from punchform.optimise.figures import FIGURES
from punchform.optimise.pools import Workers, stop
from punchform.optimise.sweep import LOST
from punchform.run import Run, run

FEW = 2
"""So many complete runs are made here, whatever workers there are."""


@dataclass(frozen=True)
class Seen:
    """What is read of a run: its figures, the deviations (n,) of the judged nodes [mm] with their weights, and which
    nodes these are."""

    figures: Mapping[str, float | None]
    deviations: Judged | None
    judged: tuple[tuple[int, int], ...]


Many = Callable[[Sequence[Case], Sequence[str]], Iterable["Seen | str"]]
"""Runs cases and reads them, in their order; a text where one of them cannot be run."""


def one_by_one(cases: Sequence[Case], names: Sequence[str]) -> Iterator[Seen | str]:
    """Run the cases in this process, one after the other."""
    return (looked_at(case, names) for case in cases)


def shared(workers: Workers) -> Many:
    """Runs cases on workers, one core each; a few are sooner run here than workers begun."""

    def many(cases: Sequence[Case], names: Sequence[str]) -> Iterator[Seen | str]:
        if len(cases) <= FEW:
            yield from one_by_one(cases, names)
            return
        executor = workers.open(workers.count)
        try:
            asked = [executor.submit(_on_one_core, case, tuple(names)) for case in cases]
            for one in asked:
                try:
                    yield one.result()
                except BrokenExecutor:
                    yield LOST
        finally:
            if workers.again:
                stop(executor)

    return many


def _on_one_core(case: Case, names: Sequence[str]) -> Seen | str:
    with at_most(1):
        return looked_at(case, names)


def looked_at(case: Case, names: Sequence[str]) -> Seen | str:
    """What is read of the run of a case; what goes wrong in one line."""
    try:
        return seen(run(case), names)
    except (InputError, NoEquilibrium) as error:
        return told(error)


def seen(done: Run, names: Sequence[str]) -> Seen:
    """What is read of a run."""
    found = {name: FIGURES[name].of(done) for name in dict.fromkeys(("rms", *names))}
    accuracy = done.accuracy
    if accuracy is None:
        return Seen(found, None, ())
    mask = accuracy.mask
    index = done.final.whole.index[mask].tolist()
    deviations = Judged(accuracy.aligned.deviations.of(accuracy.judge.measure)[mask], accuracy.weights[mask])
    return Seen(found, deviations, tuple((i, j) for i, j in index))
