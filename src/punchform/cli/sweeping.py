"""Running the designs of a sweep with its folder, its progress and its interrupts: for `sweep` and `tolerances`."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from punchform.case import Case, varied
from punchform.cli.talk import Talk, say
from punchform.errors import InputError
from punchform.progress import Progress

if TYPE_CHECKING:
    from punchform.optimise.evaluations import Evaluation
    from punchform.optimise.pools import Workers
    from punchform.optimise.sweep_folder import Request

EVERY = 30.0
"""Seconds between two lines about the progress where there is no terminal."""


@dataclass(frozen=True)
class Means:
    """What a sweep is run with: so many processes here (None: one for each core) or a Dask scheduler."""

    workers: int | None
    scheduler: str | None
    quiet: bool


@contextmanager
def workers_of(means: Means) -> Iterator[Workers]:
    """The workers that are asked for. Raises InputError for those that cannot be had."""
    from punchform.optimise.pools import InOrder, cluster, given, processes

    if means.workers is not None and means.workers < 1:
        raise InputError.of(f"{means.workers} workers are asked for", where="--workers", hint="give 1 or more")
    if means.scheduler is not None:
        if means.workers is not None:
            raise InputError.of("--workers and --scheduler exclude each other", hint="the cluster has its own workers")
        with cluster(means.scheduler) as workers:
            if not workers.count:
                say("note: the cluster has no workers yet; the designs wait for the first")
            yield workers
    elif means.workers == 1:
        yield given(InOrder(), at_once=1)
    else:
        yield processes(means.workers)


def check_designs(case: Case, designs: Sequence[Mapping[str, Any]]) -> None:
    """Raises InputError, of the first design, when not one of them makes a case; for a gridshell too."""
    _ = case.tool
    first: InputError | None = None
    for changes in designs:
        try:
            varied(case, changes)
            return
        except InputError as error:
            first = first or error
    if first is not None:
        raise first


def evaluated(
    case: Case,
    designs: Sequence[Mapping[str, Any]],
    folder: Path,
    asked: Request,
    means: Means,
    *,
    places: Sequence[str],
    parquet: bool,
) -> tuple[Evaluation, ...]:
    """Every distinct design, in order, with its table in the folder; what its record holds already is not computed
    again; places: the settings that have columns. Ctrl-C leaves a folder from which the same command goes on."""
    from punchform.optimise.evaluations import Record
    from punchform.optimise.sweep import sweep
    from punchform.optimise.sweep_folder import RECORD, write_state
    from punchform.optimise.tabulating import PARQUET, TABLE, GrowingTable

    keys: list[str] = []
    done: dict[str, Evaluation] = {}
    with Record(folder / RECORD) as record, GrowingTable(folder / TABLE, case, places, record) as table:
        known = {evaluation.key for evaluation in record}
        with _Remaining(len(designs), quiet=means.quiet) as remaining, workers_of(means) as workers:
            try:
                for evaluation in sweep(case, designs, executor=workers, record=record, keys=keys):
                    done[evaluation.key] = evaluation
                    if evaluation.key not in known:
                        table.add(evaluation)
                    remaining.tell(len(done), failed=evaluation.failed, known=evaluation.key in known)
            except KeyboardInterrupt:
                say(f"note: {len(record)} of {len(designs)} designs are kept; the same command goes on from there")
                raise
        everything = tuple(done[key] for key in keys)
        table.ordered(everything)
        if parquet:
            table.write_parquet(folder / PARQUET, everything)
        failed = sum(evaluation.failed for evaluation in everything)
        write_state(folder, asked, {"designs": len(everything), "failed": failed})
    return everything


class _Remaining:
    """How far a sweep has come and how long it will take, on stderr."""

    def __init__(self, count: int, *, quiet: bool) -> None:
        self._talk = Talk(quiet=quiet)
        self._count = count
        self._begun = self._told = perf_counter()
        self._failed = self._known = 0

    def __enter__(self) -> _Remaining:
        self._talk.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._talk.__exit__(*error)

    def tell(self, done: int, *, failed: bool, known: bool) -> None:
        """Say how far it is: in the progress line of a terminal, elsewhere in a line now and then."""
        self._failed += failed
        self._known += known
        now = perf_counter()
        words = progress(done, self._count, self._known, self._failed, now - self._begun)
        if sys.stderr.isatty():
            self._talk.show(words)
        elif now - self._told >= EVERY or done == self._count:
            self._told = now
            self._talk(Progress("sweep", message=words))


def progress(done: int, count: int, known: int, failed: int, seconds: float) -> str:
    """How far it is, in words; the remaining time is judged by what was computed now.

    >>> progress(30, 100, 10, 1, 40.0)
    '30 of 100 designs, 1 failed, about 2 min 20 s left'
    """
    words = f"{done} of {count} designs"
    if failed:
        words += f", {failed} failed"
    if done < count and done > known:
        words += f", about {duration(seconds / (done - known) * (count - done))} left"
    return words


def duration(seconds: float) -> str:
    """A time as a person says it.

    >>> duration(4.2), duration(140), duration(7260)
    ('5 s', '2 min 20 s', '2 h 1 min')
    """
    whole = -int(-seconds // 1)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
