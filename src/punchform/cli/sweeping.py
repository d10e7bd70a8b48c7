"""Running the designs of a sweep with its folder, its progress and its interrupts: for `sweep` and `tolerances`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from punchform.case import Case, varied
from punchform.cli.remaining import Remaining, left
from punchform.cli.talk import Talk, say
from punchform.cli.voice import Voice
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
    voice: Voice


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
    workers: Workers,
    voice: Voice,
    *,
    places: Sequence[str],
    parquet: bool,
) -> tuple[Evaluation, ...]:
    """Every distinct design, in order, with its table in the folder; what its record holds already is not computed
    again; places: the settings that have columns. Ctrl-C leaves a folder from which the same command goes on."""
    from punchform.optimise.evaluations import Record, recorded
    from punchform.optimise.sweep import sweep
    from punchform.optimise.sweep_folder import RECORD, write_state
    from punchform.optimise.tabulating import PARQUET, TABLE, GrowingTable

    try:
        keys: list[str] = []
        done: dict[str, Evaluation] = {}
        with Record(folder / RECORD) as record, GrowingTable(folder / TABLE, case, places, record) as table:
            known = {evaluation.key for evaluation in record}
            with _Telling(len(designs), workers.count, voice) as telling:
                for evaluation in sweep(case, designs, executor=workers, record=record, keys=keys):
                    done[evaluation.key] = evaluation
                    if evaluation.key not in known:
                        table.add(evaluation)
                    telling.tell(len(done), failed=evaluation.failed, known=evaluation.key in known)
            everything = tuple(done[key] for key in keys)
            table.ordered(everything)
            if parquet:
                table.write_parquet(folder / PARQUET, everything)
            failed = sum(evaluation.failed for evaluation in everything)
            write_state(folder, asked, {"designs": len(everything), "failed": failed})
        return everything
    except KeyboardInterrupt:
        say(f"note: {len(recorded(folder / RECORD))} of {len(designs)} designs are done")
        raise


class _Telling:
    """Tells how far a sweep has come and how long it will take, on stderr."""

    def __init__(self, count: int, at_once: int, voice: Voice) -> None:
        self._talk = Talk(voice, at_once=at_once)
        self._remaining = Remaining(at_once=at_once)
        self._count = count
        self._told = perf_counter()
        self._failed = self._known = 0

    def __enter__(self) -> _Telling:
        self._talk.__enter__()
        self._remaining.tell(0, self._count)
        self._talk(Progress("designs", total=self._count))
        return self

    def __exit__(self, *error: Any) -> None:
        self._talk.__exit__(*error)

    def tell(self, done: int, *, failed: bool, known: bool) -> None:
        """Say how far it is: in the bar of a terminal, elsewhere in a line now and then."""
        self._failed += failed
        self._known += known
        self._remaining.tell(done, self._count, known=self._known)
        self._talk(Progress("designs", done=done, total=self._count), known=self._known)
        self._talk.show(f"{self._failed} failed" if self._failed else "")
        now = perf_counter()
        if done == self._count or (not self._talk.has_bars and now - self._told >= EVERY):
            self._told = now
            self._talk(Progress("sweep", message=progress(done, self._count, self._failed, self._remaining.seconds)))


def progress(done: int, count: int, failed: int, seconds: float | None) -> str:
    """How far it is, in words; seconds: what is left, None where that is not known.

    >>> progress(30, 100, 1, 140.0), progress(100, 100, 0, 0.0)
    ('30 of 100 designs, 1 failed, about 2 min 20 s left', '100 of 100 designs')
    """
    words = f"{done} of {count} designs"
    if failed:
        words += f", {failed} failed"
    return words + (left(seconds) if done < count else "")
