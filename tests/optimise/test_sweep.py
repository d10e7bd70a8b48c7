"""A sweep loses nothing and repeats nothing, and finds the same numbers wherever its designs are computed."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import tiny_dish
from dying_workers import DEADLY, begin_mortal

from punchform.errors import InputError
from punchform.optimise import evaluations
from punchform.optimise import sweep as sweep_module
from punchform.optimise.designs import combinations, variation
from punchform.optimise.evaluations import Evaluation, Record, Task, designed
from punchform.optimise.pools import InOrder, Workers, cluster, given, processes
from punchform.optimise.sweep import LOST, sweep
from punchform.optimise.worker import begin

CASE = tiny_dish.case()
DESIGNS = list(
    combinations(
        [variation(CASE, "wire.diameter=0.6 mm:0.8 mm:3"), variation(CASE, "grid.crossing=pinned,welded")],
    )
)
WRONG = {"wire.diameter": -1.0}


def numbers(evaluations: Iterator[Evaluation]) -> dict[str, tuple[Mapping[str, Any], str | None]]:
    """Figures and failures by key; the times differ from run to run."""
    found = list(evaluations)
    assert len({one.key for one in found}) == len(found)
    return {one.key: (one.figures, one.failure) for one in found}


@cache
def looped() -> dict[str, tuple[Mapping[str, Any], str | None]]:
    """What one loop finds, with a design that cannot be."""
    return numbers(sweep(CASE, [*DESIGNS, WRONG], executor=InOrder()))


def faked(task: Task) -> Evaluation:
    """An evaluation at no cost, in place of `work`."""
    design = designed(CASE, task.changes)
    return Evaluation(design.key, design.changes, {"rms": 1.0})


def test_failures_are_recorded_and_the_rest_goes_on() -> None:
    failed = [failure for _, failure in looped().values() if failure]
    assert failed == ["wire.diameter: must be more than 0, not -1.0"]
    assert len(looped()) == len(DESIGNS) + 1


def test_threads_find_what_the_loop_finds() -> None:
    with ThreadPoolExecutor(2) as executor:
        assert numbers(sweep(CASE, [*DESIGNS, WRONG], executor=executor)) == looped()


def test_a_design_that_kills_its_worker_is_given_up_alone(tmp_path: Path) -> None:
    """Two processes, of which one dies with the other's design under way too: only the deadly one is given up, and
    all others have the numbers of the loop."""
    context = multiprocessing.get_context("spawn")
    opened: list[int] = []

    def opening(count: int) -> Executor:
        opened.append(count)
        return ProcessPoolExecutor(count, mp_context=context, initializer=begin_mortal)

    deadly = {"wire.diameter": DEADLY}
    with Record(tmp_path / "record.jsonl") as record:
        workers = Workers(opening, 2, 4, again=True)
        found = numbers(sweep(CASE, [*DESIGNS[:-1], WRONG, deadly, DESIGNS[-1]], executor=workers, record=record))
    assert found.pop(designed(CASE, deadly).key) == ({}, LOST)
    assert found == looped()
    assert opened[0] == 2
    assert 1 in opened
    with Record(tmp_path / "record.jsonl") as record:
        assert len(record) == len(found) + 1


def test_somebody_elses_executor_is_not_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken(Executor):
        def submit(self, *_: Any, **__: Any) -> Future[Any]:
            raise BrokenExecutor("gone")

    with pytest.raises(BrokenExecutor, match="gone"):
        list(sweep(CASE, DESIGNS, executor=Broken()))


def test_a_record_is_gone_on_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After an interrupt, a crash that cuts the last line, or the end: what is on the disk is not computed again."""
    asked: list[Mapping[str, Any]] = []

    def counted(task: Task) -> Evaluation:
        asked.append(task.changes)
        return faked(task)

    monkeypatch.setattr(sweep_module, "work", counted)
    path = tmp_path / "record.jsonl"
    with Record(path) as record:
        going = sweep(CASE, DESIGNS, executor=given(InOrder(), 1), record=record)
        for _ in range(4):
            next(going)
        going.close()
    path.write_bytes(path.read_bytes()[:-7])
    asked.clear()
    for expected in (len(DESIGNS) - 3, 0):
        keys: list[str] = []
        with Record(path) as record:
            found = list(sweep(CASE, DESIGNS, executor=given(InOrder(), 1), record=record, keys=keys))
        assert len(found) == len(DESIGNS)
        assert len(asked) == expected
        assert keys == [designed(CASE, changes).key for changes in DESIGNS]
        asked.clear()


def test_the_same_design_twice_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_module, "work", faked)
    found = list(sweep(CASE, [{"wire.diameter": 0.7}, {"wire.diameter": "0.7 mm"}], executor=InOrder()))
    assert len(found) == 1


def test_no_more_designs_are_under_way_than_the_workers_can_take(monkeypatch: pytest.MonkeyPatch) -> None:
    """A million designs are not queued: the next one is made when a worker is free."""
    monkeypatch.setattr(sweep_module, "work", faked)
    made = 0

    def endless() -> Iterator[Mapping[str, Any]]:
        nonlocal made
        while True:
            made += 1
            yield {"wire.diameter": 0.5 + 1e-6 * made}

    with ThreadPoolExecutor(2) as executor:
        going = sweep(CASE, endless(), executor=executor)
        for _ in range(10):
            next(going)
        assert made <= 10 + 4
        going.close()


def test_the_first_design_alone_compiles_the_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two processes that compile the same at the same time would do it twice: the second design waits."""
    under_way, most_at_first, done = [0], [0], [0]

    def counted(task: Task) -> Evaluation:
        under_way[0] += 1
        if not done[0]:
            most_at_first[0] = max(most_at_first[0], under_way[0])
            time.sleep(0.1)
        under_way[0] -= 1
        done[0] += 1
        return faked(task)

    monkeypatch.setattr(sweep_module, "work", counted)
    for compiled, most in ((False, 1), (True, 2)):
        monkeypatch.setattr(sweep_module, "kernels_are_compiled", lambda compiled=compiled, **_: compiled)
        most_at_first[0] = done[0] = 0
        workers = Workers(ThreadPoolExecutor, 2, 4, again=True)
        assert len(list(sweep(CASE, DESIGNS, executor=workers))) == len(DESIGNS)
        assert most_at_first[0] == most


def test_a_worker_of_another_version_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def other(task: Task) -> Evaluation:
        return Evaluation("another", {}, {"rms": 1.0})

    monkeypatch.setattr(sweep_module, "work", other)
    with pytest.raises(InputError, match="another version of punchform"):
        list(sweep(CASE, DESIGNS, executor=InOrder()))


def test_workers_that_cannot_begin_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def without(task: Task) -> Evaluation:
        raise ModuleNotFoundError("No module named 'punchform'")

    monkeypatch.setattr(sweep_module, "work", without)
    with pytest.raises(InputError, match="cannot evaluate designs: ModuleNotFoundError: No module named 'punchform'"):
        list(sweep(CASE, DESIGNS, executor=InOrder()))


def test_a_dask_cluster_with_a_worker_killed_in_the_middle(tmp_path: Path) -> None:
    """Nothing lost, nothing twice, and the numbers of the loop to the last bit."""
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        ) as local,
        cluster(local.scheduler_address) as workers,
        distributed.Client(local.scheduler_address) as client,
        Record(tmp_path / "record.jsonl") as record,
    ):
        begun = client.run(os.getpid)
        assert set(client.run(os.getenv, "RAYON_NUM_THREADS").values()) == {"1"}
        found = {}
        for evaluation in sweep(CASE, [*DESIGNS, WRONG], executor=workers, record=record):
            assert evaluation.key not in found
            found[evaluation.key] = (evaluation.figures, evaluation.failure)
            if len(found) == 3:
                os.kill(next(iter(begun.values())), signal.SIGKILL)
    assert found == looped()
    with Record(tmp_path / "record.jsonl") as record:
        assert len(record) == len(found)


def test_no_scheduler_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("punchform.optimise.pools.PATIENCE", "1s")
    with pytest.raises(InputError, match="no Dask scheduler answers"), cluster("tcp://127.0.0.1:9"):
        pass
    with pytest.raises(InputError, match="no Dask scheduler answers"), cluster("nonsense://x"):
        pass
    monkeypatch.setattr("punchform.optimise.pools.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'punchform\[cluster\]'"), cluster("tcp://127.0.0.1:9"):
        pass


def test_processes_are_one_for_each_core() -> None:
    assert processes().count == os.cpu_count()
    assert processes(3).at_once == 6


def test_a_worker_limits_its_libraries(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.setenv(name, "7")
    monkeypatch.setenv("NUMBA_NUM_THREADS", "7")
    before = signal.getsignal(signal.SIGINT)
    started: list[Any] = []
    monkeypatch.setattr(threading.Thread, "start", lambda thread: started.append(thread))
    try:
        begin()
        assert os.environ["RAYON_NUM_THREADS"] == os.environ["OPENBLAS_NUM_THREADS"] == "1"
        assert len(started) == 1
    finally:
        signal.signal(signal.SIGINT, before)


def test_the_loop_gives_its_errors_to_the_future() -> None:
    future = InOrder().submit(evaluations.told, ValueError("no"))
    assert future.result() == "ValueError: no"
    assert isinstance(InOrder().submit(int, "x").exception(), ValueError)
