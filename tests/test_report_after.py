"""The report after the press: words for every branch, tables that hold what they say, figures of small grids."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from fake_run import fake_run, let_go
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from punchform.antenna import SPEED_OF_LIGHT, highest_frequency, leak, leaks_above, loss
from punchform.arrays import Floats
from punchform.case import ReleaseCase
from punchform.progress import Progress
from punchform.report.accuracy_words import accuracy_lead, advice, judgement, makeup
from punchform.report.after import after_sections
from punchform.report.figures.deviation import draw_lobes, draw_spread, parts_of
from punchform.report.figures.gallery import gallery
from punchform.report.gain import gain_matrix
from punchform.report.page import draw_figures, is_good, spoken, write_report
from punchform.report.release_words import hold_words, load_words, release_words
from punchform.report.section import Matrix
from punchform.report.viewer import Packed
from punchform.wire.materials import materials

if TYPE_CHECKING:
    from punchform.run import Run

DISH = {"kind": "paraboloid", "focal_length": 250.0}
TARGET: dict[str, object] = {"profile": DISH, "aperture_radius": 200.0, "tolerance": 1.0}
FLANGE: dict[str, object] = {"hold": {"from_radius": 300.0}}


def even(rho: Floats, angle: Floats) -> Floats:
    return np.full_like(rho, -4.0)


def four(rho: Floats, angle: Floats) -> Floats:
    return np.asarray(-6 * (rho / 200) ** 4 * np.cos(4 * angle))


def tilted(rho: Floats, angle: Floats) -> Floats:
    return np.asarray(4 * rho / 200 * np.cos(angle))


def still(rho: Floats, angle: Floats) -> Floats:
    return np.zeros_like(rho)


def gone(
    shift: Callable[[Floats, Floats], Floats],
    *,
    release: dict[str, object] | None = FLANGE,
    target: dict[str, object] | None = TARGET,
    load: dict[str, object] | None = None,
    step: float = 15.0,
    negative: int | None = 0,
    mode: bool = False,
) -> Run:
    run = fake_run(step=step)
    return let_go(run, shift, release=release, target=target, load=load, negative=negative, mode=mode)


def said(run: Run) -> str:
    return " ".join(accuracy_lead(run))


def hints(run: Run) -> str:
    return " ".join(advice(run))


# --- words ---------------------------------------------------------------------------------------------------


def test_out_of_tolerance_says_by_how_much() -> None:
    run = gone(even)
    assert run.accuracy is not None
    times = run.accuracy.judged.rms
    found = re.search(r"Out of tolerance: the released grid lies ([\d.]+)\u00a0mm rms .*, ([\d.]+) times", said(run))
    assert found is not None
    assert float(found[1]) == pytest.approx(times, rel=1e-2)
    assert float(found[2]) == pytest.approx(times, rel=1e-2)
    assert "out of the tolerance of 1.00\u00a0mm" in judgement(run.accuracy)


def test_within_tolerance_says_how_much_of_it_is_used_and_gives_no_advice() -> None:
    run = gone(even, target=TARGET | {"tolerance": 40.0})
    assert said(run).startswith("Within tolerance")
    assert "% of the 40.0" in said(run)
    assert advice(run) == ()
    assert is_good(run)


def test_a_shape_within_tolerance_that_would_not_stay_is_not_good() -> None:
    run = gone(even, target=TARGET | {"tolerance": 40.0}, negative=2)
    assert "would not stay in this shape" in said(run)
    assert not is_good(run)
    assert "2 ways of leaving" in " ".join(release_words(run))


@pytest.mark.parametrize(
    ("shift", "part", "words"),
    [
        (even, "mean", "too low on the average"),
        (four, "4", "four lobes (m = 4)"),
        (tilted, "1", "a tilt or a sideways shift"),
    ],
)
def test_what_the_error_is_made_of(shift: Callable[[Floats, Floats], Floats], part: str, words: str) -> None:
    run = gone(shift, step=10.0)
    assert run.accuracy is not None
    largest, share = makeup(run.accuracy.as_held)[0]
    assert largest == part
    assert share > 0.9
    assert sum(share for _, share in makeup(run.accuracy.as_held)) == pytest.approx(1.0, abs=1e-9)
    assert words in said(run)


def test_the_tool_is_blamed_for_what_is_wrong_in_it() -> None:
    assert "the error comes with the release" in said(gone(even))
    other = TARGET | {"profile": DISH | {"focal_length": 220.0}}
    assert "the error is in the punch already" in said(gone(still, target=other))


def test_without_a_release_the_formed_grid_is_judged() -> None:
    run = gone(even, release=None)
    assert "the formed grid lies" in said(run)
    assert "In the tool the same" not in said(run)
    assert "change the punch" in hints(run)
    assert release_words(run) == ()


def test_without_a_target_nothing_is_judged() -> None:
    run = gone(even, target=None)
    assert accuracy_lead(run) == advice(run) == ()
    assert [section.name for section in after_sections(run)] == ["released"]
    assert is_good(run)


@pytest.mark.parametrize(
    ("hold", "words"),
    [
        ({"from_radius": 300.0}, "Hold it further in: what lies between the aperture and 300 mm"),
        ({"from_radius": 180.0}, None),
        ("nothing", "elastic wires that nothing holds"),
        ("rim", "Hold directions too"),
        ({"ring": 300.0}, "Hold directions too"),
    ],
)
def test_advice_goes_by_the_hold(hold: object, words: str | None) -> None:
    found = hints(gone(even, release={"hold": hold}))
    assert (words in found) if words else ("Hold" not in found)


def test_advice_goes_by_the_error() -> None:
    assert "another profile of the punch" in hints(gone(even))
    assert "ribs" not in hints(gone(even))
    lobed = hints(gone(four, step=10.0))
    assert "ribs (`release.ribs`), a hoop or spokes, would" in lobed
    assert "another profile" not in lobed
    assert "more ribs" in hints(gone(four, step=10.0, release=FLANGE | {"ribs": [{"radius": 100.0}]}))


def carrying(run: Run, most: float, strength: float = math.nan) -> Run:
    """The run with its stress scaled to a largest of `most` [MPa], and a yield strength."""
    whole = run.formed.whole
    stress = whole.stress * most / whole.stress.max()
    loaded = replace(whole, stress=stress, stress_ratio=stress / strength)
    return replace(run, formed=replace(run.formed, whole=loaded))


def test_a_stress_that_no_wire_bears_asks_first_for_a_wire_that_yields() -> None:
    strongest = max(one.tensile_strength for one in materials())
    first, *others = advice(carrying(gone(even), 1.01 * strongest))
    assert "no wire bears 2\u202f222\u00a0MPa (the strongest in `punchform materials`, patented spring" in first
    assert 'clamp the rim (`press.rim = "clamp"`)' in first
    assert "Take a wire" not in hints(carrying(gone(even), 0.99 * strongest))
    assert tuple(others) == advice(carrying(gone(even), 0.99 * strongest))
    beyond_yield = advice(carrying(gone(even), 900.0, 300.0))[0]
    assert "900.0\u00a0MPa are 3.00 times the yield strength" in beyond_yield
    assert "Take a wire" not in hints(carrying(gone(even), 290.0, 300.0))


def test_a_wire_that_yields_is_not_advised_where_it_would_not_help() -> None:
    other = TARGET | {"profile": DISH | {"focal_length": 220.0}}
    assert "Take a wire" not in hints(carrying(gone(still, target=other), 5000.0))
    assert "Take a wire" not in hints(carrying(gone(even, release=None), 5000.0))
    run = carrying(gone(even), 5000.0)
    clamped = run.case.model_copy(update={"press": run.case.press.model_copy(update={"rim": "clamp"})})
    assert "Take a wire" in hints(replace(run, case=clamped))
    assert "press.rim" not in hints(replace(run, case=clamped))


def test_what_answers_most_of_the_error_comes_first() -> None:
    offset = hints(gone(even))
    assert offset.index("punchform compensate") < offset.index("Hold it further in")
    lobed = hints(gone(four, step=10.0))
    assert lobed.index("Hold it further in") < lobed.index("ribs (")


def test_a_best_fit_is_offered_where_it_helps_and_not_when_it_is_judged() -> None:
    assert "judge the best fit" in hints(gone(even))
    assert "judge the best fit" not in hints(gone(four, step=10.0))
    assert "judge the best fit" not in hints(gone(four, step=10.0, target=TARGET | {"alignment": "best fit"}))


def test_a_dish_that_is_gone_is_not_refocused() -> None:
    found = hints(gone(lambda rho, angle: (rho / 200) ** 2 * 40 - 40))
    assert "best fit" not in found
    assert "profile" not in found


@pytest.mark.parametrize(
    ("release", "words"),
    [
        ({"hold": {"from_radius": 300.0}}, "what was formed at or beyond 300 mm stays as the press left it"),
        ({"hold": {"ring": 250.0}}, "the crossings on a ring of 250 mm keep their height"),
        ({"hold": {"points": 3, "radius": 280.0}}, "3 supports 280 mm from the axis keep their places"),
        ({"hold": {"nodes": [[0, 3], [3, 0]]}}, "2 chosen crossings keep their places"),
        ({"hold": "rim"}, "the wire ends keep their places"),
        ({}, "nothing holds it"),
        (
            {"hold": "rim", "ribs": [{"spokes": 8}, {"radius": 100.0}]},
            "the wire ends keep their places, with 8 spokes and a hoop of 100 mm under it",
        ),
    ],
)
def test_every_hold_has_its_words(release: dict[str, object], words: str) -> None:
    assert hold_words(ReleaseCase.model_validate(release)) == words


def test_the_release_tells_moves_energy_and_whether_it_stays() -> None:
    words = " ".join(release_words(gone(even)))
    assert "(40.0\u00a0%) of its energy" in words
    assert "its middle sinks by 4.00\u00a0mm" in words
    assert "it stays there" in words
    assert "was not counted" in " ".join(release_words(gone(even, negative=None)))
    flat = gone(still)
    assert flat.released is not None
    empty = replace(flat, released=replace(flat.released, energy=0.0))
    assert "keeps nothing of its energy; its middle stays, and no crossing sinks" in " ".join(release_words(empty))


def test_the_load_is_told_against_the_tolerance() -> None:
    run = gone(even, load={"pressure": 1e-5, "wind": {"dynamic_pressure": 1e-4}})
    words = " ".join(load_words(run))
    assert words.startswith("Pressure and wind, 3.35\u00a0N in all, moves")
    assert "13.0\u00a0% of the tolerance" in words
    assert load_words(gone(even)) == ()


# --- tables --------------------------------------------------------------------------------------------------


def matrices(run: Run) -> dict[str, Matrix]:
    return {one.caption.split(" (")[0].split(" [")[0]: one for one in after_sections(run)[0].matrices}


def test_the_table_of_deviations_marks_the_row_that_is_judged() -> None:
    run = gone(even, target=TARGET | {"measure": "half-path", "alignment": "best fit"})
    assert run.accuracy is not None
    table = matrices(run)["Deviation of the nodes"]
    assert len(table.rows) == 9
    (row,) = (table.rows[k] for k in table.marked)
    assert row[1] == "half-path"
    assert table.rows[table.marked[0] - 2][0] == "4-parameter"
    assert float(row[2]) == pytest.approx(run.accuracy.judged.rms, abs=1e-3)


def test_the_table_of_parts_adds_up() -> None:
    run = gone(four, step=10.0)
    assert run.accuracy is not None
    table = matrices(run)["What the normal deviation is made of, as held"]
    share = [float(row[2].rstrip("%\u00a0")) for row in table.rows]
    assert sum(share) == pytest.approx(100.0, abs=0.2)
    sizes = np.array([float(row[1]) for row in table.rows])
    assert math.hypot(*sizes) == pytest.approx(run.accuracy.judged.rms, rel=2e-3)


def test_ruze_is_told_of_paraboloids_by_the_half_path_sigma() -> None:
    run = gone(four, step=10.0)
    assert run.accuracy is not None
    table = next(one for one in after_sections(run)[0].matrices if one.caption.startswith("Loss of gain"))
    sigma = run.accuracy.as_held.statistics["half-path"].sigma
    row = next(row for row in table.rows if row[0].startswith("1.5 GHz"))
    assert float(row[1].split()[0]) == pytest.approx(loss(sigma, SPEED_OF_LIGHT / 1.5), rel=1e-2)
    assert any("more than 3 dB" in row[1] for row in table.rows)
    assert "as held" in table.note


def test_frequencies_at_which_the_mesh_leaks_are_marked() -> None:
    run = gone(four, step=10.0)
    assert run.accuracy is not None
    table = gain_matrix(run.case, run.accuracy)
    assert "above about 3.0\u00a0GHz" in table.note
    leaky = [row[0] for row in table.rows if "mesh leaks" in row[0]]
    assert leaky == [
        f"{f} GHz ({band}), mesh leaks" for f, band in ((4, "C"), (8, "X"), (12, "Ku"), (20, "K"), (30, "Ka"))
    ]
    through = [row[-1] for row in table.rows if "(L)" in row[0] or "(Ka)" in row[0]]
    assert float(through[0].split()[0]) == pytest.approx(
        leak(10.0, run.case.wire.diameter, SPEED_OF_LIGHT / 1.5), rel=1e-2
    )
    assert through[1] == "–"
    lost = next(row for row in table.rows if row[0].startswith("0.5 dB"))
    assert [cell.endswith("(mesh leaks)") for cell in lost[1:-1]] == [
        highest_frequency(aligned.statistics["half-path"].sigma, 0.5) > leaks_above(10.0)
        for aligned in (run.accuracy.as_held, run.accuracy.fitted)
    ]


def test_other_targets_have_no_focus_and_no_ruze() -> None:
    sphere = TARGET | {"profile": {"kind": "sphere", "radius": 500.0}}
    run = gone(even, target=sphere)
    captions = " ".join(one.caption for one in after_sections(run)[0].matrices)
    assert "Ruze" not in captions
    moved = next(one for one in after_sections(run)[0].matrices if "moved" in one.caption)
    assert moved.head == ("", "3-parameter")
    assert not any("focus" in row[0] or "focal" in row[0] for row in moved.rows)


def test_the_sections_are_those_of_the_run() -> None:
    load: dict[str, object] = {"pressure": 1e-5}
    assert [one.name for one in after_sections(gone(even, load=load))] == ["accuracy", "released", "loaded"]
    assert after_sections(fake_run()) == ()
    rows = dict(after_sections(gone(even, load=load))[2].tables[0][1])
    assert rows["Mass of the wire"] == "not known without `wire.density`"
    assert rows["Rigidity, its inverse"] == "25.00\u00a0N/mm"


# --- page and figures ----------------------------------------------------------------------------------------


def test_the_page_leads_with_the_verdict_and_escapes_what_it_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A made-up run has no stages to view.
    monkeypatch.setattr("punchform.report.page.scene_of", lambda run: run)
    monkeypatch.setattr("punchform.report.page.pack", lambda scene: Packed("scene", "", "{}"))
    run = gone(even, load={"pressure": 1e-5}, mode=True, negative=1)
    assert run.released is not None
    run = replace(run, released=replace(run.released, notes=("<script>alert(1)</script> `a < b`",)))
    write_report(run, tmp_path)
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "<code>a &lt; b</code>" in text
    assert text.index("<strong>Out of tolerance") < text.index("It would not stay there") < text.index('id="accuracy"')
    order = [text.index(f'id="{name}"') for name in ("accuracy", "deviation", "released", "sag", "mode", "loaded")]
    assert order == sorted(order)
    assert text.index('id="deflection"') < text.index('id="numbers"') < text.index('id="shape"')
    assert 'class="verdict open"' in text
    assert text.count('class="marked"') == 1


def test_the_figures_are_counted_while_they_are_drawn(tmp_path: Path) -> None:
    told: list[Progress] = []
    images = draw_figures(gone(even, step=90.0), tmp_path, observe=told.append)
    assert [event.done for event in told] == list(range(len(images) + 1))
    assert {(event.stage, event.total, event.message) for event in told} == {("figures", len(images), "")}


def test_settings_are_set_as_code_and_all_else_is_escaped() -> None:
    assert spoken("`a.b` <i> & `c`") == "<code>a.b</code> &lt;i&gt; &amp; <code>c</code>"


@pytest.mark.parametrize("step", [20.0, 55.0, 90.0])
@pytest.mark.parametrize("release", [FLANGE, None])
def test_every_figure_of_a_small_grid_is_drawn(step: float, release: dict[str, object] | None) -> None:
    load: dict[str, object] | None = {"pressure": 1e-5} if release else None
    run = gone(four, step=step, release=release, load=load, mode=True, negative=1)
    names = [picture.name for picture in gallery(run)]
    assert len(set(names)) == len(names)
    assert ("mode" in names) == ("sag" in names) == (release is not None)
    for picture in gallery(run):
        figure = picture.draw(run)
        assert isinstance(figure, Figure)
        figure.canvas.draw()
        labels = " ".join(axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes)
        assert re.search(r"\[(mm|N|°|mJ|MPa)", labels), picture.name
        if picture.name in ("deviation", "deviation_other", "sag", "mode", "deflection", "stress_released"):
            assert figure.axes[0].get_aspect() == 1.0


def bars(figure: Figure) -> list[float]:
    return [bar.get_height() for bar in figure.axes[0].patches if isinstance(bar, Rectangle)]


def test_the_bars_of_the_lobes_add_up_to_the_rms() -> None:
    run = gone(four, step=10.0)
    assert run.accuracy is not None
    _, sizes = parts_of(run.accuracy.as_held)
    assert math.hypot(*sizes) == pytest.approx(run.accuracy.judged.rms, rel=1e-4)
    heights = bars(draw_lobes(run.accuracy))
    np.testing.assert_allclose(heights[: len(sizes)], sizes)


def test_the_histogram_holds_all_of_the_area() -> None:
    run = gone(four, step=10.0)
    assert run.accuracy is not None
    assert sum(bars(draw_spread(run.accuracy, run.accuracy.as_held))) == pytest.approx(100.0)


def test_a_perfect_shape_still_draws_and_has_no_parts() -> None:
    """Harmonics of nothing: no share of a variance that is zero."""
    run = gone(still, step=40.0)
    assert run.accuracy is not None
    held = run.accuracy.as_held
    assert held.harmonics is None or makeup(held)
    none = replace(held, harmonics=None)
    assert makeup(none) == ()
    with pytest.raises(ValueError, match="no harmonics"):
        parts_of(none)
    assert draw_lobes(run.accuracy).axes
