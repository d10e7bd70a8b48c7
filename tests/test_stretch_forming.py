"""Stretch-forming: a clamped dish yields from rim to middle and keeps its shape; wires that never yield are elastic."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_grids import assert_equal_grids

from punchform import Run, read_case, run
from punchform.accuracy import ALIGNMENTS, best_fit, measure_case
from punchform.arrays import Bools, Floats
from punchform.case import Case, case_from_text
from punchform.mechanics.outcome import Outcome
from punchform.prepare import prepare
from punchform.release import Released
from punchform.remarks import remarks
from punchform.solved import Shaped

DISH = """
schema = 1
title = "Small stretched dish"
STAGES
[grid]
step = "12.5 mm"
blank = { shape = "circle", radius = "120 mm" }
GRID
[wire]
diameter = "0.75 mm"
material = "304 annealed"
WIRE
[punch]
profile = { kind = "paraboloid", focal_length = "100 mm" }
rim_radius = "100 mm"
fillet = "20 mm"
[press]
frame = "chord"
PRESS
[release]
hold = HOLD
LOAD
[target]
profile = { kind = "paraboloid", focal_length = "100 mm" }
aperture_radius = "80 mm"
tolerance = "1 mm"
"""
"""A dish of 200 mm, f/D = 0.5 as in the packaged case `dish600`, with a tenth of its crossings."""

ELASTIC = 'hardening = "none"'
UNREACHED = 'hardening = { kind = "linear", modulus = "2.5 GPa" }\nyield_strength = "19 GPa"'
"""A wire that yields at a stress that nothing here comes to."""
FLANGE = '{ from_radius = "100 mm" }'
CLAMP, DRAW = 'rim = "clamp"\nstrokes = 4', 'rim = "draw"\nstrokes = 4'
HOLDER = DRAW + '\nhold = { force_per_length = "5 N/mm", friction = 0.15 }'
RIM, APERTURE, FOCUS = 100.0, 80.0, 100.0


def dish(
    *, press: str = CLAMP, wire: str = "", grid: str = "", hold: str = FLANGE, stages: str = "", load: str = ""
) -> Case:
    """The case with some lines of its own in some sections."""
    text = DISH
    for place, lines in (("STAGES", stages), ("GRID", grid), ("WIRE", wire), ("PRESS", press), ("LOAD", load)):
        text = text.replace(f"\n{place}\n", f"\n{lines}\n")
    return case_from_text(text.replace("HOLD", hold))


@cache
def made(press: str = CLAMP, wire: str = "", grid: str = "", hold: str = FLANGE) -> Run:
    return run(dish(press=press, wire=wire, grid=grid, hold=hold))


def released(done: Run) -> Released:
    assert done.released is not None
    assert done.released.outcome is Outcome.CONVERGED
    return done.released


def rms(done: Run) -> float:
    """Of the normal deviations as held [mm]."""
    assert done.accuracy is not None
    return done.accuracy.as_held.statistics["normal"].rms


def laid_back(done: Run) -> float:
    """The rms [mm] of a dish that is laid back onto its target as well as a rigid part can be."""
    case, ready = done.case, prepare(done.case)
    assert case.target is not None
    whole = released(done).whole
    found = measure_case(whole.positions, whole.cells, case.target, apex_height=ready.punch.height_at_axis)
    judged = whole.positions[found.mask], found.weights[found.mask], found.target
    return best_fit(*judged, ALIGNMENTS["3-parameter"], "normal").rms


def focal_length(done: Run) -> float:
    """Of the best fit [mm]."""
    assert done.accuracy is not None
    found = done.accuracy.fitted.fit.pose.f
    assert found is not None
    return found


def inside(stage: Shaped, radius: float) -> Bools:
    """The wire pieces that lie within a radius, (M,)."""
    far = np.linalg.norm(stage.whole.positions[:, :2], axis=1)
    return np.asarray(np.maximum(far[stage.whole.start], far[stage.whole.end]) <= radius)


def moves(one: Shaped, other: Shaped) -> Floats:
    """How far each crossing lies from where the other stage has it, (N,) [mm]."""
    return np.asarray(np.linalg.norm(one.whole.positions - other.whole.positions, axis=1))


def test_the_page_shows_the_packaged_case() -> None:
    page = (Path(__file__).resolve().parents[1] / "docs" / "stretch_forming.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```toml\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    assert case_from_text(block) == read_case("packaged:dish600")


# --- what yields keeps its shape ------------------------------------------------------------------------------


@pytest.mark.parametrize("crossing", ["pinned", "welded"])
@pytest.mark.parametrize(
    "wire", ["", 'centreline = { kind = "straight", height = "0.75 mm" }'], ids=["crimped", "straight"]
)
def test_a_clamped_dish_yields_from_rim_to_middle(crossing: str, wire: str) -> None:
    weave = 'weave = "stacked"\n' if wire else ""
    done = made(wire=wire, grid=f'{weave}crossing = "{crossing}"')
    formed, strains = done.formed, done.formed.whole.plastic_strain
    assert formed.outcome is Outcome.CONVERGED
    assert formed.negative_eigenvalues == 0
    within = inside(formed, RIM)
    assert (strains[within] > 0.005).all()
    # What the clamp holds has not moved, and stays as it was bought.
    far = np.linalg.norm(formed.whole.flat, axis=1)
    beyond = np.minimum(far[formed.whole.start], far[formed.whole.end]) >= RIM
    assert beyond.any()
    assert not strains[beyond].any()
    # Flow in tension: pulled beyond the yield strength, stretched for good, thinner.
    assert formed.whole.stretch[within].min() > 1.001
    assert formed.whole.stretch[inside(formed, APERTURE)].min() > 1.005
    assert released(done).stability.negative == 0


def test_the_wire_through_the_middle_has_grown_to_the_length_of_the_punch() -> None:
    done = made()
    whole = done.formed.whole
    on_it = (whole.family == 1) & (whole.index[whole.start, 1] == 0) & (np.abs(whole.flat[whole.start, 0]) < RIM)
    chords = np.linalg.norm(whole.positions[whole.end] - whole.positions[whole.start], axis=1)[on_it]
    x = np.linspace(0, RIM, 10_001)
    z = prepare(done.case).punch.height(np.column_stack((x, np.zeros_like(x))))
    arc = 2 * np.hypot(np.diff(x), np.diff(z)).sum()
    # Chords of 12.5 mm across the fillet of 20 mm are shorter than it.
    assert chords.sum() == pytest.approx(arc, rel=4e-3)
    assert 1.02 < chords.sum() / (2 * RIM) < 1.0402


def test_yielded_wires_lose_what_their_pull_has_stretched_them() -> None:
    """Membrane recovery: the dish loses the elastic strain of its wires, and hardly anything by bending."""
    done = made()
    formed, free = done.formed.whole, released(made(hold='"nothing"')).whole
    within = inside(done.formed, APERTURE)
    lengths = [np.linalg.norm(w.positions[w.end] - w.positions[w.start], axis=1)[within] for w in (formed, free)]
    section = prepare(done.case).elements[0].section
    assert section is not None
    elastic = (formed.F[:, 0] / section.EA * formed.stretch)[within].mean()
    assert 1 - (lengths[1] / lengths[0]).mean() == pytest.approx(elastic, rel=0.2)


def test_it_comes_nearer_to_the_punch_than_elastic_wires_drawn_in() -> None:
    clamped, drawn = made(), made(press='rim = "draw"', wire=ELASTIC)
    assert rms(clamped) < rms(drawn) / 3
    assert released(clamped).max_sag > released(drawn).max_sag / 5
    assert rms(made(press=CLAMP, wire=ELASTIC)) > 10.0


def test_only_what_was_stretched_keeps_its_shape_out_of_the_tool() -> None:
    out = '"nothing"'
    stretched, drawn = made(hold=out), made(press=DRAW, hold=out)
    elastic = made(press='rim = "draw"', wire=ELASTIC, hold=out)
    assert laid_back(stretched) < 0.75
    assert laid_back(drawn) > 4 * laid_back(stretched)
    assert laid_back(elastic) > 6 * laid_back(stretched)
    assert focal_length(stretched) == pytest.approx(FOCUS, rel=0.2)
    assert focal_length(drawn) > 3 * FOCUS
    assert not any("spring back to the flat grid" in note for note in released(stretched).notes)
    assert np.abs(released(elastic).whole.positions[:, 2]).max() < 1e-9


def test_a_quarter_is_the_whole_grid() -> None:
    quarter, whole = made(), made(grid='symmetry = "full"')
    for one, other in ((quarter.formed, whole.formed), (released(quarter), released(whole))):
        assert one.grid.quarter
        assert not other.grid.quarter
        assert one.energy == pytest.approx(other.energy, rel=1e-7)
        assert_equal_grids(one.whole, other.whole, 1e-6)
        size = other.whole.plastic_strain.max()
        assert np.sort(one.whole.plastic_strain) == pytest.approx(np.sort(other.whole.plastic_strain), abs=1e-6 * size)


def test_the_answer_hardly_depends_on_the_number_of_strokes_and_converges() -> None:
    found = [made(press=f'rim = "clamp"\nstrokes = {count}') for count in (4, 8, 16)]
    deviations, sags = [rms(done) for done in found], [released(done).max_sag for done in found]
    assert deviations[0] == pytest.approx(deviations[2], rel=0.03)
    assert sags[0] == pytest.approx(sags[2], rel=0.03)
    # Between order 1, of levers, and order 2, of what Eq. (12.18) foresees.
    assert abs(deviations[0] - deviations[1]) > 1.5 * abs(deviations[1] - deviations[2])


# --- what does not yield is elastic ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("press", "section"),
    [
        pytest.param(CLAMP, "resultants", id="clamp"),
        pytest.param(CLAMP, "fibres", id="clamp, fibres"),
        pytest.param(DRAW, "resultants", id="draw"),
        pytest.param('rim = "draw"\nstrokes = 1', "resultants", id="draw, one stroke"),
        pytest.param(HOLDER, "resultants", id="holder"),
    ],
)
def test_a_wire_that_never_yields_is_the_elastic_one(press: str, section: str) -> None:
    elastic, strong = made(press, ELASTIC), made(press, f'{UNREACHED}\nsection = "{section}"')
    # Bit by bit in the tool; the way to the released shape differs.
    assert_equal_grids(strong.formed.whole, elastic.formed.whole, 0.0)
    assert strong.formed.energy == elastic.formed.energy
    assert not strong.formed.whole.plastic_strain.any()
    one, other = released(strong), released(elastic)
    np.testing.assert_allclose(one.whole.positions, other.whole.positions, rtol=0, atol=1e-9 * RIM)
    assert one.energy == pytest.approx(other.energy, rel=1e-9, abs=1e-9 * elastic.formed.energy)


def test_so_it_is_with_the_check_case() -> None:
    base = read_case("packaged:check")
    press = base.press.model_copy(update={"frame": "chord"})
    text = {"hardening": {"kind": "linear", "modulus": 2500.0}, "yield_strength": 20_000.0}
    wires = base.wire, type(base.wire).model_validate(base.wire.model_dump(exclude_unset=True) | text)
    elastic, strong = (run(base.model_copy(update={"press": press, "wire": wire})) for wire in wires)
    assert strong.formed.energy == pytest.approx(6614.378, abs=1e-3)
    assert_equal_grids(strong.formed.whole, elastic.formed.whole, 1e-9)
    one, other = released(strong), released(elastic)
    assert one.energy == pytest.approx(other.energy, rel=1e-9)
    assert one.apex == pytest.approx(1.1041, abs=1e-4)
    assert one.max_sag == pytest.approx(-19.0594, abs=1e-4)
    np.testing.assert_allclose(one.whole.positions, other.whole.positions, rtol=0, atol=1e-9 * 345.0)


# --- stages ---------------------------------------------------------------------------------------------------


def test_struck_again_it_moves_less() -> None:
    done = run(dish(stages='stages = ["press", "release", "press", "release"]'))
    pressed, first, struck, second = (stage.done for stage in done.stages)
    assert isinstance(first, Released)
    assert isinstance(second, Released)
    assert struck.energy < pressed.energy
    assert abs(second.apex) < abs(first.apex)
    assert abs(second.max_sag) < abs(first.max_sag)
    assert (struck.whole.plastic_strain >= pressed.whole.plastic_strain).all()


def test_a_trimmed_dish_keeps_its_history() -> None:
    stages = 'stages = ["press", "release", { trim = { radius = "85 mm" } }, { release = { hold = "rim" } }]'
    done = run(dish(stages=stages))
    _, before, cut, after = (stage.done for stage in done.stages)
    assert len(after.whole.index) < len(before.whole.index)
    there = {tuple(node): number for number, node in enumerate(before.whole.index.tolist())}
    same = [there[tuple(node)] for node in after.whole.index.tolist()]
    # Nothing but the flange pulled at the dish: without it the dish rests where it was.
    assert np.abs(after.whole.positions - before.whole.positions[same]).max() < 0.1
    assert cut.whole.stretch.min() > 1.0
    np.testing.assert_array_equal(np.sort(after.whole.stretch), np.sort(cut.whole.stretch))


def test_a_load_beyond_yield_leaves_a_permanent_set_and_one_below_does_not() -> None:
    stages = 'stages = ["press", "release", "load", "release", "load", "release"]'

    def sets(pressure: str) -> tuple[float, float]:
        done = run(dish(stages=stages, load=f'[load]\npressure = "{pressure}"'))
        one, two, three = (stage.done for stage in done.stages if isinstance(stage.done, Released))
        return float(moves(two, one).max()), float(moves(three, two).max())

    light, heavy = sets("-100 Pa"), sets("-5 kPa")
    assert light[0] < 1e-3
    assert heavy[0] > 30 * light[0]
    # The second time the same load finds wires that have hardened for it.
    assert heavy[1] < heavy[0] / 100


def test_what_a_run_says_of_its_wires() -> None:
    done = made()
    ready = prepare(done.case)
    press = done.case.framed(done.case.press)

    def told(**changed: Any) -> str:
        whole = replace(done.formed.whole, **changed)
        return " ".join(remarks(done.formed.grid, ready.elements, whole, done.formed.surface, press))

    assert "neck" not in told()
    assert "no wire bears" not in told()
    strain = done.formed.whole.plastic_strain
    assert "plastic strain of 2, which no wire bears" in told(plastic_strain=np.full_like(strain, 2.0))
    longer = np.full_like(strain, np.expm1(0.9 * 0.435))
    assert "little is left for scatter" in told(axial_strain=longer)
    assert f"{len(strain)} wire pieces are stretched to a true strain of up to 0.5" in told(
        axial_strain=np.full_like(strain, np.expm1(0.5))
    )
    loose = made(hold='"nothing"').released
    assert loose is not None
    assert any("its shape is what a best fit says" in note for note in loose.notes)
