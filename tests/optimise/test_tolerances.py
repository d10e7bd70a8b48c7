"""Scatter: what is drawn, what it may not change, and what the samples say."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tiny_dish
from matplotlib.patches import Rectangle

from punchform.case import Case, case_from_text, varied, write_case
from punchform.case.scattering import Scattered, scattered
from punchform.cli import main
from punchform.errors import InputError
from punchform.grid import lay
from punchform.optimise import sweep as sweep_module
from punchform.optimise.evaluations import Evaluation, Task, designed
from punchform.optimise.tolerances import Tolerances, draws, influence, tolerances, wilson
from punchform.report.figures.tolerances import draw_histogram

SCATTER = """
[scatter]
"wire.diameter" = "2 %"
"grid.step" = "0.05 mm"
"punch.fillet" = { uniform = "0.5 mm" }
"punch.profile.focal_length" = { normal = 0.3 }
"""
CASE = tiny_dish.case(SCATTER)


def linear(task: Task) -> Evaluation:
    """An rms that is linear in three of the four numbers; a thick wire fails."""
    design = designed(CASE, task.changes)
    assert design.case is not None
    wire, step, fillet = design.case.wire.diameter or 0.0, design.case.grid.step[0], design.case.tool.fillet
    if wire > 0.77:
        return Evaluation(design.key, design.changes, failure=f"the wire is {wire:g} mm thick")
    rms = 0.5 + 4.0 * (wire - 0.75) - 2.0 * (step - 10) + 0.01 * ((fillet or 0.0) - 20)
    return Evaluation(design.key, design.changes, {"rms": rms, "clamped": 0.0, "held": 3.0}, 0.1)


def test_the_section_is_read_in_internal_units_and_written_back() -> None:
    assert scattered(CASE) == (
        Scattered("wire.diameter", 0.75, "mm", "normal", 0.015),
        Scattered("grid.step", 10.0, "mm", "normal", 0.05),
        Scattered("punch.fillet", 20.0, "mm", "uniform", 0.5),
        Scattered("punch.profile.focal_length", 60.0, "mm", "normal", 0.3),
    )
    assert case_from_text(write_case(CASE)) == CASE
    assert designed(CASE, {}).key == designed(tiny_dish.case(), {}).key


def test_a_case_without_scatter_or_target_is_told() -> None:
    with pytest.raises(InputError, match="does not say what varies"):
        next(draws(tiny_dish.case(), 3, np.random.default_rng(1)))
    untold = CASE.model_copy(update={"target": None})
    with pytest.raises(InputError, match="target: is missing"):
        next(draws(untold, 3, np.random.default_rng(1)))


def test_draws_have_the_moments_that_are_asked_for() -> None:
    """Eq. (13.52): mean and standard deviation to the error of 4 000 draws, uniform ones within their limits; and the
    first draws of more are the same."""
    n = 4000
    found = list(draws(CASE, n, np.random.default_rng(7)))
    assert list(draws(CASE, 5, np.random.default_rng(7))) == found[:5]
    for one in scattered(CASE):
        values = np.array([changes[one.place] for changes in found])
        sd = one.amount / np.sqrt(3) if one.kind == "uniform" else one.amount
        assert abs(values.mean() - one.nominal) < 4 * sd / np.sqrt(n)
        assert abs(values.std() / sd - 1) < 4 / np.sqrt(2 * n)
        if one.kind == "uniform":
            assert np.abs(values - one.nominal).max() <= one.amount


@pytest.mark.parametrize(
    "blank",
    [
        '{ shape = "circle", radius = "70 mm" }',
        '{ shape = "rectangle", size = ["140 mm", "160 mm"] }',
        '{ shape = "polygon", points = [[-80, -80], [80, -80], [80, 80], [-80, 80]] }',
    ],
)
def test_no_crossing_on_the_outline_comes_or_goes_with_the_step(blank: str) -> None:
    """Eq. (13.53): crossings that lie exactly on the outline of the nominal blank stay in it whatever the step is."""
    case = case_from_text(tiny_dish.TEXT.replace('{ shape = "circle", radius = "70 mm" }', blank) + SCATTER)
    nominal = lay(case.grid, rim_radius=60.0)
    for changes in draws(case, 20, np.random.default_rng(2)):
        grid = varied(case, changes).grid
        assert grid.step[0] == pytest.approx(changes["grid.step"])
        np.testing.assert_array_equal(lay(grid, rim_radius=60.0).index, nominal.index)


def test_wilson_is_the_root_of_its_equation() -> None:
    """Eq. (13.55): at both ends of the interval the seen share is z standard errors away."""
    z = 1.959963984540054
    for k, n in ((0, 10), (3, 10), (10, 10), (145, 200)):
        for p in wilson(k, n):
            assert (k / n - p) ** 2 == pytest.approx(z**2 * p * (1 - p) / n, abs=1e-12)


def test_influences_of_a_linear_law_are_its_coefficients() -> None:
    """Eq. (13.56): y = 3 x1 - 4 x2 of independent numbers of the same spread has the slopes 0.6 and -0.8, and they
    explain all of it; a number without effect has none."""
    x = np.random.default_rng(5).standard_normal((2000, 3))
    x = np.linalg.qr(x - x.mean(axis=0))[0]
    numbers = [Scattered(name, 0.0, "mm", "normal", 1.0) for name in "abc"]
    found, explained = influence(numbers, x, 3 * x[:, 0] - 4 * x[:, 1])
    assert [one.place for one in found] == ["b", "a", "c"]
    assert [one.slope for one in found] == pytest.approx([-0.8, 0.6, 0.0], abs=1e-12)
    assert explained == pytest.approx(1.0)
    assert [one.rank for one in found[:2]] == pytest.approx([-0.8, 0.6], abs=0.03)
    # Ranks see through a bent law.
    bent, linear_part = influence(numbers[:1], x[:, :1], np.exp(200 * x[:, 0]))
    assert bent[0].rank == pytest.approx(1.0)
    assert linear_part is not None
    assert linear_part < 0.9
    assert influence(numbers, x[:3], np.arange(3.0)) == ((), None)
    assert influence(numbers, x, np.ones(2000)) == ((), None)


def test_samples_that_hold_other_crossings_are_told_and_tell_no_slope() -> None:
    nominal = linear(Task("", {}))
    each = [linear(Task("", changes)) for changes in draws(CASE, 60, np.random.default_rng(1))]
    good = [one for one in each if not one.failed]
    jumped = Evaluation("x", good[0].changes, {"rms": 9.0, "clamped": 0.0, "held": 4.0})
    found = tolerances(CASE, nominal, [*each, jumped])
    assert found.held_otherwise == 1
    assert found.explained == pytest.approx(1.0)
    assert found.samples == 61
    assert list(found.failures.values()) == [len(each) - len(good)]
    assert found.within == sum((one.figures["rms"] or 0) <= 0.5 for one in good)


def test_the_command_writes_its_folder_and_goes_on_with_more_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []

    def counted(task: Task) -> Evaluation:
        asked.append(task.changes)
        return linear(task)

    monkeypatch.setattr(sweep_module, "work", counted)
    path, folder = tmp_path / "dish.toml", tmp_path / "out"
    path.write_text(tiny_dish.TEXT + SCATTER, encoding="utf-8")
    call = ["tolerances", str(path), "-o", str(folder), "--workers", "1", "--seed", "4"]
    assert main([*call, "--samples", "60"]) == 0
    said = capsys.readouterr()
    assert "influence 1" in said.out
    assert "wire is 0.77" in said.err or "wire is 0.78" in said.err
    assert len(asked) == 61
    assert main([*call, "--samples", "100", "--json", "--quiet"]) == 0
    assert len(asked) == 101
    result = json.loads(capsys.readouterr().out)
    assert result["samples"] == 100
    assert result["failed"] == sum(result["failures"].values()) > 0
    assert result["yield"] == result["within"] / 100
    assert result["influences"][0]["place"] == "grid.step"
    assert result["explained"] == pytest.approx(1.0)
    assert (folder / "figures" / "histogram.png").stat().st_size > 5000
    assert "grid.step" in (folder / "report.html").read_text("utf-8")
    assert len((folder / "table.csv").read_text("utf-8").splitlines()) == 102
    assert main([*call[:-1], "5", "--samples", "60"]) == 2
    assert "another" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--samples", "3"], "3 samples are asked for"),
        (["--seed", "-1"], "the seed is -1"),
        (["--workers", "0"], "0 workers are asked for"),
        (["--workers", "2", "--scheduler", "tcp://x:1"], "exclude each other"),
    ],
)
def test_bad_arguments_are_told(
    more: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "dish.toml"
    path.write_text(tiny_dish.TEXT + SCATTER, encoding="utf-8")
    assert main(["tolerances", str(path), "-o", str(tmp_path / "out"), *more]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize("tolerance", [0.2, 0.5, 0.8])
def test_the_bars_of_the_histogram_are_the_samples(tolerance: float) -> None:
    """Every sample is in a bar, and those beyond the tolerance in bars of the other colour."""
    values = np.random.default_rng(3).normal(0.5, 0.1, 150)
    found = Tolerances(0.5, values, 150, tolerance, int((values <= tolerance).sum()), 0.0, 1.0, (), None, {}, 0)
    bars: dict[Any, float] = {}
    for bar in draw_histogram(found).axes[0].patches:
        assert isinstance(bar, Rectangle)
        bars[bar.get_facecolor()] = bars.get(bar.get_facecolor(), 0.0) + bar.get_height()
    wanted = (found.within, 150 - found.within)
    assert sorted(count for count in bars.values() if count) == sorted(count for count in wanted if count)


def test_all_samples_failing_is_told() -> None:
    failed = [Evaluation(str(k), {}, failure=f"blank of {k} mm") for k in range(12)]
    with pytest.raises(
        InputError, match=r"only 0 of 12 samples have an rms; 10 are needed\. Most failed like this: blank"
    ):
        tolerances(CASE, failed[0], failed)


def test_the_nominal_case_is_the_case() -> None:
    assert isinstance(CASE, Case)
    assert designed(CASE, {}).case == CASE
