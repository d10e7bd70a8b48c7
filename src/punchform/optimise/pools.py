"""Where evaluations are made: in order here, in processes of this machine, or on a Dask cluster.

Which and why: docs/decisions/sweeps.md.
"""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any, ParamSpec, TypeVar

from punchform.errors import InputError
from punchform.optimise.worker import begin, limit_libraries

AHEAD = 1
"""Designs that wait behind those in work, per worker: enough to keep it busy, few to lose."""
AT_ONCE = 64
"""Designs that a cluster is given at once at least: its workers may come and go."""
PATIENCE = "10s"
"""How long a scheduler may take to answer."""

P = ParamSpec("P")
T = TypeVar("T")


class InOrder(Executor):
    """An executor that does everything at once, here: a loop."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Call the function before returning its future."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@dataclass(frozen=True)
class Workers:
    """Where designs go: how to open an executor for so many workers, how many designs it is given at once, and whether
    it may be opened again when it breaks."""

    open: Callable[[int], Executor]
    count: int
    at_once: int
    again: bool = False


def given(executor: Executor, at_once: int | None = None) -> Workers:
    """Somebody else's executor, which stays open."""
    count = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    return Workers(lambda _: executor, count, at_once or (1 + AHEAD) * count)


def processes(count: int | None = None) -> Workers:
    """So many new processes of this machine, by default one for each core."""
    count = count or os.cpu_count() or 1
    return Workers(_processes, count, (1 + AHEAD) * count, again=True)


def _processes(count: int) -> Executor:
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"), initializer=begin)


def stop(executor: Executor) -> None:
    """Close an executor of `processes` without waiting for what its workers are at."""
    # Python has a public way to stop them from 3.14 on only.
    working = dict(getattr(executor, "_processes", None) or {})
    executor.shutdown(wait=False, cancel_futures=True)
    for process in working.values():
        process.terminate()
    for process in working.values():
        process.join()


class OneCore:
    """What every worker of a cluster does first, also one that joins later."""

    name = "punchform-one-core"
    idempotent = True

    def setup(self, worker: Any) -> None:
        """Limit the libraries of the worker."""
        limit_libraries()

    def teardown(self, worker: Any) -> None:
        """Nothing to take back: the worker ends."""


@contextmanager
def cluster(address: str) -> Iterator[Workers]:
    """The workers of a Dask cluster, of which there may be none yet.

    Raises InputError when Dask is not installed or the scheduler does not answer.
    """
    if find_spec("distributed") is None:
        raise InputError.of("Dask is not installed, which --scheduler needs", hint="pip install 'punchform[cluster]'")
    distributed: Any = import_module("distributed")
    try:
        client = distributed.Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError.of(
            f"no Dask scheduler answers: {error}",
            where=address,
            hint="start one with `dask scheduler`, and give the address that it prints, such as tcp://host:8786",
        ) from None
    with client:
        client.register_plugin(type("OneCore", (OneCore, distributed.WorkerPlugin), {})())
        threads = sum(client.nthreads().values())
        executor = client.get_executor(pure=False)
        yield Workers(lambda _: executor, threads, max(AT_ONCE, 3 * threads))
