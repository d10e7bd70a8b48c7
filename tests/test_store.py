"""A run folder is whole or not there; what is not ours is never destroyed; what was written is read back."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import tiny_dish

from punchform.case import read_case
from punchform.errors import InputError
from punchform.run import run as form
from punchform.store import check_folder, read_run, write_run

if TYPE_CHECKING:
    from punchform.run import Run

FILES = {"case.toml", "result.json", "nodes.csv", "wires.csv", "shape.vtp", "run.npz"}


@pytest.fixture(scope="module")
def let_go() -> Run:
    return form(tiny_dish.case())


@pytest.fixture(scope="module")
def run() -> Run:
    return form(tiny_dish.case().model_copy(update={"release": None, "target": None}))


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_the_folder_holds_the_files_of_the_contract_and_nothing_lies_beside_it(run: Run, tmp_path: Path) -> None:
    folder = write_run(run, tmp_path / "new" / "dish")
    assert folder == tmp_path / "new" / "dish"
    assert names(folder) == FILES
    assert names(tmp_path / "new") == {"dish"}


def test_what_was_written_is_read_back(run: Run, tmp_path: Path) -> None:
    stored = read_run(write_run(run, tmp_path / "dish"))
    whole = run.formed.whole
    assert stored.result["formed"]["energy_mJ"] == run.formed.energy
    assert stored.nodes["i"].dtype == np.int64
    order = np.lexsort((whole.index[:, 1], whole.index[:, 0]))
    np.testing.assert_allclose(stored.nodes["z"], whole.positions[order, 2], atol=1e-11)
    assert np.isnan(stored.nodes["xr"]).all()
    assert stored.wires["energy_mJ"].sum() == pytest.approx(run.formed.energy, rel=1e-12)
    assert np.isnan(stored.wires["stress_ratio"]).all()
    assert read_case(stored.folder / "case.toml") == run.case


def test_the_wires_of_a_released_run_are_written_and_read_back(run: Run, let_go: Run, tmp_path: Path) -> None:
    assert read_run(write_run(run, tmp_path / "formed")).wires_released is None
    folder = write_run(let_go, tmp_path / "released")
    assert names(folder) == FILES | {"wires_released.csv"}
    stored = read_run(folder)
    assert stored.wires_released is not None
    assert let_go.released is not None
    whole = let_go.released.whole
    assert stored.wires_released["energy_mJ"].sum() == pytest.approx(whole.energy.sum(), rel=1e-12)
    order = np.lexsort((whole.index[:, 1], whole.index[:, 0]))
    np.testing.assert_allclose(stored.nodes["zr"], whole.positions[order, 2], atol=1e-11)


def test_extras_write_into_the_same_folder(run: Run, tmp_path: Path) -> None:
    def extra(run: Run, folder: Path) -> None:
        (folder / "extra.txt").write_text(run.case.title)

    folder = write_run(run, tmp_path / "dish", extras=(extra,))
    assert (folder / "extra.txt").read_text() == run.case.title


def test_an_empty_folder_is_used(run: Run, tmp_path: Path) -> None:
    (tmp_path / "dish").mkdir()
    assert names(write_run(run, tmp_path / "dish")) == FILES


def test_an_old_run_is_replaced_only_on_request(run: Run, tmp_path: Path) -> None:
    folder = write_run(run, tmp_path / "dish")
    (folder / "stale.txt").write_text("old")
    with pytest.raises(InputError, match="--overwrite"):
        write_run(run, folder)
    assert "stale.txt" in names(folder)
    write_run(run, folder, overwrite=True)
    assert names(folder) == FILES
    assert names(tmp_path) == {"dish"}


@pytest.mark.parametrize("content", [None, "not json", "[]", "{}", '{"schema": 1}'])
def test_a_folder_that_is_not_a_run_is_never_touched(run: Run, tmp_path: Path, content: str | None) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    if content is not None:
        (tmp_path / "result.json").write_text(content)
    with pytest.raises(InputError, match="not a punchform run"):
        write_run(run, tmp_path, overwrite=True)
    assert (tmp_path / "thesis.txt").read_text() == "years of work"


@pytest.mark.parametrize("below", ["", "/deep/er"])
def test_a_file_is_not_replaced_by_a_folder(run: Run, tmp_path: Path, below: str) -> None:
    (tmp_path / "dish").write_text("a file")
    with pytest.raises(InputError, match="file"):
        write_run(run, f"{tmp_path}/dish{below}", overwrite=True)
    assert (tmp_path / "dish").read_text() == "a file"


@pytest.mark.parametrize("place", [".", "..", "/", "~"])
def test_the_folders_one_lives_in_are_refused(
    place: str, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = write_run(run, tmp_path / "home")
    here = write_run(run, tmp_path / "outer" / "here")
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("USERPROFILE", str(home))
    monkeypatch.chdir(here)
    with pytest.raises(InputError, match="cannot replace"):
        check_folder(place, overwrite=True)


@pytest.mark.parametrize("stop", [KeyboardInterrupt, RuntimeError, MemoryError])
def test_an_interrupted_write_leaves_no_trace(run: Run, tmp_path: Path, stop: type[BaseException]) -> None:
    def extra(run: Run, folder: Path) -> None:
        raise stop

    with pytest.raises(stop):
        write_run(run, tmp_path / "deep" / "er" / "dish", extras=(extra,))
    assert names(tmp_path) == set()
    old = write_run(run, tmp_path / "dish")
    (old / "mark.txt").write_text("old")
    with pytest.raises(stop):
        write_run(run, old, overwrite=True, extras=(extra,))
    assert names(tmp_path) == {"dish"}
    assert names(old) == FILES | {"mark.txt"}


def failing_rename(time: int, problem: BaseException) -> Callable[[Path, Path], None]:
    """os.rename that raises at its n-th call."""
    calls: list[Path] = []
    real = os.rename

    def rename(source: Path, target: Path) -> None:
        calls.append(source)
        if len(calls) == time:
            raise problem
        real(source, target)

    return rename


@pytest.mark.parametrize("time", [1, 2])
@pytest.mark.parametrize(
    ("problem", "seen"),
    [(OSError(28, "No space left on device"), InputError), (KeyboardInterrupt(), KeyboardInterrupt)],
)
def test_the_old_run_comes_back_when_the_rename_fails(
    time: int,
    problem: BaseException,
    seen: type[BaseException],
    run: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    old = write_run(run, tmp_path / "dish")
    (old / "mark.txt").write_text("old")
    with monkeypatch.context() as patch:
        patch.setattr("punchform.store.os.rename", failing_rename(time, problem))
        with pytest.raises(seen):
            write_run(run, old, overwrite=True)
    assert names(tmp_path) == {"dish"}
    assert names(old) == FILES | {"mark.txt"}


def test_an_error_of_the_disk_is_said_to_a_person(run: Run, tmp_path: Path) -> None:
    def extra(run: Run, folder: Path) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(InputError, match="No space left on device"):
        write_run(run, tmp_path / "dish", extras=(extra,))


def test_a_folder_that_is_not_a_run_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        read_run(tmp_path / "nowhere")
    with pytest.raises(InputError, match="not a punchform run"):
        read_run(tmp_path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text.replace("i,j,x0", "i,j,u0"), "header"),
        (lambda text: text[: len(text) // 2].rsplit(",", 3)[0], "damaged"),
        (lambda text: text.replace("1", "one"), "damaged"),
        (lambda text: text.splitlines()[0], "no rows"),
        (lambda text: "", "damaged"),
    ],
)
def test_a_damaged_table_is_named(run: Run, tmp_path: Path, change: Callable[[str], str], said: str) -> None:
    folder = write_run(run, tmp_path / "dish")
    table = folder / "nodes.csv"
    table.write_text(change(table.read_text()))
    with pytest.raises(InputError, match=said) as caught:
        read_run(folder)
    assert "nodes.csv" in caught.value.problems[0].where


def test_a_missing_table_is_named(run: Run, tmp_path: Path) -> None:
    folder = write_run(run, tmp_path / "dish")
    (folder / "wires.csv").unlink()
    with pytest.raises(InputError, match="cannot be read"):
        read_run(folder)
