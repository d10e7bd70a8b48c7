"""What flat cells add between perfect nodes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from perfect_dishes import dish, net

from punchform.accuracy import facets, square_cell, triangle_sigma


def test_bilinear_cells_cut_below_the_dome_as_published() -> None:
    """T8: mean p²/6R towards the focus, rms about it 0.0527 p²/R, sag p²/4R; here R = 2f near the axis."""
    step, focal_length = 7.5, 300.0
    points, cells = net(step, focal_length, reach=30.0)
    closed = square_cell(step, 2 * focal_length)
    found = facets(points, cells, dish(focal_length))
    assert found is not None
    assert found.mean == pytest.approx(closed.mean, rel=5e-3)
    assert found.sigma == pytest.approx(closed.sigma, rel=5e-3)
    assert found.largest == pytest.approx(closed.largest, rel=5e-3)
    assert (-closed.mean, closed.sigma, closed.largest) == pytest.approx((0.0156, 0.0049, 0.0234), abs=5e-5)
    assert closed.sigma == pytest.approx(0.0527 * step**2 / 600, rel=1e-3)


def test_flat_triangles_deviate_as_published() -> None:
    """T8: equilateral facets of side l on a dome of focal length F, 0.01614 l²/F."""
    side, focal_length = 7.0, 300.0
    corners = side / math.sqrt(3) * np.array([[math.cos(a), math.sin(a)] for a in 2 * math.pi * np.arange(3) / 3])
    points = np.column_stack((corners, np.zeros(3)))
    found = facets(points, np.array([[0, 1, 2, 2]]), dish(focal_length))
    assert found is not None
    assert found.sigma == pytest.approx(triangle_sigma(side, 2 * focal_length), rel=1e-3)
    assert triangle_sigma(side, 2 * focal_length) == pytest.approx(0.01614 * side**2 / focal_length, rel=1e-3)


def test_facets_do_not_feel_errors_of_the_nodes() -> None:
    points, cells = net(20.0)
    target = dish()
    bumpy = points + np.random.default_rng(5).normal(scale=0.01, size=(len(points), 1)) * [0.0, 0.0, 1.0]
    clean, found = facets(points, cells, target), facets(bumpy, cells, target)
    assert clean is not None
    assert found is not None
    assert found.mean == pytest.approx(clean.mean, rel=1e-3)
    assert facets(np.full((4, 3), math.nan), np.array([[0, 1, 2, 3]]), target) is None
