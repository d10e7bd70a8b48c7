"""GRASP files and FE decks show what a run is in the end; heads are lines, whatever the title of the case."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from exported_runs import MADE, made

from punchform.export.fe_deck import FORMED, RELEASED, SPRINGBACK, write_decks
from punchform.export.grasp import write_grasp
from punchform.export.heading import Heading, heading
from punchform.export.shapes import shapes

every_run = pytest.mark.parametrize("name", MADE)


@every_run
def test_grasp_has_the_surfaces_that_the_other_formats_show(name: str, tmp_path: Path) -> None:
    run = made(name)
    written = [path.stem for path in write_grasp(run, tmp_path) if path.suffix == ".sfc"]
    wanted = [] if run.case.target is None else ["target"]
    assert written == [*(shape for shape in shapes(run) if shape in ("formed", "released")), *wanted]


@every_run
def test_decks_are_of_a_release_that_no_press_has_undone(name: str, tmp_path: Path) -> None:
    run = made(name)
    written = [path.name for path in write_decks(run, tmp_path) if path.suffix == ".inp"]
    assert written == ([SPRINGBACK, RELEASED] if "released" in shapes(run) else [FORMED])
    text = (tmp_path / written[-1]).read_text(encoding="utf-8")
    first, last = "*NODE, NSET=ALL\n", "\n*MATERIAL"
    nodes = text[text.index(first) + len(first) : text.index(last)].splitlines()
    whole = (shapes(run).get("released") or run.final).whole
    for row, place in zip(nodes, whole.positions.tolist(), strict=False):
        assert [float(cell) for cell in row.split(",")[1:]] == pytest.approx(place, abs=1e-9)


def test_a_run_that_was_pressed_again_has_no_release() -> None:
    run = made("pressed again")
    assert run.released is not None
    assert list(shapes(run)) == ["formed"]


@pytest.mark.parametrize("title", ["Dish: the second", "Dish:\r\nthe\vsecond", "Dish:\x85\x00 the\u2028\tsecond "])
def test_a_title_is_one_line_and_is_not_cut(title: str) -> None:
    run = made("elastic")
    head = heading(replace(run, case=run.case.model_copy(update={"title": title})), "a\r\nshape")
    assert head.title == "Dish: the second"
    assert head.first == head.lines[0] == "Dish: the second: a shape"
    assert [len(line.splitlines()) for line in head.lines] == [1, 1, 1, 1]


def test_comments_of_grasp_name_the_whole_title(tmp_path: Path) -> None:
    run = made("elastic")
    named = replace(run, case=run.case.model_copy(update={"title": "Dish: no. 2\rG0"}))
    for path in write_grasp(named, tmp_path):
        assert "Dish: no. 2 G0: " in path.read_text(encoding="utf-8")
    assert "// Dish: no. 2 G0: the best fit" in (tmp_path / "dish.tor").read_text(encoding="utf-8")


def test_a_heading_says_units_frame_and_version() -> None:
    head = Heading("title", "what", "mm", "punch", "punchform 1")
    assert head.lines == ("title: what", "units: mm", "frame: punch", "punchform 1")
