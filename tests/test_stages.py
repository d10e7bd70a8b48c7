"""Stages one after the other: the second press, the trim, and what a run makes and tells of them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_grids import PUNCH, SHALLOW, STEP, assert_equal_grids, grid, wire_case, wires

from punchform import run
from punchform.arrays import Floats
from punchform.case import (
    TEMPLATE,
    Case,
    CrossingSpring,
    HoldFrom,
    HoldPoints,
    LoadCase,
    PressCase,
    ReleaseCase,
    case_from_text,
    json_schema,
    packaged_text,
    write_case,
)
from punchform.cli import main
from punchform.cli.compare import read_predicted
from punchform.errors import InputError, NoEquilibrium
from punchform.export.result import all_notes, result
from punchform.grid import Grid
from punchform.load import load
from punchform.mechanics.frames import crossing_angle
from punchform.mechanics.outcome import Outcome
from punchform.press import Formed, press
from punchform.punch import Surface
from punchform.release import Released, release
from punchform.report.page import write_report
from punchform.run import Run
from punchform.solved import Shaped
from punchform.start import struck
from punchform.store import read_run, write_run
from punchform.trim import Trimmed, cut, cut_like, trim
from punchform.whole import state_on
from punchform.wire import Element, pieces

RADIUS = 5.2 * STEP
RIM = 4.0 * STEP
EDGE = 3.55 * STEP
"""Trimmed here in the formed shape the grid is that of a blank of this radius."""
SPRING = CrossingSpring(stiffness=300.0)
WIRE = wire_case().model_copy(update={"density": 7850.0})
Crossing = str | CrossingSpring


def elements(laid: Grid) -> tuple[Element, ...]:
    return pieces(wires(laid.step), laid.subdivide)


@cache
def formed(symmetry: str = "quarter", crossing: Crossing = "pinned", subdivide: int = 1) -> Formed:
    laid = grid(RADIUS, symmetry=symmetry, subdivide=subdivide)
    return press(laid, elements(laid), PUNCH, PressCase(), crossing=crossing)


def let_go(stage: Shaped, hold: Any = "rim", crossing: Crossing = "pinned", **settings: Any) -> Released:
    case = ReleaseCase(hold=hold)
    return release(stage, elements(stage.grid), case, PressCase(), crossing=crossing, **settings)


def again(stage: Shaped, crossing: Crossing = "pinned", surface: Surface = PUNCH, **settings: Any) -> Formed:
    start = struck(stage.state, surface)
    return press(stage.grid, elements(stage.grid), surface, PressCase(**settings), crossing=crossing, start=start)


def trimmed(stage: Shaped, radius: float = EDGE, crossing: Crossing = "pinned") -> Trimmed:
    return trim(stage, radius, elements(stage.grid), WIRE, crossing=crossing)


# --- the second press ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("hold", [HoldFrom(from_radius=RIM), "rim", HoldPoints(points=8, radius=RIM), "nothing"])
def test_an_elastic_grid_struck_again_is_the_pressed_one(hold: Any) -> None:
    first = formed()
    second = again(let_go(first, hold))
    assert second.outcome is Outcome.CONVERGED
    assert_equal_grids(second.whole, first.whole)
    assert second.energy == pytest.approx(first.energy, rel=1e-12)


@pytest.mark.parametrize("crossing", [SPRING, "welded"])
@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_so_it_is_with_stiff_crossings_and_a_whole_grid(crossing: Crossing, symmetry: str) -> None:
    first = formed(symmetry, crossing)
    second = again(let_go(first, "rim", crossing), crossing)
    assert_equal_grids(second.whole, first.whole)


def test_a_clamp_holds_what_lies_at_the_rim_now() -> None:
    laid = grid(RADIUS)
    first = press(laid, elements(laid), SHALLOW, PressCase(rim="clamp"))
    second = again(let_go(first, HoldFrom(from_radius=RIM)), surface=SHALLOW, rim="clamp")
    assert_equal_grids(second.whole, first.whole)
    drawn = formed()
    clamped = again(let_go(drawn, HoldFrom(from_radius=RIM)), rim="clamp")
    outside = np.linalg.norm(drawn.whole.positions[:, :2], axis=1) >= RIM
    assert outside.any()
    np.testing.assert_allclose(clamped.whole.positions[outside], drawn.whole.positions[outside], rtol=0, atol=1e-9)


def test_nothing_left_at_the_rim_cannot_be_clamped() -> None:
    with pytest.raises(InputError, match="nothing can be clamped") as refused:
        again(trimmed(formed()), rim="clamp")
    assert refused.value.problems[0].where == "press.rim"


def test_a_trimmed_grid_struck_again_rests_on_the_punch() -> None:
    second = again(trimmed(formed()))
    assert second.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(PUNCH.gap(second.whole.positions).value, 0.0, atol=1e-8)
    # Its ends lie within the rim because they were cut there, not because they were drawn in.
    assert not any("drawn in past the rim" in note for note in second.notes)
    direct = press(grid(EDGE), elements(second.grid), PUNCH, PressCase())
    assert_equal_grids(second.whole, direct.whole)


# --- the trim -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("symmetry", "weave"), [("quarter", "plain"), ("full", "plain"), ("quarter", "same")])
@pytest.mark.parametrize("subdivide", [1, 3])
def test_a_cut_grid_is_the_grid_of_the_smaller_blank(symmetry: str, weave: str, subdivide: int) -> None:
    large, small = (grid(r, symmetry=symmetry, weave=weave, subdivide=subdivide) for r in (RADIUS, 3.2 * STEP))
    there = {tuple(number) for number in small.index.tolist()}
    nodes = np.array([tuple(number) in there for number in large.index.tolist()])
    found = cut(large, nodes, nodes[large.start] & nodes[large.end])
    assert found.trimmed
    for name, value in vars(small).items():
        if name != "trimmed":
            np.testing.assert_array_equal(getattr(found, name), value, err_msg=name)


@pytest.mark.parametrize("subdivide", [1, 2])
@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_what_is_left_lies_as_it_did(symmetry: str, subdivide: int) -> None:
    before = formed(symmetry, subdivide=subdivide)
    after = trimmed(before)
    small = grid(EDGE, symmetry=symmetry, subdivide=subdivide)
    np.testing.assert_array_equal(after.grid.index, small.index)
    np.testing.assert_array_equal(after.grid.neighbours, small.neighbours)
    kept = {tuple(place): number for number, place in enumerate(before.whole.flat.tolist())}
    same = [kept[tuple(place)] for place in after.whole.flat.tolist()]
    for name in ("positions", "normals", "index", "between"):
        np.testing.assert_array_equal(getattr(after.whole, name), getattr(before.whole, name)[same], err_msg=name)
    radius = np.linalg.norm(before.whole.positions[: before.whole.crossings, :2], axis=1)
    assert after.whole.crossings == np.count_nonzero(radius <= EDGE)
    assert after.crossings_cut == np.count_nonzero(radius > EDGE)
    assert not after.whole.contact.any()
    # The whole grid of the next stage has the same order.
    held = let_go(after)
    for name in ("flat", "family", "start", "end", "sigma", "cells"):
        np.testing.assert_array_equal(getattr(after.whole, name), getattr(held.whole, name), err_msg=name)


@pytest.mark.parametrize("crossing", ["pinned", SPRING])
def test_its_energy_is_that_of_the_kept_elements(crossing: Crossing) -> None:
    before = formed(crossing=crossing)
    after = trimmed(before, crossing=crossing)
    inside = np.linalg.norm(before.whole.positions[:, :2], axis=1) <= EDGE
    kept = inside[before.whole.start] & inside[before.whole.end]
    springs = 0.0
    if isinstance(crossing, CrossingSpring):
        passed = after.grid.passes.all(axis=1)
        turned = (crossing_angle(after.state) - 0.5 * np.pi) ** 2 * passed
        springs = float(0.5 * crossing.stiffness * 4 * (after.grid.node_weight @ turned))
    assert after.energy == pytest.approx(before.whole.energy[kept].sum() + springs, rel=1e-12)
    assert after.energy_kinds["crossing"] == pytest.approx(springs, rel=1e-12)
    assert after.pieces_cut == np.count_nonzero(~kept)
    np.testing.assert_array_equal(after.whole.F, before.whole.F[kept])


def test_beyond_the_blank_it_changes_nothing() -> None:
    before = formed()
    after = trimmed(before, 2 * RADIUS)
    assert after.grid is before.grid
    assert (after.crossings_cut, after.pieces_cut, after.wires_cut, after.mass_cut) == (0, 0, 0, 0.0)
    assert after.energy == pytest.approx(before.energy, rel=1e-14)
    assert "cuts nothing off" in after.notes[0]
    assert_equal_grids(let_go(after).whole, let_go(before).whole)


def test_trimming_in_two_steps_is_trimming_once() -> None:
    once, twice = trimmed(formed(), 2.5 * STEP), trimmed(trimmed(formed()), 2.5 * STEP)
    np.testing.assert_array_equal(once.whole.positions, twice.whole.positions)
    np.testing.assert_array_equal(once.grid.neighbours, twice.grid.neighbours)
    assert once.energy == pytest.approx(twice.energy, rel=1e-14)


def test_a_quarter_is_trimmed_as_the_whole_grid() -> None:
    quarter, whole = trimmed(formed()), trimmed(formed("full"))
    assert_equal_grids(quarter.whole, whole.whole, 1e-8)
    told = ("crossings_cut", "pieces_cut", "wires_cut", "blank")
    assert [getattr(quarter, name) for name in told] == [getattr(whole, name) for name in told]
    assert quarter.mass_cut == pytest.approx(whole.mass_cut, rel=1e-12)
    full = cut_like(grid(RADIUS, symmetry="full"), quarter.whole)
    np.testing.assert_array_equal(full.neighbours, whole.grid.neighbours)
    np.testing.assert_array_equal(state_on(full, quarter.whole).positions, quarter.whole.positions)


def test_what_is_cut_off_is_told() -> None:
    # Eleven by eleven lines of crossings within 5.2 steps; those beyond 3 steps go, in the flat shape.
    laid = grid(RADIUS)
    flat = let_go(formed(), "nothing")
    after = trimmed(flat, 3.0 * STEP)
    i, j = np.meshgrid(np.arange(-5, 6), np.arange(-5, 6))
    distance = np.hypot(i, j)
    blank, left = distance <= RADIUS / STEP, distance <= 3.0
    assert after.whole.crossings == left.sum()
    assert after.crossings_cut == blank.sum() - left.sum()
    assert after.wires_cut == 2 * 11
    np.testing.assert_allclose(after.blank, (np.sqrt(5) * STEP, 3 * STEP))
    mass = elements(laid)[0].wire_length * after.pieces_cut * 7850e-9 * 0.25 * np.pi
    assert after.mass_cut == pytest.approx(mass, rel=1e-9)
    assert trim(flat, 3.0 * STEP, elements(laid), wire_case()).mass_cut is None


def test_what_hangs_on_nothing_falls_off_and_is_told() -> None:
    before = formed("full")
    far = before.whole.index[:, 0] == 3
    lifted = before.state.positions.copy()
    lifted[far, 0] += 2 * RADIUS
    moved = replace(
        before,
        state=replace(before.state, positions=lifted),
        whole=replace(before.whole, positions=lifted),
    )
    after = trimmed(moved, 2 * RADIUS)
    assert after.whole.index[:, 0].max() == 2
    hanging = np.count_nonzero(before.whole.index[:, 0] > 3)
    assert after.notes == (
        f"{hanging} crossings within {2 * RADIUS:g} mm hang on nothing that stays: they fall off with the trim",
    )


def test_hardly_anything_left_is_refused() -> None:
    with pytest.raises(InputError, match="only 5 crossings lie within 12 mm") as refused:
        trimmed(formed(), 12.0)
    assert refused.value.problems[0].where == "trim.radius"


# --- what comes after the trim --------------------------------------------------------------------------------


@pytest.mark.parametrize("crossing", ["pinned", "welded"])
def test_let_go_it_is_the_smaller_grid_in_the_same_held_places(crossing: Crossing) -> None:
    cut_off = trimmed(formed(crossing=crossing), crossing=crossing)
    after = let_go(cut_off, "rim", crossing)
    assert after.energy < cut_off.energy
    assert_equilibrium_of(after)
    # Laid with the small blank, formed by itself, and then brought to the places at which the other is held.
    small = press(grid(EDGE), elements(cut_off.grid), PUNCH, PressCase(), crossing=crossing)
    ends = small.grid.wire_ends.any(axis=(1, 2))
    places = small.state.positions.copy()
    places[ends] = cut_off.state.positions[ends]
    assert np.abs(places - small.state.positions).max() > 1e-3
    brought = let_go(replace(small, state=replace(small.state, positions=places)), "rim", crossing)
    assert brought.energy == pytest.approx(after.energy, rel=1e-10)
    assert_equal_grids(brought.whole, after.whole, 1e-8)


def assert_equilibrium_of(stage: Released) -> None:
    """What holds the grid is in balance: no other force acts on it."""
    total = stage.reactions.sum(axis=0)
    moment = np.cross(stage.whole.positions, stage.reactions).sum(axis=0)
    size = np.abs(stage.reactions).sum()
    np.testing.assert_allclose(total, 0.0, atol=1e-8 * size)
    np.testing.assert_allclose(moment, 0.0, atol=1e-8 * size * RADIUS)


def test_it_bears_loads_and_is_let_go_again() -> None:
    held = let_go(trimmed(formed()))
    under = load(held, elements(held.grid), LoadCase(gravity=(0.0, 0.0, -1.0)), WIRE, PressCase())
    assert under.mass is not None
    assert under.reactions[:, 2].sum() == pytest.approx(under.mass * 9.80665, rel=1e-8)
    # The held places have not moved, so the same hold finds the unloaded shape again.
    assert_equal_grids(let_go(under).whole, held.whole, 1e-8)
    np.testing.assert_allclose(let_go(under).moved, held.whole.positions - under.whole.positions, atol=1e-9)


# --- runs -----------------------------------------------------------------------------------------------------

CASE = """\
schema = 1
title = "small dish"
{stages}
[grid]
step = "10 mm"
blank = {{ shape = "circle", radius = "52 mm" }}
[wire]
diameter = "1 mm"
youngs_modulus = "210 GPa"
poisson = 0.25
density = 7850
[punch]
profile = {{ kind = "paraboloid", focal_length = "100 mm" }}
rim_radius = "40 mm"
fillet = "20 mm"
[target]
profile = {{ kind = "paraboloid", focal_length = "100 mm" }}
aperture_radius = "25 mm"
tolerance = "20 mm"
{sections}
"""
RELEASE = '[release]\nhold = { from_radius = "40 mm" }\n'
LOAD = "[load]\ngravity = [0, 0, -1]\n"


def case(stages: str = "", sections: str = RELEASE) -> Case:
    return case_from_text(CASE.format(stages=f"stages = {stages}" if stages else "", sections=sections))


@cache
def long_run() -> Run:
    return run(
        case(
            '["press", "release", { trim = { radius = "35.5 mm" } }, "press", '
            '{ release = { hold = "rim", symmetry = "full" } }, "load", "release"]',
            RELEASE.replace("40 mm", "30 mm") + LOAD,
        )
    )


def without_seconds(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: without_seconds(value) for key, value in content.items() if key != "seconds"}
    return [without_seconds(value) for value in content] if isinstance(content, list) else content


def test_named_stages_do_what_the_sections_did() -> None:
    plain, named = run(case(sections=RELEASE + LOAD)), run(case('["press", "release", "load"]', RELEASE + LOAD))
    told = without_seconds(result(named))
    assert [stage["name"] for stage in told.pop("stages")] == ["press 1", "release 1", "load 1"]
    assert told == without_seconds(result(plain))
    assert [stage.name for stage in plain.stages] == ["press 1", "release 1", "load 1"]
    assert "stages" not in result(plain)


def test_a_run_has_its_stages_in_order_and_the_last_of_each_kind() -> None:
    done = long_run()
    names = ["press 1", "release 1", "trim 1", "press 2", "release 2", "load 1", "release 3"]
    assert [stage.name for stage in done.stages] == names
    of = {stage.name: stage.done for stage in done.stages}
    assert (done.formed, done.released, done.loaded) == (of["press 2"], of["release 3"], of["load 1"])
    assert done.final is done.released
    assert not of["release 2"].grid.quarter
    moves = zip(("release 1", "release 2", "release 3"), ("press 1", "press 2", "load 1"), strict=True)
    for after, before in moves:
        one = of[after]
        assert isinstance(one, Released)
        np.testing.assert_array_equal(one.moved, one.whole.positions - of[before].whole.positions)
    assert done.accuracy is not None
    assert len(done.accuracy.mask) == len(done.final.whole.index)


def test_the_folder_keeps_the_place_of_what_was_cut_off(tmp_path: Path) -> None:
    done = long_run()
    stored = read_run(write_run(done, tmp_path / "out", extras=(write_report,)))
    trims = [stage for stage in stored.result["stages"] if stage["kind"] == "trim"]
    first = done.stages[0].done.whole
    assert len(stored.nodes) == first.crossings == stored.result["grid"]["nodes"]
    assert np.count_nonzero(np.isnan(stored.nodes["x"])) == trims[0]["crossings_cut"]
    for columns, shape in ((("x", "y", "z"), done.formed.whole), (("xr", "yr", "zr"), done.final.whole)):
        table: Floats = np.column_stack([stored.nodes[name] for name in columns])
        left = np.isfinite(table).all(axis=1)
        np.testing.assert_allclose(table[left], shape.positions, rtol=0, atol=1e-11)
        np.testing.assert_array_equal(stored.nodes["i"][left], shape.index[:, 0])
    _, predicted = read_predicted(stored.folder)
    np.testing.assert_allclose(predicted.nodes, done.final.whole.positions, rtol=0, atol=1e-11)
    assert [stage["name"] for stage in stored.result["stages"]] == [stage.name for stage in done.stages]
    assert stored.result["released"]["energy_mJ"] == stored.result["stages"][-1]["energy_mJ"]
    assert stored.result["loaded"] is None
    report = (stored.folder / "report.html").read_text(encoding="utf-8")
    assert all(stage.name in report for stage in done.stages)
    assert "moves are counted from the stage before, load 1" in report
    again = case_from_text((stored.folder / "case.toml").read_text(encoding="utf-8"))
    assert again == done.case


def test_in_the_tool_and_released_are_compared_for_what_is_left(tmp_path: Path) -> None:
    done = run(case('["press", "trim", { release = { hold = "rim" } }, "load"]', LOAD))
    folder = write_run(done, tmp_path / "out", extras=(write_report,))
    stored = read_run(folder)
    assert len(stored.wires) == len(done.formed.whole.family)
    assert stored.wires_released is not None
    assert len(stored.wires_released) == len(done.final.whole.family) < len(stored.wires)
    assert np.isfinite(stored.nodes["x"]).all()
    assert np.isnan(stored.nodes["xr"]).sum() == stored.result["stages"][1]["crossings_cut"] > 0
    report = (folder / "report.html").read_text(encoding="utf-8")
    assert "moves are counted from" not in report
    assert (folder / "figures" / "before_after.png").exists()


def test_a_later_press_undoes_what_was_told_of_the_release(tmp_path: Path) -> None:
    done = run(case('["press", "release", "press"]'))
    assert done.released is done.stages[1].done
    assert done.final is done.formed
    assert_equal_grids(done.formed.whole, done.stages[0].done.whole)
    stored = read_run(write_run(done, tmp_path / "out", extras=(write_report,)))
    assert stored.result["released"] is None
    assert np.isnan(stored.nodes["xr"]).all()
    assert done.accuracy is not None
    assert done.accuracy.judged.rms < 1e-8


def test_sections_that_no_stage_names_are_doubted() -> None:
    doubtful = case('["press"]', RELEASE + LOAD)
    assert [note for note in all_notes(run(doubtful)) if "has no effect" in note] == [
        "[release] has no effect: `stages` does not name it",
        "[load] has no effect: `stages` does not name it",
    ]


def test_a_stage_that_fails_is_named() -> None:
    short = case('["press", "release", "press"]', "[solver]\nmax_steps = 4\n" + RELEASE)
    with pytest.raises(NoEquilibrium, match=r"stages\[2\], press: the step limit"):
        run(short)


@pytest.mark.parametrize(
    ("stages", "sections", "told"),
    [
        ('["press", { trim = { radius = "12 mm" } }]', "", "stages[1].trim.radius: only 5 crossings"),
        (
            '["press", { trim = { radius = "35 mm" } },\n"release"]',
            RELEASE,
            ":18: release.hold.from_radius: no crossing",
        ),
        ('["press",\n{ release = { hold = { ring = "90 mm" } } }]', "", ":4: stages[1].release.hold.ring: no crossing"),
        ('["press", "trim",\n{ press = { rim = "clamp" } }]', "", ":4: stages[2].press.rim: nothing of the grid"),
    ],
)
def test_faults_that_only_a_run_finds_are_placed(
    stages: str, sections: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "dish.toml"
    # Nothing is judged: the smallest grids leave no aperture.
    text = CASE.format(stages=f"stages = {stages}", sections=sections)
    file.write_text(text[: text.index("[target]")] + text[text.index('tolerance = "20 mm"\n') + 20 :], encoding="utf-8")
    assert main(["form", str(file), "-o", str(tmp_path / "out")]) == 2
    assert told in capsys.readouterr().err


def test_the_command_tells_of_the_stages(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "dish.toml"
    stages = 'stages = ["press", { trim = { radius = "35.5 mm" } }, { release = { hold = "rim" } }]'
    file.write_text(CASE.format(stages=stages, sections=""), encoding="utf-8")
    assert main(["form", str(file), "-o", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "press 1, trim 1, release 1" in printed
    assert "crossings beyond 35.5 mm cut off" in printed
    content = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert content["stages"][1]["radius_mm"] == 35.5


# --- the case -------------------------------------------------------------------------------------------------


def test_what_a_stage_leaves_out_follows_its_section() -> None:
    found = case('["press", { release = { symmetry = "full" } }, { release = { hold = "rim" } }]')
    assert found.stages is not None
    first, second = (step.settings for step in found.steps[1:])
    assert first == ReleaseCase(hold=HoldFrom(from_radius=40.0), symmetry="full")
    assert second == ReleaseCase(hold="rim")
    assert case_from_text(write_case(found)) == found
    assert found.release is not None
    changed = found.model_copy(update={"release": found.release.model_copy(update={"hold": "rim"})})
    assert changed.steps[1].settings == ReleaseCase(hold="rim", symmetry="full")
    without = found.model_copy(update={"release": None})
    assert without.steps[1].settings == ReleaseCase(symmetry="full")


def test_the_template_shows_stages_that_are_valid() -> None:
    text = packaged_text(TEMPLATE)
    [line] = [line for line in text.splitlines() if "stages = [" in line]
    shown = case_from_text(text.replace(line, line.lstrip("# ")))
    assert [step.kind for step in shown.steps] == ["press", "release", "trim", "release"]


def test_the_schema_knows_the_stages() -> None:
    schema = json_schema()
    choices = schema["properties"]["stages"]["anyOf"][0]["items"]["oneOf"]
    assert choices[0]["enum"] == ["press", "release", "trim", "load"]
    assert {choice["$ref"].rpartition("/")[2] for choice in choices[1:]} <= set(schema["$defs"])


def test_without_stages_the_sections_say_what_is_done() -> None:
    assert [step.kind for step in case(sections="").steps] == ["press"]
    assert [step.kind for step in case(sections=RELEASE + LOAD).steps] == ["press", "release", "load"]


# --- the page on stages -----------------------------------------------------------------------------------------

PAGE = Path(__file__).resolve().parents[1] / "docs" / "stages.md"


def test_the_table_of_the_page_is_what_its_case_gives() -> None:
    page = PAGE.read_text(encoding="utf-8")
    text = page.partition("```toml\n")[2].partition("```")[0]
    table = page.partition("| stage |")[2].partition("\n\n")[0].splitlines()[2:]
    assert rows_of(run(case_from_text(text))) == table


def rows_of(done: Run) -> list[str]:
    """The table of the page for a run."""
    rows = []
    for stage in done.stages:
        moves = ["", ""]
        if isinstance(stage.done, Released):
            moves = [f"{move:+.2f} mm".replace("-", "−") for move in (stage.done.apex, stage.done.max_sag)]
        rows.append(
            f"| {stage.name} | {stage.done.whole.crossings} | {stage.done.energy:.1f} mJ | {moves[0]} | {moves[1]} |"
        )
    return rows
