"""Rigid motions that the tool leaves free: how many, and that it does not matter by which unknown they are held."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_grids import (
    BLANK,
    DISH,
    PUNCH,
    STEP,
    Cylinder,
    Plane,
    beyond,
    dense,
    differences,
    energy_of,
    free_frames,
    grid,
    pinned,
    random_state,
)

from punchform.mechanics.assembly import Hessian
from punchform.mechanics.differences import Differences
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.rigid import free_motions, unturned
from punchform.punch import Sphere, Surface
from punchform.start import flat_start

SPHERE = Sphere(60.0)


def motions(kinematics: FreeFrames | Differences, *, amount: float = 0.1) -> int:
    state = random_state(kinematics, kinematics.grid, np.random.default_rng(1), amount=amount)
    found = free_motions(kinematics.grid, kinematics, kinematics.chart(state))
    assert len(set(found)) == len(found)
    assert all(0 <= number < kinematics.count for number in found)
    return len(found)


@pytest.mark.parametrize(
    ("surface", "count"),
    [(DISH, 1), (PUNCH, 1), (SPHERE, 3), (Sphere(100.0), 3), (Sphere(300.0), 3), (Plane(), 3), (Cylinder(50.0), 2)],
)
def test_a_whole_grid_moves_as_its_tool_lets_it(surface: Surface, count: int) -> None:
    # About the axis of revolution, about any axis of the sphere, in the plane, along and about the cylinder.
    laid = grid(symmetry="full")
    assert motions(free_frames(laid, surface)) == count
    assert motions(free_frames(laid, surface, welded=True)) == count
    assert motions(differences(laid, surface)) == count
    # In the symmetric start as well, where the motions are combined at their plainest.
    assert motions(free_frames(laid, surface), amount=0.0) == count


def test_without_a_tool_six_motions_are_free() -> None:
    assert motions(free_frames(grid(symmetry="full"), None)) == 6


@pytest.mark.parametrize("surface", [DISH, SPHERE, Plane(), Cylinder(50.0)])
def test_mirror_planes_hold_a_quarter_on_its_tool(surface: Surface) -> None:
    assert motions(free_frames(grid(), surface)) == 0
    assert motions(differences(grid(), surface)) == 0


def test_a_quarter_without_a_tool_may_rise() -> None:
    assert motions(free_frames(grid(), None)) == 1


@pytest.mark.parametrize("surface", [DISH, SPHERE, None])
def test_a_clamp_holds_every_motion(surface: Surface | None) -> None:
    laid = grid(symmetry="full")
    assert motions(free_frames(laid, surface, held=beyond(laid, 2.5 * STEP))) == 0


def test_a_frame_that_cannot_turn_holds_a_motion_about_its_node() -> None:
    """Nodes on an axis do not move when a flat grid turns about it: their frames alone can hold it there."""
    for symmetry, held in (("full", 0), ("quarter", 0), ("full", -3)):
        laid = grid(symmetry=symmetry)
        on = laid.index[:, 0] == held
        state = flat_start(laid, Plane())
        clamped = free_frames(laid, None, held=on)
        assert free_motions(laid, clamped, clamped.chart(state)) == ()
        hinged = replace(free_frames(laid, None), fixed=np.repeat(on[:, None], 3, axis=1))
        # In the quarter the mirror plane is the clamp.
        assert len(free_motions(laid, hinged, hinged.chart(state))) == (1 if symmetry == "full" else 0)


def test_free_motions_are_the_null_space_of_the_stiffness_at_rest() -> None:
    # At an unloaded state the exact Hessian has one zero eigenvalue for each rigid motion; spring crossings leave
    # no mechanism beside them.
    laid = grid(symmetry="full")
    for surface, count in ((Plane(), 3), (None, 6)):
        energy = energy_of(free_frames(laid, surface), crossing=500.0)
        state = flat_start(laid, Plane())
        matrix = dense(energy, energy.model(energy.kinematics.chart(state), Hessian.EXACT).values)
        eigenvalues = np.linalg.eigvalsh(matrix)
        assert (np.abs(eigenvalues) < 1e-10 * eigenvalues[-1]).sum() == count
        held = pinned(energy, state)
        assert held.kinematics.count == energy.kinematics.count - count
        matrix = dense(held, held.model(held.kinematics.chart(state), Hessian.EXACT).values)
        assert np.linalg.eigvalsh(matrix)[0] > 1e-8 * eigenvalues[-1]


@pytest.mark.parametrize("surface", [PUNCH, Sphere(300.0)])
def test_the_answer_does_not_depend_on_the_unknown_that_is_pinned(surface: Surface) -> None:
    laid = grid(BLANK, symmetry="full")
    kinematics = free_frames(laid, surface)
    start = flat_start(laid, surface)
    chosen = free_motions(laid, kinematics, kinematics.chart(start))
    # Another choice: shifts of a node near the diagonal, and of one near an axis where more are needed.
    node, second = (int(np.flatnonzero((laid.index == at).all(axis=1))[0]) for at in ((3, 2), (0, 4)))
    candidates = [int(kinematics.unknowns[2 * n, k]) for n, k in ((node, 1), (node, 0), (second, 0))]
    other = tuple(sorted(candidates[: len(chosen)]))
    assert not set(other) & set(chosen)
    found = []
    for pins in (chosen, other):
        energy = energy_of(replace(kinematics, pins=pins))
        solution = minimise(energy, start)
        assert solution.negative_eigenvalues == 0
        found.append((energy.at(solution.state), energy.elastic(solution.state)[0], solution.state))
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-12)
    np.testing.assert_allclose(found[0][1], found[1][1], rtol=0, atol=1e-8)
    if surface is PUNCH:
        one, two = (unturned(laid, state).positions for *_, state in found)
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-7)


def test_unturned_takes_back_a_turn_about_the_axis_and_nothing_else() -> None:
    laid = grid(symmetry="full")
    state = random_state(free_frames(laid), laid, np.random.default_rng(2))
    straight = unturned(laid, state)
    c, s = np.cos(0.7), np.sin(0.7)
    about = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    again = unturned(laid, State(state.positions @ about, state.normals @ about, state.tangents @ about))
    for mine, theirs in ((again.positions, straight.positions), (again.tangents, straight.tangents)):
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(straight.positions[:, 2], state.positions[:, 2])
    (x, y), (u, v) = laid.flat.T, straight.positions[:, :2].T
    turning = x * v - y * u
    assert abs(turning.sum()) < 1e-10 * np.abs(turning).sum()
