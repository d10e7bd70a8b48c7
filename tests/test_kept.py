"""A run read back from its folder is the run that was written, number for number, whatever its stages."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tiny_dish
from stretched import dish

from punchform.case import Case, read_case
from punchform.case.reading import case_from_text
from punchform.cli.shell import write_shell
from punchform.errors import InputError
from punchform.export.result import result
from punchform.kept import keep
from punchform.run import Run
from punchform.run import run as form
from punchform.shell import form_shell
from punchform.store import load, load_run, write_run

LOAD = "[load]\ngravity = [0, 0, -1]\n"
STAGES = 'stages = ["press", { trim = { radius = "65 mm" } }, "release", "press", "release"]'
NOT_KEPT = "state.history"
"""What wires that yield remember for a further stroke."""


def case(first: str = "", grid: str = "", more: str = "") -> Case:
    """The tiny dish with other lines before its tables, in [grid] and after."""
    text = tiny_dish.TEXT.replace("schema = 1", f"schema = 1\n{first}").replace(
        "[wire]", f"{grid}\n[wire]\ndensity = 7850"
    )
    return case_from_text(text + more)


RUNS: Mapping[str, Callable[[], Run]] = {
    "elastic": lambda: form(case()),
    "only pressed": lambda: form(case().model_copy(update={"release": None, "target": None})),
    "whole": lambda: form(case(grid='symmetry = "full"')),
    "cut between crossings": lambda: form(case(grid="subdivide = 2")),
    "loaded": lambda: form(case(more=LOAD)),
    "in stages": lambda: form(case(first=STAGES)),
    "yielding": dish,
}


def assert_same(one: Any, other: Any, at: str = "run") -> None:
    """Equal in type and in every number, what is made from the case again included."""
    assert type(one) is type(other), at
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, at
        np.testing.assert_array_equal(one, other, err_msg=at)
    elif is_dataclass(one):
        for field in fields(one):
            place = f"{at}.{field.name}"
            if not place.endswith(NOT_KEPT):
                assert_same(getattr(one, field.name), getattr(other, field.name), place)
    elif isinstance(one, tuple | list):
        assert len(one) == len(other), at
        for number, (mine, its) in enumerate(zip(one, other, strict=True)):
            assert_same(mine, its, f"{at}.{number}")
    elif isinstance(one, Mapping):
        assert one.keys() == other.keys(), at
        for name in one:
            assert_same(one[name], other[name], f"{at}.{name}")
    elif not callable(one) and not at.endswith("surface"):
        assert one == other or (one != one and other != other), at


@pytest.mark.parametrize("name", RUNS)
def test_a_run_is_read_back_as_it_was(name: str, tmp_path: Path) -> None:
    run = RUNS[name]()
    again = load_run(write_run(run, tmp_path / "dish"))
    assert_same(run, again)
    assert result(run) == result(again)


@pytest.fixture(scope="module")
def tiny() -> Run:
    return form(tiny_dish.case())


@pytest.fixture
def folder(tiny: Run, tmp_path: Path) -> Path:
    return write_run(tiny, tmp_path / "dish")


def test_a_gridshell_is_read_back_too(tmp_path: Path) -> None:
    shell = form_shell(read_case("packaged:gridshell"))
    again = load(write_shell(shell, tmp_path / "shell"))
    assert_same(shell, again)
    with pytest.raises(InputError, match="holds a gridshell"):
        load_run(tmp_path / "shell")


def test_equal_runs_are_kept_in_equal_files(tiny: Run, tmp_path: Path) -> None:
    keep(tiny, tmp_path / "one")
    keep(tiny, tmp_path / "other")
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes()


def test_a_folder_of_an_older_version_says_what_to_do(folder: Path) -> None:
    (folder / "run.npz").unlink()
    with pytest.raises(InputError, match=r"(?s)holds no run.npz.*form its case again"):
        load_run(folder)


@pytest.mark.parametrize(
    "change",
    [
        lambda content: b"",
        lambda content: content[: len(content) // 2],
        lambda content: b"not an archive",
        lambda content: content[:3000] + b"\x00" * 200 + content[3200:],
    ],
    ids=["empty", "half", "text", "zeros"],
)
def test_a_damaged_file_is_named(folder: Path, change: Callable[[bytes], bytes]) -> None:
    kept = folder / "run.npz"
    kept.write_bytes(change(kept.read_bytes()))
    with pytest.raises(InputError, match="damaged") as caught:
        load_run(folder)
    assert "run.npz" in caught.value.problems[0].where


def test_a_missing_member_is_named(folder: Path) -> None:
    kept = folder / "run.npz"
    with zipfile.ZipFile(kept) as archive:
        members = {name: archive.read(name) for name in archive.namelist() if name != "0.whole.positions.npy"}
    with zipfile.ZipFile(kept, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    with pytest.raises(InputError, match="damaged"):
        load_run(folder)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('diameter = "0.75 mm"', 'diameter = "0.8 mm"'),
        ("[wire]", "[load]\ngravity = [0, 0, -1]\n\n[wire]\ndensity = 7850"),
    ],
    ids=["another number", "another stage"],
)
def test_a_case_that_was_changed_after_its_run_is_refused(folder: Path, old: str, new: str) -> None:
    path = folder / "case.toml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match="the case was changed after the run"):
        load_run(folder)


def test_words_beside_the_case_may_change(folder: Path) -> None:
    path = folder / "case.toml"
    path.write_text("# seen by the toolmaker\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    assert load_run(folder).formed.energy > 0


def test_the_strokes_end_where_the_grid_was(folder: Path) -> None:
    formed = load_run(folder).formed
    np.testing.assert_array_equal(formed.strokes[-1].positions, formed.state.positions)
    stretched = dish().formed
    assert len(stretched.strokes) > 1
    depths = [stroke.positions[:, 2].max() for stroke in stretched.strokes]
    assert depths == sorted(depths)
    np.testing.assert_array_equal(stretched.strokes[-1].positions, stretched.state.positions)
