"""The benchmarks run at a tiny size, and the pages that they write have a place for every table."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
BENCHMARKS = ROOT / "benchmarks"
PAGES = {
    "net.py": ("performance.md", ("net",)),
    "press_scaling.py": ("performance.md", ("press",)),
    "release_scaling.py": ("performance.md", ("release",)),
    "stretch_scaling.py": ("performance.md", ("stretch",)),
    "against_others.py": ("performance.md", ("others", "rods")),
    "viewer_pages.py": ("performance.md", ("viewer",)),
    "descent_against_newton.py": ("paper.md", ("descent",)),
    "sweep_scaling.py": ("sweeps.md", ("sweep",)),
    "linear_solvers.py": ("decisions/linear-solver.md", ("solvers",)),
    "compensation.py": ("compensation.md", ("stretch", "paper")),
    "stretch_forming.py": ("stretch_forming.md", ("forming", "flow", "lengths", "strokes", "sections")),
}
TINY = {
    "net.py": ("--nodes", "300", "--repeats", "1"),
    "press_scaling.py": ("--only", "dish, D = 150 mm, f/D = 0.42"),
    "stretch_scaling.py": ("--tiny", "--strokes", "3"),
    "against_others.py": ("--tiny", "--seconds", "0.5"),
    "sweep_scaling.py": ("--cases", "6"),
}


Load = Callable[[str], ModuleType]


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Load:
    """Import a script of the benchmarks by its name."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module


def run(script: str, *arguments: str) -> str:
    """What a script prints."""
    command = [sys.executable, str(BENCHMARKS / script), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout


def table_rows(text: str) -> list[list[str]]:
    """The cells of the first table in a text, its head first and its ruler left out."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if not set(line) <= set("|-")]


@pytest.mark.parametrize("script", TINY)
def test_a_tiny_benchmark_writes_its_table(script: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    name = PAGES[script][1][0]
    page.write_text(f"before\n<!-- table: {name} -->\n<!-- end: {name} -->\nafter\n", encoding="utf-8")
    printed = run(script, *TINY[script], "--write", str(page))
    rows = table_rows(printed)
    assert len(rows) > 1
    assert len({len(row) for row in rows}) == 1
    written = page.read_text(encoding="utf-8")
    assert table_rows(written) == rows
    assert written.startswith("before\n")
    assert written.endswith("after\n")


@pytest.mark.parametrize("script", PAGES)
def test_the_page_of_a_benchmark_has_a_place_for_its_tables(script: str) -> None:
    page, names = PAGES[script]
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    source = (BENCHMARKS / script).read_text(encoding="utf-8")
    for name in names:
        assert len(re.findall(rf"<!-- table: {name} -->.*?<!-- end: {name} -->", text, re.DOTALL)) == 1
        assert f"table: {name}" in source or f"`{name}` likewise" in source


@pytest.mark.parametrize("page", ["performance.md", "stretch_forming.md"])
def test_the_prose_about_what_was_measured_states_no_number(page: str) -> None:
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    prose = re.sub(r"<!-- table: (\w+) -->.*?<!-- end: \1 -->", "", text, flags=re.DOTALL)
    prose = re.sub(r"^```.*?^```|Eqs?\. [\d.() and]+|\]\([^)]*\)", "", prose, flags=re.DOTALL | re.MULTILINE)
    assert not re.findall(r"\d+", prose)


def test_every_run_of_stretch_forming_fills_its_rows(load: Load, tmp_path: Path) -> None:
    stretch = load("stretch_forming")
    coarse = stretch.Variant("coarse, clamped", grid={"step": (15.0, 15.0)}, press={"strokes": 4})
    assert stretch.kept(tmp_path, coarse.name) is None
    stretch.keep(tmp_path, coarse.name, stretch.figures(coarse))
    for text in stretch.tables(lambda _: stretch.kept(tmp_path, coarse.name)).values():
        rows = table_rows(text)
        assert len({len(row) for row in rows}) == 1
        assert all(cell for row in rows for cell in row)
    for text in stretch.tables(lambda _: None).values():
        assert not any(table_rows(text)[1][1:])


def test_a_press_is_not_faster_than_its_floor_and_says_what_it_solved() -> None:
    rows = table_rows(run("press_scaling.py", *TINY["press_scaling.py"]))
    row = dict(zip(rows[0], rows[1], strict=True))
    assert int(row["factorisations"]) <= 5
    assert int(row["solved nodes"]) < int(row["crossings"]) < int(row["unknowns"])
    assert float(row["again, over the floor"]) >= 1.0


def test_factorisations_of_a_stroke_do_not_grow_with_the_dish(load: Load) -> None:
    scaling = load("stretch_scaling")
    small, large = (scaling.formed_in(scaling.laid_to_yield(scaling.dish(radius)), 6) for radius in (45.0, 90.0))
    assert large.grid.nodes > 3 * small.grid.nodes
    assert large.whole.plastic_strain.max() > 0.01
    for one in (small, large):
        # None of the strokes had to be halved.
        assert len(one.strokes) == 6
        assert max(stroke.factorisations for stroke in one.strokes) <= 10
    assert large.factorisations <= 1.3 * small.factorisations


def test_an_unknown_case_is_refused() -> None:
    command = [sys.executable, str(BENCHMARKS / "press_scaling.py"), "--row", "dish"]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 2


def test_the_gradient_for_general_minimisers_is_that_of_the_energy_far_from_the_start(load: Load) -> None:
    from punchform.case import PressCase
    from punchform.press import energy_of

    laid = load("dishes").dish_of(60.0, 0.4).laid()
    start = laid.net_start
    energy = energy_of(laid.grid, laid.elements, laid.surface, PressCase(), start=start)
    function = load("one_chart").OneChart(energy, energy.kinematics.chart(start))
    rng = np.random.default_rng(1)
    z, way = 0.2 * rng.standard_normal((2, energy.kinematics.count))
    value, gradient = function(z)
    assert value == pytest.approx(energy.at(function.chart.moved(z)), rel=1e-12)
    h = 1e-4
    slope = (energy.at(function.chart.moved(z + h * way)) - energy.at(function.chart.moved(z - h * way))) / (2 * h)
    assert gradient @ way == pytest.approx(slope, rel=1e-6)


def test_the_steps_that_a_descent_still_needs_are_exact_at_one_rate_and_else_too_few(load: Load) -> None:
    others = load("against_others")
    steps = np.arange(1000)
    one_rate = others.Trace(least=1.0, limit=1.0, steps=steps.tolist(), excess=np.exp(-0.01 * (steps + 1)).tolist())
    assert others.steps_needed(one_rate) == pytest.approx(np.log(1 / others.CLOSE) / 0.01)
    falling = np.exp(-0.01 * (steps + 1)) + 1e-3 * np.exp(-0.001 * (steps + 1))
    true = np.log(1e-3 / others.CLOSE) / 0.001
    two_rates = others.Trace(least=1.0, limit=1.0, steps=steps.tolist(), excess=falling.tolist())
    assert len(steps) < others.steps_needed(two_rates) < true


def test_the_blank_of_a_hemisphere_lands_on_its_equator(load: Load) -> None:
    outline = load("dishes").equator_outline()
    assert np.hypot(*outline.T).max() == pytest.approx(np.pi / 2, abs=1e-3)
    # On the diagonal: the corner of the exact outline of the unit sphere.
    corner = outline[np.argmin(np.abs(outline[:, 0] - outline[:, 1]) + (outline[:, 0] < 0))]
    assert corner == pytest.approx([0.9805, 0.9805], abs=0.03)
