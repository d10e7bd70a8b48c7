"""The inextensible limit: straight wires with EA -> infinity become the exact nets of section 6, at two orders.

Why the quarter has one answer. Let E = EA S(x) + W(x), S the stretching energy over EA (half the sum of D1²/s), W all
the rest. As EA -> infinity the minimum tends to the least W among the states with every D1 = 0. A square quarter of
n × n cells has 2 n (n + 1) wires between crossings, hence as many conditions D1 = 0, and its nodes have 2 n² + 2 n free
shifts (two inside, one on a mirror plane, none at the apex): as many again. Given the frames, the conditions alone
place every node; W has no say in the net but through the frames, that is through the false strain below. The wires in
the mirror planes cannot leave them, so they are the geodesic generators of Eq. (6.1) and (6.3).

The part in 1/EA. The tension F1 = EA D1/s of each wire tends to the multiplier T of its condition, so D1 = T s/EA, and
positions move by a quantity proportional to 1/EA (order 1) at a fixed step.
Its coefficient grows as the step is refined: a free wire end carries no moment, so within the last steps the wire
leaves its curvature kappa_g and loads the edge with couples EI kappa_g; the edge threads hold them as a pair of forces
EI kappa_g/s per node, whose tensions add up along the edge to T = EI kappa_g L/s². Linear behaviour ends where their
strains, moving an edge thread by T L/EA against the next, change kappa_g by as much as it was: it needs the softness
EI L²/(EA s⁴) << 1, which is (d L/4 s²)² for a round wire.

The part in (kappa s)². D1 = d·t - s with t at O, Eq. (3.5): the chord d of a wire of curvature kappa leaves its tangent
at O by kappa s/2, so D1 = 0 makes the chord s (1 + (kappa s)²/8) and the arc s (1 + (kappa s)²/6). The net is the exact
one of slightly longer edges: order 2 in s once EA is out of the way.

Sections have no shear flexibility here (kappa G A infinite): t is then the tangent of the wire, as (3.5) takes it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from exact_nets import Dome, laid, paraboloid, sphere, sphere_net, square_grid

from punchform.arrays import Floats
from punchform.case import PressCase
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Bars
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Solution
from punchform.press import Formed, press
from punchform.wire import Element, along, round_section, straight_line

RADIUS = 100.0
DOMES: dict[str, tuple[Dome, float]] = {
    "sphere": (sphere(RADIUS), 70.0),
    "paraboloid": (paraboloid(50.0), 90.0),
}
"""Surface and half side of the square blank [mm]; the curvature at both apices is 1/100 mm."""
DIAMETER = 0.75


def straight(step: float, stiffer: float) -> Element:
    """Steel wire with EA multiplied by `stiffer`, all else as it is, and no shear flexibility."""
    steel = round_section(DIAMETER, youngs_modulus=210e3, poisson=0.25, shear_factor=0.9)
    return along(straight_line(step), replace(steel, EA=stiffer * steel.EA, kappa_GA=np.inf))


@cache
def formed(name: str, count: int, stiffer: float) -> Formed:
    dome, side = DOMES[name]
    step = side / count
    grid, element = square_grid(step, count), straight(step, stiffer)
    start = laid(dome.net(step, count), grid, dome.surface)
    answer = press(grid, (element, element), dome.surface, PressCase(), start=start)
    assert answer.outcome.name == "CONVERGED"
    return answer


def positions(name: str, count: int, stiffer: float) -> Floats:
    return formed(name, count, stiffer).state.positions


def limit(name: str, count: int) -> Floats:
    """Positions for EA -> infinity at this step, by the line through EA × 10^5 and 10^6 over 1/EA."""
    return np.asarray((10 * positions(name, count, 1e6) - positions(name, count, 1e5)) / 9)


def exact(name: str, count: int) -> Floats:
    dome, side = DOMES[name]
    i, j = square_grid(side / count, count).index.T
    return np.asarray(dome.net(side / count, count)[i, j])


def largest(shift: Floats) -> float:
    return float(np.linalg.norm(shift, axis=1).max())


@pytest.mark.parametrize("name", DOMES)
@pytest.mark.parametrize("count", [6, 12])
def test_order_1_in_the_flexibility(name: str, count: int) -> None:
    """At a fixed step the distance to the inextensible grid falls as 1/EA: EA times 1, 10^3, 10^4."""
    stiffer = np.array([1.0, 1e3, 1e4])
    side = DOMES[name][1]
    softness = (DIAMETER * count**2 / (4 * side)) ** 2
    errors = [largest(positions(name, count, m) - limit(name, count)) for m in stiffer]
    orders = -np.diff(np.log(errors)) / np.diff(np.log(stiffer))
    np.testing.assert_allclose(orders, 1.0, atol=0.005 + softness)
    assert orders[-1] == pytest.approx(1.0, abs=0.005)


@pytest.mark.parametrize("name", DOMES)
def test_the_tensions_have_a_limit(name: str) -> None:
    """They are the multipliers of D1 = 0: what makes the order in EA exactly 1."""
    one, two, three = (formed(name, 12, m).whole.F[:, 0] for m in (1e2, 1e3, 1e4))
    assert np.abs(three - two).max() == pytest.approx(0.1 * np.abs(two - one).max(), rel=0.1)
    assert np.abs(three - two).max() < 1e-2 * np.abs(three).max()


@pytest.mark.parametrize("name", DOMES)
def test_order_2_in_the_step(name: str) -> None:
    """For EA -> infinity the distance to the exact net falls as s²."""
    counts = np.array([6, 12, 24])
    errors = [largest(limit(name, n) - exact(name, n)) for n in counts]
    orders = -np.diff(np.log(errors)) / np.diff(np.log(counts))
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


@pytest.mark.parametrize("name", DOMES)
def test_the_error_is_the_sum_of_both_parts(name: str) -> None:
    """Error (EA, s) = a/EA + b s²: a measured with stiff wires, b with fine steps, the sum with neither."""
    stretched = 1e4 * (positions(name, 12, 1e4) - limit(name, 12))
    fine = limit(name, 24) - exact(name, 24)
    whole_fine = {tuple(index): row for index, row in zip(square_grid(1.0, 24).index, fine, strict=True)}
    coarse = np.array([4 * whole_fine[tuple(2 * index)] for index in square_grid(1.0, 12).index])
    found = positions(name, 12, 10.0) - exact(name, 12)
    assert largest(found - coarse - stretched / 10) < 0.1 * largest(found)


def test_false_strain_of_the_frame_at_o() -> None:
    """Eq. (3.5) on the great circles of the sphere: chords (kappa s)²/8 longer than s, arcs (kappa s)²/6."""
    answer = formed("sphere", 24, 1e6)
    x = answer.state.positions[answer.grid.index[:, 1] == 0]
    chord = np.linalg.norm(np.diff(x, axis=0), axis=1)
    step, bent = answer.grid.step[0], answer.grid.step[0] / RADIUS
    arc = 2 * RADIUS * np.arcsin(chord / (2 * RADIUS))
    inside = slice(0, -4)  # the last steps belong to the free end, which carries no moment
    np.testing.assert_allclose((chord / step - 1)[inside], bent**2 / 8, rtol=0.02)
    np.testing.assert_allclose((arc / step - 1)[inside], bent**2 / 6, rtol=0.02)


def unfolded(quarter: Formed) -> State:
    whole = quarter.whole
    return State(whole.positions, whole.normals, whole.tangents)


def continued(start: State, count: int, stiffer: float, *, max_steps: int) -> Solution:
    """A few Newton steps of the whole grid on the sphere, its three rigid rotations taken out by hand."""
    dome, side = DOMES["sphere"]
    grid, element = square_grid(side / count, count, symmetry="full"), straight(side / count, stiffer)
    frames = FreeFrames(grid, dome.surface, np.zeros(grid.nodes, dtype=bool))
    node = {(int(i), int(j)): number for number, (i, j) in enumerate(grid.index)}
    # The apex stays where it is, and the last node on the x axis does not go round.
    pins = (*frames.unknowns[2 * node[0, 0], :2], frames.unknowns[2 * node[count, 0], 1])
    bars = Bars(np.stack([element.C] * 2), np.zeros(2), np.full(2, element.length), rise=np.zeros(2))
    return minimise(Energy(grid, bars, replace(frames, pins=pins)), start, max_steps=max_steps)


@pytest.mark.parametrize("stiffer", [1.0, 1e2])
def test_without_mirror_planes_the_bending_energy_picks_another_net(stiffer: float) -> None:
    """On a bare sphere the net of the quarter is stationary for the whole grid, but no minimum.

    Equal-edge nets are free up to their two generators. On a sphere every wire has the normal curvature 1/R and no
    geodesic torsion, so only the geodesic curvatures -omega_u and omega_v differ between nets, omega the angle between
    the wires, omega_uv = -sin(omega)/R². Let two great circles cross at omega_0 instead of a right angle. Near the
    apex omega = omega_0 - u v sin(omega_0)/R², and the energy per unit of area is
    ½ EI sin²(omega_0) (u² + v²)/R⁴: largest at the right angle, which the mirror planes of the quarter enforce. The
    whole grid therefore shears, at any EA, unless a rim or welded crossings hold it.
    """
    quarter = formed("sphere", 6, stiffer)
    start = unfolded(quarter)
    at_once = continued(start, 6, stiffer, max_steps=2)
    assert at_once.history[0].energy == pytest.approx(quarter.energy, rel=1e-9)
    assert at_once.history[0].decrement < 1e-12
    assert quarter.negative_eigenvalues == 0
    assert at_once.negative_eigenvalues is not None
    assert at_once.negative_eigenvalues > 0
    later = continued(start, 6, stiffer, max_steps=12).history[-1]
    assert later.energy < quarter.energy * (1 - 1e-7)


def test_a_sheared_sphere_net_is_cheaper_to_bend() -> None:
    """The formula of the test above, on exact nets: geodesic curvature energy ∝ sin² of the crossing angle."""
    step, count = 0.01, 30
    energies = [geodesic_bending(crossed(step, count, angle), step) for angle in (np.pi / 2, np.pi / 3)]
    assert energies[1] / energies[0] == pytest.approx(np.sin(np.pi / 3) ** 2, rel=0.05)


def crossed(step: float, count: int, angle: float) -> Floats:
    """The net of two great circles of the unit sphere that cross at an angle; the quarter between them."""
    net = sphere_net(1.0, step, count)
    polar = 2 * np.arcsin(step / 2) * np.arange(count + 1)
    net[0, :] = np.stack((np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)), axis=1)
    for i in range(count):
        for j in range(count):
            across = np.cross(net[i + 1, j], net[i, j + 1])
            net[i + 1, j + 1] = net[i, j] - 2 * across * (net[i, j] @ across) / (across @ across)
    return net


def geodesic_bending(net: Floats, step: float) -> float:
    """Sum of squared geodesic curvatures over the inner nodes of both families."""
    total = 0.0
    for family in range(2):
        turned = np.moveaxis(net, family, 0)
        here, tangent = turned[1:-1], (turned[2:] - turned[:-2]) / (2 * step)
        bent = (turned[2:] - 2 * here + turned[:-2]) / step**2
        total += float(np.sum(np.sum(np.cross(here, tangent) * bent, axis=2) ** 2))
    return total
