"""The page says the right thing in plain words, opens offline, and trusts no text of the case."""

from __future__ import annotations

import math
import re
import struct
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from subprocess import run as subprocess_run
from typing import TYPE_CHECKING
from urllib.parse import unquote

import numpy as np
import pytest
import tiny_dish
from fake_run import FakeOutcome, check_case, fake_run
from matplotlib import colormaps
from matplotlib.figure import Figure

from punchform.arrays import Floats
from punchform.case import write_case
from punchform.report import page as page_module
from punchform.report.figures.conclusions import found
from punchform.report.figures.files import svg
from punchform.report.figures.gallery import GALLERY, gallery
from punchform.report.figures.sections import enlargement, near_section
from punchform.report.figures.shape import TOWARDS_EYE, seen, some_wires
from punchform.report.figures.shear import most_sheared
from punchform.report.figures.style import DIVERGING, RELIEF, SEQUENTIAL, about_zero, from_zero, in_colour, new_figure
from punchform.report.page import write_report
from punchform.report.words import energy, size, verdict
from punchform.run import run as form
from punchform.store import read_run, write_run

if TYPE_CHECKING:
    from punchform.run import Run


class Page(HTMLParser):
    """The tags, links and ids of a page, checking that tags close in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.sources: list[str] = []
        self.alternatives: list[str] = []
        self.captions: list[str] = []
        self.text = ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        if tag not in ("meta", "img", "br", "link", "input"):
            self.open.append(tag)
        self.ids += [value for name, value in attrs if name == "id" and value]
        self.sources += [value for name, value in found.items() if name in ("src", "href") and value]
        self.alternatives += [found["alt"] or ""] if "alt" in found else []
        self.captions += [""] if tag == "figcaption" else []

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data
        if "figcaption" in self.open:
            self.captions[-1] += data


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path]:
    changes = {"title": "<b>Dish</b> & {{ 7 * 7 }}", "release": None, "target": None}
    run = replace(form(tiny_dish.case().model_copy(update=changes)), notes=("clamped <script>alert(1)</script>",))
    folder = tmp_path_factory.mktemp("dish")
    write_report(run, folder)
    return run, folder


def test_every_figure_is_a_file_twice_and_embedded_in_the_page(written: tuple[Run, Path]) -> None:
    _, folder = written
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    names = sorted(f"{picture.name}.{kind}" for picture in GALLERY for kind in ("png", "svg"))
    assert sorted(path.name for path in (folder / "figures").iterdir()) == names
    shown = [source for source in page.sources if source.startswith("data:")]
    for picture, source in zip(GALLERY, shown, strict=True):
        embedded = unquote(source.removeprefix("data:image/svg+xml,"))
        assert embedded == (folder / "figures" / f"{picture.name}.svg").read_text(encoding="utf-8")
        width, height = struct.unpack(">II", (folder / "figures" / f"{picture.name}.png").read_bytes()[16:24])
        assert 400 < width < 2000
        assert 300 < height < 2000


def test_the_page_opens_offline(written: tuple[Run, Path]) -> None:
    text = unquote((written[1] / "report.html").read_text(encoding="utf-8"))
    assert all(source.startswith(("data:", "#")) for source in Page(text).sources)
    addresses = re.findall(r"https?://[^\s\"'<>]+", text)
    assert all(address.startswith("http://www.w3.org/") for address in addresses)
    assert not re.search(r"@import|<link|<script [^>]*src|url\((?!#)", text)


def test_every_figure_says_in_words_what_it_comes_to(written: tuple[Run, Path]) -> None:
    run, folder = written
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert len(page.captions) == len(page.alternatives) == len(GALLERY)
    for picture, words, caption in zip(GALLERY, page.alternatives, page.captions, strict=True):
        assert words == f"{picture.title}: {found(picture.name, run)}"
        assert caption == f"{found(picture.name, run)} {picture.caption}"
        assert re.search(r"\d", found(picture.name, run)), picture.name


def test_the_same_run_gives_the_same_bytes(written: tuple[Run, Path], tmp_path: Path) -> None:
    run, folder = written
    write_report(run, tmp_path)
    for path in sorted(folder.rglob("*.*")):
        assert (tmp_path / path.relative_to(folder)).read_bytes() == path.read_bytes(), path.name


def test_the_list_of_parts_leads_to_parts(written: tuple[Run, Path]) -> None:
    page = Page((written[1] / "report.html").read_text(encoding="utf-8"))
    anchors = [source[1:] for source in page.sources if source.startswith("#")]
    assert {"verdict", "notes", "numbers", "details", "case"} <= set(anchors) <= set(page.ids)
    assert len(anchors) == len(set(anchors))


def test_both_themes_set_the_same_colours_and_paper_is_light() -> None:
    style = (Path(page_module.__file__).parent / "templates" / "style.css.j2").read_text(encoding="utf-8")
    dark, light = (
        set(re.findall(r"(--\w+):", part)) for part in re.findall(r"color-scheme: (?:dark|light);(.*)", style)
    )
    assert dark == light >= set(re.findall(r"var\((--\w+)\)", style))
    # Every selector that makes the page dark is answered on paper by one as specific.
    selectors = re.search(r"@media print \{\s*(.*?) \{ \{\{ light\(\)", style)
    assert selectors is not None
    assert set(selectors[1].split(", ")) == {":root", ":root[data-theme]", ':root:not([data-theme="light"])'}


def test_a_hundred_thousand_nodes_make_no_larger_figures() -> None:
    """Dense parts are one picture: six times the nodes take hardly more bytes."""
    coarse, fine = fake_run(step=10.0), fake_run(step=4.0)
    for name in ("shear", "stress", "contact"):
        draw = next(picture.draw for picture in GALLERY if picture.name == name)
        small, large = len(svg(draw(coarse))), len(svg(draw(fine)))
        assert large < 2 * small, name
        assert large < 100_000, name


def test_the_letters_of_an_svg_are_those_of_the_figure() -> None:
    """Lengths are rounded, labels are not: a tick of 0.0001 stays one."""
    figure = new_figure(3.0, 3.0)
    axes = figure.add_axes((0.3, 0.3, 0.6, 0.6))
    axes.plot([0.12345, 1.0], [0.0, 1.0])
    axes.set_xticks([0.12345], ["0.12345"])
    drawn = svg(figure)
    assert "0.12345<" in drawn
    assert not re.search(r" d=\"[^\"]*\d\.\d{3}", drawn)
    assert "<metadata" not in drawn
    assert "DejaVu Sans, Verdana" in drawn


def test_text_of_the_case_is_escaped(written: tuple[Run, Path]) -> None:
    text = (written[1] / "report.html").read_text(encoding="utf-8")
    assert "<b>Dish" not in text
    page = Page(text)
    assert "<b>Dish</b> & {{ 7 * 7 }}" in page.text
    assert "clamped <script>alert(1)</script>" in page.text


def test_the_page_holds_its_parts(written: tuple[Run, Path]) -> None:
    run, folder = written
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    parts = {"verdict", "notes", "numbers", "details", "case"} | {picture.name for picture in GALLERY}
    assert parts <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))
    assert write_case(run.case).strip() in page.text
    assert all(sentence.replace("`", "") in page.text for sentence in verdict(run))


def test_the_verdict_tells_a_failed_solve_from_a_good_one() -> None:
    good, bad = fake_run(), fake_run(outcome=FakeOutcome.STEP_LIMIT)
    assert "converged to a minimum" in verdict(good)[0]
    assert FakeOutcome.STEP_LIMIT.value in verdict(bad)[0]
    assert "not as the answer" in verdict(bad)[0]


def test_the_verdict_on_yield() -> None:
    def said(run: Run) -> str:
        return verdict(run)[4]

    assert "not known without `wire.yield_strength`" in said(fake_run())
    assert "stay elastic" in said(fake_run(yield_strength=1e4))
    over = fake_run(yield_strength=5.0)
    count = int((over.formed.whole.stress > 5).sum())
    assert f"{count} of {len(over.formed.whole.stress)} wire segments would yield" in said(over)
    unknown = replace(over.formed.whole, stress=np.full(len(over.formed.whole.stress), np.nan))
    assert "given as a matrix" in said(replace(over, formed=replace(over.formed, whole=unknown)))


def test_the_verdict_on_contact_names_the_ring_that_must_be_held() -> None:
    run = fake_run(step=15)
    assert "would lift off" in verdict(run)[5]
    low, high = (float(text) for text in re.findall(r"(\d+)\u00a0mm", verdict(run)[5])[-2:])
    assert low < 0.85 * 345 < high
    pushed = replace(run.formed.whole, contact=np.abs(run.formed.whole.contact))
    assert "nothing has to hold the grid down" in verdict(replace(run, formed=replace(run.formed, whole=pushed)))[5]


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0, "N", "0\u00a0N"),
        (12.345678, "mm", "12.35\u00a0mm"),
        (-0.5, "N", "−0.5000\u00a0N"),
        (12345.6, "N", "12\u202f346\u00a0N"),
        (9.99996, "N", "10.00\u00a0N"),
        (1e-9, "", "1.000e−09"),
        (20.0, "°", "20.00°"),
        (math.nan, "N", "not known"),
    ],
)
def test_numbers_as_a_person_writes_them(value: float, unit: str, text: str) -> None:
    assert size(value, unit) == text


def test_energy_changes_to_joules_at_one_joule() -> None:
    assert energy(6600.058) == "6.6001\u00a0J"
    assert energy(999.0) == "999.00\u00a0mJ"


def test_a_run_without_steps_has_no_progress_figure() -> None:
    run = fake_run()
    short = replace(run, formed=replace(run.formed, history=run.formed.history[:1]))
    assert [picture.name for picture in gallery(short)] == [p.name for p in GALLERY if p.name != "progress"]


def test_every_figure_has_units_on_its_axes_and_the_plans_equal_scales() -> None:
    run = fake_run()
    for picture in gallery(run):
        figure = picture.draw(run)
        assert isinstance(figure, Figure)
        labels = " ".join(axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes)
        assert re.search(r"\[(mm|N|°|mJ)", labels), picture.name
        if picture.name in ("shear", "contact", "axial_x", "axial_y"):
            assert figure.axes[0].get_aspect() == 1.0


def test_unequal_histories_of_zero_energy_still_draw() -> None:
    """A descent that stops at once, or an energy that is zero, must not end the report with an error."""
    run = fake_run()
    flat = tuple(replace(step, energy=0.0, gradient=0.0) for step in run.formed.history)
    still = replace(run, formed=replace(run.formed, history=flat, energy=0.0))
    picture = next(picture for picture in gallery(still) if picture.name == "progress")
    picture.draw(still).canvas.draw()


def test_the_shape_is_seen_in_a_true_parallel_projection() -> None:
    points = np.random.default_rng(2).normal(size=(20, 3))
    plane = seen(points)
    depth = points @ TOWARDS_EYE
    np.testing.assert_allclose((plane**2).sum(axis=1) + depth**2, (points**2).sum(axis=1), rtol=1e-12)
    assert seen(np.array([[0.0, 0.0, 1.0]]))[0, 1] > 0


@pytest.mark.parametrize("step", [30.0, 5.0])
def test_wires_are_thinned_evenly(step: float) -> None:
    whole = fake_run(step=step).formed.whole
    wires = some_wires(whole)
    rows = np.unique(whole.index[wires[whole.index[wires[:, 0], 1] == whole.index[wires[:, 1], 1], 0], 1])
    assert len(set(np.diff(rows))) == 1
    assert len(rows) <= 61


def test_colours_are_the_same_in_any_order() -> None:
    """Pieces are grouped by shade: each keeps its own colour, none is lost."""
    values = np.array([0.0, 1.0, 0.5, 1.0, 0.0])
    cells = np.arange(5)[:, None, None] + np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    drawn = in_colour(cells, values, from_zero(values), "viridis", width=0.0)
    assert len(drawn.get_paths()) == 3
    corners = np.concatenate([path.vertices for path in drawn.get_paths()])
    assert sorted(set(corners[:, 0])) == list(range(6))
    lightness = np.asarray(drawn.get_facecolor()).sum(axis=1)
    assert lightness[0] < lightness[1] < lightness[2]


def test_scales_about_zero_are_symmetric_and_go_with_the_root() -> None:
    scale = about_zero(np.array([-16.0, 4.0]))
    np.testing.assert_allclose(scale(np.array([-16.0, -4.0, 0.0, 1.0, 16.0])), [0, 0.25, 0.5, 0.625, 1])
    assert about_zero(np.zeros(3)).vmax == 1.0
    assert from_zero(np.zeros(3)).vmax == 1.0


def test_of_mirror_images_the_cell_in_the_first_quadrant_is_named() -> None:
    whole = fake_run(step=15).formed.whole
    spot = whole.positions[whole.cells[most_sheared(whole)]].mean(axis=0)
    assert spot[0] > 0
    assert spot[1] > 0


def test_a_section_takes_the_nodes_nearest_to_it() -> None:
    step = 10.0
    i, j = np.meshgrid(np.arange(-3, 4), np.arange(-3, 4), indexing="ij")
    node = np.column_stack((i.ravel() * step, j.ravel() * step, 0.0 * i.ravel()))
    assert node[near_section(node, 0, step / 2)].shape == (7, 3)
    diagonal = node[near_section(node, 45, step / 2)]
    np.testing.assert_array_equal(diagonal[:, 0], diagonal[:, 1])
    cell = node + np.array([step / 2, step / 2, 0.0])
    assert set(cell[near_section(cell, 0, step / 2), 1]) == {-step / 2, step / 2}


def test_only_shallow_heights_are_enlarged() -> None:
    assert enlargement(600.0, 90.0) == 1
    assert enlargement(600.0, 300.0) == 1
    assert enlargement(600.0, 15.0) == 5
    assert enlargement(600.0, 0.0) == 20


def test_neither_the_package_nor_the_store_brings_in_matplotlib() -> None:
    code = "import sys, punchform.store; sys.exit(bool({'matplotlib', 'jinja2'} & sys.modules.keys()))"
    assert subprocess_run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_real_run_is_written_and_read_back(tmp_path: Path) -> None:
    """The names of the fake run are those of a real one; the energy of the table is that of the run."""
    case = check_case()
    coarse = case.model_copy(update={"grid": case.grid.model_copy(update={"step": (15.0, 15.0)})})
    formed = form(coarse)
    stored = read_run(write_run(formed, tmp_path / "dish", extras=(write_report,)))
    assert (stored.folder / "report.html").stat().st_size > 100_000
    assert stored.result["formed"]["outcome"] == "converged"
    assert stored.wires["energy_mJ"].sum() == pytest.approx(formed.formed.energy, rel=1e-9)
    axis = stored.nodes[(stored.nodes["i"] == 0) & (stored.nodes["j"] == 0)]
    assert axis["z"][0] == pytest.approx(stored.nodes["z"].max())


def oklab(colours: Floats) -> Floats:
    """Colours (n, 3) in Oklab, in which equal distances look equal (B. Ottosson, 2020)."""
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    cones = np.array(
        [
            [0.4122214708, 0.5363325363, 0.0514459929],
            [0.2119034982, 0.6806995451, 0.1073969566],
            [0.0883024619, 0.2817188376, 0.6299787005],
        ]
    )
    opponents = np.array(
        [
            [0.2104542553, 0.7936177850, -0.0040720468],
            [1.9779984951, -2.4285922050, 0.4505937099],
            [0.0259040371, 0.7827717662, -0.8086757660],
        ]
    )
    return np.asarray(np.cbrt(linear @ cones.T) @ opponents.T)


@pytest.mark.parametrize("name", [SEQUENTIAL, RELIEF])
def test_maps_of_sizes_have_even_steps_and_one_way_of_lightness(name: str) -> None:
    shades = oklab(np.asarray(colormaps[name](np.linspace(0, 1, 33)))[:, :3])
    steps = np.linalg.norm(np.diff(shades, axis=0), axis=1)
    assert steps.max() < 1.6 * steps.min()
    assert len(set(np.sign(np.diff(shades[:, 0])))) == 1


def test_the_map_with_a_sign_parts_in_its_middle() -> None:
    lightness = oklab(np.asarray(colormaps[DIVERGING](np.linspace(0, 1, 33)))[:, :3])[:, 0]
    assert (np.diff(lightness[:17]) > 0).all()
    assert (np.diff(lightness[16:]) < 0).all()
