"""The net as a start of the press: normals of the surface and tangents along the wires."""

from __future__ import annotations

import numpy as np
import pytest
from nets import Hidden, rectangle

from punchform.arrays import Floats
from punchform.net import NetStart, start_state
from punchform.punch import Paraboloid, Sphere

FOCAL = 0.5


def assert_frames(start: NetStart) -> None:
    """Unit vectors, tangents across the normals, and (first, second, normal) right-handed."""
    first, second = start.tangents[:, 0], start.tangents[:, 1]
    for vectors in (start.normals, first, second):
        assert np.abs(np.linalg.norm(vectors, axis=1) - 1).max() < 1e-14
    for tangent in (first, second):
        assert np.abs(np.sum(tangent * start.normals, axis=1)).max() < 1e-14
    assert (np.sum(np.cross(first, second) * start.normals, axis=1) > 0).all()


def exact_tangents(x: Floats) -> Floats:
    """On the paraboloid, a translation surface, the wires lie in planes: tangents (N, 2, 3)."""
    one, zero = np.ones(len(x)), np.zeros(len(x))
    along_x = np.column_stack((one, zero, -x[:, 0] / (2 * FOCAL)))
    along_y = np.column_stack((zero, one, -x[:, 1] / (2 * FOCAL)))
    tangents = np.stack((along_x, along_y), axis=1)
    return np.asarray(tangents / np.linalg.norm(tangents, axis=2, keepdims=True))


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_tangents_tend_to_those_of_the_wires_at_second_order_up_to_their_ends(symmetry: str) -> None:
    errors = []
    for step in (0.05, 0.025):
        grid = rectangle((round(0.4 / step),) * 2, (step, step), symmetry=symmetry)  # type: ignore[arg-type]
        start = start_state(grid, Paraboloid(FOCAL))
        assert_frames(start)
        errors.append(float(np.abs(start.tangents - exact_tangents(start.positions)).max()))
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] > 3.4


def test_wires_in_a_mirror_plane_stay_in_it() -> None:
    grid = rectangle((8, 8), (0.1, 0.1), symmetry="quarter")
    start = start_state(grid, Sphere(1.0))
    on_x, on_y = grid.on_mirror.T
    assert np.abs(start.tangents[on_y, 0, 1]).max() == 0.0
    assert np.abs(start.tangents[on_x, 1, 0]).max() == 0.0
    # A wire crosses a mirror plane at a right angle.
    assert np.abs(start.tangents[on_x, 0] - (1.0, 0.0, 0.0)).max() < 1e-15
    assert np.abs(start.tangents[on_y, 1] - (0.0, 1.0, 0.0)).max() < 1e-15


def test_any_surface_gives_the_same_frames() -> None:
    grid = rectangle((6, 6), (0.1, 0.1))
    fast, slow = start_state(grid, Sphere(1.0)), start_state(grid, Hidden(Sphere(1.0)))
    assert np.abs(fast.tangents - slow.tangents).max() < 1e-12
    assert np.abs(fast.normals - slow.normals).max() < 1e-12


def test_a_node_that_one_wire_passes_gets_a_tangent_across_it() -> None:
    from punchform.case import GridCase, PolygonBlank
    from punchform.grid import lay

    # A plus: the ends of its arms are single wires.
    corners = ((-0.5, -0.05), (-0.05, -0.05), (-0.05, -0.5), (0.05, -0.5), (0.05, -0.05), (0.5, -0.05))
    points = (*corners, *((-x, -y) for x, y in corners))
    blank = PolygonBlank(points=points)
    grid = lay(GridCase(step=(0.1, 0.1), weave="same", blank=blank, symmetry="full"))
    assert not grid.passes.all()
    assert_frames(start_state(grid, Sphere(1.0)))


def test_what_the_net_does_not_reach_has_no_frame() -> None:
    grid = rectangle((32, 32), (0.05, 0.05), symmetry="quarter")
    start = start_state(grid, Sphere(1.0))
    reached = start.net.reached
    assert not start.net.complete
    assert np.isnan(start.tangents[~reached]).all()
    assert np.isnan(start.normals[~reached]).all()
    assert np.isfinite(start.tangents[reached]).all()
