"""Wires that yield are told of as such: their section, figures and words, and where their springback comes from."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_run import fake_run
from stretched import KEPT, dish

from punchform import Run
from punchform.cli.form import summary
from punchform.report.accuracy_words import advice
from punchform.report.after import after_sections
from punchform.report.figures.gallery import gallery
from punchform.report.figures.plastic import draw_along_middle, middle_wire
from punchform.report.page import page, write_report
from punchform.report.words import percent, size, verdict
from punchform.report.yielding import springback_tables, yielding_sections

ELASTIC_WORDS = (
    "would yield",
    "this elastic answer",
    "elastic wires",
    "those of these elastic ones",
    "strain of the wire by its pull",
    "largest strain by the pull",
)


def hardened(run: Run, **how: object) -> Run:
    """The run with another flow curve."""
    assert run.formed.hardening is not None
    return replace(run, formed=replace(run.formed, hardening=replace(run.formed.hardening, **how)))  # type: ignore[arg-type]


@pytest.mark.parametrize("hold", [KEPT, '"rim"', '"nothing"'])
def test_no_elastic_sentence_on_the_page(hold: str) -> None:
    text = page(dish(hold), ())
    captions = " ".join(picture.caption for picture in gallery(dish(hold)))
    for words in ELASTIC_WORDS:
        assert words not in text
        assert words not in captions
    assert "How the wires yield" in text
    assert "Largest elongation of the wire" in text


def test_elastic_wires_have_no_section_and_no_figures_of_it() -> None:
    run = fake_run(yield_strength=250.0)
    assert yielding_sections(run) == ()
    assert not {"elongation", "plastic_strain", "elongation_middle"} & {picture.name for picture in gallery(run)}
    stress = next(picture for picture in gallery(run) if picture.name == "stress")
    assert "elastic answer" in stress.caption


def test_the_section_says_what_the_wires_have_gone_through() -> None:
    run = dish()
    assert run.released is not None
    (section,) = yielding_sections(run)
    (table,) = section.matrices
    assert table.head == ("", "in the tool", "released")
    rows = {name: values for name, *values in table.rows}
    stages = (run.formed, run.released)
    assert rows["Largest plastic strain in a section"] == [percent(stage.max_plastic_strain) for stage in stages]
    assert rows["Largest elongation of a wire piece"] == [percent(stage.max_axial_strain) for stage in stages]
    assert rows["Wire pieces that have yielded"] == [percent(stage.yielded) for stage in stages]
    thinnest = 0.75 / np.sqrt(run.formed.whole.stretch.max())
    assert rows["Diameter of the wire where it is thinnest"][0] == size(thinnest, "mm")
    assert run.formed.max_axial_strain > run.released.max_axial_strain


def test_the_place_of_the_largest_strain_is_named() -> None:
    run = dish()
    whole = run.formed.whole
    x, y, _ = whole.positions[[whole.start, whole.end]][:, whole.plastic_strain.argmax()].mean(axis=0)
    rows = dict(yielding_sections(run)[0].tables[0][1])
    found = [float(number) for number in re.findall(r"[\d.]+", rows["Largest plastic strain"].replace("−", "-"))]
    assert found == pytest.approx([abs(x), abs(y)], abs=0.5)


def test_the_verdict_says_how_near_to_breaking() -> None:
    run = dish()
    assert "of the true strain at which it necks and breaks" in verdict(run)[4]
    assert "longer than in the flat blank" in verdict(run)[3]
    assert "the wire breaks" in verdict(hardened(run, breaks_at=0.01))[4]
    assert "its flow curve does not say" in verdict(hardened(run, breaks_at=None))[4]
    soft = replace(run.formed.whole, plastic_strain=np.zeros(len(run.formed.whole.family)))
    assert "No wire yields" in verdict(replace(run, formed=replace(run.formed, whole=soft)))[4]


def test_a_curve_that_does_not_say_where_the_wire_breaks_has_no_share() -> None:
    (section,) = yielding_sections(hardened(dish(), breaks_at=None))
    rows = dict(section.tables[1][1])
    assert rows["True strain at which the wire necks"] == "its flow curve does not say"
    assert "Share of it that is used up" not in rows


# --- springback ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("hold", "parts"), [(KEPT, 4), ('"rim"', 5)])
def test_the_springback_is_told_in_its_parts(hold: str, parts: int) -> None:
    run = dish(hold)
    assert run.released is not None
    (table,) = springback_tables(run.released)
    assert len(table.rows) == parts
    assert ("rim let go" in {row[0] for row in table.rows}) == (parts == 5)
    assert table.marked == (parts - 1,)
    assert table.rows[-1][0] == "all together"
    middles = [float(row[2].removesuffix("\u00a0mm").replace("−", "-")) for row in table.rows]
    assert sum(middles[:-1]) == pytest.approx(middles[-1], abs=0.01)
    shown = {section.name: section.matrices for section in after_sections(run)}
    assert shown["released"] == (table,)


def test_elastic_wires_are_not_told_to_stretch_further() -> None:
    run = dish()
    assert run.released is not None
    (told,) = springback_tables(run.released)
    (elastic,) = springback_tables(replace(run.released, hardening=None))
    assert told.note.startswith(elastic.note)
    assert "stretched" in told.note
    assert "stretched" not in elastic.note


def test_a_release_that_was_not_split_has_no_table() -> None:
    run = dish()
    assert run.released is not None
    assert springback_tables(replace(run.released, split=None)) == ()


def test_the_advice_to_hold_a_grid_does_not_take_it_for_elastic() -> None:
    text = " ".join(advice(dish('"nothing"\n[target]\nprofile = { kind = "paraboloid", focal_length = "60 mm" }\n'
                                'aperture_radius = "45 mm"\ntolerance = "0.01 mm"')))  # fmt: skip
    assert "Hold it: nothing says where" in text


def test_the_summary_of_the_command_tells_of_elongation_and_springback() -> None:
    run = dish('"rim"')
    lines = {line.split("  ")[1].strip(): line for line in summary(run, Path("out")).splitlines()[1:]}
    assert f"{100 * run.formed.max_axial_strain:.3g} %" in lines["elongation"]
    assert f"{100 * run.formed.max_plastic_strain:.3g} %" in lines["plastic strain"]
    assert "by the rim" in lines["springback"]
    assert run.released is not None
    assert run.released.split is not None
    assert lines["springback"].endswith(f"not told apart {run.released.split.remainder.rms:.3g}")
    assert "largest strain" not in lines
    assert "by the rim" not in summary(dish(), Path("out"))


# --- figures ------------------------------------------------------------------------------------------------


def test_every_figure_of_wires_that_yield_is_drawn_with_units(tmp_path: Path) -> None:
    run = dish()
    write_report(run, tmp_path)
    drawn = {path.stem for path in (tmp_path / "figures").iterdir()}
    assert {"elongation", "plastic_strain", "elongation_middle"} <= drawn
    for picture in gallery(run):
        if picture.section == "yielding":
            labels = " ".join(axes.get_xlabel() + axes.get_ylabel() for axes in picture.draw(run).axes)
            assert "[%]" in labels
            assert "[mm]" in labels


@pytest.mark.parametrize("family", [1, 2])
@pytest.mark.parametrize("step", [30.0, 15.0])
def test_the_middle_wire_runs_from_end_to_end(family: int, step: float) -> None:
    whole = fake_run(step=step).formed.whole
    wire = middle_wire(whole, family)
    assert (whole.family[wire] == family).all()
    ends = np.sort(whole.flat[np.column_stack((whole.start, whole.end))[wire], family - 1], axis=1)
    np.testing.assert_allclose(ends[1:, 0], ends[:-1, 1])
    np.testing.assert_array_equal(whole.flat[whole.start[wire], 2 - family], 0.0)
    assert (ends[0, 0], ends[-1, 1]) == (-(345 // step) * step, 345 // step * step)


def test_beside_the_axis_one_wire_is_shown() -> None:
    whole = fake_run().formed.whole
    beside = replace(whole, flat=whole.flat + np.array([15.0, 15.0, 0.0]))
    for family in (1, 2):
        wire = middle_wire(beside, family)
        assert set(beside.flat[beside.start[wire], 2 - family]) == {15.0}


def test_what_stays_of_the_elongation_is_what_the_wire_has_kept() -> None:
    run = dish()
    lines = {line.get_label(): np.asarray(line.get_ydata()) for line in draw_along_middle(run).axes[0].lines}
    longer, stays = lines["wire along x"], lines["what stays, along x"]
    assert (stays <= longer + 1e-9).all()
    wire = middle_wire(run.formed.whole, 1)
    assert stays.max() == pytest.approx(100 * (run.formed.whole.stretch[wire].max() - 1))
