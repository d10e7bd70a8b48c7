"""The net on the sphere tends to the continuum limit, Eq. (6.4), at the second order, and collapses where it does."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from nets import Hidden, rectangle, reference
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from punchform.arrays import Floats
from punchform.net import Net, lay_net, outline
from punchform.punch import Paraboloid, Sphere

COLLAPSE = 1.86159168
STEPS = (0.05, 0.025, 0.0125)


def omega(p: Floats) -> Floats:
    """The angle between the threads at p = u v / R², by the series at p = 0 and an integration from there."""

    def change(p: float, y: Floats) -> list[float]:
        return [y[1], -(y[1] + np.sin(y[0])) / p]

    small = 1e-8
    solved = solve_ivp(
        change, (small, 1.87), (np.pi / 2 - small, -1.0), method="DOP853", rtol=1e-12, atol=1e-13, dense_output=True
    )
    return np.asarray(solved.sol(p)[0])


def order(errors: list[float]) -> list[float]:
    return [float(np.log2(coarse / fine)) for coarse, fine in pairwise(errors)]


def test_the_limit_used_here_is_that_of_the_table() -> None:
    table = reference("sphere_omega_of_uv")
    p = table["s=uv/R^2"][1:]
    assert np.abs(np.degrees(omega(p)) - table["omega_deg"][1:]).max() < 1e-6
    assert omega(np.array([COLLAPSE]))[0] == pytest.approx(0.0, abs=1e-8)


def test_shear_tends_to_the_continuum_at_second_order() -> None:
    errors = []
    for step in STEPS:
        grid = rectangle((round(0.9 / step),) * 2, (step, step), symmetry="quarter")
        net = lay_net(grid, Sphere(1.0))
        middle = grid.flat[net.cells].mean(axis=1)
        errors.append(float(np.abs(net.shear - (np.pi / 2 - omega(middle.prod(axis=1)))).max()))
    assert all(1.8 < rate < 2.2 for rate in order(errors)), (errors, order(errors))


def test_the_diagonal_reaches_its_colatitudes_at_second_order() -> None:
    table = reference("sphere_diagonal_shear")
    flat = np.concatenate(([0.0], table["u_eq_v_over_R"]))
    colatitude = CubicSpline(flat, np.concatenate(([0.0], np.radians(table["colatitude_deg"]))))
    errors = []
    for step in STEPS:
        grid = rectangle((round(0.9 / step),) * 2, (step, step), symmetry="quarter")
        net = lay_net(grid, Sphere(1.0))
        diagonal = grid.index[:, 0] == grid.index[:, 1]
        reached = np.arccos(net.positions[diagonal, 2])
        errors.append(float(np.abs(reached - colatitude(grid.flat[diagonal, 0])).max()))
    assert all(1.8 < rate < 2.2 for rate in order(errors)), (errors, order(errors))


def test_the_flat_outline_that_lands_on_the_equator_at_second_order() -> None:
    table = np.column_stack(list(reference("sphere_equator_outline").values()))
    directions = np.arctan2(table[:, 1], table[:, 0])
    errors = []
    for step in STEPS:
        grid = rectangle((round(1.7 / step),) * 2, (step, step))
        net = lay_net(grid, Sphere(1.0))
        found = outline(grid.index, grid.flat, -net.positions[:, 2], directions)
        errors.append(float(np.abs(found - table).max()))
    assert errors[-1] < 3e-4
    assert all(1.6 < rate < 2.4 for rate in order(errors)), (errors, order(errors))


def test_the_flat_outline_that_lands_on_the_edge_of_a_dish_at_second_order() -> None:
    """On the translation net of a paraboloid the flat coordinates are the arcs of x and y, Eq. (6.1)."""
    focal_length, edge = 0.5, 0.6
    angle = np.linspace(0.0, 0.5 * np.pi, 9)
    x = edge * np.column_stack((np.cos(angle), np.sin(angle)))
    slope = x / (2 * focal_length)
    exact = 0.5 * x * np.sqrt(1 + slope**2) + focal_length * np.arcsinh(slope)
    errors = []
    for step in STEPS:
        grid = rectangle((round(0.8 / step),) * 2, (step, step))
        net = lay_net(grid, Paraboloid(focal_length))
        level = np.hypot(*net.positions[:, :2].T) - edge
        found = outline(grid.index, grid.flat, level, np.arctan2(exact[:, 1], exact[:, 0]))
        errors.append(float(np.sqrt(np.square(found - exact).mean())))
    assert errors[-1] < 1e-4
    assert all(1.5 < rate < 2.5 for rate in order(errors)), (errors, order(errors))


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("step", [0.06, 0.03])
def test_the_collapse_is_found_within_a_step(step: float, hidden: bool) -> None:
    count = round(1.65 / step)
    grid = rectangle((count, count), (step, step), symmetry="quarter")
    net = lay_net(grid, Hidden(Sphere(1.0)) if hidden else Sphere(1.0))
    table = np.zeros((count + 1, count + 1), dtype=bool)
    table[tuple(grid.index.T)] = net.reached
    for i in range(round(1.2 / step), count + 1):
        last = np.flatnonzero(table[i])[-1]
        # The hyperbola u v = 1.8616 R² passes within a step of the last node reached, along both wires.
        u = i * step
        assert abs(last * step - COLLAPSE / u) <= step * max(1.0, COLLAPSE / u**2)
        assert not table[i, last + 1 :].any()
    says_where(net)


def says_where(net: Net) -> None:
    assert not net.complete
    assert np.isnan(net.positions[~net.reached]).all()
    assert np.isfinite(net.positions[net.reached]).all()
    assert np.isnan(net.shear[~net.reached[net.cells].all(axis=1)]).all()
    (note,) = [note for note in net.notes if note.startswith("the net ends")]
    assert f"{(~net.reached).sum()} of {len(net.reached)} nodes" in note
    assert "wires would lie over one another" in note
    assert "cut the blank" in note
