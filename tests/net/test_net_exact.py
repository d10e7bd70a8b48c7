"""The net against nets that are known exactly, Eqs. (6.1)-(6.3), at every scale, and a published one."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from nets import Hidden, edges, rectangle, reference
from scipy.optimize import brentq

from punchform.arrays import Floats
from punchform.net import lay_net
from punchform.punch import Paraboloid, Revolution, Sphere

SCALES = (1e-3, 1.0, 1e4)
REFERENCES: dict[str, tuple[Revolution, tuple[int, Literal["node", "cell"], float], float]] = {
    "net_sphere_R1_chord0.1": (Sphere(1.0), (9, "node", 0.1), 1e-11),
    "net_paraboloid_f0.5_chord0.05": (Paraboloid(0.5), (18, "cell", 0.05), 1e-11),
    "kindrape_hemisphere_R1_d0.075": (Sphere(1.0), (12, "cell", 0.075), 7e-6),
}
"""Surface of size 1; wires to one side, what is on the axis, step; how near the table is to be met."""


def scaled(name: str, scale: float) -> Revolution:
    return Paraboloid(0.5 * scale) if "paraboloid" in name else Sphere(scale)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", REFERENCES)
def test_reference_nets_are_met_at_every_scale(name: str, scale: float) -> None:
    _, (wires, centre, step), allowed = REFERENCES[name]
    grid = rectangle((wires, wires), (step * scale, step * scale), centre=centre)
    net = lay_net(grid, scaled(name, scale))
    table = reference(name)
    known = np.column_stack((table["x"], table["y"], table["z"])) * scale
    assert net.complete
    assert net.notes == ()
    # Both are in the order of (i, j).
    assert np.abs(net.positions - known).max() < allowed * scale
    assert np.abs(edges(grid, net.positions)).max() < 1e-13


def equal_chords(step: float, count: int, focal_length: float) -> Floats:
    """x of nodes along z = -x²/4f at equal chords."""
    x = [0.0]
    for _ in range(count):
        before = x[-1]

        def excess(after: float, before: float = before) -> float:
            return float(np.hypot(after - before, (after**2 - before**2) / (4 * focal_length))) - step

        x.append(brentq(excess, before, before + step, xtol=1e-15, rtol=1e-15))
    return np.array(x)


@pytest.mark.parametrize("hidden", [False, True])
def test_a_paraboloid_is_a_translation_surface_also_with_unequal_steps(hidden: bool) -> None:
    surface, focal_length, steps = Paraboloid(0.5), 0.5, (0.05, 0.031)
    grid = rectangle((14, 20), steps, symmetry="quarter")
    net = lay_net(grid, Hidden(surface) if hidden else surface)
    x = equal_chords(steps[0], 14, focal_length)[grid.index[:, 0]]
    y = equal_chords(steps[1], 20, focal_length)[grid.index[:, 1]]
    exact = np.column_stack((x, y, -(x**2 + y**2) / (4 * focal_length)))
    assert np.abs(net.positions - exact).max() < 1e-14
    corner = net.cells[(grid.index[net.cells[:, 0]] == (13, 19)).all(axis=1)][0]
    u, v = x[corner[:2]].mean(), y[corner[1:3]].mean()
    sine = u * v / np.sqrt((4 * focal_length**2 + u**2) * (4 * focal_length**2 + v**2))
    # Chords of a parabola have the slope of its tangent at their middle: Eq. (6.2) holds for the cells themselves.
    assert np.sin(net.shear[(net.cells == corner).all(axis=1)][0]) == pytest.approx(sine, rel=1e-12)


@pytest.mark.parametrize("hidden", [False, True])
def test_on_a_sphere_opposite_nodes_of_a_cell_are_mirror_images(hidden: bool) -> None:
    surface, step, count = Sphere(2.0), 0.11, 11
    grid = rectangle((count, count), (step, step), symmetry="quarter")
    net = lay_net(grid, Hidden(surface) if hidden else surface)
    exact = np.empty((count + 1, count + 1, 3))
    angle = 2 * np.arcsin(step / 4.0) * np.arange(count + 1)
    exact[:, 0] = 2.0 * np.column_stack((np.sin(angle), 0 * angle, np.cos(angle)))
    exact[0] = exact[:, 0][:, [1, 0, 2]]
    for i in range(count):
        for j in range(count):
            plane = np.cross(exact[i + 1, j], exact[i, j + 1])
            plane /= np.linalg.norm(plane)
            exact[i + 1, j + 1] = exact[i, j] - 2 * (exact[i, j] @ plane) * plane
    assert np.abs(net.positions - exact[tuple(grid.index.T)]).max() < 1e-13
    assert np.abs(edges(grid, net.positions)).max() < 1e-13


@pytest.mark.parametrize("centre", ["node", "cell"])
def test_mirror_images_are_exact(centre: Literal["node", "cell"]) -> None:
    grid = rectangle((9, 7), (0.1, 0.12), centre=centre)
    net = lay_net(grid, Sphere(1.3))
    # The last node is the image of the first, the last but one of the second, by the half turn.
    assert np.array_equal(net.positions[::-1], net.positions * (-1.0, -1.0, 1.0))
    number = {tuple(index): n for n, index in enumerate(grid.index.tolist())}
    other = [number[-i - (centre == "cell"), j] for i, j in grid.index.tolist()]
    assert np.array_equal(net.positions[other], net.positions * (-1.0, 1.0, 1.0))
    assert net.shear.sum() == pytest.approx(0.0, abs=1e-12)


def test_the_quarter_is_a_quarter_of_the_whole() -> None:
    whole, quarter = (rectangle((9, 9), (0.1, 0.1), symmetry=symmetry) for symmetry in ("full", "quarter"))
    of_whole, of_quarter = lay_net(whole, Sphere(1.0)), lay_net(quarter, Sphere(1.0))
    assert np.array_equal(of_whole.positions[(whole.index >= 0).all(axis=1)], of_quarter.positions)
    first = (whole.index[of_whole.cells[:, 0]] >= 0).all(axis=1)
    assert np.array_equal(of_whole.shear[first], of_quarter.shear)
