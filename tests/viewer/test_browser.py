"""The viewer in a real browser: what is clicked, pressed and slid has its effect; the numbers are those of the run."""

from __future__ import annotations

import importlib
import re
import shutil
from collections.abc import Generator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import stretched
import tiny_dish

from punchform.arrays import Floats
from punchform.case.reading import case_from_text
from punchform.report.page import render
from punchform.report.viewer import Scene, pack, program, scene_of, style
from punchform.report.viewer.payload import SHARE
from punchform.run import Run, run

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
VIEWER = "document.querySelector('.pf-viewer').viewer"
OTHER = "document.querySelectorAll('.pf-viewer')[1].viewer"
NODE = 1e-4


@dataclass
class Tab:
    """A page in the browser, all it has said and asked for."""

    page: Page
    said: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)

    def js(self, expression: str) -> Any:
        """The value of an expression in which `viewer` is the first viewer."""
        return self.page.evaluate(f"() => {{ const viewer = {VIEWER}; return {expression}; }}")

    def picture(self) -> bytes:
        """The canvas as it is drawn now."""
        return bytes(self.page.locator(".pf-canvas").first.screenshot())

    def numbers(self) -> dict[str, float]:
        """What the panel tells, by key; of keys that stand there twice the first."""
        rows = self.page.eval_on_selector_all(
            ".pf-panel tr[data-key]", "rows => rows.map(row => [row.dataset.key, Number(row.dataset.value)])"
        )
        return dict(reversed(rows))

    def click(self, node: int) -> None:
        """Click where a node is drawn."""
        self.click_at(f"[...viewer.points.slice(3 * {node}, 3 * {node} + 3)]")

    def click_at(self, point: str) -> None:
        """Click where a point is drawn."""
        x, y = self.js(f"viewer.stage.seen({point})")
        self.page.locator(".pf-canvas").first.click(position={"x": x, "y": y})


@pytest.fixture(scope="module")
def browser() -> Generator[Browser, None, None]:
    sync_api = pytest.importorskip("playwright.sync_api", reason="needs playwright: pip install 'punchform[test]'")
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip("needs a Chromium: scripts/install-test-tools installs it")
    with sync_api.sync_playwright() as play:
        opened = play.chromium.launch(executable_path=path, args=list(FLAGS))
        yield opened
        opened.close()


@cache
def dish() -> Run:
    """A small dish, let go, loaded and judged."""
    return run(tiny_dish.case('[load]\npressure = "100 Pa"\n'))


@cache
def shallow() -> Run:
    """The same dish over a flatter punch for a flatter target."""
    return run(case_from_text(tiny_dish.TEXT.replace('focal_length = "60 mm"', 'focal_length = "90 mm"')))


@cache
def divided() -> Run:
    """The dish with a node between each two crossings."""
    return run(case_from_text(tiny_dish.TEXT.replace('step = "10 mm"', 'step = "10 mm"\nsubdivide = 2')))


def figure_of(scene: Scene, key: str) -> Floats:
    """A figure of the shape in the tool."""
    return next(one.values for one in scene.poses[1].figures if one.key == key)


@cache
def html(*made: str) -> str:
    """The page of runs, without its figures."""
    runs = {"dish": dish, "stretched": stretched.dish, "shallow": shallow, "divided": divided}
    scenes = tuple(pack(scene_of(runs[name](), name), f"scene-{number}") for number, name in enumerate(made))
    return render(
        dish().case, subtitle="", good=True, verdict=("Fine.",), results=(), details_title="Details", details=(),
        images=(), notes=(), beside="", scenes=scenes,
    )  # fmt: skip


@dataclass
class Opener:
    """Opens pages from files, as a user does."""

    browser: Browser
    folder: Path

    def __call__(self, *made: str, ready: bool = True, script: str = "", text: str = "", **options: Any) -> Tab:
        context = self.browser.new_context(**({"viewport": {"width": 1000, "height": 800}} | options))
        tab = Tab(context.new_page())
        tab.page.on("console", lambda message: tab.said.append(message.text))
        tab.page.on("pageerror", lambda error: tab.said.append(str(error)))
        tab.page.on("request", lambda request: tab.asked.append(request.url))
        if script:
            tab.page.add_init_script(script)
        path = self.folder / f"{len(list(self.folder.iterdir()))}.html"
        path.write_text(text or html(*(made or ("dish",))), encoding="utf-8")
        tab.page.goto(path.as_uri())
        if ready:
            tab.page.wait_for_function(f"{VIEWER} && {VIEWER}.stage.pictures > 0")
        return tab


@pytest.fixture
def show(browser: Browser, tmp_path: Path) -> Generator[Opener, None, None]:
    yield Opener(browser, tmp_path)
    for context in browser.contexts:
        context.close()


def test_the_page_says_nothing_and_asks_for_nothing(show: Opener) -> None:
    tab = show()
    for key in ("c", "]", "[", "m", "q", "p", "t", "x", "y", "2", "3", "1", "0", "+", "-", "Escape"):
        tab.page.locator(".pf-canvas").press(key)
    assert tab.said == []
    assert len(tab.asked) == 1
    assert tab.asked[0].startswith("file:///")


def test_slider_colour_and_parts_change_the_picture(show: Opener) -> None:
    tab = show()
    seen = [tab.picture()]

    def changed() -> bool:
        seen.append(tab.picture())
        return seen[-1] not in seen[:-1]

    tab.page.get_by_role("button", name="in the tool", exact=True).click()
    assert changed()
    tab.page.locator(".pf-head select").select_option("axial_force")
    assert changed()
    tab.page.locator(".pf-slider").fill("0.5")
    assert changed()
    assert "drawn only, not computed" in tab.page.locator(".pf-caption").inner_text()
    tab.page.get_by_label("Wires along x").uncheck()
    assert changed()
    tab.page.get_by_label("Punch").uncheck()
    assert changed()
    tab.page.get_by_label("Quarter").check()
    assert changed()
    tab.page.get_by_role("button", name="Top").click()
    assert changed()


def test_what_is_clicked_is_told_with_its_numbers(show: Opener) -> None:
    tab, done = show(), dish()
    assert done.released is not None
    assert done.accuracy is not None
    scene, whole = scene_of(done), done.released.whole
    tab.page.get_by_role("button", name="Top").click()
    for node in range(3, len(whole.index), 17):
        tab.click(node)
        i, j = (str(number).replace("-", "\u2212") for number in whole.index[node])
        assert tab.page.locator(".pf-panel h3").inner_text() == f"Node ({i}, {j})"
        told = tab.numbers()
        assert [told[axis] for axis in "xyz"] == pytest.approx(whole.positions[node], abs=NODE)
        assert [told["x0"], told["y0"]] == pytest.approx(whole.flat[node, :2], abs=NODE)
        moved = done.released.moved[:, 2]
        assert told["release_moved"] == pytest.approx(moved[node], abs=SHARE * np.abs(moved).max())
        deviation = done.accuracy.as_held.deviations.normal
        if done.accuracy.mask[node]:
            assert told["deviation_held"] == pytest.approx(deviation[node], abs=1e-4)
        else:
            assert "deviation_held" not in told
        pieces = np.flatnonzero((scene.ends == node).any(axis=1))
        assert {key for key in told if key.startswith("axial_force")} == {f"axial_force:{piece}" for piece in pieces}


def test_a_click_on_a_wire_tells_its_piece(show: Opener) -> None:
    tab, scene = show(), scene_of(dish())
    tab.page.get_by_role("button", name="Top").click()
    tab.page.get_by_role("button", name="in the tool", exact=True).click()
    values = {figure.key: figure.values for figure in scene.poses[1].figures}
    for piece in range(5, len(scene.ends), 41):
        a, b = scene.ends[piece]
        tab.click_at(f"[0, 1, 2].map(k => (viewer.points[{3 * a} + k] + viewer.points[{3 * b} + k]) / 2)")
        assert tab.page.locator(".pf-panel h3").inner_text().startswith("Wire piece")
        told = tab.numbers()
        for key in ("axial_force", "moment", "stress"):
            assert told[key] == pytest.approx(values[key][piece], abs=SHARE * np.abs(values[key]).max())


def test_the_legend_tells_name_unit_and_extent(show: Opener) -> None:
    tab, whole = show(), dish().formed.whole
    tab.page.get_by_role("button", name="in the tool", exact=True).click()
    tab.page.locator(".pf-head select").select_option("axial_force")
    assert tab.page.locator(".pf-legend-name").inner_text() == "Axial force F1 [N]"
    said = tab.page.locator(".pf-extent").inner_text().replace("\u2212", "-")
    least, largest = (float(number) for number in re.findall(r"-?\d[\d.e-]*", said)[:2])
    assert least == pytest.approx(whole.F[:, 0].min(), rel=1e-3)
    assert largest == pytest.approx(whole.F[:, 0].max(), rel=1e-3)
    assert tab.page.locator(".pf-tick").count() >= 3
    tab.page.get_by_label("Without the extremes").uncheck()
    low, high = tab.js("viewer.uniforms.range.value")
    assert low == -high
    assert high == pytest.approx(np.abs(whole.F[:, 0]).max(), rel=1e-5)


def test_every_legend_has_ticks_and_tells_where_its_bar_ends_too_early(show: Opener) -> None:
    tab = show("stretched")
    for key in tab.js("viewer.quantities.map(one => one.key)"):
        tab.js(f"viewer.ask({{ colour: '{key}' }})")
        assert tab.page.locator(".pf-tick").count() >= 3, key
        low, high = tab.js("viewer.uniforms.range.value")
        values = np.array(tab.js("[...viewer.told].filter(value => value > -1e29)"))
        assert tab.page.locator(".pf-beyond-high").count() == (values.max() > high * (1 + 1e-6)), key
        assert tab.page.locator(".pf-beyond-low").count() == (values.min() < low * (1 + 1e-6)), key
        signed = tab.js(f"viewer.quantity('{key}').signed")
        assert low == (-high if signed and values.min() < -1e-4 * values.max() else 0), key


def test_a_mark_that_figures_pass_is_on_the_bar(show: Opener) -> None:
    tab, done = show("stretched"), stretched.dish()
    assert done.formed.hardening is not None
    strength, stress = done.formed.hardening.yield_strength, done.formed.whole.stress
    assert stress.max() > strength
    tab.js("viewer.ask({ time: viewer.scene.poses.findIndex(pose => pose.name === 'in the tool'), colour: 'stress' })")
    assert tab.page.locator(".pf-mark").count() == 1
    assert tab.js("viewer.uniforms.range.value")[1] > strength
    assert "line: yield strength" in tab.page.locator(".pf-extent").inner_text()


def test_a_mark_near_which_no_figure_comes_does_not_pale_the_picture(show: Opener) -> None:
    tab = show()
    tab.js(
        "(viewer.quantity('deviation_held').marks.forEach(mark => { mark.value *= 100; }), viewer.ranges.clear(), 0)"
    )
    tab.js("viewer.ask({ colour: 'deviation_held' })")
    assert tab.page.locator(".pf-mark").count() == 0
    assert "tolerance 50 mm is farther off" in tab.page.locator(".pf-extent").inner_text().replace("\u00a0", " ")


def test_the_families_of_wires_have_a_key_in_their_colours(show: Opener) -> None:
    tab = show()
    tab.js("viewer.ask({ colour: '' })")
    told = tab.page.locator(".pf-families > span").all_inner_texts()
    assert [one.strip() for one in told] == ["wires along x", "wires along y"]
    colour = "getComputedStyle(document.querySelector('.pf-swatch{}')).backgroundColor"
    for family in (1, 2):
        shown = re.findall(r"\d+", tab.page.evaluate(colour.format(family)))
        drawn = tab.js(f"viewer.families[{family - 1}][1].material.uniforms.plain.value.map(part => 255 * part)")
        assert [int(part) for part in shown] == pytest.approx(drawn, abs=0.6)
    tab.js("viewer.ask({ colour: 'shear' })")
    assert not tab.page.locator(".pf-families").is_visible()


def test_a_figure_not_told_of_a_shape_takes_one_of_which_it_is(show: Opener) -> None:
    tab = show()
    select, caption = tab.page.locator(".pf-head select"), tab.page.locator(".pf-caption")
    pose = "viewer.scene.poses[viewer.state.time].name"
    tab.page.get_by_role("button", name="released", exact=True).click()
    select.select_option("contact_force")
    assert tab.js(pose) == "in the tool"
    assert "not told of \u201creleased\u201d" in caption.inner_text()
    select.select_option("load_moved")
    assert tab.js(pose) == "loaded"
    select.select_option("axial_force")
    assert tab.js(pose) == "released"
    assert "not told" not in caption.inner_text()
    select.select_option("contact_force")
    tab.page.get_by_role("button", name="flat", exact=True).click()
    assert "not told of the shape" in tab.page.locator(".pf-extent").inner_text()


def test_wires_cut_between_crossings_are_coloured_along_their_length(show: Opener) -> None:
    tab = show("divided")
    tab.js("viewer.ask({ time: 1, colour: 'shear' })")
    values = tab.js("[...viewer.told]")
    scene = scene_of(divided())
    known = np.isfinite(figure_of(scene, "shear"))
    assert not known[scene.between > 0].any()
    assert np.array_equal(np.array(values) > -1e29, known | (scene.between > 0))
    tab.click(int(np.flatnonzero(scene.between)[0]))
    assert "shear" not in tab.numbers()


def test_moves_are_enlarged_from_their_reference(show: Opener) -> None:
    tab, done = show(), dish()
    assert done.released is not None
    tab.js("viewer.ask({ reference: 'in the tool', times: 20 })")
    points = np.array(tab.js("[...viewer.points]")).reshape(-1, 3)
    wanted = done.formed.whole.positions + 20 * done.released.moved
    np.testing.assert_allclose(points, wanted, atol=2e-3)
    assert "drawn 20 times as large" in tab.page.locator(".pf-caption").inner_text()


@pytest.mark.parametrize("reference", ["in the tool", "the target"])
def test_moves_are_enlarged_to_three_tenths_of_the_grid_and_stay_in_the_picture(show: Opener, reference: str) -> None:
    tab, scene = show(), scene_of(dish())
    tab.js(f"(viewer.look('side'), viewer.ask({{ reference: '{reference}', times: 1000 }}))")
    times, factors = tab.js("viewer.state.times"), tab.js("viewer.factors()")
    moves = [
        pose.positions - dict(pose.references)[reference] for pose in scene.poses if reference in dict(pose.references)
    ]
    largest = max(float(np.nanmax(np.linalg.norm(one, axis=1))) for one in moves)
    width = float(np.ptp(scene.poses[0].positions[:, :2], axis=0).max())
    assert times == factors[-1]
    assert times * largest <= 0.3 * width
    assert times == 1000 or 2.5 * times * largest > 0.3 * width
    drawn = "[...viewer.scene.i].map((_, k) => viewer.stage.seen(viewer.points.slice(3 * k, 3 * k + 3)))"
    seen = tab.js(drawn)
    spots = np.array([[np.nan if part is None else part for part in spot] for spot in seen])
    size = tab.js("[viewer.canvas.clientWidth, viewer.canvas.clientHeight]")
    assert np.nanmin(spots) >= 0
    assert (np.nanmax(spots, axis=0) <= size).all()
    scale = tab.js("viewer.stage.scale")
    tab.js("viewer.ask({ times: 1 })")
    assert tab.js("viewer.stage.scale") >= scale


def test_moves_enlarged_in_a_near_view_leave_it_where_it_is(show: Opener) -> None:
    tab = show()
    tab.js("viewer.stage.zoom(4)")
    before = tab.js("viewer.stage.pose")
    tab.js("viewer.ask({ times: 50 })")
    assert tab.js("viewer.stage.pose") == before


def test_the_keyboard_walks_from_node_to_node(show: Opener) -> None:
    tab = show()
    canvas, title = tab.page.locator(".pf-canvas"), tab.page.locator(".pf-panel h3")
    canvas.focus()
    for key, told in (
        ("ArrowRight", "Node (0, 0)"),
        ("ArrowRight", "Node (1, 0)"),
        ("ArrowUp", "Node (1, 1)"),
        ("ArrowLeft", "Node (0, 1)"),
        ("ArrowDown", "Node (0, 0)"),
    ):
        canvas.press(key)
        assert title.inner_text() == told
    before = tab.js("viewer.stage.camera.position.toArray()")
    canvas.press("Shift+ArrowRight")
    assert tab.js("viewer.stage.camera.position.toArray()") != before
    assert title.inner_text() == "Node (0, 0)"
    canvas.press("Escape")
    assert title.count() == 0
    tab.page.locator(".pf-slider").press("ArrowLeft")
    assert tab.js("viewer.state.time") == 1


@pytest.mark.parametrize("how", ["system", "page"])
def test_the_ground_follows_the_theme(show: Opener, how: str) -> None:
    tab = show(color_scheme="light")
    light = tab.js("viewer.stage.scene.background.getHexString()")
    if how == "system":
        tab.page.emulate_media(color_scheme="dark")
    else:
        tab.page.evaluate("document.documentElement.dataset.theme = 'dark'")
    tab.page.wait_for_function(f"{VIEWER}.ground === 'dark'")
    dark = tab.js("viewer.stage.scene.background.getHexString()")
    assert int(light[:2], 16) > 200
    assert int(dark[:2], 16) < 60


@pytest.mark.parametrize("made", [("dish",), ("dish", "stretched")])
def test_a_phone_shows_all_without_scrolling_sideways(show: Opener, made: tuple[str, ...]) -> None:
    tab = show(*made, viewport={"width": 390, "height": 800}, device_scale_factor=2, has_touch=True, is_mobile=True)
    assert tab.page.evaluate("document.documentElement.scrollWidth") == 390
    tab.page.locator(".pf-stage").first.scroll_into_view_if_needed()
    x, y = tab.js("viewer.stage.seen([...viewer.points.slice(0, 3)])")
    tab.page.locator(".pf-canvas").first.tap(position={"x": x, "y": y})
    assert tab.page.locator(".pf-panel h3").first.inner_text().startswith("Node")


def test_nothing_moves_on_the_page_when_things_are_chosen(show: Opener) -> None:
    tab = show()
    parts = "document.querySelectorAll('.pf-stage, .pf-panel, .pf-slider, #case')"
    place = f"[...{parts}].map(part => part.getBoundingClientRect().top + scrollY)"
    before = tab.page.evaluate(place)
    for key in tab.js("viewer.quantities.map(one => one.key)"):
        tab.js(f"viewer.ask({{ colour: '{key}', times: 50, picked: {{ kind: 'node', number: 5 }} }})")
        assert tab.page.evaluate(place) == before


def test_nothing_is_drawn_while_nothing_changes(show: Opener) -> None:
    tab = show()
    tab.page.wait_for_timeout(200)
    before = tab.js("viewer.stage.pictures")
    tab.page.wait_for_timeout(400)
    assert tab.js("viewer.stage.pictures") == before


def test_playing_ends_at_the_last_shape_and_hops_where_motion_is_unwelcome(show: Opener) -> None:
    tab = show(
        reduced_motion="reduce", script="window.setTimeout = (go => (what, wait) => go(what, wait / 20))(setTimeout)"
    )
    listening = "(ask => asked => (window.times.push(asked.time), ask.call(viewer, asked)))(viewer.ask)"
    tab.js(f"(window.times = [], viewer.ask = {listening}, 0)")
    tab.page.get_by_role("button", name="flat", exact=True).click()
    tab.page.locator(".pf-play").click()
    tab.page.wait_for_function(f"{VIEWER}.state.time === 3 && !{VIEWER}.state.playing")
    times = tab.page.evaluate("window.times")
    assert times[-3:] == [1, 2, 3]
    assert tab.page.locator(".pf-play").inner_text() == "Play"


def test_without_webgl_the_page_says_so(show: Opener) -> None:
    tab = show(ready=False, script="HTMLCanvasElement.prototype.getContext = () => null")
    tab.page.wait_for_selector(".pf-message")
    assert "needs WebGL 2" in tab.page.locator(".pf-message").inner_text()
    assert tab.said == []


def test_without_javascript_the_page_says_so(show: Opener) -> None:
    tab = show(ready=False, java_script_enabled=False)
    assert "needs JavaScript" in tab.page.locator("#viewer noscript").inner_text()


def test_a_print_has_a_still_on_light_ground(show: Opener) -> None:
    tab = show(color_scheme="dark")
    assert tab.js("viewer.ground") == "dark"
    tab.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert tab.js("viewer.ground") == "light"
    tab.page.emulate_media(media="print")
    still = tab.page.locator(".pf-still")
    assert still.is_visible()
    assert (still.get_attribute("src") or "").startswith("data:image/png;base64,")
    assert not tab.page.locator(".pf-tools").is_visible()
    tab.page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    tab.page.emulate_media(media="screen")
    tab.page.wait_for_function(f"{VIEWER}.ground === 'dark'")


def test_viewers_side_by_side_have_one_range_from_the_start(show: Opener) -> None:
    tab = show("dish", "shallow")
    tab.page.wait_for_function(f"{OTHER} && {OTHER}.stage.pictures > 0")
    for ask in ("0", "viewer.ask({ colour: 'axial_force' })"):
        tab.js(ask)
        first, other = (tab.js(f"{one}.uniforms.range.value") for one in ("viewer", OTHER))
        assert first == other
        shown = "true, false, viewer.scene.poses[viewer.state.time].name"
        own = [tab.js(f"{one}.ownRange(viewer.state.colour, {shown}).high") for one in ("viewer", OTHER)]
        assert own[0] != own[1]
        assert first[1] == max(own)


def test_viewers_side_by_side_follow_each_other(show: Opener) -> None:
    tab = show("dish", "stretched")
    tab.page.wait_for_function(f"{OTHER}")
    tab.js("viewer.ask({ time: 1, colour: 'axial_force' })")
    pose = f"{OTHER}.scene.poses[{OTHER}.state.time].name"
    assert tab.page.evaluate(pose) == "in the tool"
    tab.js("viewer.stage.turn(3, 1)")
    ways = tab.js("viewer.stage.pose.way"), tab.page.evaluate(f"{OTHER}.stage.pose.way")
    assert ways[0] == pytest.approx(ways[1], abs=1e-6)
    tab.page.locator(".pf-link input").uncheck()
    tab.js("viewer.ask({ time: 0 })")
    assert tab.page.evaluate(pose) == "in the tool"
    assert tab.said == []


def test_three_viewers_side_by_side_leave_no_hole(show: Opener) -> None:
    tab = show("dish", "shallow", "stretched", viewport={"width": 1100, "height": 800})
    tops = "[...document.querySelectorAll('.pf-scenes > div')].map(one => one.getBoundingClientRect().top)"
    assert len(set(tab.page.evaluate(tops))) == 1


def test_the_punch_is_said_to_have_stood_where_it_has_gone(show: Opener) -> None:
    tab = show()
    for pose, label in (("in the tool", "Punch"), ("released", "Punch (where it stood)")):
        tab.page.get_by_role("button", name=pose, exact=True).click()
        tab.page.get_by_label(label, exact=True).uncheck()
        assert not tab.js("viewer.skins[0][1].object.visible")
        tab.page.get_by_label(label, exact=True).check()


def test_strokes_are_on_the_slider_and_not_among_the_buttons(show: Opener) -> None:
    tab = show("stretched")
    assert tab.page.locator(".pf-chip").all_inner_texts() == ["flat", "in the tool", "released"]
    tab.js("viewer.ask({ time: 2 })")
    assert (
        tab.page.locator(".pf-caption").inner_text() == "Stroke 2 of 4: the punch is down to 50.0\u00a0% of its depth."
    )
    depth = tab.js("viewer.skins[0][1].object.scale.z")
    assert depth == pytest.approx(0.5)


def test_a_hundred_thousand_nodes_are_few_megabytes_and_few_draw_calls(
    show: Opener, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "benchmarks"))
    pages = importlib.import_module("viewer_pages")
    scene = pages.paraboloid(100_000)
    text = pages.page_of(scene)
    assert len(scene.index) > 95_000
    assert len(text) < 11e6
    tab = show(text=text)
    assert tab.js("viewer.stage.renderer.info.render.calls") <= 3
    assert tab.js("viewer.stage.renderer.info.render.lines") == len(scene.ends)
    tab.page.locator(".pf-slider").fill("1.5")
    tab.page.wait_for_function(f"{VIEWER}.state.time === 1.5")
    assert tab.said == []


def test_the_program_and_its_style_name_no_address() -> None:
    assert set(re.findall(r"https?://[^\s\"'`)]+", program() + style())) <= {
        "http://www.w3.org/1999/xhtml",
        "http://www.w3.org/2000/svg",
    }
    assert "</script" not in program()
