"""Release and load against closed forms: elastic wires come back straight, beams and plates bend as they must.

Small loads on flat grids are linear, so the textbook holds to the digits of the load's size: a strip of straight wires
is a cantilever, a dense grid an orthotropic plate without Poisson's effect, D_x = D_y = EI/s, H = GJ/s.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipe
from small_grids import PUNCH, STEP, Cylinder, Plane, grid, wires
from test_elastica import wire_grid

from punchform.arrays import Bools, Floats
from punchform.case import (
    CosineLine,
    HoldFrom,
    HoldNodes,
    LoadCase,
    PointForce,
    PressCase,
    ReleaseCase,
    StraightLine,
    WindCase,
    WireCase,
)
from punchform.case.release import Hold
from punchform.forces import EARTH
from punchform.grid import Grid
from punchform.holds import Held
from punchform.load import Loaded, load
from punchform.mechanics.outcome import Outcome, Solution
from punchform.press import energy_of, press
from punchform.release import Released, release
from punchform.solved import solved
from punchform.start import flat_start
from punchform.wire import Element, Section, along, straight_line

DENSITY = 7850.0
WIRE = WireCase(diameter=1.0, youngs_modulus=210e3, poisson=0.25, density=DENSITY, centreline=StraightLine(height=0.0))
SMALL = 1e-9
"""A pressure [MPa] that moves the plates of this page by some millionths of their size."""
SECTION = Section(1.0, EA=165e3, EI=1e4, GJ=8e3, kappa_GA=np.inf)
ROUND = np.pi / 4
"""Area of the wire's section over the square of its diameter."""


def let_go(laid: Grid, elements: tuple[Element, Element], hold: Hold = "nothing") -> Released:
    """A flat grid, never pressed, with a hold."""
    state, case = flat_start(laid, Plane()), PressCase()
    energy = energy_of(laid, elements, Plane(), case, start=state)
    flat = solved(energy, Solution(state, Outcome.CONVERGED, ()), elements, np.zeros(laid.nodes), None)
    return release(flat, elements, ReleaseCase(hold=hold), case)


def straight(step: tuple[float, float], section: Section = SECTION) -> tuple[Element, Element]:
    return along(straight_line(step[0]), section), along(straight_line(step[1]), section)


def loaded(released: Released, elements: tuple[Element, Element], case: LoadCase, wire: WireCase = WIRE) -> Loaded:
    return load(released, elements, case, wire, PressCase())


# --- what elastic wires come back to ------------------------------------------------------------------------


@pytest.mark.parametrize("frame", ["O", "chord"])
def test_a_wire_bent_over_a_cylinder_comes_back_straight(frame: str) -> None:
    wire, elements, case = wire_grid(12, 120.0), wires((10.0, 10.0), straight=True, height=0.0), PressCase(start="flat")
    wire = replace(wire, flat=wire.flat - (60.0, 0.0))
    case = case.model_copy(update={"frame": frame})
    formed = press(wire, elements, Cylinder(80.0), case)
    bent = formed.state.positions
    assert np.ptp(bent[:, 2]) > 20.0
    released = release(formed, elements, ReleaseCase(hold=HoldNodes(nodes=((6, 0),))), case)
    assert released.outcome is Outcome.CONVERGED
    assert released.energy < 1e-20 * formed.energy
    np.testing.assert_allclose(off_its_line(released.state.positions), 0.0, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(np.diff(released.state.positions, axis=0), axis=1), 10.0, rtol=1e-12)


def off_its_line(points: Floats) -> Floats:
    """How far points lie off the straight line through the first and the last."""
    way = points[-1] - points[0]
    return np.asarray(np.linalg.norm(np.cross(points - points[0], way / np.linalg.norm(way)), axis=1))


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
@pytest.mark.parametrize("crossing", ["pinned", "welded"])
def test_a_grid_held_at_one_point_springs_back_flat(symmetry: str, crossing: str) -> None:
    """What a release that holds nothing is told to be, found by the solve."""
    laid = grid(5.2 * STEP, symmetry=symmetry)
    elements = wires(laid.step)
    formed = press(laid, elements, PUNCH, PressCase(), crossing=crossing)
    hold = HoldNodes(nodes=((0, 0),))
    released = release(formed, elements, ReleaseCase(hold=hold), PressCase(), crossing=crossing)
    assert released.outcome is Outcome.CONVERGED
    # A flat pinned grid can be sheared for nothing: rounding decides the sign of that eigenvalue, but it is no saddle.
    assert released.negative_eigenvalues == released.stability.negative == 0
    assert released.energy < 1e-20 * formed.energy
    x, index = released.whole.positions, released.whole.index
    assert np.linalg.svd(x - x.mean(axis=0))[1][2] < 1e-8
    for family in range(2):
        for line in np.unique(index[:, 1 - family]):
            assert off_its_line(x[index[:, 1 - family] == line]).max() < 1e-8
    if crossing == "welded":
        flat = released.whole.flat
        apart = np.linalg.norm(x[:, None] - x[None], axis=2)
        np.testing.assert_allclose(apart, np.linalg.norm(flat[:, None] - flat[None], axis=2), rtol=0, atol=1e-8)


# --- a strip under its own weight ---------------------------------------------------------------------------


def cantilever(count: int, case: LoadCase) -> tuple[Loaded, Element, float]:
    """A strip of three wires, `count` elements beyond a clamp that holds their first two crossings, and its length."""
    step = (144.0 / (count - 1), 3.0)
    laid = grid(step=step, size=((count + 1.01) * step[0], 2.01 * step[1]), symmetry="full", weave="stacked")
    elements = straight(step, Section(1.0, EA=165e3, EI=1e4, GJ=8e3, kappa_GA=6e4))
    released = let_go(laid, elements, "rim")
    clamped = laid.index[:, 0] <= laid.index[:, 0].min() + 1
    hold = Held(clamped, np.zeros((laid.nodes, 3), dtype=bool), released.state.positions)
    return loaded(replace(released, hold=hold), elements, case), elements[0], count * step[0]


def tip(strip: Loaded) -> float:
    """Deflection of the strip's end, the mean of its wires: the cross wires only share the load among them."""
    i = strip.whole.index[:, 0]
    return -float(strip.moved[i == i.max(), 2].mean())


@pytest.mark.parametrize("count", [5, 9])
def test_a_strip_bends_under_its_weight_as_a_row_of_cantilevers(count: int) -> None:
    """The deflections of single forces on a cantilever, P a² (3 L - a)/6 EI + P a/κGA, added up: no error in s."""
    strip, element, length = cantilever(count, LoadCase(gravity=(0.0, 0.0, -1e-3)))
    arm = strip.whole.positions[:, 0] - strip.whole.positions[:, 0].max() + length
    force, section = -strip.applied[:, 2], element.section
    assert section is not None
    bent = force * arm**2 * (3 * length - arm) / (6 * section.EI) + force * arm / section.kappa_GA
    assert tip(strip) == pytest.approx(bent[arm > 0].sum() / 3, rel=1e-7)


def test_a_uniform_load_bends_it_by_w_l4_over_8_ei_at_order_two() -> None:
    """Forces on nodes stand for the uniform load: the end sinks by 1 + 1/3 n² of w L⁴/8 EI, and by w L²/2 κGA."""
    off = []
    for count in (5, 9, 17):
        strip, element, length = cantilever(count, LoadCase(pressure=-SMALL))
        load_per_length, section = SMALL * 2 * 3.0 / 3, element.section
        assert section is not None
        bent = load_per_length * length**4 / (8 * section.EI)
        sheared = load_per_length * length**2 / (2 * section.kappa_GA)
        assert tip(strip) == pytest.approx(bent * (1 + 1 / (3 * count**2)) + sheared, rel=1e-7)
        off.append((tip(strip) / (bent + sheared) - 1) * count**2)
    np.testing.assert_allclose(off, 1 / 3, rtol=1e-2)


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_a_flat_grid_on_one_support_bears_its_weight(symmetry: str) -> None:
    """The mirror planes of the quarter keep it from tipping, for the whole grid it is balanced."""
    laid = grid(step=(8.0, 8.0), size=(80.5, 48.5), symmetry=symmetry, weave="stacked")
    elements = straight(laid.step)
    released = replace(let_go(laid, elements, "rim"), hold=Held(*one_support(laid)))
    under = loaded(released, elements, LoadCase(gravity=(0.0, 0.0, -1e-3)))
    assert_balance(under.whole.positions, under.applied + under.reactions, under.load)
    tips = np.abs(under.whole.index[:, 0]) == 5
    # The whole grid may lean, its mean may not.
    assert under.moved[tips, 2].mean() < 0


def one_support(laid: Grid) -> tuple[Bools, Bools, Floats]:
    nobody = np.zeros(laid.nodes, dtype=bool)
    fixed = np.repeat((laid.index == 0).all(axis=1)[:, None], 3, axis=1)
    return nobody, fixed, np.column_stack((laid.flat, nobody))


# --- dense grids are plates ---------------------------------------------------------------------------------


def test_a_clamped_round_grid_tends_to_the_orthotropic_plate() -> None:
    """w = q a⁴ (1 - r²/a²)² / 8 (3 D_x + 2 H + 3 D_y): it solves D_x w,xxxx + 2 H w,xxyy + D_y w,yyyy = q.

    r⁴ has the derivatives 24, 8 and 24. The nodes of the clamp form stairs beyond the circle: an error of order 1.
    """
    radius, off = 100.0, []
    for count in (10, 20, 40):
        step = radius / count
        laid = grid(radius + 2 * step, step=(step, step), weave="stacked")
        elements = straight(laid.step)
        plate = loaded(let_go(laid, elements, HoldFrom(from_radius=radius)), elements, LoadCase(pressure=SMALL))
        D, H = SECTION.EI / step, SECTION.GJ / step
        highest = SMALL * radius**4 / (8 * (6 * D + 2 * H))
        square = (plate.whole.flat**2).sum(axis=1) / radius**2
        exact = highest * np.where(square < 1, (1 - square) ** 2, 0.0)
        off.append(np.abs(plate.moved[:, 2] - exact).max() / highest)
    assert off[0] < 0.08
    assert off[1] < 0.7 * off[0]
    assert off[2] < 0.6 * off[1]


def navier(x: Floats, y: Floats, side: float, rigidity: float) -> Floats:
    """Deflection of a square plate on four simple supports, torsion-free, pressed by SMALL; x, y from its centre."""
    odd = np.arange(1, 120, 2)
    m, n = odd[:, None], odd[None]
    weights = 16 * SMALL * side**4 / (np.pi**6 * rigidity * m * n * (m**4 + n**4))
    along_x, along_y = (np.sin(np.pi * odd * (along[:, None] / side + 0.5)) for along in (x, y))
    return np.asarray(np.einsum("pm,mn,pn->p", along_x, weights, along_y))


def test_a_square_grid_on_its_rim_tends_to_naviers_plate_at_order_two() -> None:
    """Pinned wire ends that turn freely are simple supports; wires without resistance to twist, H = 0."""
    side, off = 100.0, []
    untwisted = replace(SECTION, GJ=1e-7 * SECTION.EI)
    for count in (8, 16, 32):
        step = side / count
        laid = grid(step=(step, step), size=(1.001 * side, 1.001 * side), weave="stacked")
        elements = straight(laid.step, untwisted)
        plate = loaded(let_go(laid, elements, "rim"), elements, LoadCase(pressure=SMALL))
        exact = navier(plate.whole.flat[:, 0], plate.whole.flat[:, 1], side, untwisted.EI / step)
        off.append(np.abs(plate.moved[:, 2] - exact).max() / exact.max())
    np.testing.assert_allclose(np.log2(np.divide(off[:-1], off[1:])), 2.0, atol=0.02)
    assert off[-1] < 2e-3


# --- sums of forces -----------------------------------------------------------------------------------------


def dish(
    symmetry: str = "full", hold: Hold = "rim", *, wire: WireCase = WIRE
) -> tuple[Released, tuple[Element, Element]]:
    """A woven grid formed over the small punch and let go."""
    laid = grid(5.2 * STEP, symmetry=symmetry)
    elements = wires(laid.step, height=wire.height)
    formed = press(laid, elements, PUNCH, PressCase())
    return release(formed, elements, ReleaseCase(hold=hold), PressCase()), elements


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_the_mass_is_density_times_section_times_the_length_of_the_crimped_wires(symmetry: str) -> None:
    """z = h (1 - cos πt)/2 has the arc length (2 s/π) E(-(π h/2 s)²)."""
    crimped = WIRE.model_copy(update={"centreline": CosineLine(height=1.0, segments=32), "height": 1.0})
    released, elements = dish(symmetry, HoldFrom(from_radius=40.0), wire=crimped)
    mass = loaded(released, elements, LoadCase(gravity=(0.0, 0.0, -1.0)), crimped).mass
    piece = 2 * STEP / np.pi * ellipe(-((np.pi * 1.0 / (2 * STEP)) ** 2))
    pieces = len(released.whole.family)
    assert mass == pytest.approx(DENSITY * 1e-9 * ROUND * pieces * piece, rel=1e-5)


def test_a_wire_without_density_has_no_mass() -> None:
    released, elements = dish()
    light = WIRE.model_copy(update={"density": None})
    assert loaded(released, elements, LoadCase(pressure=SMALL), light).mass is None


@pytest.mark.parametrize(
    "case",
    [
        LoadCase(gravity=(30.0, -40.0, -90.0)),
        LoadCase(pressure=-1e-3),
        LoadCase(wind=WindCase(dynamic_pressure=1e-2)),
        LoadCase(forces=(PointForce(node=(2, -1), force=(1.0, 2.0, -5.0)),)),
        LoadCase(gravity=(0.0, 0.0, -50.0), pressure=2e-4),
    ],
    ids=["gravity", "pressure", "wind", "force", "two"],
)
def test_what_holds_the_grid_balances_what_loads_it(case: LoadCase) -> None:
    """Forces and, since the rim turns freely, their moments too: at the release and under the load."""
    released, elements = dish()
    assert_balance(released.whole.positions, released.reactions, released.largest_reaction)
    under = loaded(released, elements, case)
    assert under.outcome is Outcome.CONVERGED
    assert under.load > 0.02 * released.largest_reaction
    assert_balance(under.whole.positions, under.applied + under.reactions, under.load)


def assert_balance(positions: Floats, forces: Floats, size: float) -> None:
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-6 * size)
    np.testing.assert_allclose(np.cross(positions, forces).sum(axis=0), 0.0, atol=1e-7 * size * 5 * STEP)


def test_gravity_pulls_with_the_weight_of_the_wires() -> None:
    released, elements = dish()
    direction = np.array([0.3, -0.4, -0.9])
    under = loaded(released, elements, LoadCase(gravity=tuple(direction)))
    assert under.mass is not None
    # A tonne mm/s² is a newton; the mass is told in kilograms.
    np.testing.assert_allclose(under.applied.sum(axis=0), 1e-3 * under.mass * EARTH * direction, rtol=1e-12)


def test_pressure_acts_on_the_cloth_and_wind_on_its_wires_alone() -> None:
    """On a flat grid: p times its area, and c q times what its wires cover, each crossing counted once."""
    laid = grid(step=(10.0, 8.0), size=(80.5, 64.5), weave="stacked")
    elements = straight(laid.step)
    released = let_go(laid, elements, "rim")
    pressed_ = loaded(released, elements, LoadCase(pressure=SMALL))
    np.testing.assert_allclose(pressed_.applied.sum(axis=0), (0, 0, SMALL * 80 * 64), rtol=1e-12, atol=1e-18)
    blown = loaded(released, elements, LoadCase(wind=WindCase(dynamic_pressure=SMALL, coefficient=1.3)))
    wires_, crossings = 9 * 80 + 9 * 64, 81
    covered = WIRE.diameter * wires_ - WIRE.diameter**2 * crossings
    np.testing.assert_allclose(blown.applied.sum(axis=0), (0, 0, 1.3 * SMALL * covered), rtol=1e-12, atol=1e-18)


def test_pressure_follows_the_normals_of_the_released_shape() -> None:
    released, elements = dish()
    under = loaded(released, elements, LoadCase(pressure=1e-6))
    inner = (np.abs(released.whole.index) <= 2).all(axis=1)
    expected = 1e-6 * STEP**2 * released.whole.normals[inner]
    np.testing.assert_allclose(under.applied[inner], expected, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_the_compliance_is_that_of_small_loads_whatever_their_size(symmetry: str) -> None:
    released, elements = dish(symmetry, HoldFrom(from_radius=40.0))
    weights = [loaded(released, elements, LoadCase(gravity=(0.0, 0.0, -g))) for g in (1.0, 2.0, 0.01)]
    for under in weights[1:]:
        assert under.compliance == pytest.approx(weights[0].compliance, rel=1e-6)

    small = [under.rms_deflection / under.load - under.compliance for under in weights[:2]]
    assert abs(small[0]) < 1e-3 * weights[0].compliance
    # What is left is of second order: in proportion to the load.
    assert small[1] / small[0] == pytest.approx(2.0, rel=0.05)
