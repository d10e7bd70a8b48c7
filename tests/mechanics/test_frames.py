"""Frames: how they turn, Eq. (4.1), and the directions across them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from punchform.arrays import Floats
from punchform.mechanics.frames import State, basis, crossing_angle, is_finite, squared, turn, turned, unit

COUNT = 40


def random_frames(seed: int = 0) -> State:
    """Nodes with random frames whose wires cross at any angle."""
    rng = np.random.default_rng(seed)
    frames = Rotation.random(COUNT, random_state=rng).as_matrix()
    shear = rng.uniform(-1.0, 1.0, COUNT)[:, None]
    second = np.cos(shear) * frames[:, 1] + np.sin(shear) * frames[:, 0]
    return State(rng.standard_normal((COUNT, 3)), frames[:, 2], np.stack((frames[:, 0], second), axis=1))


def frame_of(state: State, wire: int) -> Floats:
    """The frame that a wire carries: t, n × t and n as rows, (N, 3, 3)."""
    t, n = state.tangents[:, wire], state.normals
    return np.stack((t, np.cross(n, t), n), axis=1)


def steps(state: State, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Random tilts across the normals (N, 3) and spins (N, 2)."""
    tilt = np.einsum("nca,na->nc", basis(state.normals), rng.uniform(-1.0, 1.0, (COUNT, 2)))
    return tilt, rng.uniform(-1.0, 1.0, (COUNT, 2))


def test_turned_is_the_rotation_by_the_vector() -> None:
    rng = np.random.default_rng(1)
    vectors, rotations = rng.standard_normal((2, COUNT, 3))
    rotations[0] = 0.0
    rotations[1] *= 1e-9
    expected = Rotation.from_rotvec(rotations).apply(vectors)
    np.testing.assert_allclose(turned(vectors, rotations), expected, rtol=0, atol=1e-14)


def test_a_turn_keeps_the_frames_orthonormal() -> None:
    state = random_frames()
    rng = np.random.default_rng(2)
    for _ in range(200):
        state = turn(state, state.positions, *steps(state, rng))
    for wire in range(2):
        frame = frame_of(state, wire)
        np.testing.assert_allclose(
            frame @ frame.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frame.shape), atol=1e-14
        )


def test_a_turn_is_the_spin_followed_by_the_tilt() -> None:
    state = random_frames()
    tilt, spin = steps(state, np.random.default_rng(3))
    after = turn(state, state.positions, tilt, spin)
    for wire in range(2):
        about = Rotation.from_rotvec(state.normals * spin[:, wire, None])
        both = (Rotation.from_rotvec(tilt) * about).as_matrix()
        expected = frame_of(state, wire) @ both.transpose(0, 2, 1)
        np.testing.assert_allclose(frame_of(after, wire), expected, rtol=0, atol=1e-14)


def test_the_rotation_vector_of_a_turn_is_that_of_the_theory_to_third_order() -> None:
    # Eq. (4.1): tau + s n + s tau x n / 2; halving the step divides what is left over by 8.
    state = random_frames()
    tilt, spin = steps(state, np.random.default_rng(4))
    left = []
    for size in (0.02, 0.01):
        after = turn(state, state.positions, size * tilt, size * spin)
        s = size * spin[:, :1]
        foretold = size * tilt + s * state.normals + 0.5 * s * np.cross(size * tilt, state.normals)
        turning = frame_of(after, 0).transpose(0, 2, 1) @ frame_of(state, 0)
        left.append(np.abs(Rotation.from_matrix(turning).as_rotvec() - foretold).max())
    assert left[1] < 1e-6
    assert left[0] / left[1] == pytest.approx(8.0, rel=0.02)


def test_the_crossing_angle_changes_by_the_difference_of_the_spins_whatever_the_tilt() -> None:
    # Eq. (4.5), exactly and at any size.
    state = random_frames()
    tilt, spin = steps(state, np.random.default_rng(5))
    after = turn(state, state.positions, tilt, spin)
    change = crossing_angle(after) - crossing_angle(state) - (spin[:, 1] - spin[:, 0])
    np.testing.assert_allclose(np.sin(0.5 * change), 0.0, atol=1e-14)


def test_squared_wires_cross_at_right_angles_and_keep_their_bisector() -> None:
    state = random_frames()
    after = squared(state)
    np.testing.assert_allclose(crossing_angle(after), np.pi / 2, rtol=1e-14)
    np.testing.assert_allclose(unit(after.tangents.sum(axis=1)), unit(state.tangents.sum(axis=1)), atol=1e-13)
    np.testing.assert_allclose(after.normals, state.normals, atol=1e-15)


def test_bases_are_orthonormal_and_right_handed() -> None:
    normals = np.concatenate((random_frames().normals, np.eye(3), -np.eye(3)))
    first, second = basis(normals).transpose(2, 0, 1)
    whole = np.stack((first, second, normals), axis=1)
    np.testing.assert_allclose(whole @ whole.transpose(0, 2, 1), np.broadcast_to(np.eye(3), whole.shape), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(whole), 1.0, rtol=1e-14)


def test_on_a_mirror_plane_one_direction_lies_in_it_and_the_other_across() -> None:
    # Which of the two it is decides what `FreeFrames` holds there: in x = 0 the first is across, in y = 0 the second.
    slope = np.linspace(0.0, np.pi / 2, 30)
    nothing = np.zeros_like(slope)
    in_x = basis(np.column_stack((nothing, np.sin(slope), np.cos(slope))))
    np.testing.assert_allclose(in_x[:, :, 0], np.broadcast_to((1.0, 0.0, 0.0), (30, 3)), atol=1e-15)
    np.testing.assert_array_equal(in_x[:, 0, 1], nothing)
    in_y = basis(np.column_stack((np.sin(slope), nothing, np.cos(slope))))
    np.testing.assert_array_equal(in_y[:, 1, 0], nothing)
    np.testing.assert_allclose(np.abs(in_y[:, :, 1]), np.broadcast_to((0.0, 1.0, 0.0), (30, 3)), atol=1e-15)


def test_a_state_with_a_number_that_is_none_is_not_finite() -> None:
    state = random_frames()
    assert is_finite(state)
    broken = state.tangents.copy()
    broken[3, 1, 2] = np.nan
    assert not is_finite(State(state.positions, state.normals, broken))
