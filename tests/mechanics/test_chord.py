"""The element seen from its chord: Eqs. (3.10)-(3.14), written out a second time with NumPy, and what they promise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from small_grids import STEP, Plane, bars, beyond, dead, differences, energy_of, free_frames, grid, random_state, wires

from punchform.arrays import Floats
from punchform.mechanics import chord, element, sweeps
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Bars
from punchform.punch import Sphere
from punchform.start import flat_start
from punchform.testing import assert_derivatives, assert_rigid_invariance, slope_and_curvature
from punchform.wire import Element, Section, along, straight_line

HEIGHT = 2.0


def stacked() -> Element:
    """A straight wire with EI = 1000 N mm²."""
    return along(straight_line(STEP), Section(1.0, 1e5, 1e3, 800.0, np.inf))


@dataclass(frozen=True)
class Wire:
    """One element in space: frames (3, 3) at O and B with tangent, across and normal as rows, wire along +."""

    x_o: Floats
    x_b: Floats
    frame_o: Floats
    frame_b: Floats
    sigma: float = 1.0
    e: float = 0.0
    h: float = 0.0

    def measures(self, rest: Floats) -> Floats:
        """L of Eqs. (3.10)-(3.12), by rotations; counted from those at rest, and so the bow, Eq. (12.14)."""
        n_o, n_b = self.sigma * self.frame_o[2], self.sigma * self.frame_b[2]
        c = self.x_b + self.e * n_b - self.x_o - (self.e - self.h) * n_o
        lean = np.arctan2(self.h, STEP)
        free = np.hypot(STEP, self.h)
        along_it, up = np.array([np.cos(lean), np.sin(lean)]), np.array([-np.sin(lean), np.cos(lean)])
        frames = ((self.frame_o, n_o), (self.frame_b, n_b))
        axes = [np.array((along_it @ (f[0], n), up @ (f[0], n), np.cross(f[2], f[0]))) for f, n in frames]
        one, two = (bent(u @ c) for u in axes)
        twist = 0.5 * (axes[1][2] @ axes[0][1] - axes[1][1] @ axes[0][2]) + one[1] * two[0] - one[0] * two[1]
        one, two = one - rest[1:3], two - rest[3:5]
        start, end = one - rest[6:8], two - rest[8:]
        bow = free / 30 * (2 * start @ start - start @ end + 2 * end @ end)
        return np.array([np.linalg.norm(c) - free + bow - rest[0], *one, *two, twist - rest[5]])

    def modes(self, rest: Floats | None = None) -> Floats:
        """D of Eq. (3.13): elongation, deflections and rotations of the tip, turned from the chord to the step."""
        measures = self.measures(np.zeros(10) if rest is None else rest)
        stretch, beta_o, gamma_o, beta_b, gamma_b, twist = measures
        free = np.hypot(STEP, self.h)
        turn = np.array([[STEP, -self.h], [self.h, STEP]]) / free
        moved, turned = turn @ (stretch, free * beta_o), turn @ (twist, gamma_o - gamma_b)
        return np.array([moved[0], free * gamma_o, moved[1], turned[0], beta_b - beta_o, turned[1]])

    def moved(self, z: Floats) -> Wire:
        """The element after the motion z = (a, w_O, b, w_B), its frames turned by exact rotations."""
        a, w_o, b, w_b = z.reshape(4, 3)
        frame_o, frame_b = Rotation.from_rotvec(w_o).apply(self.frame_o), Rotation.from_rotvec(w_b).apply(self.frame_b)
        return replace(self, x_o=self.x_o + a, x_b=self.x_b + b, frame_o=frame_o, frame_b=frame_b)

    def vectors(self) -> tuple[tuple[float, float, float], ...]:
        """d, t, j, n, n_B, t_B as the kernels take them, by the kernel of Eq. (3.1)."""
        return element.wire_ends(*self.arrays(), np.array([self.sigma]), self.e, 0)  # type: ignore[no-any-return]

    def arrays(self, direction: float = 1.0) -> tuple[np.ndarray, ...]:
        """Positions, normals, tangents, family, start, end, direction of a grid of this element alone."""
        ends = np.array([0, 1]) if direction > 0 else np.array([1, 0])
        return (
            np.array([self.x_o, self.x_b]),
            np.array([self.frame_o[2], self.frame_b[2]]),
            np.array([self.frame_o[0], self.frame_o[1], self.frame_b[0], self.frame_b[1]]),
            *(np.array([0]), ends[:1], ends[1:]),
            np.array([direction]),
        )

    def energy(self, C: Floats, *, by_chord: bool, direction: float = 1.0) -> float:
        """½ D C D; against the direction of the wire a woven one falls, and its offset is counted from above."""
        woven = self.h > 0
        sigma = direction * self.sigma if woven else self.sigma
        e = self.h - self.e if woven and direction < 0 else self.e
        made_of = (C[None], np.array([e]), np.array([STEP]), np.array([self.h]))
        D, F, found = np.empty((1, 6)), np.empty((1, 6)), np.empty(1)
        *where, family, start, end, along = self.arrays(direction)
        one = (*where, family, family, start, end, along, np.array([sigma]), np.ones(1))
        sweeps.states(*one, *made_of, by_chord, np.zeros((1, 10)), D, F, found)
        return float(found[0])


def bent(p: Floats) -> Floats:
    """The angles of Eq. (3.11): how far the chord p is turned from the first axis, towards the second and third."""
    away = p[1:] / np.linalg.norm(p[1:]) if p[1:].any() else p[1:]
    return np.asarray(np.arctan2(np.linalg.norm(p[1:]), p[0]) * away)


def unloaded(sigma: float = 1.0, e: float = 0.0, h: float = 0.0) -> Wire:
    """The flat wire along x."""
    return Wire(np.zeros(3), np.array([STEP, 0.0, 0.0]), np.eye(3), np.eye(3), sigma, e, h)


def random_wire(seed: int, sigma: float, e: float, h: float, amount: float = 1.0) -> Wire:
    """An element bent by up to about half a radian, somewhere in space."""
    rng = np.random.default_rng(seed)
    z = amount * np.concatenate([scale * rng.uniform(-1, 1, 3) for scale in (1.0, 0.3, 1.0, 0.3)])
    wire = unloaded(sigma, e, h).moved(z)
    turn, shift = Rotation.random(random_state=rng), 30 * rng.standard_normal(3)
    return replace(
        wire,
        x_o=turn.apply(wire.x_o) + shift,
        x_b=turn.apply(wire.x_b) + shift,
        frame_o=turn.apply(wire.frame_o),
        frame_b=turn.apply(wire.frame_b),
    )


def expansion(wire: Wire, C: Floats, rest: Floats | None = None) -> tuple[float, Floats, Floats, Floats, Floats]:
    """Energy, D, gradient, rates and second-order terms by the kernel."""
    D, F, g, J, K = np.empty(6), np.empty(6), np.empty(12), np.empty((6, 12)), np.empty((12, 12))
    at_rest = np.zeros(10) if rest is None else rest
    line = (*wire.vectors(), wire.sigma, wire.e, wire.h, STEP, at_rest)
    energy = chord.expand_chord(*line, C, False, True, D, F, g, J, K)
    return energy, D, g, J, K


any_wire = {
    "seed": st.integers(0, 2**32 - 1),
    "sigma": st.sampled_from((1.0, -1.0)),
    "e": st.floats(0.0, 2.0),
    "h": st.floats(0.0, 3.0),
    "amount": st.sampled_from((0.01, 0.3, 1.0)),
}


def any_stiffness(seed: int) -> Floats:
    root = np.random.default_rng(seed).standard_normal((6, 6))
    return np.asarray(root @ root.T)


@settings(max_examples=50, deadline=None)
@given(**any_wire)
def test_modes_are_those_of_the_theory(seed: int, sigma: float, e: float, h: float, amount: float) -> None:
    wire = random_wire(seed, sigma, e, h, amount)
    D = np.empty(6)
    chord.chord_modes(*wire.vectors(), sigma, e, h, STEP, np.zeros(10), D)
    np.testing.assert_allclose(D, wire.modes(), rtol=0, atol=1e-12)
    energy, again, *_ = expansion(wire, C := any_stiffness(seed))
    np.testing.assert_allclose(again, D, rtol=0, atol=1e-14)
    assert energy == pytest.approx(0.5 * D @ C @ D, rel=1e-12)


@settings(max_examples=50, deadline=None)
@given(**any_wire)
def test_rates_and_second_order_terms_are_the_derivatives(
    seed: int, sigma: float, e: float, h: float, amount: float
) -> None:
    wire, C = random_wire(seed, sigma, e, h, amount), any_stiffness(seed)
    rng = np.random.default_rng(seed)
    z, rest = rng.uniform(-1, 1, 12), 0.1 * rng.uniform(-1, 1, 10)
    _, D, g, J, K = expansion(wire, C, rest)
    np.testing.assert_allclose(D, wire.modes(rest), rtol=0, atol=1e-12)
    slope, _ = slope_and_curvature(lambda t: wire.moved(t * z).modes(rest), 0.1)
    np.testing.assert_allclose(J @ z, slope, rtol=0, atol=1e-8 * np.abs(J).max())
    np.testing.assert_allclose(g, D @ C @ J, rtol=0, atol=1e-12 * np.abs(C).max() * np.abs(J).max())
    F = C @ D
    _, curvature = slope_and_curvature(lambda t: F @ wire.moved(t * z).modes(rest), 0.1)
    np.testing.assert_array_equal(K, K.T)
    assert z @ K @ z == pytest.approx(curvature, abs=1e-7 * np.abs(F).max() * 12 * STEP)


@pytest.mark.parametrize("part", [chord.SMALL * (1 - 1e-9), chord.SMALL * (1 + 1e-9)])
def test_the_series_of_the_angle_meets_its_closed_form(part: float) -> None:
    angle = np.arcsin(np.sqrt(part))
    sine, cosine = np.sin(angle), np.cos(angle)
    found = chord.opening((3.0 * cosine, 3.0 * sine, 0.0))
    first = 0.5 * (cosine - angle / sine) / part
    expected = np.array([angle / sine, first, -0.5 * (cosine + 3 * first) / part])
    np.testing.assert_allclose(found, expected / 3.0 ** np.array([1, 3, 5]), rtol=1e-10)


@pytest.mark.parametrize("sigma", [1.0, -1.0])
@pytest.mark.parametrize(("e", "h"), [(0.0, 0.0), (0.5, 0.0), (1.0, HEIGHT), (HEIGHT, HEIGHT)])
def test_to_first_order_the_modes_are_those_of_the_frame_at_o(sigma: float, e: float, h: float) -> None:
    wire = unloaded(sigma, e, h)
    J = np.empty((6, 12))
    # The frame at O takes the rise for the offset that it has: D3 does not see where the wire begins.
    element.mode_rates(*wire.vectors(), sigma, e, J)
    _, D, _, by_chord, _ = expansion(wire, np.eye(6))
    np.testing.assert_allclose(D, 0.0, atol=1e-14)
    np.testing.assert_allclose(by_chord, J, rtol=0, atol=1e-13)


ELEMENTS: dict[str, tuple[Callable[[], Element], float, float]] = {
    "straight": (stacked, 0.0, 0.0),
    "stacked": (stacked, 0.5, 0.0),
    "woven, centred": (lambda: wires(diameter=HEIGHT)[0], 0.5 * HEIGHT, HEIGHT),
    "woven, lower": (lambda: wires(diameter=HEIGHT)[0], HEIGHT, HEIGHT),
}


@pytest.mark.parametrize("name", ELEMENTS)
@pytest.mark.parametrize("sigma", [1.0, -1.0])
def test_it_does_not_matter_which_end_is_o(name: str, sigma: float) -> None:
    """Neither for a straight wire nor for a crimped one, which is its own image when its ends are exchanged."""
    build, e, h = ELEMENTS[name]
    C = build().C
    for seed in range(5):
        wire = random_wire(seed, sigma, e, h)
        energy = wire.energy(C, by_chord=True)
        assert wire.energy(C, by_chord=True, direction=-1.0) == pytest.approx(energy, rel=1e-10)


@pytest.mark.parametrize("name", ["straight", "woven, centred"])
def test_to_the_frame_at_o_it_matters_in_the_third_order_of_the_bending(name: str) -> None:
    """Energies are of second order in the motion, their difference by reversal is one order smaller."""
    build, e, h = ELEMENTS[name]
    C, difference = build().C, []
    for amount in (0.02, 0.01):
        wire = random_wire(1, 1.0, e, h, amount)
        difference.append(wire.energy(C, by_chord=False) - wire.energy(C, by_chord=False, direction=-1.0))
    assert np.log2(difference[0] / difference[1]) == pytest.approx(3.0, abs=0.1)


def test_a_wire_that_falls_is_the_mirror_image_of_one_that_rises() -> None:
    wire = random_wire(3, 1.0, 1.0, HEIGHT)
    mirror = np.diag([1.0, 1.0, -1.0])
    # The normal of a frame points to the same side of the grid in the image.
    frame_o, frame_b = (frame @ mirror * np.array([[1.0], [1.0], [-1.0]]) for frame in (wire.frame_o, wire.frame_b))
    image = Wire(wire.x_o @ mirror, wire.x_b @ mirror, frame_o, frame_b, -1.0, 1.0, HEIGHT)
    np.testing.assert_allclose(expansion(image, np.eye(6))[1], expansion(wire, np.eye(6))[1], rtol=0, atol=1e-12)


def arc(bend: float, azimuth: float = 0.0) -> Wire:
    """A wire of unchanged length bent to an arc over `bend` [rad], in a plane turned about the wire by the azimuth."""
    axis = np.array([0.0, np.cos(azimuth), np.sin(azimuth)])
    across = np.cross(axis, (1.0, 0.0, 0.0))
    x_b = STEP / bend * (np.sin(bend) * np.array([1.0, 0.0, 0.0]) + (1 - np.cos(bend)) * across)
    return Wire(np.zeros(3), x_b, np.eye(3), Rotation.from_rotvec(bend * axis).apply(np.eye(3)))


@pytest.mark.parametrize("azimuth", [0.0, 0.7, np.pi / 2])
@pytest.mark.parametrize("bend", [0.02, 0.25, 0.8])
def test_bending_to_an_arc_makes_a_false_strain_of_fourth_order_only(bend: float, azimuth: float) -> None:
    """Eq. (3.12): (kappa s)⁴/1920, in any plane; from O it is -(kappa s)²/6, Eq. (3.5). The rotation is exact."""
    wire = arc(bend, azimuth)
    D = expansion(wire, np.eye(6))[1]
    at_o = np.empty(6)
    element.modes(*wire.vectors(), 1.0, 0.0, STEP, at_o)
    assert at_o[0] / STEP == pytest.approx(-(bend**2) / 6, rel=0.06 * bend**2)
    assert D[0] / STEP == pytest.approx(bend**4 / 1920, rel=0.02 * bend**2, abs=1e-15)
    assert D[3] == pytest.approx(0.0, abs=1e-15)
    assert D[4:] == pytest.approx(bend * np.array([np.cos(azimuth), np.sin(azimuth)]), rel=1e-13, abs=1e-15)


def helix(length: float, curvature: float, torsion: float) -> Wire:
    """A piece of a helix, its frames carried along it without twist, from the middle `length`/2 both ways.

    Frenet's frame (T, N, B) turns about T at the torsion; one that turns back by as much does not twist.
    """
    rate = np.hypot(curvature, torsion)
    radius, climb = curvature / rate**2, torsion / rate

    def at(u: float) -> tuple[Floats, Floats]:
        cosine, sine, back = np.cos(rate * u), np.sin(rate * u), torsion * u + 0.4
        tangent = np.array([-radius * rate * sine, radius * rate * cosine, climb])
        inwards = np.array([-cosine, -sine, 0.0])
        normal = np.cos(back) * inwards - np.sin(back) * np.cross(tangent, inwards)
        place = np.array([radius * cosine, radius * sine, climb * u])
        return place, np.array([tangent, np.cross(normal, tangent), normal])

    (x_o, frame_o), (x_b, frame_b) = at(-0.5 * length), at(0.5 * length)
    scale = STEP / length
    return Wire(scale * x_o, scale * x_b, frame_o, frame_b)


def test_a_helix_without_twist_has_none_and_no_strain() -> None:
    """Eq. (3.12): the last term of tau is the area on the sphere of tangents between the wire's and the shortest way.

    Without it tau would be of third order in the length of the element; from O it is of second.
    """
    false = []
    for length in (0.4, 0.2):
        wire = helix(length, 1.0, 0.8)
        D, at_o = expansion(wire, np.eye(6))[1], np.empty(6)
        element.modes(*wire.vectors(), 1.0, 0.0, STEP, at_o)
        false.append(np.abs((D[0] / STEP, D[3], at_o[3])))
    order = np.log2(false[0] / false[1])
    assert (order[:2] > [3.9, 4.9]).all()
    assert order[2] < 2.2
    assert false[1][1] < 1e-3 * false[1][2]


WOVEN = bars(wires(), chord=True)
STRAIGHT = bars(wires(straight=True), chord=True)
LOWER = bars(wires(), share=1.0, chord=True)


def loaded() -> Energy:
    laid = grid()
    frames = free_frames(laid, None, held=beyond(laid, 2.5 * STEP))
    forces = 20.0 * np.random.default_rng(3).standard_normal((laid.nodes, 3))
    return energy_of(frames, made_of=WOVEN, loads=dead(laid, forces))


ENERGIES: dict[str, Callable[[], Energy]] = {
    "pinned": lambda: energy_of(free_frames(grid()), made_of=WOVEN),
    "welded, whole": lambda: energy_of(free_frames(grid(symmetry="full"), welded=True), made_of=WOVEN),
    "stacked": lambda: energy_of(free_frames(grid(weave="stacked")), made_of=STRAIGHT, crossing=500.0),
    "lower": lambda: energy_of(free_frames(grid(weave="same")), made_of=LOWER),
    "sphere": lambda: energy_of(free_frames(grid(symmetry="full"), Sphere(60.0)), made_of=WOVEN),
    "no surface": lambda: energy_of(free_frames(grid(symmetry="full"), None), made_of=WOVEN),
    "no surface, clamped, loads": loaded,
    "differences": lambda: energy_of(differences(grid()), made_of=WOVEN),
}
every_energy = pytest.mark.parametrize("name", ENERGIES)


@every_energy
@pytest.mark.parametrize("amount", [0.02, 0.3])
def test_gradient_and_hessian_are_the_derivatives_of_the_energy(name: str, amount: float) -> None:
    energy = ENERGIES[name]()
    state = random_state(energy.kinematics, energy.grid, np.random.default_rng(1), amount=amount)
    assert_derivatives(energy, state, rng=np.random.default_rng(2))


@every_energy
def test_a_rigid_motion_costs_nothing(name: str) -> None:
    energy = ENERGIES[name]()
    state = random_state(energy.kinematics, energy.grid, np.random.default_rng(1))
    assert_rigid_invariance(energy, state, rng=np.random.default_rng(4))


def test_modes_and_forces_of_a_grid_are_what_its_energy_sums() -> None:
    energy = ENERGIES["lower"]()
    state = random_state(energy.kinematics, energy.grid, np.random.default_rng(5))
    D, F, each = energy.elastic(state)
    np.testing.assert_allclose(F, np.einsum("mkl,ml->mk", energy.bars.C[energy.grid.family], D), rtol=1e-10)
    np.testing.assert_allclose(each, 0.5 * np.sum(D * F, axis=1), rtol=1e-12)
    assert energy.at(state) == pytest.approx(each @ energy.grid.weight, rel=1e-13)


@pytest.mark.parametrize(("weave", "made_of"), [("plain", WOVEN), ("same", LOWER), ("stacked", STRAIGHT)])
def test_the_flat_grid_is_without_energy(weave: str, made_of: Bars) -> None:
    laid = grid(weave=weave)
    assert energy_of(free_frames(laid), made_of=made_of).at(flat_start(laid, Plane())) < 1e-20
