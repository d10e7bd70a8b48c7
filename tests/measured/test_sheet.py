"""The sheet through the nodes is a surface: exact where it must be, third order in between, at unit slope."""

from __future__ import annotations

import numpy as np
import pytest
from measured_clouds import predicted

from punchform.arrays import Floats
from punchform.measured import Sheet, sheet
from punchform.punch import Paraboloid, Sphere


def on_paraboloid(step: float, reach: float = 150.0, focal: float = 250.0) -> tuple[Sheet, Floats]:
    """The sheet of a square grid raised onto a paraboloid, and its flat nodes."""
    count = round(reach / step)
    axis = np.arange(-count, count + 1)
    index = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    flat = step * index.astype(np.float64)
    return sheet(index, flat, np.column_stack((flat, -(flat**2).sum(axis=1) / (4 * focal)))), flat


def test_nodes_lie_on_it() -> None:
    made = sheet(*[getattr(predicted(), name) for name in ("index", "flat", "nodes")])
    value, _ = made.distance_gradient(made.nodes)
    assert np.abs(value).max() < 1e-12
    assert made.covers(made.nodes).all()


def test_distances_to_a_paraboloid_are_of_third_order_in_the_step() -> None:
    rng = np.random.default_rng(1)
    xy = rng.uniform(-120, 120, (400, 2))
    points = np.column_stack((xy, -(xy**2).sum(axis=1) / 1000 + rng.uniform(-5, 5, 400)))
    exact = Paraboloid(250.0).distance(points)
    errors = [np.abs(on_paraboloid(step)[0].distance_gradient(points)[0] - exact).max() for step in (15.0, 7.5)]
    assert errors[1] < 2e-4
    assert np.log2(errors[0] / errors[1]) > 2.5


def test_the_stated_errors_bound_and_explain_what_is_there() -> None:
    made, flat = on_paraboloid(15.0)
    value, _ = made.distance_gradient(np.column_stack((flat + 6, -((flat + 6) ** 2).sum(axis=1) / 1000)))
    inner = np.abs(flat).max(axis=1) < 120
    assert np.abs(value[inner]).max() < 3 * made.own_error[1]
    # The middle of a square cell of bilinear facets sags by s^2/4R with R = 2f at the apex.
    assert made.facet_error[1] == pytest.approx(15**2 / (4 * 500), rel=3e-3)


def test_the_gradient_is_that_of_the_distance() -> None:
    made, _ = on_paraboloid(15.0)
    rng = np.random.default_rng(2)
    points = np.column_stack((rng.uniform(-100, 100, (50, 2)), rng.uniform(-20, 10, 50)))
    _, gradient = made.distance_gradient(points)
    np.testing.assert_allclose(np.linalg.norm(gradient, axis=1), 1.0)
    for axis in np.eye(3):
        ahead, behind = (made.distance_gradient(points + way * 0.01 * axis)[0] for way in (1, -1))
        np.testing.assert_allclose((ahead - behind) / 0.02, gradient @ axis, atol=1e-3)


def test_a_steep_wall_keeps_its_side() -> None:
    angle = np.linspace(-1.35, 1.35, 55)
    index = np.stack(np.meshgrid(np.arange(55), np.arange(9), indexing="ij"), axis=-1).reshape(-1, 2)
    flat = np.column_stack((100 * angle[index[:, 0]], 5.0 * (index[:, 1] - 4)))
    turn = angle[index[:, 0]]
    tilt = flat[:, 1] / 100
    nodes = 100 * np.column_stack((np.sin(turn) * np.cos(tilt), np.sin(tilt), np.cos(turn) * np.cos(tilt)))
    made = sheet(index, flat, nodes)
    points = np.vstack((nodes * 1.02, nodes * 0.97))
    np.testing.assert_allclose(made.distance_gradient(points)[0], Sphere(100.0).distance(points), atol=5e-3)


def test_it_ends_where_the_grid_ends() -> None:
    made, _ = on_paraboloid(15.0)
    beside = np.array([[155.0, 0.0, -24.0], [175.0, 0.0, -30.6], [0.0, 0.0, 30.0]])
    assert made.covers(beside).tolist() == [True, False, True]
