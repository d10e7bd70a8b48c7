"""A straight wire at large bending against exact figures: elastica, Euler load, a wire laid over a hill.

The published figures are those of the inextensible elastica: EI theta'' = -(P + w (L - s)) cos(theta), theta(0) = 0.
They show the orders of the two element frames: from its chord (3.13) the element converges at order 4, from its frame
at O (3.2) at order 2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import OdeSolution, quad, solve_ivp
from scipy.optimize import brentq

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.bars import Bars, Loads
from punchform.mechanics.frames import State, turned
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.linear import upper_matrix
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome
from punchform.punch import Gap, Surface
from punchform.wire import Section, along, straight_line

LENGTH = 100.0
EI = 1e3
FORCE = EI / LENGTH**2
"""The unit of force in which the figures are given."""
INEXTENSIBLE = 1e8
"""EA in this unit: what the wire stretches changes the figures in their eighth digit."""

ELASTICA = {
    1.0: (0.3017208, 0.0564332),
    2.0: (0.4934575, 0.1606417),
    5.0: (0.7137915, 0.3876284),
    10.0: (0.8106090, 0.5549956),
}
"""P L²/EI of a cantilever with a dead end force: deflection and shortening of its end over its length."""
OWN_WEIGHT = (0.4959050, 1 - 0.8466572)
"""The same under its own weight w L³/EI = 5."""


def wire_grid(count: int, length: float = LENGTH) -> Grid:
    """One wire along x in `count` elements, no mirror planes."""
    step, i = length / count, np.arange(count + 1)
    neighbours = np.full((count + 1, 2, 2), -1)
    neighbours[1:, 0, 0], neighbours[:-1, 0, 1] = i[:-1], i[1:]
    ones = np.ones(count, dtype=np.int64)
    return Grid(
        step=(step, step),
        index=np.column_stack((i, 0 * i)),
        flat=np.column_stack((step * i, np.zeros(count + 1))),
        family=0 * ones,
        start=i[:-1],
        end=i[1:],
        direction=ones,
        sigma=ones,
        weight=np.ones(count),
        neighbours=neighbours,
        on_mirror=np.zeros((count + 1, 2), dtype=bool),
        quarter=False,
    )


def wire_energy(
    grid: Grid,
    chord: bool,
    *,
    rigidity: float = INEXTENSIBLE,
    surface: Surface | None = None,
    clamped: bool = True,
    forces: Floats | None = None,
) -> Energy:
    """The energy of a straight round wire without shear flexibility; clamped at node 0 or free."""
    section = Section(1.0, rigidity * FORCE, EI, EI / 1.25, np.inf)
    C = along(straight_line(grid.step[0]), section).C
    made_of = Bars(np.stack([C] * 2), np.zeros(2), np.array(grid.step), rise=np.zeros(2), chord=chord)
    held = np.zeros(grid.nodes, dtype=bool)
    held[0] = clamped
    loads = None if forces is None else Loads(forces, np.column_stack((grid.flat, np.zeros(grid.nodes))))
    return Energy(grid, made_of, FreeFrames(grid, surface, held), loads=loads)


def bent(x: Floats, z: Floats, slope: Floats, azimuth: float = 0.0) -> State:
    """The wire through the points (x, z) of a plane through the x axis, its frames turned about the plane's normal."""
    axis = np.array([0.0, -np.cos(azimuth), np.sin(azimuth)])
    rotations = slope[:, None] * axis
    frame = [turned(np.broadcast_to(row, rotations.shape), rotations) for row in np.eye(3)]
    positions = np.column_stack((x, z * np.sin(azimuth), z * np.cos(azimuth)))
    return State(positions, frame[2], np.stack(frame[:2], axis=1))


@cache
def exact(push: float, weight: float) -> Callable[[Floats | float], Floats]:
    """The elastica of length and EI 1: slope, curvature, x and z over the arc length, by shooting."""

    def rates(s: float, y: Floats) -> list[float]:
        return [y[1], -(push + weight * (1 - s)) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

    def shot(root: float) -> OdeSolution:
        return solve_ivp(rates, (0, 1), [0, root, 0, 0], rtol=1e-11, atol=1e-12, dense_output=True).sol

    found: Callable[[Floats | float], Floats] = shot(
        brentq(lambda root: shot(root)(1.0)[1], 0.0, push + weight, xtol=1e-13)
    )
    return found


@cache
def cantilever(push: float, weight: float, count: int, chord: bool, azimuth: float = 0.0) -> Floats:
    """Deflection and shortening of the end, over the length, (2,), bent in a plane at an azimuth to the frames."""
    grid = wire_grid(count)
    sideways = np.array([0.0, np.sin(azimuth), np.cos(azimuth)])
    forces = np.full(count + 1, weight / count)
    forces[[0, -1]] *= 0.5
    forces[-1] += push
    energy = wire_energy(grid, chord, forces=FORCE * forces[:, None] * sideways)
    # The search begins at the answer of the continuum: a long way round would cost many small steps.
    slope, _, x, z = exact(push, weight)(np.linspace(0, 1, count + 1))
    solution = minimise(energy, bent(LENGTH * x, LENGTH * z, slope, azimuth), max_steps=300)
    assert solution.outcome is Outcome.CONVERGED
    end = solution.state.positions[-1] / LENGTH
    assert abs(end @ np.cross(sideways, (1.0, 0.0, 0.0))) < 1e-10
    return np.array([end @ sideways, 1 - end[0]])


def errors(push: float, weight: float, count: int, chord: bool) -> Floats:
    """Errors of deflection and shortening, without their signs."""
    _, _, x, z = exact(push, weight)(1.0)
    return np.asarray(np.abs(cantilever(push, weight, count, chord) - (z, 1 - x)))


@pytest.mark.parametrize("push", ELASTICA)
def test_elastica_with_an_end_force(push: float) -> None:
    assert cantilever(push, 0.0, 8, chord=True) == pytest.approx(ELASTICA[push], abs=1e-4)
    assert cantilever(push, 0.0, 16, chord=True) == pytest.approx(ELASTICA[push], abs=2e-6)


def test_elastica_under_its_own_weight() -> None:
    """As forces on the nodes, which is of second order in the step for any element."""
    assert cantilever(0.0, 5.0, 32, chord=True) == pytest.approx(OWN_WEIGHT, abs=1e-4)
    order = np.log2(errors(0.0, 5.0, 16, chord=True) / errors(0.0, 5.0, 32, chord=True))
    assert order == pytest.approx([2.0, 2.0], abs=0.05)
    assert (errors(0.0, 5.0, 32, chord=False) > 4 * errors(0.0, 5.0, 32, chord=True)).all()


@pytest.mark.parametrize("push", ELASTICA)
def test_from_its_chord_the_element_is_of_fourth_order(push: float) -> None:
    order = np.log2(errors(push, 0.0, 4, chord=True) / errors(push, 0.0, 8, chord=True))
    assert order == pytest.approx([4.0, 4.0], abs=0.15)


@pytest.mark.parametrize("push", ELASTICA)
def test_from_o_the_element_is_of_second_order(push: float) -> None:
    order = np.log2(errors(push, 0.0, 32, chord=False) / errors(push, 0.0, 64, chord=False))
    assert order == pytest.approx([2.0, 2.0], abs=0.15)
    # 64 elements seen from O are worse than 8 seen from their chords.
    assert (errors(push, 0.0, 64, chord=False) > 5 * errors(push, 0.0, 8, chord=True)).all()


@pytest.mark.parametrize("azimuth", [0.4, np.pi / 4, np.pi / 2])
def test_the_plane_of_bending_does_not_matter(azimuth: float) -> None:
    """Eq. (3.11) turns the chord as a whole: two angles measured one by one would make this of second order."""
    upright = cantilever(10.0, 0.0, 8, chord=True)
    assert cantilever(10.0, 0.0, 8, chord=True, azimuth=azimuth) == pytest.approx(upright, abs=1e-9)


@cache
def space_curve(count: int, chord: bool) -> Floats:
    """The end of a cantilever bent upwards at its end and sideways in the middle, (3,), over its length."""
    forces = np.zeros((count + 1, 3))
    forces[-1, 2], forces[count // 2, 1] = 4 * FORCE, 6 * FORCE
    grid = wire_grid(count)
    state = bent(grid.flat[:, 0], grid.flat[:, 1], grid.flat[:, 1])
    for part in np.linspace(0.1, 1, 10):
        # So stretchy that the load may come in ten parts; the continuum that the elements tend to stretches alike.
        solution = minimise(wire_energy(grid, chord, rigidity=1e5, forces=part * forces), state, max_steps=300)
        state = solution.state
    assert solution.outcome is Outcome.CONVERGED
    return np.asarray(state.positions[-1] / LENGTH)


@pytest.mark.parametrize(("chord", "order"), [(True, 4.0), (False, 2.0)])
def test_a_wire_bent_to_a_space_curve_converges_as_a_plane_one(chord: bool, order: float) -> None:
    one, two, four = (space_curve(count, chord) for count in (8, 16, 32))
    ratio = np.linalg.norm(two - one) / np.linalg.norm(four - two)
    assert np.log2(ratio) == pytest.approx(order, abs=0.25)


def negative_modes(count: int, force: float, chord: bool) -> int:
    """Unstable modes of a straight wire with pinned ends under a dead end force, tension positive [FORCE]."""
    grid = wire_grid(count)
    ends = np.zeros((count + 1, 3))
    ends[-1, 0] = force * FORCE
    energy = wire_energy(grid, chord, clamped=False, forces=ends)
    unknowns = energy.kinematics.unknowns
    # Slots: three shifts, the turn about the wire, the other tilt, the spin.
    pins = (*unknowns[0, :4], *unknowns[2 * count, 1:3])
    energy = replace(energy, kinematics=FreeFrames(grid, None, np.zeros(count + 1, dtype=bool), pins=tuple(pins)))
    stretched = (1 + force / INEXTENSIBLE) * grid.flat[:, 0]
    chart = energy.kinematics.chart(bent(stretched, grid.flat[:, 1], grid.flat[:, 1]))
    model = energy.model(chart, Hessian.EXACT)
    assert np.abs(model.gradient).max() < 1e-6 * abs(force) * FORCE
    upper = upper_matrix(energy.pattern, model.values).toarray()
    scale = np.sqrt(np.diag(upper).clip(1e-12))
    return int((np.linalg.eigvalsh(upper.T / np.outer(scale, scale)) < 0).sum())


def buckling_load(count: int, chord: bool) -> float:
    """The push at which the wire gives way in both planes, over that of Euler, by bisection to 1e-8."""
    low, high = 0.9, 2.5
    while high - low > 1e-8:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if negative_modes(count, -middle * np.pi**2, chord) == 0 else (low, middle)
    assert negative_modes(count, -(high + 1e-6) * np.pi**2, chord) == 2
    return high


@pytest.mark.parametrize(("chord", "order", "worst"), [(True, 4.0, 4e-5), (False, 2.0, 0.06)])
def test_a_pushed_wire_buckles_at_the_load_of_euler(chord: bool, order: float, worst: float) -> None:
    over = [buckling_load(count, chord) - 1 for count in (4, 8)]
    assert 0 < over[1] < worst
    assert np.log2(over[0] / over[1]) == pytest.approx(order, abs=0.2)


def test_a_pulled_wire_is_stable_at_any_tension() -> None:
    """From O it buckles beyond T = 3 EI/s², Eq. (3.8); from its chord never."""
    count = 8
    limit = 3.0 * count**2
    assert negative_modes(count, 0.99 * limit, chord=False) == 0
    assert negative_modes(count, 1.01 * limit, chord=False) > 0
    for times in (1.01, 10.0, 1000.0):
        assert negative_modes(count, times * limit, chord=True) == 0


GREENHILL = 8.986818916
"""Torque M L/EI at which a straight wire with clamped ends buckles: twice the first root of tan(x) = x."""


def torque_is_stable(count: int, torque: float, chord: bool) -> bool:
    """Whether a straight wire with clamped ends bears a torque [EI/L]; so stiff against twist that it hardly turns."""
    grid, GJ = wire_grid(count), 1e4 * EI
    section = Section(1.0, INEXTENSIBLE * FORCE, EI, GJ, np.inf)
    made_of = Bars(
        np.stack([along(straight_line(grid.step[0]), section).C] * 2),
        np.zeros(2),
        np.array(grid.step),
        rise=np.zeros(2),
        chord=chord,
    )
    held = np.zeros(count + 1, dtype=bool)
    held[[0, -1]] = True
    energy = Energy(grid, made_of, FreeFrames(grid, None, held))
    straight = bent(grid.flat[:, 0], grid.flat[:, 1], grid.flat[:, 1])
    twist = np.outer(torque * EI / (LENGTH * GJ) * grid.flat[:, 0], (1.0, 0.0, 0.0))
    tangents = np.stack([turned(straight.tangents[:, w], twist) for w in range(2)], axis=1)
    chart = energy.kinematics.chart(State(straight.positions, turned(straight.normals, twist), tangents))
    upper = upper_matrix(energy.pattern, energy.model(chart, Hessian.EXACT).values).toarray()
    scale = np.sqrt(np.diag(upper))
    return bool(np.linalg.eigvalsh(upper.T / np.outer(scale, scale))[0] >= 0)


@pytest.mark.parametrize(("chord", "order", "worst"), [(True, 4.0, 2e-4), (False, 2.0, 0.02)])
def test_a_twisted_wire_buckles_at_the_torque_of_greenhill(chord: bool, order: float, worst: float) -> None:
    """The last term of Eq. (3.12) is what a torque does to bending: without it the order would be 2."""
    off = []
    for count in (8, 16):
        low, high = 0.5 * GREENHILL, 2.0 * GREENHILL
        while high - low > 1e-7:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if torque_is_stable(count, middle, chord) else (low, middle)
        off.append(abs(high / GREENHILL - 1))
    assert off[1] < worst
    assert np.log2(off[0] / off[1]) == pytest.approx(order, abs=0.2)


HILL, WIDTH = 30.0, 30.0


@dataclass(frozen=True)
class Hill:
    """z = HILL exp(-x²/WIDTH²), a tool that is flat where the wire ends."""

    rim_radius: float = np.inf
    mirror_planes: bool = True

    def height(self, xy: Floats) -> Floats:
        return np.asarray(HILL * np.exp(-((xy[:, 0] / WIDTH) ** 2)))

    def slope(self, x: Floats) -> Floats:
        return -2 * x / WIDTH**2 * self.height(np.atleast_1d(x)[:, None]).reshape(np.shape(x))

    def bend(self, x: Floats) -> Floats:
        return (4 * x**2 / WIDTH**4 - 2 / WIDTH**2) * self.height(np.atleast_1d(x)[:, None]).reshape(np.shape(x))

    def gap(self, points: Floats) -> Gap:
        x, flat = points[:, 0], np.zeros(len(points))
        hessian = np.zeros((len(points), 3, 3))
        hessian[:, 0, 0] = -self.bend(x)
        return Gap(points[:, 2] - self.height(points), np.column_stack((-self.slope(x), flat, flat + 1)), hessian)

    def distance(self, points: Floats) -> Floats:
        return self.distance_gradient(points)[0]

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        gap = self.gap(points)
        steep = np.linalg.norm(gap.gradient, axis=1)
        return gap.value / steep, gap.gradient / steep[:, None]


def laid_over_the_hill(count: int, chord: bool) -> float:
    """Energy of an inextensible wire of length 8 WIDTH laid across the hill, over that of the curve itself."""
    hill, length = Hill(), 8 * WIDTH

    def arc_length(x: float) -> float:
        return float(quad(lambda u: np.hypot(1.0, hill.slope(u)), 0, x, epsabs=1e-12, limit=200)[0])

    grid = wire_grid(count, length)
    places = grid.flat[:, 0] - 0.5 * length
    x = np.array([np.sign(s) * brentq(lambda u, s=s: arc_length(u) - abs(s), 0, length) for s in places])
    energy = wire_energy(grid, chord, rigidity=1e9, surface=hill, clamped=False)
    unknowns = energy.kinematics.unknowns
    # In the plane of the hill: the shifts across, the turn about the wire and the spin stay, and the top stays on top.
    pins = tuple(int(one) for one in (*unknowns[0::2, [1, 2, 4]].ravel(), unknowns[count, 0]))
    energy = replace(energy, kinematics=FreeFrames(grid, hill, np.zeros(count + 1, dtype=bool), pins=pins))
    solution = minimise(energy, bent(x, hill.height(x[:, None]), np.arctan(hill.slope(x))))
    assert solution.outcome is Outcome.CONVERGED
    bending = quad(lambda u: hill.bend(u) ** 2 / (1 + hill.slope(u) ** 2) ** 2.5, 0, x[-1], limit=200)[0]
    return energy.at(solution.state) / float(EI * bending)


@pytest.mark.parametrize(("chord", "order", "worst"), [(True, 4.0, 3e-6), (False, 2.0, 2e-3)])
def test_a_wire_over_a_hill_stores_the_bending_energy_of_its_curve(chord: bool, order: float, worst: float) -> None:
    off = [abs(laid_over_the_hill(count, chord) - 1) for count in (64, 128)]
    assert off[1] < worst
    assert np.log2(off[0] / off[1]) == pytest.approx(order, abs=0.35)
