"""A real dish whose punch is compensated: how much better, the case that it gives, and one that does not follow."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest
from compensated_dishes import case_of, elastic, stretched, text_of

from punchform.case import read_case, varied
from punchform.case.reading import case_from_text
from punchform.cli import main
from punchform.errors import InputError, NoEquilibrium
from punchform.optimise import compensated
from punchform.optimise.compensated import Wish, compensate_case
from punchform.optimise.compensation import Ending, Limits, one_rms
from punchform.optimise.compensation_files import SOLVE_COLUMNS, compensation_result, convergence_csv
from punchform.optimise.remedies import remedies_of
from punchform.report.compensate_words import explained, remedies, solve_rows
from punchform.run import run


def test_a_stretched_dish_follows_its_punch_and_two_solves_are_worth_ten_times() -> None:
    done = stretched()
    assert done.within
    assert done.found.ending is Ending.WITHIN
    assert len(done.found.solves) == 2
    assert done.found.gain > 10
    assert done.found.solves[1].follows == pytest.approx(1.0, abs=0.1)


def test_the_case_it_gives_has_the_rms_that_it_claims() -> None:
    done = stretched()
    accuracy = run(done.case).accuracy
    assert accuracy is not None
    assert accuracy.judged.rms == pytest.approx(done.after.rms, rel=1e-9)
    assert done.case.tool.correction is not None
    assert varied(done.case, {"punch.correction": None}) == done.given


def test_the_target_stays_at_the_vertex_of_the_profile() -> None:
    before, after = stretched().before.run, stretched().run
    assert before is not None
    assert before.accuracy is not None
    assert after.accuracy is not None
    assert after.accuracy.target.apex_height == before.accuracy.target.apex_height
    shift = after.formed.whole.positions[:, 2].max() - before.formed.whole.positions[:, 2].max()
    assert shift > 0.1


def test_what_the_press_holds_stays_where_it_was() -> None:
    before, after = stretched().before.run, stretched().run
    assert before is not None
    flange = np.hypot(*before.formed.whole.flat[:, :2].T) >= 60.0
    moved = after.formed.whole.positions[flange] - before.formed.whole.positions[flange]
    assert np.abs(moved).max() < 1e-3


def test_simpler_punches_are_pressed_once_over_what_they_can_take_of_the_answer() -> None:
    done = stretched()
    assert set(done.others) == {"revolution", "lobes"}
    turned, lobed = (one_rms(done.others[kind].best) for kind in ("revolution", "lobes"))
    assert turned > lobed
    assert one_rms(done.others["revolution"].best) == pytest.approx(done.floors["revolution"], rel=0.1)
    assert done.floors["field"] <= done.floors["lobes"] <= done.floors["revolution"]
    assert any("lathe" in sentence and "floor" in sentence for sentence in explained(done))


def test_a_turned_punch_ends_on_its_floor() -> None:
    done = stretched("revolution", 1e-4)
    assert done.found.ending is Ending.FLOOR
    assert one_rms(done.found.best) == pytest.approx(done.found.floor, rel=0.1)
    assert not done.others
    assert any("Mill the punch" in hint for hint in remedies(done))


def test_it_goes_on_from_a_correction_that_the_case_has() -> None:
    done = compensate_case(stretched().case, Wish(limits=Limits(1e-4, 2)))
    assert done.before.rms == pytest.approx(stretched().after.rms, rel=0.02)
    assert done.after.rms < done.before.rms


def test_a_dish_within_its_tolerance_needs_no_correction() -> None:
    done = compensate_case(case_of(), Wish(limits=Limits(1.0)))
    assert len(done.found.solves) == 1
    assert done.case == done.given
    assert "nothing to correct" in explained(done)[0]


def test_an_elastic_dish_is_told_not_to_follow_why_and_what_would_help() -> None:
    done = elastic()
    assert done.found.ending is Ending.UNMOVED
    assert done.within is False
    assert done.reach is not None
    assert done.reach.solves == 0
    assert done.reach.left > done.given.target.tolerance  # type: ignore[union-attr]
    said = " ".join(explained(done))
    assert "stay elastic" in said
    assert "of the squared error cannot be moved" in said
    assert "lobes" in said
    advice = remedies(done)
    assert any("annealed" in hint and "Tried" in hint for hint in advice)
    left = [one.rms for one in done.remedies if one.rms is not None]
    assert left == sorted(left)


def test_what_a_case_does_already_is_not_suggested() -> None:
    names = {one.name for one in remedies_of(case_of(elastic=True))}
    assert names == {"soft", "weld", "ribs", "hold", "pull"}
    better = varied(
        case_of(),
        {
            "grid.crossing": "welded",
            "press.rim": "clamp",
            "release.ribs": [{"radius": 30.0}],
            "release.hold.from_radius": 45.0,
        },
    )
    assert not remedies_of(better)


def test_a_response_by_pressing_agrees_with_that_by_tangents_on_what_is_out_of_reach(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compensated, "why_not", lambda run: "asked not to")
    monkeypatch.setattr(compensated, "tried", lambda case, observe: ())
    # Held from where no crossing comes near: the same ones in all presses.
    held = varied(case_of(elastic=True), {"release.hold.from_radius": 55.0})
    pressed = compensate_case(held, Wish(limits=Limits(0.005, 1), response=True)).reach
    monkeypatch.undo()
    followed = compensate_case(held, Wish(limits=Limits(0.005, 1), response=True)).reach
    assert pressed is not None
    assert followed is not None
    assert pressed.solves == 14
    np.testing.assert_allclose(pressed.values[:3], followed.values[:3], rtol=0.1)
    assert pressed.beyond == pytest.approx(followed.beyond, abs=0.1)


def test_the_response_of_wires_that_yield_is_that_of_presses_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    wish = Wish(limits=Limits(0.02, 1), response=True)
    followed = compensate_case(case_of(), wish).reach
    monkeypatch.setattr(compensated, "why_not", lambda run: "asked not to")
    pressed = compensate_case(case_of(), wish).reach
    assert pressed is not None
    assert followed is not None
    assert (pressed.solves, followed.solves) == (7, 0)
    np.testing.assert_allclose(pressed.values, followed.values, rtol=0.01)


def test_an_aperture_as_wide_as_the_rim_is_doubted() -> None:
    wide = varied(case_of(), {"target.aperture_radius": 60.0})
    done = compensate_case(wide, Wish(limits=Limits(10.0)))
    assert any("outermost ring" in note for note in done.notes)


def test_a_case_without_release_has_nothing_to_answer() -> None:
    with pytest.raises(InputError, match="has not sprung back"):
        compensate_case(varied(case_of(), {}).model_copy(update={"release": None}), Wish())


@pytest.mark.parametrize("change", [{"target.alignment": "best fit"}, {"target.measure": "half-path"}])
def test_the_floor_is_that_of_what_is_judged(change: dict[str, object]) -> None:
    """A search does not end at a floor above what it has reached."""
    done = compensate_case(varied(case_of(), change), Wish(limits=Limits(0.002)))
    assert done.found.floor < 1.0001 * one_rms(done.found.best)
    assert one_rms(done.found.best) < 0.016


@pytest.mark.parametrize(
    "changes",
    [
        {"target.alignment": "best fit"},
        {"target.measure": "half-path", "grid.symmetry": "full"},
        {"target.profile.focal_length": 66.0, "release.hold": "rim"},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_other_judgements_symmetries_targets_and_holds_are_compensated_too(changes: dict[str, object]) -> None:
    found = compensate_case(varied(case_of(), changes), Wish("lobes", Limits(1e-4, 2))).found
    assert found.gain > (8 if "target.alignment" not in changes else 1.5)
    assert all(one.follows == pytest.approx(1.0, abs=0.3) for one in found.solves[1:])


def test_a_trimmed_dish_is_compensated_for_what_is_left_of_it() -> None:
    text = text_of().replace("schema = 1", 'schema = 1\nstages = ["press", "release", { trim = {} }]')
    found = compensate_case(case_from_text(text), Wish("revolution", Limits(1e-4, 2))).found
    assert found.gain > 5


def test_the_tables_tell_every_solve() -> None:
    done = stretched()
    rows = list(csv.reader(io.StringIO(convergence_csv(done))))
    assert tuple(rows[0]) == SOLVE_COLUMNS
    assert [row[0] for row in rows[1:]] == ["field", "field", "revolution", "lobes"]
    assert float(rows[2][2]) == pytest.approx(done.after.rms, rel=1e-8)
    content = compensation_result(done)["compensation"]
    assert isinstance(content, dict)
    assert content["within"] is True
    assert len(content["solves"]) == 2
    assert len(solve_rows(done)) == len(rows)


def test_the_command_writes_a_folder_whose_case_can_be_formed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "dish.toml").write_text(text_of(), encoding="utf-8")
    folder = tmp_path / "out"
    assert main(["compensate", str(tmp_path / "dish.toml"), "-o", str(folder), "--quiet"]) == 0
    told = capsys.readouterr()
    assert "lathe" in told.out
    assert not told.err
    names = {path.name for path in folder.iterdir()}
    assert {"convergence.csv", "result.json", "case.toml", "correction.csv", "punch.stl", "report.html"} <= names
    assert {"figures", "revolution", "lobes", "punch_profile.dxf", "punch_height_field.csv"} <= names
    written, known = read_case(folder / "case.toml"), stretched().case
    assert varied(written, {"punch.correction": None}) == varied(known, {"punch.correction": None})
    assert written.tool.correction is not None
    assert known.tool.correction is not None
    np.testing.assert_allclose(written.tool.correction.points, known.tool.correction.points, atol=1e-12)
    turned = read_case(folder / "revolution" / "case.toml")
    assert turned.tool.correction is not None
    assert turned.tool.correction.kind == "radial"
    claimed = json.loads((folder / "result.json").read_text(encoding="utf-8"))["compensation"]["rms_mm"]
    assert claimed == pytest.approx(stretched().after.rms, rel=1e-9)
    page = (folder / "report.html").read_text(encoding="utf-8")
    for heading in ("How it went", "The correction of the punch", "Deviation before and after", "What is left"):
        assert heading in page


def test_the_command_ends_with_one_when_the_punch_cannot_help(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = elastic()
    monkeypatch.setattr("punchform.cli.compensate.compensate_case", lambda case, wish, observe: done)
    (tmp_path / "dish.toml").write_text(text_of(elastic=True), encoding="utf-8")
    arguments = ["compensate", str(tmp_path / "dish.toml"), "-o", str(tmp_path / "out"), "--json"]
    assert main(arguments) == 1
    content = json.loads(capsys.readouterr().out)["compensation"]
    assert content["within"] is False
    assert content["reach"]["rms_not_moved_mm"] == pytest.approx(done.reach.left)  # type: ignore[union-attr]
    assert {one["remedy"] for one in content["tried"]} == {"soft", "weld", "ribs", "hold", "pull"}
    assert "What the punch can reach" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "place"),
    [
        (["--solves", "0"], "--solves 0"),
        (["--solves", "many"], "--solves many"),
        (["--relaxation", "0"], "--relaxation 0"),
        (["--relaxation", "1.5"], "--relaxation 1.5"),
        (["--relaxation", "half"], "--relaxation half"),
        (["--to", "0 mm"], "--to 0 mm"),
        (["--to", "3 N"], "--to 3 N"),
        (["--surface", "cone"], "--surface"),
    ],
)
def test_options_that_cannot_be_are_refused_before_anything_is_solved(
    options: list[str], place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    assert main(["compensate", "packaged:dish600", "-o", str(folder), *options]) == 2
    assert place in capsys.readouterr().err
    assert not folder.exists()


@pytest.mark.parametrize(
    ("name", "change", "place"),
    [("no target", lambda text: text[: text.index("[target]")], "target"), ("no punch", None, "press.ends")],
)
def test_cases_without_target_or_punch_are_refused(
    name: str, change: object, place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = "packaged:gridshell"
    if callable(change):
        (tmp_path / "dish.toml").write_text(change(text_of()), encoding="utf-8")
        path = str(tmp_path / "dish.toml")
    assert main(["compensate", path, "-o", str(tmp_path / "out")]) == 2
    assert place in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt(), 130), (NoEquilibrium("press: none"), 3)])
def test_an_interrupted_or_failed_search_leaves_nothing(
    error: BaseException, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*arguments: object, **settings: object) -> None:
        raise error

    monkeypatch.setattr(compensated, "run", fails)
    (tmp_path / "dish.toml").write_text(text_of(), encoding="utf-8")
    assert main(["compensate", str(tmp_path / "dish.toml"), "-o", str(tmp_path / "out"), "--quiet"]) == code
    assert [path.name for path in tmp_path.iterdir()] == ["dish.toml"]


def test_a_missing_target_is_told_from_python_too() -> None:
    with pytest.raises(InputError, match="target"):
        compensate_case(varied(case_of(), {}).model_copy(update={"target": None}), Wish())


def test_the_packaged_dish_on_a_coarser_grid_is_ten_times_better_after_one_correction() -> None:
    coarse = varied(read_case("packaged:dish600"), {"grid.step": 15.0})
    done = compensate_case(coarse, Wish(limits=Limits(0.14)))
    assert done.found.ending is Ending.WITHIN
    assert len(done.found.solves) <= 6
    assert done.found.gain >= 10
    turned = done.others["revolution"]
    assert one_rms(turned.best) == pytest.approx(turned.floor, rel=0.05)
    assert 3 < done.before.rms / turned.floor < 10
