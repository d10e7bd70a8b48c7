"""Runs side by side: numbers of result.json, differences to the first, words that follow from them, one scale."""

from __future__ import annotations

import json
import re
import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tiny_dish
from fake_run import fake_run, let_go

from punchform.case.reading import case_from_text
from punchform.cli import main
from punchform.cli.exits import Exit
from punchform.export.result import result_json
from punchform.report.figures import files
from punchform.report.page import write_report
from punchform.report.side_by_side import Line, Side, changed_settings, lines, sides
from punchform.report.side_page import KINDS, comparison_page
from punchform.report.side_words import comparison_words, judged_alike, nearest
from punchform.run import Run, run
from punchform.store import write_run

UNITS = {"%": 100.0}


@cache
def dish(old: str = "", new: str = "") -> Run:
    """The tiny dish with a piece of its case replaced."""
    assert old in tiny_dish.TEXT
    return run(case_from_text(tiny_dish.TEXT.replace(old, new) if old else tiny_dish.TEXT))


def fine() -> Run:
    return dish('step = "10 mm"', 'step = "8 mm"')


def pair() -> tuple[Side, ...]:
    return sides((("coarse", dish()), ("fine", fine())))


def said(*named: tuple[str, Run]) -> str:
    return " ".join(comparison_words(sides(named)))


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    place = tmp_path_factory.mktemp("runs")
    return (
        write_run(dish(), place / "coarse", extras=(write_report,)),
        write_run(fine(), place / "fine", extras=(write_report,)),
    )


def found_at(content: Any, key: str) -> float:
    for part in key.split("."):
        content = content[part]
    return float(content)


def test_the_figures_are_those_of_result_json() -> None:
    files = [json.loads(result_json(side.run)) for side in pair()]
    told = [line for line in lines(pair()) if line.key.partition(".")[0] in ("formed", "released", "accuracy")]
    assert len(told) > 12
    for line in told:
        want = [UNITS.get(line.unit, 1.0) * found_at(file, line.key) for file in files]
        assert list(line.values) == pytest.approx(want, rel=1e-15), line.key


def test_the_best_fit_is_that_of_the_judged_measure() -> None:
    (line,) = (line for line in lines(pair()) if line.key == "best_fit.rms_mm")
    for value, side in zip(line.values, pair(), strict=True):
        accuracy = side.run.accuracy
        assert accuracy is not None
        assert value == accuracy.fitted.statistics[accuracy.judge.measure].rms


def test_differences_are_to_the_first_run() -> None:
    line = Line("key", "name", "mm", (4.0, 5.0, 4.0, None, -1.0))
    assert line.differences == (0.0, 1.0, 0.0, None, -5.0)
    assert line.percent == (0.0, 25.0, 0.0, None, None)
    assert Line("key", "name", "mm", (None, 5.0)).differences == (None, None)
    assert Line("key", "name", "mm", (0.0, 5.0)).percent == (None, None)


def test_only_settings_that_differ_are_told_with_every_value() -> None:
    assert changed_settings(pair()) == (("grid.step", ("10 mm", "8 mm")),)
    assert changed_settings(sides((("one", dish()), ("other", dish())))) == ()
    held = dish("[release]\nhold", '[press]\nrim = "clamp"\n[release]\nhold')
    assert ("press.rim", ("draw", "clamp")) in changed_settings(sides((("free", dish()), ("held", held))))


def test_the_nearest_has_the_least_rms() -> None:
    first, second = judged_alike(pair())
    assert first.rms < second.rms
    assert nearest(pair()) == first.side.name
    words = " ".join(comparison_words(pair()))
    assert words.startswith(f"{first.side.name} is nearer to the wanted shape: ")
    for one in (first, second):
        assert one.side.run.accuracy is not None
        assert one.rms == one.side.run.accuracy.judged.rms
        assert f"{one.rms:.3g}"[:4] in words
    assert "The cases differ in `grid.step`." in words


def moved(by: float, lobes: float = 0.0) -> Run:
    """A dish whose released nodes lie lower by so much, and by so much more in four lobes [mm]."""
    return let_go(
        fake_run(step=15.0),
        lambda rho, angle: by - lobes * (rho / 200) ** 4 * np.cos(4 * angle),
        release={"hold": {"from_radius": 300.0}},
        target={"profile": {"kind": "paraboloid", "focal_length": 250.0}, "aperture_radius": 200.0, "tolerance": 5.0},
    )


def test_why_the_farther_run_is_farther() -> None:
    """Parts of the difference of two mean squares add up to it; the largest is told."""
    runs = tuple(Side(name, one, {}) for name, one in (("near", moved(-2.0)), ("far", moved(-6.0))))
    words = " ".join(comparison_words(runs))
    share = re.search(
        r"sets far behind near \(the difference of the squares of their rms\), ([\d.]+)\u00a0% is an even offset",
        words,
    )
    assert share is not None
    assert float(share[1]) == pytest.approx(98, abs=2)
    assert "Within tolerance: near. Out of tolerance: far." in words
    assert "the difference comes with the release" in words
    runs = tuple(Side(name, one, {}) for name, one in (("near", moved(-2.0)), ("far", moved(-2.0, 9.0))))
    assert "are its four lobes (m = 4)" in " ".join(comparison_words(runs))


def test_the_same_twice_is_equally_near_and_of_one_case() -> None:
    words = said(("one", dish()), ("other", dish()))
    assert "one and other are equally near" in words
    assert "The cases are the same." in words
    assert nearest(sides((("one", dish()), ("other", dish())))) is None


def test_another_nearest_after_the_best_fits_is_told() -> None:
    """What lies lower all round is mended by a best fit, lobes are not."""
    low, lobed = Side("low", moved(-3.0), {}), Side("lobed", moved(0.0, 4.0), {})
    assert nearest((low, lobed)) == "lobed"
    assert "after the best fits low has" in " ".join(comparison_words((low, lobed)))
    assert "after the best fits" not in " ".join(comparison_words((Side("less", moved(0.0, 2.0), {}), lobed)))


def test_other_targets_and_none_are_told() -> None:
    other = dish('[target]\nprofile = { kind = "paraboloid", focal_length = "60 mm" }',
                 '[target]\nprofile = { kind = "paraboloid", focal_length = "61 mm" }')  # fmt: skip
    assert "held against a target of its own" in said(("one", dish()), ("other", other))
    tighter = dish('tolerance = "0.5 mm"', 'tolerance = "0.001 mm"')
    words = said(("one", dish()), ("tight", tighter))
    assert "of its own" not in words
    assert "Out of tolerance: tight." in words
    none = run(tiny_dish.case().model_copy(update={"target": None}))
    assert "Only one has a target" in said(("one", dish()), ("none", none))
    assert "No run has a target" in said(("none", none), ("too", none))


def test_figures_of_a_kind_have_one_scale() -> None:
    for kind in KINDS:
        reaches = [kind.reach(side.run) for side in pair()]
        known = [reach for reach in reaches if reach is not None]
        assert len(known) == 2
        bars = [kind.draw(side.run, max(known)).axes[-1].get_ylim() for side in pair()]
        np.testing.assert_allclose(bars[0], bars[1])
        assert max(bars[0]) == pytest.approx(max(known))


def test_a_run_without_a_release_stands_beside_one_with() -> None:
    flat = run(tiny_dish.case().model_copy(update={"release": None}))
    page = comparison_page(sides((("formed", flat), ("released", dish()))))
    ids = re.findall(r'<figure id="(\w+)"', page)
    assert "sag_2" in ids
    assert "sag_1" not in ids
    assert len(ids) == len(set(ids))


# --- the command ---------------------------------------------------------------------------------------------


def test_two_runs_are_one_page_and_one_json(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "both.html"
    code = main(["report", *map(str, folders), "-o", str(page), "--json"])
    out = json.loads(capsys.readouterr().out)
    assert code == Exit.DONE
    assert [one["name"] for one in out["runs"]] == ["coarse", "fine"]
    assert out["settings"] == [{"key": "grid.step", "values": ["10 mm", "8 mm"]}]
    files = [json.loads((folder / "result.json").read_text(encoding="utf-8")) for folder in folders]
    (energy,) = (one for one in out["figures"] if one["key"] == "formed.energy_mJ")
    assert energy["values"] == [file["formed"]["energy_mJ"] for file in files]
    text = page.read_text(encoding="utf-8")
    assert len(text) < 1_300_000
    assert all(f'id="{kind.name}_{number}"' in text for kind in KINDS for number in (1, 2))


def test_without_a_file_there_is_a_table(folders: tuple[Path, Path], capsys: pytest.CaptureFixture[str]) -> None:
    main(["report", *map(str, folders)])
    printed = capsys.readouterr()
    assert re.search(r"Largest shear in the tool +[\d.]+° +[\d.]+° +[+−][\d.]+ \([+−][\d.]+\u00a0?%?", printed.out)
    assert "-o FILE" in printed.err
    main(["report", *map(str, folders), "--quiet"])
    assert capsys.readouterr().err == ""


def test_one_run_gets_the_same_report_anew(
    folders: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "again"
    shutil.copytree(folders[0], folder)
    kept = {path.name: path.read_bytes() for path in folder.rglob("*.*")}
    (folder / "report.html").write_text("old", encoding="utf-8")
    (folder / "figures" / "shear.svg").unlink()
    assert main(["report", str(folder), "--quiet"]) == Exit.DONE
    assert {path.name: path.read_bytes() for path in folder.rglob("*.*")} == kept
    elsewhere = tmp_path / "one.html"
    # A page alone reads no PNG, so none is drawn.
    monkeypatch.delattr(files, "png")
    assert main(["report", str(folder), "-o", str(elsewhere), "--quiet"]) == Exit.DONE
    assert elsewhere.read_bytes() == kept["report.html"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{here}/no"], "no such folder"),
        (["{here}"], "not a punchform run"),
        (["{run}", "{run}/../coarse"], "the run is named twice"),
        (["{run}", "-o", "{here}"], "is a folder"),
        (["{run}", "-o", "{here}/no/page.html"], "there is no folder"),
        (["{run}", "-o", "{here}/there.html"], "the file exists"),
        (["{run}", "-o", "{run}/nodes.csv", "--overwrite"], "among the files of a run"),
        (["{here}/old"], "form its case again"),
    ],
)
def test_bad_input_is_told_and_nothing_written(
    arguments: list[str], message: str, folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "there.html").write_text("mine", encoding="utf-8")
    shutil.copytree(folders[0], tmp_path / "old")
    (tmp_path / "old" / "run.npz").unlink()
    before = sorted(tmp_path.rglob("*"))
    filled = [one.format(here=tmp_path, run=folders[0]) for one in arguments]
    assert main(["report", *filled]) == Exit.UNUSABLE_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert message in printed.err
    assert sorted(tmp_path.rglob("*")) == before
    assert (tmp_path / "there.html").read_text(encoding="utf-8") == "mine"
