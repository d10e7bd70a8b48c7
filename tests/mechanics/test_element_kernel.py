"""The kernel of one element against the formulas of Eqs. (3.1)-(3.4), written out a second time with NumPy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from punchform.arrays import Floats
from punchform.mechanics import element, sweeps
from punchform.testing import slope_and_curvature

STEP = 7.5


@dataclass(frozen=True)
class Wire:
    """One element in space: frames (3, 3) at O and B with tangent and normal as rows 0 and 2, wire along +."""

    x_o: Floats
    x_b: Floats
    frame_o: Floats
    frame_b: Floats
    sigma: float
    e: float
    direction: float

    def modes(self) -> Floats:
        """D of Eqs. (3.1) and (3.2)."""
        t, n = self.direction * self.frame_o[0], self.frame_o[2]
        t_b, n_b = self.direction * self.frame_b[0], self.frame_b[2]
        j = np.cross(n, t)
        d = self.x_b - self.x_o + self.sigma * self.e * n_b
        s = self.sigma
        return np.array([d @ t - STEP, d @ j, s * (d @ n) - self.e, -s * (n_b @ j), -s * (t_b @ n), t_b @ j])

    def moved(self, z: Floats) -> Wire:
        """The element after the motion z = (a, w_O, b, w_B), its frames turned by exact rotations."""
        a, w_o, b, w_b = z.reshape(4, 3)
        return replace(
            self,
            x_o=self.x_o + a,
            x_b=self.x_b + b,
            frame_o=Rotation.from_rotvec(w_o).apply(self.frame_o),
            frame_b=Rotation.from_rotvec(w_b).apply(self.frame_b),
        )

    def vectors(self) -> tuple[tuple[float, float, float], ...]:
        """d, t, j, n, n_B, t_B as the kernels take them, by the kernel of Eq. (3.1)."""
        return element.wire_ends(*self.arrays(), np.array([self.sigma]), self.e, 0)  # type: ignore[no-any-return]

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Positions, normals, tangents, family, start, end, direction of a grid of this element alone."""
        return (
            np.array([self.x_o, self.x_b]),
            np.array([self.frame_o[2], self.frame_b[2]]),
            np.array([self.frame_o[0], self.frame_o[1], self.frame_b[0], self.frame_b[1]]),
            *(np.array([0]), np.array([0]), np.array([1])),
            np.array([self.direction]),
        )


def random_wire(rng: np.random.Generator, sigma: float, e: float, direction: float) -> Wire:
    """An element far from its unloaded state."""
    frame_o, frame_b = Rotation.random(2, random_state=rng).as_matrix()
    x_o = 100 * rng.standard_normal(3)
    return Wire(x_o, x_o + STEP * rng.standard_normal(3), frame_o, frame_b, sigma, e, direction)


any_wire = {
    "seed": st.integers(0, 2**32 - 1),
    "sigma": st.sampled_from((1.0, -1.0)),
    "e": st.floats(0.0, 2.0),
    "direction": st.sampled_from((1.0, -1.0)),
}


@settings(max_examples=50, deadline=None)
@given(**any_wire)
def test_modes_are_those_of_the_theory(seed: int, sigma: float, e: float, direction: float) -> None:
    wire = random_wire(np.random.default_rng(seed), sigma, e, direction)
    D = np.empty(6)
    element.modes(*wire.vectors(), sigma, e, STEP, D)
    np.testing.assert_allclose(D, wire.modes(), rtol=0, atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(**any_wire)
def test_rates_are_the_first_derivatives_of_the_modes(seed: int, sigma: float, e: float, direction: float) -> None:
    rng = np.random.default_rng(seed)
    wire = random_wire(rng, sigma, e, direction)
    z = rng.standard_normal(12)
    slope, _ = slope_and_curvature(lambda h: wire.moved(h * z).modes(), 0.2)
    J = np.empty((6, 12))
    element.mode_rates(*wire.vectors(), sigma, e, J)
    np.testing.assert_allclose(J @ z, slope, rtol=0, atol=1e-9 * np.abs(J).max())


@settings(max_examples=50, deadline=None)
@given(**any_wire)
def test_second_order_terms_are_the_second_derivatives_weighed_by_the_force(
    seed: int, sigma: float, e: float, direction: float
) -> None:
    rng = np.random.default_rng(seed)
    wire = random_wire(rng, sigma, e, direction)
    F, z = rng.standard_normal(6), rng.standard_normal(12)
    _, curvature = slope_and_curvature(lambda h: F @ wire.moved(h * z).modes(), 0.2)
    K = np.empty((12, 12))
    vectors = wire.vectors()
    element.second_order(*vectors[1:], element.loads(*vectors, sigma, e, F), K)
    np.testing.assert_allclose(K, K.T, rtol=0, atol=1e-13 * np.abs(K).max())
    assert z @ K @ z == pytest.approx(curvature, abs=1e-8 * np.abs(K).max())


@settings(max_examples=50, deadline=None)
@given(**any_wire)
def test_the_gradient_is_the_force_on_the_rates(seed: int, sigma: float, e: float, direction: float) -> None:
    rng = np.random.default_rng(seed)
    wire = random_wire(rng, sigma, e, direction)
    F, G, J = rng.standard_normal(6), np.empty(12), np.empty((6, 12))
    vectors = wire.vectors()
    element.gradient(*vectors[1:], element.loads(*vectors, sigma, e, F), G)
    element.mode_rates(*vectors, sigma, e, J)
    np.testing.assert_allclose(G, F @ J, rtol=0, atol=1e-12 * np.abs(J).max())


def test_force_and_energy_are_those_of_the_stiffness() -> None:
    rng = np.random.default_rng(0)
    root = rng.standard_normal((6, 6))
    C, D, F = root @ root.T, rng.standard_normal(6), np.empty(6)
    assert element.end_force(C, D, F) == pytest.approx(0.5 * D @ C @ D, rel=1e-13)
    np.testing.assert_allclose(F, C @ D, rtol=1e-13)


def test_a_sweep_reads_family_direction_and_sign_of_its_own_element() -> None:
    # Two elements on two nodes, one of each family, the second from B to O.
    rng = np.random.default_rng(1)
    wire = random_wire(rng, 1.0, 0.4, 1.0)
    positions, normals, tangents, *_ = wire.arrays()
    roots = rng.standard_normal((2, 6, 6))
    C = roots @ roots.transpose(0, 2, 1)
    offset, sigma, direction = np.array([0.4, 0.3]), np.array([1.0, -1.0]), np.array([1.0, -1.0])
    family, start, end = np.array([0, 1]), np.array([0, 1]), np.array([1, 0])
    D, F, energies = np.empty((2, 6)), np.empty((2, 6)), np.empty(2)
    common = (positions, normals, tangents, family, family, start, end, direction, sigma, np.ones(2))
    sweeps.states(*common, C, offset, np.array([STEP, STEP]), offset, False, np.zeros((1, 10)), D, F, energies)
    second = Wire(wire.x_b, wire.x_o, wire.frame_b[[1, 0, 2]], wire.frame_o[[1, 0, 2]], -1.0, 0.3, -1.0)
    for m, one in enumerate((wire, second)):
        expected = one.modes()
        np.testing.assert_allclose(D[m], expected, rtol=0, atol=1e-12)
        np.testing.assert_allclose(F[m], C[m] @ expected, rtol=1e-12)
        assert energies[m] == pytest.approx(0.5 * expected @ C[m] @ expected, rel=1e-12)
    again = np.empty(2)
    sweeps.energies(*common, C, offset, np.array([STEP, STEP]), offset, False, np.zeros((1, 10)), again)
    np.testing.assert_array_equal(again, energies)


def test_a_mirrored_element_turns_the_other_way() -> None:
    # D2, D4 and D6 change sign in a mirror that holds the wire and the normal; n and t are vectors, j an axial one.
    wire = random_wire(np.random.default_rng(2), -1.0, 0.4, 1.0)
    mirror = np.diag([1.0, -1.0, 1.0])
    image = Wire(wire.x_o @ mirror, wire.x_b @ mirror, wire.frame_o @ mirror, wire.frame_b @ mirror, -1.0, 0.4, 1.0)
    np.testing.assert_allclose(image.modes(), wire.modes() * (1, -1, 1, -1, 1, -1), rtol=0, atol=1e-12)


def test_a_bent_straight_wire_seems_to_shorten_as_the_theory_says() -> None:
    # Eq. (3.5): D1 = sin(kappa s)/kappa - s, D5 = sin(kappa s) for bending away from the normal and sigma = 1.
    for bend in (0.015, 0.25):
        frame_b = Rotation.from_rotvec((0.0, bend, 0.0)).apply(np.eye(3))
        x_b = STEP / bend * np.array([np.sin(bend), 0.0, np.cos(bend) - 1])
        D = Wire(np.zeros(3), x_b, np.eye(3), frame_b, 1.0, 0.0, 1.0).modes()
        assert D[0] == pytest.approx(STEP * (np.sin(bend) / bend - 1), rel=1e-10)
        assert D[0] / STEP == pytest.approx(-(bend**2) / 6, rel=bend**2)
        assert D[4] == pytest.approx(np.sin(bend), rel=1e-12)
