"""Why a grid springs back: the parts add up, each is what it says it is, and little is left over."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_grids import PUNCH, STEP, Plane, grid, wires
from stretched import KEPT, dish

from punchform.arrays import Floats
from punchform.case import CrossingSpring, ParaboloidProfile, PressCase, PunchCase, ReleaseCase
from punchform.case.release import Hold, HoldFrom, HoldNodes, HoldPoints
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.kinematics import spread
from punchform.mechanics.linear import solver_for
from punchform.prepare import prepare
from punchform.press import Formed, press
from punchform.punch import Surface, surface
from punchform.release import Released, free_energy, release
from punchform.run import Run
from punchform.springback import Springback, pulls
from punchform.whole import unfold_vectors
from punchform.wire import Element

RADIUS, RIM = 5.2 * STEP, 4.0 * STEP
SPRING = CrossingSpring(stiffness=300.0)


def parts(done: Run) -> tuple[Formed, Released, Springback]:
    assert done.released is not None
    assert done.released.split is not None
    return done.formed, done.released, done.released.split


def energy_of(done: Run, *, rim_held: bool = False) -> tuple[Energy, Floats]:
    """The energy of the released grid, and the end forces of the formed one."""
    formed, released, _ = parts(done)
    case = done.case
    held = replace(released.hold, held=released.hold.held | (formed.held & rim_held))
    held = replace(held, fixed=held.fixed & ~held.held[:, None])
    elements = prepare(case).elements
    settings = case.framed(case.press)
    energy = free_energy(formed.grid, elements, settings, held, released.state, crossing=case.grid.crossing)
    return energy, energy.elastic(formed.state)[1]


def shifts(energy: Energy, step: Floats) -> Floats:
    grid = energy.grid
    first = np.where(grid.passes[:, 0], 0, 1)
    slots = spread(energy.kinematics.unknowns, step).reshape(grid.nodes, 2, -1)
    return unfold_vectors(grid, slots[np.arange(grid.nodes), first, :3])


@pytest.mark.parametrize("hold", [KEPT, '"rim"', '"nothing"'])
def test_the_parts_are_all_of_the_springback(hold: str) -> None:
    _, released, split = parts(dish(hold))
    whole = sum(part.moved for part in (split.membrane, split.bending, split.rim, split.remainder))
    np.testing.assert_allclose(whole, released.moved, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(split.total.moved, released.moved)
    assert split.total.apex == pytest.approx(released.apex, abs=1e-12)
    assert split.total.largest == pytest.approx(np.linalg.norm(released.moved, axis=1).max())


@pytest.mark.parametrize("hold", [KEPT, '"rim"'])
def test_the_linear_parts_add_up_to_the_linear_answer_of_all(hold: str) -> None:
    done = dish(hold)
    _, released, split = parts(done)
    energy, F = energy_of(done)
    chart = energy.kinematics.chart(released.state)
    factor = solver_for(energy.pattern).factor(energy.model(chart, Hessian.EXACT).values)
    together = shifts(energy, factor.solve(-energy.gradient_of(chart, F)))
    found = split.membrane.moved + split.bending.moved + split.rim.moved
    np.testing.assert_allclose(found, together, rtol=0, atol=1e-9 * np.abs(together).max())


def test_the_rim_part_is_the_answer_to_what_the_rim_takes_without_the_punch() -> None:
    done = dish('"rim"')
    formed, released, split = parts(done)
    energy, F = energy_of(done)
    held, _ = energy_of(done, rim_held=True)
    chart = energy.kinematics.chart(released.state)
    factor = solver_for(energy.pattern).factor(energy.model(chart, Hessian.EXACT).values)
    of_rim = held.kinematics.chart(released.state)
    answer = solver_for(held.pattern).factor(held.model(of_rim, Hessian.EXACT).values)
    step = answer.solve(-held.gradient_of(of_rim, F))
    unknowns, kept = energy.kinematics.unknowns, held.kinematics.unknowns >= 0
    whole_step = np.zeros(energy.kinematics.count)
    whole_step[unknowns[kept]] = step[held.kinematics.unknowns[kept]]
    taken = factor.times(whole_step) + energy.gradient_of(chart, F)

    at_rim = np.zeros(energy.kinematics.count, dtype=bool)
    theirs = unknowns.reshape(formed.grid.nodes, -1)[formed.held]
    at_rim[theirs[theirs >= 0]] = True
    assert np.abs(taken[~at_rim]).max() < 1e-9 * np.abs(taken[at_rim]).max()
    found = shifts(energy, factor.solve(-taken))
    np.testing.assert_allclose(split.rim.moved, found, rtol=0, atol=1e-8 * np.abs(found).max())
    assert split.rim.largest > 0.05 * split.total.largest


def test_a_rim_that_stays_held_has_no_part() -> None:
    _, _, split = parts(dish())
    assert not split.rim.moved.any()
    assert split.rim.rms == split.rim.apex == split.rim.largest == 0.0


def test_little_is_left_over_when_a_stretched_dish_is_let_go() -> None:
    formed, _, split = parts(dish())
    assert formed.yielded > 0.8
    assert split.remainder.rms < 0.06 * split.total.rms
    assert split.membrane.rms > split.bending.rms


@pytest.mark.parametrize("crossing", ["", 'crossing = "welded"', 'crossing = { stiffness = "300 N*mm/rad" }'])
def test_so_it_is_with_every_sort_of_crossing(crossing: str) -> None:
    _, _, split = parts(dish(KEPT, 'rim = "clamp"', crossing))
    assert split.remainder.rms < 0.05 * split.total.rms


def test_a_holder_that_lets_go_is_a_rim_that_lets_go() -> None:
    formed, _, split = parts(
        dish('"nothing"', 'hold = { force_per_length = "20 N/mm", friction = 0.2 }', 'crossing = "welded"')
    )
    assert formed.held.any()
    assert (np.linalg.norm(formed.state.positions[formed.held, :2], axis=1) > 60.0).all()
    assert split.rim.largest > 0


# --- elastic wires ------------------------------------------------------------------------------------------


def let_go(
    tool: Surface,
    case: PressCase,
    hold: Hold,
    elements: tuple[Element, ...],
    crossing: str | CrossingSpring,
    **more: str,
) -> tuple[Formed, Released]:
    formed = press(grid(RADIUS, **more), elements, tool, case, crossing=crossing)
    return formed, release(formed, elements, ReleaseCase(hold=hold), case, crossing=crossing)


def shallow(focal_length: float) -> Surface:
    return surface(PunchCase(profile=ParaboloidProfile(focal_length=focal_length), rim_radius=RIM, fillet=20.0))


@pytest.mark.parametrize("crossing", ["welded", SPRING])
def test_what_is_left_over_falls_faster_than_the_depth(crossing: str | CrossingSpring) -> None:
    left = []
    for focal_length in (2000.0, 4000.0):
        case = PressCase(frame="chord")
        _, released = let_go(shallow(focal_length), case, "rim", wires(), crossing)
        assert released.split is not None
        left.append(released.split.remainder.rms / released.split.total.rms)
    assert left[1] < 0.6 * left[0]
    assert left[0] < 0.1


def test_straight_wires_stretched_in_their_plane_spring_back_by_their_pull_alone() -> None:
    case = PressCase(frame="chord", pull=(20.0, 20.0))
    straight = wires(height=0.0, straight=True)
    hold = HoldNodes(nodes=((2, 0), (-2, 0)))
    _, released = let_go(Plane(), case, hold, straight, "welded")
    split = released.split
    assert split is not None
    assert split.membrane.largest > 1e-3
    assert max(split.bending.largest, split.rim.largest) < 1e-9 * split.membrane.largest
    assert split.remainder.largest < 1e-2 * split.membrane.largest


def test_a_quarter_and_the_whole_grid_let_go_of_it_tell_the_same() -> None:
    case, supports = PressCase(rim="clamp"), HoldPoints(points=8, radius=30.0)
    formed = press(grid(RADIUS), wires(), shallow(400.0), case, crossing="welded")
    tell = [
        release(formed, wires(), ReleaseCase(hold=supports), case, crossing="welded", full_grid=full)
        for full in (None, grid(RADIUS, symmetry="full"))
    ]
    assert formed.grid.quarter
    one, other = (released.split for released in tell)
    assert one is not None
    assert other is not None
    for name in ("membrane", "bending", "rim"):
        mine, theirs = getattr(one, name), getattr(other, name)
        np.testing.assert_allclose(mine.moved, theirs.moved, rtol=0, atol=1e-6 * np.abs(theirs.moved).max())
        assert (mine.rms, mine.apex) == pytest.approx((theirs.rms, theirs.apex), rel=1e-6)


@pytest.mark.parametrize("hold", [KEPT, '"rim"'])
def test_all_end_forces_together_are_the_gradient(hold: str) -> None:
    done = dish(hold)
    energy, F = energy_of(done)
    chart = energy.kinematics.chart(done.formed.state)
    whole = energy.gradient(chart).gradient
    np.testing.assert_allclose(energy.gradient_of(chart, F), whole, rtol=0, atol=1e-9 * np.abs(whole).max())
    part = pulls(energy, F)
    halves = energy.gradient_of(chart, part) + energy.gradient_of(chart, F - part)
    np.testing.assert_allclose(halves, whole, rtol=0, atol=1e-9 * np.abs(whole).max())


def test_the_pull_of_a_wire_is_along_its_chord() -> None:
    energy, F = energy_of(dish())
    mine = pulls(energy, F)
    rise, step = energy.bars.rise[energy.grid.kind], energy.bars.length[energy.grid.kind]
    np.testing.assert_allclose(mine[:, 2] * step, mine[:, 0] * rise, atol=1e-9)
    np.testing.assert_allclose(pulls(energy, mine), mine, rtol=1e-12)
    np.testing.assert_allclose(pulls(energy, F - mine), 0.0, atol=1e-9 * np.abs(F).max())
    assert not mine[:, [1, 3, 4, 5]].any()


def test_it_is_told_of_chords_after_a_press_and_where_something_stays() -> None:
    formed, released = let_go(PUNCH, PressCase(frame="O"), HoldFrom(from_radius=RIM), wires(), "pinned")
    assert released.split is None
    assert not formed.held.any()
    flat = let_go(shallow(400.0), PressCase(rim="clamp"), "rim", wires(), "welded")[1]
    assert flat.energy < 1e-12
    assert flat.split is None
    again = release(released, wires(), ReleaseCase(hold="rim"), PressCase(frame="chord"))
    assert again.split is None
