"""What `punchform element` says and draws."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from punchform.wire import (
    Element,
    along,
    cosine_line,
    describe,
    given,
    paper,
    plot_element,
    round_section,
    straight_line,
    straight_wire,
)
from punchform.wire.element_plot import drawn_line, enlargement
from punchform.wire.element_report import Axes

STEEL = round_section(0.75, youngs_modulus=210e3, poisson=0.25, shear_factor=0.9)
WOVEN = along(cosine_line(0.75, 7.5, segments=64), STEEL)
STRAIGHT = along(straight_line(7.5), STEEL, height=0.75)
PRINTED = given(paper.to_element_axes(np.array(paper.TABLE_1)), height=0.75, length=7.5)


def test_words_and_numbers() -> None:
    text = describe(PRINTED).text()
    assert "stiffness given as a matrix" in text
    assert "pulling the wire straight" in text
    assert " 11810 N/mm" in text
    assert "positive definite    yes" in text
    assert max(len(line) for line in text.splitlines()) <= 96


def test_a_straight_wire_compares_with_itself() -> None:
    for each in describe(STRAIGHT).principal:
        assert each.held_ratio == pytest.approx(1)
        assert each.free_ratio == pytest.approx(1)
    assert "of a straight wire's" in describe(STRAIGHT).text()
    assert "of a straight wire's" not in describe(PRINTED).text()


def test_an_end_that_is_free_is_never_stiffer_than_one_that_is_held() -> None:
    for each in describe(WOVEN).principal:
        assert each.free <= each.held * (1 + 1e-12)


def test_paper_axes_give_back_the_print() -> None:
    report = describe(PRINTED, axes="paper")
    table = np.array(paper.TABLE_1)
    np.testing.assert_allclose(report.C, 0.5 * (table + table.T), rtol=1e-13)
    assert report.units["C"] == "N/m, N, N m"
    assert "1.181e+07" in report.text()


@pytest.mark.parametrize("axes", ["element", "paper"])
def test_json(axes: Axes) -> None:
    report = describe(WOVEN, axes=axes)
    record = json.loads(json.dumps(report.json_ready(), allow_nan=False))
    assert record["axes"] == axes
    np.testing.assert_allclose(np.array(record["C"]) @ np.array(record["B"]), np.eye(6), atol=1e-7)
    assert record["checks"]["positive_definite"] is True
    assert record["checks"]["inverse_error"] < 1e-12
    assert record["units"]["B"].startswith("mm/N" if axes == "element" else "m/N")
    assert len(record["principal"]) == 6


def test_a_wire_without_a_line_is_drawn_as_the_elastic_line_between_its_ends() -> None:
    """Exact for a straight wire without shear: its elastic line under end loads is a cubic."""
    slender = replace(STEEL, kappa_GA=1e12)
    _, wanted = drawn_line(along(straight_line(7.5), slender))
    line, motions = drawn_line(given(straight_wire(7.5, slender), height=0.0, length=7.5))
    every = np.linspace(0, 1, len(line)), np.linspace(0, 1, len(wanted))
    common = np.flatnonzero(np.isin(every[0], every[1]))
    there = np.flatnonzero(np.isin(every[1], every[0]))
    assert len(common) > 5
    np.testing.assert_allclose(motions[common, :3], wanted[there, :3], atol=1e-9)


@pytest.mark.parametrize("load", range(6))
def test_enlargement_keeps_the_picture_in_its_frame(load: int) -> None:
    line, motions = drawn_line(WOVEN)
    motion = motions[:, :, load]
    scale = enlargement(line, motion)
    moved = scale * np.linalg.norm(motion[:, :3], axis=1).max()
    turned = scale * np.linalg.norm(motion[:, 3:], axis=1).max()
    assert moved <= 1.5
    assert turned <= np.pi / 2
    assert moved > 0.6 or turned > np.pi / 5


@pytest.mark.parametrize("element", [WOVEN, STRAIGHT, PRINTED], ids=["woven", "straight", "matrix"])
def test_plot(element: Element, tmp_path: Path) -> None:
    path = tmp_path / "element.png"
    plot_element(element, path)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert path.stat().st_size > 30_000


def test_the_wire_room_loads_no_plotting() -> None:
    code = "import sys, punchform.wire; print({'matplotlib', 'scipy', 'pydantic'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
