"""Results in notebooks: whole HTML, a figure of every field of every stage, and clear words for what is not there."""

from __future__ import annotations

import base64
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
import stretched
import tiny_dish
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from punchform import Drape, Run, drape, form_shell, read_case, run
from punchform.arrays import Ints
from punchform.case import varied
from punchform.case.reading import case_from_text
from punchform.errors import InputError
from punchform.grid import Grid
from punchform.report import notebook
from punchform.report.fields import field_of, fields, stage_of
from punchform.report.quantities import readings
from punchform.report.viewer import scene_of
from punchform.shell import Shell


@cache
def elastic(symmetry: str = "quarter") -> Run:
    """A small dish of elastic wires with a target."""
    case = tiny_dish.case("[load]\npressure = '1 Pa'\n")
    return run(varied(case, {"grid.symmetry": symmetry}))


@cache
def pressed_again() -> Run:
    """The small dish, let go, trimmed and pressed once more: it lies in the tool."""
    stages = 'schema = 1\nstages = ["press", "release", { trim = { radius = "65 mm" } }, "press"]'
    return run(case_from_text(tiny_dish.TEXT.replace("schema = 1", stages)))


@cache
def net() -> Drape:
    """The net of the small dish."""
    return drape(tiny_dish.case())


@cache
def shell() -> Shell:
    """The packaged gridshell."""
    return form_shell(read_case("packaged:gridshell"))


class Tags(HTMLParser):
    """Checks that every tag is closed, and collects the text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag == "img"

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def checked(page: str) -> str:
    """The text of a page that is well-formed, brings its picture with it, and leaves its colours to the notebook."""
    tags = Tags(page)
    assert not tags.open
    picture = re.search(r'src="data:image/png;base64,([^"]+)"', page)
    assert picture is not None
    assert base64.b64decode(picture[1]).startswith(b"\x89PNG")
    assert not re.search(r"https?://|<script", page)
    assert "color:" not in page, "text is legible on dark and light"
    assert 5_000 < len(page) < 400_000
    return " | ".join(tags.words)


def test_a_run_shows_its_verdict_and_its_figures() -> None:
    done = elastic()
    told = checked(done._repr_html_())
    assert done.accuracy is not None
    assert ("✔" in told) is bool(done.accuracy.within)
    assert ("✘" in told) is not done.accuracy.within
    assert done.formed.outcome.value in told
    assert f"{done.formed.whole.crossings} crossings" in told
    assert "tolerance of 0.500" in told
    yielding = checked(stretched.dish()._repr_html_())
    assert "largest elongation of the wire" in yielding
    assert "largest strain of the wire by its pull" in told
    assert not re.search("[✔✘]", yielding), "nothing is judged without a target"


def test_grid_net_and_gridshell_show_themselves() -> None:
    grid = elastic().formed.grid
    assert f"{grid.nodes} nodes, {grid.elements} wire pieces, a quarter" in checked(grid._repr_html_())
    assert "✔" in checked(net()._repr_html_())
    assert "hemisphere" in checked(shell()._repr_html_()) or "rods" in checked(shell()._repr_html_())
    assert "ends held" in checked(shell()._repr_html_())


def test_titles_are_text_and_not_html() -> None:
    done = elastic()
    titled = done.case.model_copy(update={"title": "<b>5 & 6</b>"})
    told = notebook.html_of_run(Run(**{**vars(done), "case": titled}))
    assert "<b>" not in told
    assert "<b>5 & 6</b>" in checked(told)


CASES = {
    "elastic": lambda: elastic(),
    "whole": lambda: elastic("full"),
    "yielding": lambda: stretched.dish(),
}


@pytest.mark.parametrize("which", CASES)
def test_every_field_of_every_stage_draws(which: str) -> None:
    done: Run = CASES[which]()
    for stage in ("formed", "released"):
        known = fields(done, stage)
        for field in ("shape", *known):
            figure = done.plot(field, stage)
            assert isinstance(figure, Figure)
            labels = [axes.get_ylabel() for axes in figure.axes]
            assert ("height z [mm]" if field == "shape" else known[field].label) in labels
    assert ("plastic_strain" in fields(done, "formed")) is (which == "yielding")
    assert ("deviation" in fields(done, "released")) is (which != "yielding")


def test_the_fields_are_those_of_the_run() -> None:
    done = elastic()
    whole, accuracy = done.formed.whole, done.accuracy
    assert accuracy is not None
    assert np.array_equal(field_of(done, "contact_force", "formed").values, whole.contact)
    assert np.abs(field_of(done, "shear", "formed").values).max() == pytest.approx(np.degrees(done.formed.max_shear))
    assert field_of(done, "axial_strain", "formed").values.max() == pytest.approx(100 * done.formed.max_axial_strain)
    deviation = field_of(done, "deviation", "released").values
    assert (np.isfinite(deviation) == accuracy.mask).all()
    rms = np.sqrt(np.average(deviation[accuracy.mask] ** 2, weights=accuracy.weights[accuracy.mask]))
    assert rms == pytest.approx(accuracy.judged.rms)
    assert done.released is not None
    sunk = field_of(done, "moved", "released").values
    assert sunk.max() == pytest.approx(np.linalg.norm(done.released.moved, axis=1).max())
    assert stage_of(done, "press 1") is done.formed
    assert stage_of(done, "loaded") is done.loaded


def test_what_a_later_press_has_undone_is_there_by_its_name_alone() -> None:
    done = pressed_again()
    assert done.released is not None
    assert "springback" in checked(elastic()._repr_html_())
    assert "springback" not in checked(done._repr_html_()), "the dish lies in the tool"
    told = "no stage 'released'; it has: formed, press 1, release 1, trim 1, press 2"
    with pytest.raises(ValueError, match=re.escape(told)):
        done.plot("shape", "released")
    assert stage_of(done, "release 1") is done.released
    moved = field_of(done, "moved", "release 1").values
    assert moved.max() == pytest.approx(np.linalg.norm(done.released.moved, axis=1).max())
    assert "deviation" not in fields(done, "release 1")
    assert "deviation" in fields(done, "formed"), "what was judged last is the dish in the tool"


def test_the_deviation_is_shown_of_a_release_that_counts_its_moves_from_another_stage() -> None:
    stages = 'schema = 1\nstages = ["press", { release = { hold = "rim" } }, "release"]'
    done = run(case_from_text(tiny_dish.TEXT.replace("schema = 1", stages)))
    assert done.accuracy is not None
    assert stage_of(done, "released").whole is done.final.whole
    assert (np.isfinite(field_of(done, "deviation", "released").values) == done.accuracy.mask).all()


@pytest.mark.parametrize("which", ["elastic", "yielding"])
def test_a_quantity_has_one_name_and_unit_wherever_it_is_shown(which: str) -> None:
    done: Run = CASES[which]()
    yields = which == "yielding"
    table = {one.key: one for one in readings(yields=yields)}
    assert len(table) == len(readings(yields=yields)), "a key for each"
    known = fields(done, "formed")
    for key in known.keys() & table.keys():
        one = table[key]
        assert (known[key].label, known[key].place, known[key].signed) == (one.legend, one.place, one.signed)
    seen = {one.key: one for one in scene_of(done).quantities}
    for key in seen.keys() & table.keys():
        assert (seen[key].label, seen[key].unit, seen[key].signed) == (
            table[key].label,
            table[key].unit,
            table[key].signed,
        )
    assert seen.keys() & table.keys() >= {"shear", "axial_force", "moment", "stress", "contact_force"}
    assert known["axial_strain"].label == (
        "elongation of the wire [%]" if yields else "strain of the wire by its pull [%]"
    )
    assert ("plastic_strain" in table) is ("plastic_strain" in seen) is ("axial_strain" in seen) is yields
    if done.accuracy is not None:
        judged = field_of(done, "deviation", "released").label
        assert judged == f"{seen['deviation_held'].label} [{seen['deviation_held'].unit}]"


def test_a_plan_shows_as_many_colours_as_it_has_values() -> None:
    figure = elastic().plot("height")
    drawn = [one for one in figure.axes[0].collections if isinstance(one, PathCollection)]
    corners = sum(np.shape(path.vertices)[0] for path in drawn[0].get_paths())
    assert corners == 5 * elastic().formed.whole.crossings, "a closed square for each crossing"


@pytest.mark.parametrize(
    ("field", "stage", "told"),
    [
        ("shears", "formed", "no field 'shears' of the stage 'formed'; there are: shape, height, shear, axial_force"),
        ("contact_force", "released", "no field 'contact_force' of the stage 'released'"),
        ("shape", "cut", "no stage 'cut'; it has: formed, released, loaded, press 1, release 1, load 1"),
    ],
)
def test_what_is_not_there_is_told_with_what_is(field: str, stage: str, told: str) -> None:
    with pytest.raises(ValueError, match=re.escape(told)):
        elastic().plot(field, stage)


def test_a_quarter_is_drawn_with_its_images() -> None:
    quarter, whole = (elastic(symmetry).formed.grid for symmetry in ("quarter", "full"))
    counts = [[len(one.get_paths()) for one in grid.plot().axes[0].collections] for grid in (quarter, whole)]
    assert counts[0][:3] == [quarter.elements] * 3, "three pale images"
    assert counts[0][3:] == [int((quarter.family == w).sum()) for w in (0, 1)]
    assert counts[1] == [int((whole.family == w).sum()) for w in (0, 1)]


def test_figures_show_themselves_in_a_notebook() -> None:
    drawn: Grid = elastic().formed.grid
    shown = getattr(drawn.plot(), "_repr_png_")()  # noqa: B009
    assert shown.startswith(b"\x89PNG")
    assert isinstance(net().plot(), Figure)
    assert isinstance(shell().plot(), Figure)


def test_pyvista_shows_the_field(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    done = elastic()
    for field, count in (
        ("shape", len(done.formed.whole.positions)),
        ("stress", len(done.formed.whole.start)),
        ("shear", len(done.formed.whole.cells)),
    ):
        plotter = done.plot3d(field, off_screen=True)
        mesh = plotter.meshes[0]
        assert len(mesh.active_scalars) == count
        assert mesh.n_points == len(done.formed.whole.positions)
        plotter.close()
    monkeypatch.setattr(notebook, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'punchform\[pyvista\]'"):
        done.plot3d()


@pytest.mark.parametrize("field", ["shape", "stress", "shear"])
def test_what_has_no_place_is_left_out_in_space(field: str) -> None:
    pytest.importorskip("pyvista")
    done = elastic()
    whole = done.formed.whole
    node = int(whole.cells[0, 0])
    positions = whole.positions.copy()
    positions[node] = np.nan
    lost = replace(done, formed=replace(done.formed, whole=replace(whole, positions=positions)))
    plotter = lost.plot3d(field, off_screen=True)
    mesh = plotter.meshes[0]
    touching = (whole.cells == node).any(axis=1) if field == "shear" else (whole.start == node) | (whole.end == node)
    assert mesh.n_cells == np.count_nonzero(~touching)
    assert mesh.n_points == len(positions) - 1
    assert np.isfinite(mesh.points).all()
    corners: Ints = mesh.regular_faces if field == "shear" else mesh.lines.reshape(-1, 3)[:, 1:]
    lengths = np.linalg.norm(np.diff(mesh.points[corners], axis=1), axis=2)
    assert lengths.max() < 2 * max(done.case.grid.step), "no wire runs to another place"
    if field == "stress":
        np.testing.assert_array_equal(mesh.active_scalars, whole.stress[~touching])
    plotter.close()


def test_drawing_is_loaded_when_something_is_drawn() -> None:
    drawers = ("matplotlib", "pyvista")
    ask = f"import sys, punchform.run, punchform.grid; print([name for name in {drawers} if name in sys.modules])"
    told = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True)
    assert told.stdout == "[]\n"
