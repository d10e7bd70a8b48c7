"""The press in strokes and the blank holder: limits, closed forms, balance of energy, what is told and refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_grids import (
    BLANK,
    PUNCH,
    SHALLOW,
    STEP,
    Plane,
    assert_equal_grids,
    bars,
    energy_of,
    free_frames,
    grid,
    nobody,
    wires,
)

from punchform import holder as holders
from punchform.arrays import Bools
from punchform.case import (
    CaseText,
    CircleBlank,
    CrossingSpring,
    GridCase,
    HolderCase,
    ParaboloidProfile,
    PressCase,
    PunchCase,
    SolverCase,
    parse,
)
from punchform.errors import InputError, NoEquilibrium
from punchform.grid import Grid, lay
from punchform.holder import SLACK, TRAIL, Holder, holder
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Loads
from punchform.mechanics.frames import State
from punchform.mechanics.friction import Friction
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome, Solution
from punchform.press import Formed, clamped, press
from punchform.press import energy_of as pressed_energy
from punchform.progress import Progress
from punchform.punch import surface
from punchform.start import flat
from punchform.strokes import Lying, Task, carried, go_down, strokes_of
from punchform.testing import assert_derivatives, assert_equilibrium
from punchform.wire import pieces

WIDE = BLANK + 8.0
RIM = surface(PunchCase(profile=ParaboloidProfile(focal_length=100.0), rim_radius=40.3, fillet=20.0))
"""A punch on whose rim lies no node of the grids here."""


def pressed(
    laid: Grid | None = None, *, tool: Any = PUNCH, crossing: str | CrossingSpring = "pinned", **how: Any
) -> Formed:
    laid = grid(BLANK) if laid is None else laid
    return press(laid, wires(laid.step), tool, PressCase(**how), crossing=crossing)


def held(force: float, friction: float = 0.15) -> HolderCase:
    return HolderCase(force_per_length=force, friction=friction)


# --- strokes without a history --------------------------------------------------------------------------------

ELASTIC: dict[str, dict[str, Any]] = {
    "pinned": {"frame": "chord"},
    "frame O": {},
    "welded": {"crossing": "welded"},
    "spring": {"crossing": CrossingSpring(stiffness=300.0)},
    "clamped": {"rim": "clamp", "tool": SHALLOW},
    "differences": {"kinematics": "differences"},
    "pulled": {"pull": (3.0, 2.0)},
}


# On a punch that is hardly down a whole grid slides where it is pulled, which no pull that follows it can bear.
EVERY = [(name, symmetry) for name in ELASTIC for symmetry in ("quarter", "full")]
EVERY.remove(("pulled", "full"))


@pytest.mark.parametrize(("name", "symmetry"), EVERY)
def test_elastic_wires_do_not_remember_their_strokes(name: str, symmetry: str) -> None:
    setting = ELASTIC[name]
    once = pressed(grid(BLANK, symmetry=symmetry), **setting)
    for count in (2, 5):
        often = pressed(grid(BLANK, symmetry=symmetry), strokes=count, **setting)
        assert often.outcome is Outcome.CONVERGED
        assert often.energy == pytest.approx(once.energy, rel=1e-9)
        # The pull is followed until the wire ends turn by less than 1e-9.
        assert_equal_grids(often.whole, once.whole, 1e-7 if name == "pulled" else 1e-8)
        assert often.notes == once.notes
    np.testing.assert_allclose(
        often.whole.positions, once.whole.positions, atol=1e-9 * BLANK if name != "pulled" else 1e-6
    )


def test_what_is_told_of_the_strokes_adds_up() -> None:
    formed = pressed(strokes=4, frame="chord")
    assert [stroke.share for stroke in formed.strokes] == [0.25, 0.5, 0.75, 1.0]
    assert sum(stroke.steps for stroke in formed.strokes) == formed.steps
    assert sum(stroke.factorisations for stroke in formed.strokes) == formed.factorisations
    assert len(formed.history) == formed.strokes[-1].steps
    assert formed.strokes[-1].energy == pytest.approx(formed.energy, rel=1e-12)
    assert (np.diff([stroke.energy for stroke in formed.strokes]) > 0).all()
    assert all(stroke.friction_work == 0 for stroke in formed.strokes)
    once = pressed()
    (only,) = once.strokes
    assert (only.share, only.steps, only.factorisations, only.energy) == (
        1.0,
        once.steps,
        once.factorisations,
        once.energy,
    )
    assert formed.seconds["total"] > 0


def test_one_stroke_where_nothing_is_remembered_and_twelve_where_something_is() -> None:
    assert strokes_of(PressCase()) == strokes_of(PressCase(rim="clamp")) == 1
    assert strokes_of(PressCase(hold=held(1.0))) == 12
    assert strokes_of(PressCase(hold=held(1.0), strokes=3)) == 3


def test_a_start_of_ones_own_is_one_stroke() -> None:
    laid, elements, case = grid(BLANK), wires(), PressCase(strokes=3, frame="chord")
    once = press(laid, elements, PUNCH, case)
    again = press(laid, elements, PUNCH, case, start=once.state)
    assert len(again.strokes) == 1
    assert again.energy == pytest.approx(once.energy, rel=1e-12)


def test_the_steps_name_their_stroke() -> None:
    told: list[Progress] = []
    press(grid(BLANK), wires(), PUNCH, PressCase(strokes=2), observe=told.append)
    assert {event.stage for event in told if event.step >= 0} == {"press, 50% down", "press, 100% down"}


# --- how a stroke begins and what happens to one that fails --------------------------------------------------


def form_of(
    laid: Grid, *, tool: Any = PUNCH, case: PressCase | None = None
) -> Callable[[Task], tuple[Energy, Solution]]:
    case = case or PressCase(frame="chord")

    def form(task: Task) -> tuple[Energy, Solution]:
        energy = pressed_energy(laid, wires(), task.tool, case, start=task.start, friction=task.friction)
        return energy, minimise(energy, task.start)

    return form


def test_a_stroke_begins_on_the_line_through_the_two_before_it() -> None:
    laid = grid(BLANK)
    seen: list[Task] = []
    states: list[State] = []

    def form(task: Task) -> tuple[Energy, Solution]:
        seen.append(task)
        energy, solution = form_of(laid)(task)
        states.append(solution.state)
        return energy, solution

    go_down(laid, PUNCH, 8, form, held=nobody(laid))
    from_flat = [np.abs(task.tool.distance(task.start.positions)).max() for task in seen]
    assert max(from_flat) < 1e-9
    # Nearer than the place before it by an order in the length of a stroke.
    for task, before, after in list(zip(seen[1:], states, states[1:], strict=False))[2:]:
        missed = np.abs(task.start.positions - after.positions)[:, :2].max()
        assert missed < 0.5 * np.abs(before.positions - after.positions)[:, :2].max()
        np.testing.assert_allclose(np.linalg.norm(task.start.normals, axis=1), 1.0)
        np.testing.assert_allclose(np.einsum("nwc,nc->nw", task.start.tangents, task.start.normals), 0, atol=1e-12)


def test_what_is_held_is_not_carried_on() -> None:
    laid = grid(BLANK)
    still = clamped(laid, PUNCH)
    low = replace(flat(laid), positions=flat(laid).positions + 0.1)
    start = carried(Lying(0.25, flat(laid), None), Lying(0.5, low, None), PUNCH, 1.0, still)
    np.testing.assert_array_equal(start.positions[still, :2], low.positions[still, :2])
    np.testing.assert_array_equal(start.tangents[still], low.tangents[still])
    assert np.abs(start.positions[~still, :2] - low.positions[~still, :2]).min() > 0.05


def test_a_stroke_that_fails_is_halved() -> None:
    laid = grid(BLANK)
    reached = [0.0]

    def timid(task: Task) -> tuple[Energy, Solution]:
        energy, solution = form_of(laid)(task)
        if task.share - reached[-1] > 0.13:
            return energy, replace(solution, outcome=Outcome.NO_DESCENT)
        reached.append(task.share)
        return energy, solution

    down = go_down(laid, PUNCH, 4, timid, held=nobody(laid))
    np.testing.assert_allclose([stroke.share for stroke in down.strokes], np.arange(1, 9) / 8)
    at_once = pressed(frame="chord")
    assert down.strokes[-1].energy == pytest.approx(at_once.energy, rel=1e-9)


def test_a_press_that_ends_on_the_way_says_where() -> None:
    laid = grid(BLANK)

    def stuck(task: Task) -> tuple[Energy, Solution]:
        if task.share > 0.5:
            raise NoEquilibrium("the wires are knotted")
        return form_of(laid)(task)

    with pytest.raises(NoEquilibrium, match=r"came down to 0\.5 of the depth .* at 0\.516.*wires are knotted"):
        go_down(laid, PUNCH, 4, stuck, held=nobody(laid))
    with pytest.raises(NoEquilibrium, match=r"came down to 0 of the depth .*step limit"):
        press(laid, wires(), PUNCH, PressCase(strokes=2), solver=SolverCase(max_steps=1))


def test_what_a_grid_remembers_is_settled_after_each_stroke() -> None:
    laid = grid(BLANK)
    settled: list[float] = []

    def settle(energy: Energy, state: State) -> State:
        settled.append(energy.at(state))
        return replace(state, positions=state.positions + 0.0)

    down = go_down(laid, PUNCH, 3, form_of(laid), held=nobody(laid), settle=settle)
    assert [laid.copies * energy for energy in settled] == pytest.approx([stroke.energy for stroke in down.strokes])


# --- friction in closed form ---------------------------------------------------------------------------------

COUNT = 8
GRIPPED = 5.0


def pulled_wires(force: float, slack: float = 1e-6) -> tuple[Grid, Energy, Solution, Friction]:
    """Straight wires in a plane, held in the middle by the mirror, every crossing gripped, all ends along x pulled."""
    laid = grid(size=((2 * COUNT + 0.4) * STEP, 2.4 * STEP))
    friction = Friction(laid.flat.astype(float), GRIPPED * laid.node_weight * (laid.index[:, 0] > 0), slack)
    share = np.where(laid.on_mirror[:, 1], 0.5, 1.0)
    forces = np.zeros((laid.nodes, 3))
    forces[:, 0] = np.where(laid.index[:, 0] == COUNT, force * share, 0.0)
    made_of = bars(wires(straight=True, height=0.0), chord=True)
    start = flat(laid)
    energy = energy_of(
        free_frames(laid, Plane()),
        made_of=made_of,
        loads=Loads(forces, start.positions),
        friction=friction,
        crossing=1.0,
    )
    return laid, energy, minimise(energy, start), friction


@pytest.mark.parametrize("crossings", [0.5, 3.5, 7.5, 8.5, 12.0])
def test_a_pulled_wire_passes_on_what_the_crossings_do_not_hold(crossings: float) -> None:
    force = crossings * GRIPPED
    laid, energy, solution, friction = pulled_wires(force)
    assert solution.outcome is Outcome.CONVERGED
    assert_equilibrium(energy, solution.state, tolerance=1e-10)
    F = energy.elastic(solution.state)[1]
    along = laid.family == 0
    outside = COUNT - np.maximum(laid.index[laid.start[along], 0], laid.index[laid.end[along], 0]) + 1
    np.testing.assert_allclose(F[along, 0], np.maximum(force - GRIPPED * outside, 0.0), atol=2e-3 * GRIPPED)
    # It slips where it is pulled harder than all crossings from there to its end can hold, and nowhere else.
    slipped = friction.slip(solution.state) > TRAIL * friction.slack
    from_end = COUNT + 1 - laid.index[:, 0]
    np.testing.assert_array_equal(slipped, (laid.index[:, 0] > 0) & (from_end < crossings))


def test_the_stretch_of_a_pulled_wire_is_that_of_its_tensions() -> None:
    force = 12 * GRIPPED
    laid, _, solution, _ = pulled_wires(force)
    section = wires(straight=True)[0].section
    assert section is not None
    stretched = sum((force - GRIPPED * k) * STEP / section.EA for k in range(1, COUNT + 1))
    # The element's own tension ends half-way: what the last crossing holds does not pull at the wire beyond it.
    end = laid.index[:, 0] == COUNT
    moved = (solution.state.positions - flat(laid).positions)[end, 0]
    np.testing.assert_allclose(moved, stretched, rtol=1e-5)


def test_a_smaller_slack_changes_what_it_should() -> None:
    # The creep of what sticks goes with the slack, and so do the tensions that it lets by.
    moved = []
    for slack in (1e-3, 5e-4, 2.5e-4):
        laid, _, solution, _ = pulled_wires(3.5 * GRIPPED, slack)
        moved.append((solution.state.positions - flat(laid).positions)[laid.index[:, 0] == COUNT, 0].max())
    assert moved[0] > moved[1] > moved[2]
    assert moved[1] - moved[2] < 0.7 * (moved[0] - moved[1])


@settings(max_examples=20, deadline=None)
@given(
    slip=st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
    slack=st.floats(1e-6, 1.0),
    capacity=st.just(0.0) | st.floats(1e-3, 1e3),
)
def test_friction_is_convex_and_never_more_than_its_capacity(
    slip: tuple[float, float], slack: float, capacity: float
) -> None:
    rubbed = Friction(np.zeros((1, 2)), np.array([capacity]), slack)
    state = State(np.array([[*slip, 3.0]]), np.eye(3)[2:], np.eye(3)[None, :2])
    force = np.linalg.norm(rubbed.gradient(state))
    assert force <= capacity * (1 + 1e-12)
    assert np.linalg.eigvalsh(rubbed.hessian(state)).min() >= -1e-9 * max(capacity / slack, 1e-300)
    potential = rubbed.energies(rubbed.slip(state))[0]
    assert 0 <= potential <= capacity * np.hypot(*slip) * (1 + 1e-12)
    if np.hypot(*slip) > TRAIL * slack:
        assert force >= 0.98 * capacity


# --- the holder ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
@pytest.mark.parametrize("centre", ["node", "cell"])
def test_the_crossings_of_the_flange_share_the_force_of_both_faces(symmetry: str, centre: str) -> None:
    laid = grid(WIDE, symmetry=symmetry, centre=centre)
    made = holder(laid, RIM.rim_radius, held(5.0, 0.2))
    rubbed = made.friction(flat(laid), made.at_rest())
    whole = laid.copies * rubbed.capacity.sum()
    assert whole == pytest.approx(2 * 0.2 * 5.0 * 2 * np.pi * RIM.rim_radius)
    rho = np.linalg.norm(laid.flat, axis=1)
    assert not rubbed.capacity[rho <= RIM.rim_radius].any()
    assert not rubbed.capacity[~laid.passes.all(axis=1)].any()
    inside = laid.passes.all(axis=1) & (rho > RIM.rim_radius)
    assert (rubbed.capacity[inside] > 0).all()
    # A whole crossing a step outside the rim holds as much as any other.
    full = inside & (rho >= RIM.rim_radius + STEP) & ~laid.wire_ends.any(axis=(1, 2))
    np.testing.assert_allclose((rubbed.capacity / laid.node_weight)[full], (rubbed.capacity / laid.node_weight).max())


def test_a_quarter_grips_like_the_whole() -> None:
    for force in (1.0, 60.0, 1e4):
        quarter, whole = (
            pressed(grid(WIDE, symmetry=symmetry), tool=RIM, hold=held(force), strokes=6)
            for symmetry in ("quarter", "full")
        )
        assert whole.energy == pytest.approx(quarter.energy, rel=1e-8)
        assert_equal_grids(whole.whole, quarter.whole, 1e-6)
        assert whole.grip is not None
        assert quarter.grip is not None
        assert whole.grip.work == pytest.approx(quarter.grip.work, rel=1e-6)
        assert whole.grip.largest_slip == pytest.approx(quarter.grip.largest_slip, rel=1e-6)
        assert whole.grip.slipped == pytest.approx(quarter.grip.slipped)


def test_a_holder_without_force_is_a_free_flange() -> None:
    free = pressed(frame="chord")
    for none in (held(0.0), held(5.0, 0.0)):
        loose = pressed(hold=none)
        assert loose.energy == pytest.approx(free.energy, rel=1e-9)
        assert_equal_grids(loose.whole, free.whole, 1e-8)
        assert loose.grip is not None
        assert loose.grip.work == 0
        assert loose.grip.largest_slip == pytest.approx(free.draw_in, rel=0.1)


class Nailed(FreeFrames):
    """Free frames whose nodes beyond the rim keep their places, but not their frames."""

    def _free(self) -> Bools:
        free = super()._free()
        free[np.linalg.norm(self.grid.flat, axis=1) > RIM.rim_radius, :2] = False
        return free


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_a_strong_holder_nails_the_flange(symmetry: str) -> None:
    laid = lay(GridCase(step=(STEP, STEP), blank=CircleBlank(radius=58.0), symmetry=symmetry))
    gripped = laid.passes.all(axis=1) | (np.linalg.norm(laid.flat, axis=1) < RIM.rim_radius)
    assert gripped.all()
    start = flat(laid)
    tight = pressed(laid, tool=RIM, hold=held(1e7))
    frames = Nailed(laid, RIM, nobody(laid))
    nailed = minimise(Energy(laid, bars(wires(), chord=True), frames), tight.state)
    assert nailed.outcome is Outcome.CONVERGED
    moved = tight.state.positions - nailed.state.positions
    assert np.abs(moved).max() < SLACK * STEP
    beyond = np.linalg.norm(laid.flat, axis=1) > RIM.rim_radius
    assert np.abs((tight.state.positions - start.positions)[beyond]).max() < SLACK * STEP
    energy = Energy(laid, bars(wires(), chord=True), frames).at(nailed.state)
    assert tight.energy == pytest.approx(laid.copies * energy, rel=1e-4)
    assert tight.grip is not None
    assert tight.grip.slipped == tight.grip.work == tight.grip.largest_slip == 0
    assert any("lets nothing slip" in note for note in tight.notes)
    # A clamp holds the frames of the flange too.
    clamp = pressed(laid, tool=RIM, rim="clamp")
    assert tight.energy < clamp.energy < 1.5 * tight.energy


def test_the_harder_it_holds_the_less_is_drawn_in() -> None:
    found = [pressed(tool=RIM, laid=grid(WIDE), hold=held(force)) for force in (0.0, 1.0, 10.0, 100.0, 1000.0)]
    assert (np.diff([formed.draw_in for formed in found]) < 0).all()
    assert (np.diff([formed.energy for formed in found]) > 0).all()
    assert (np.diff([formed.max_axial_strain for formed in found]) > 0).all()
    assert all(stroke.friction_work >= 0 for formed in found for stroke in formed.strokes)
    assert all(formed.outcome is Outcome.CONVERGED for formed in found)


def test_only_the_product_of_force_and_friction_counts() -> None:
    one, other = pressed(hold=held(20.0, 0.1)), pressed(hold=held(5.0, 0.4))
    assert_equal_grids(one.whole, other.whole, 1e-9)


def test_the_punch_does_the_work_that_the_wires_keep_and_the_friction_takes() -> None:
    # At the minimum the potential changes with the depth by the work of the tool alone: sum of contact · dz, and a
    # point of the punch rises by its whole height per share.
    laid = grid(WIDE)
    made = holder(laid, RIM.rim_radius, held(30.0))
    rates, stored = [0.0], [0.0]

    def settle(energy: Energy, state: State) -> State:
        chart = energy.kinematics.chart(state)
        upwards = energy.kinematics.surface.gap(state.positions).gradient[:, 2]  # type: ignore[attr-defined]
        contact = chart.contact(energy.gradient(chart).G)
        rates.append(laid.copies * float(np.sum(contact * upwards * state.positions[:, 2])) * count / (len(rates)))
        assert energy.friction is not None
        trailing = np.minimum(energy.friction.slip(state), TRAIL * made.slack)
        stored.append(laid.copies * float(energy.friction.energies(trailing).sum()))
        return state

    missed = []
    for count in (12, 24):
        rates = [0.0]
        down = go_down(laid, RIM, count, form_of(laid), held=nobody(laid), holder=made, settle=settle)
        by_punch = float(np.trapezoid(rates, dx=1 / count))
        kept = down.strokes[-1].energy + stored[-1]
        taken = sum(stroke.friction_work for stroke in down.strokes)
        assert taken > 0.3 * kept
        missed.append(abs(by_punch - kept - taken) / by_punch)
    # What is left is that the friction of a crossing changes where it has come nearer to the rim.
    assert max(missed) < 2e-3


def test_more_strokes_change_little() -> None:
    found = [pressed(grid(WIDE), tool=RIM, hold=held(30.0), strokes=count) for count in (6, 12, 24)]
    for fewer in found[:2]:
        assert fewer.energy == pytest.approx(found[2].energy, rel=1e-3)
        assert np.abs(fewer.whole.positions - found[2].whole.positions).max() < SLACK * STEP


def test_half_the_slack_changes_nothing_visible(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for slack in (SLACK, 0.5 * SLACK):
        monkeypatch.setattr(holders, "SLACK", slack)
        found.append(pressed(grid(WIDE), tool=RIM, hold=held(30.0)))
    usual, half = found
    assert half.energy == pytest.approx(usual.energy, rel=5e-3)
    assert np.abs(half.whole.positions - usual.whole.positions).max() < TRAIL * SLACK * STEP


def test_an_anchor_stays_with_what_sticks_and_trails_what_slips() -> None:
    laid = grid(WIDE)
    made = holder(laid, RIM.rim_radius, held(10.0))
    rest = made.at_rest()
    rubbed = made.friction(flat(laid), rest)
    shift = np.zeros((laid.nodes, 3))
    shift[:, 0] = (
        np.where(np.arange(laid.nodes) % 2 == 0, 3.0, 0.5 * TRAIL)
        * made.slack
        * np.where(np.arange(laid.nodes) % 2 == 0, TRAIL, 1.0)
    )
    after = replace(flat(laid), positions=flat(laid).positions + shift)
    grasp = made.settled(rubbed, flat(laid), after, rest)
    gripped = rubbed.capacity > 0
    slips, sticks = (gripped & (np.arange(laid.nodes) % 2 == parity) for parity in (0, 1))
    np.testing.assert_allclose(grasp.anchors[slips], (after.positions[:, :2] - (TRAIL * made.slack, 0.0))[slips])
    np.testing.assert_array_equal(grasp.anchors[sticks], laid.flat[sticks])
    np.testing.assert_allclose(grasp.slid[slips], 2 * TRAIL * made.slack)
    assert not grasp.slid[sticks].any()
    # What is not gripped has no anchor to remember.
    np.testing.assert_array_equal(grasp.anchors[~gripped], after.positions[~gripped, :2])
    # The force goes on where it was, and the work that is lost is that of the drag.
    again = made.friction(flat(laid), grasp)
    np.testing.assert_allclose(again.gradient(after)[sticks], rubbed.gradient(after)[sticks])
    expected = (rubbed.capacity[slips] * 2 * TRAIL * made.slack).sum()
    assert grasp.work == pytest.approx(expected, rel=0.01)


def test_derivatives_hold_on_the_flange() -> None:
    laid = grid(WIDE)
    formed = pressed(laid, tool=RIM, hold=held(30.0))
    made = holder(laid, RIM.rim_radius, held(30.0))
    rubbed = replace(made.friction(formed.state, made.at_rest()), slack=0.05)
    energy = pressed_energy(laid, wires(), RIM, PressCase(hold=held(30.0)), start=formed.state, friction=rubbed)
    assert energy.bars.chord
    assert_derivatives(energy, formed.state, rng=np.random.default_rng(3))


def test_a_weak_holder_says_so() -> None:
    laid = lay(GridCase(step=(STEP, STEP), blank=CircleBlank(radius=58.0)))
    deep = surface(PunchCase(profile=ParaboloidProfile(focal_length=40.0), rim_radius=40.3, fillet=20.0))
    formed = pressed(laid, tool=deep, hold=held(0.01))
    assert formed.grip is not None
    assert formed.grip.slipped == 1.0
    assert any("brakes the flange but does not hold it" in note for note in formed.notes)


SORTS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "welded": ({}, {"crossing": "welded"}),
    "spring": ({}, {"crossing": CrossingSpring(stiffness=100.0)}),
    "rectangle": ({"size": (140.0, 110.0), "step": (STEP, 8.0)}, {}),
    "whole": ({"symmetry": "full"}, {"crossing": "welded"}),
}


@pytest.mark.parametrize("name", SORTS)
def test_every_sort_of_grid_can_be_held(name: str) -> None:
    laid_as, how = SORTS[name]
    laid = grid(WIDE, **laid_as)
    free, braked = pressed(laid, frame="chord", **how), pressed(laid, hold=held(5.0), **how)
    assert braked.outcome is Outcome.CONVERGED
    assert braked.grip is not None
    # A little friction takes what it resists over the way that the free flange goes, to first order.
    rubbed = holder(laid, PUNCH.rim_radius, held(5.0))
    capacity = laid.copies * rubbed.friction(flat(laid), rubbed.at_rest()).capacity
    way = np.linalg.norm(free.state.positions[:, :2] - laid.flat, axis=1)
    assert braked.grip.work == pytest.approx(capacity @ way, rel=0.2)
    assert free.energy < braked.energy < 1.01 * free.energy


def test_a_cut_wire_is_gripped_at_its_crossings() -> None:
    laid = grid(WIDE, subdivide=2)
    cut = pieces(wires(), 2)
    once, often = (press(laid, cut, PUNCH, PressCase(frame="chord", strokes=count)) for count in (1, 3))
    assert often.energy == pytest.approx(once.energy, rel=1e-9)
    made = holder(laid, PUNCH.rim_radius, held(5.0))
    capacity = made.friction(flat(laid), made.at_rest()).capacity
    assert not capacity[~laid.crossings].any()
    assert capacity[laid.crossings].any()
    assert press(laid, cut, PUNCH, PressCase(hold=held(5.0))).outcome is Outcome.CONVERGED


def test_a_blank_that_leaves_its_holder_is_free() -> None:
    # The last crossings pass the rim on the way; a whole grid may then turn about the axis, at no cost.
    tool = surface(PunchCase(profile=ParaboloidProfile(focal_length=100.0), rim_radius=41.2, fillet=20.0))
    laid = lay(GridCase(step=(STEP, STEP), blank=CircleBlank(radius=42.0), symmetry="full"))
    formed, free = pressed(laid, tool=tool, hold=held(5.0)), pressed(laid, tool=tool, frame="chord")
    assert formed.outcome is Outcome.CONVERGED
    assert formed.strokes[0].energy > 0
    assert formed.strokes[-1].friction_work == 0
    assert formed.energy == pytest.approx(free.energy, rel=1e-9)
    assert any("drawn in past the rim" in note for note in formed.notes)


def test_there_must_be_a_flange() -> None:
    laid = grid(2.2 * STEP)
    with pytest.raises(InputError, match="no crossing lies outside the rim"):
        pressed(laid, tool=RIM, hold=held(1.0))
    with pytest.raises(InputError, match="no crossing lies outside the rim"):
        pressed(laid, tool=Plane(), hold=held(1.0))


def test_a_grip_of_nothing_is_no_force() -> None:
    laid = grid(WIDE)
    made = Holder(laid, 40.3, 100.0, 1e-3)
    drawn = replace(flat(laid), positions=0.1 * flat(laid).positions)
    assert not made.friction(drawn, made.at_rest()).capacity.any()


# --- from a case file ------------------------------------------------------------------------------------------


def test_a_case_with_a_holder_tells_what_it_did(tmp_path: Path) -> None:
    from punchform.cli.form import summary
    from punchform.export.result import result
    from punchform.report.page import page
    from punchform.run import run

    text = """\
schema = 1
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "60 mm" }
[wire]
diameter = "1 mm"
youngs_modulus = "210 GPa"
[punch]
profile = { kind = "paraboloid", focal_length = "100 mm" }
rim_radius = "40 mm"
fillet = "20 mm"
[press]
hold = { force_per_length = "20 kN/m", friction = 0.2 }
strokes = 3
"""
    case = parse(CaseText(text, "dish.toml"))
    assert case.press.hold == HolderCase(force_per_length=20.0, friction=0.2)
    assert case.press.chord
    done = run(case)
    told: Any = result(done)
    formed, grip = told["formed"], done.formed.grip
    assert grip is not None
    assert [stroke["share"] for stroke in formed["strokes"]] == pytest.approx([1 / 3, 2 / 3, 1])
    assert formed["holder"] == {
        "friction_work_mJ": grip.work,
        "largest_slip_mm": grip.largest_slip,
        "slipped_share": grip.slipped,
    }
    assert "of its crossings slipped" in summary(done, tmp_path)
    assert "in 3 strokes" in summary(done, tmp_path)
    html = page(done, ())
    assert "between the faces of the holder" in html
    assert "Work against the friction of the holder" in html
    assert "66.7" in html
    assert 0 < formed["strokes"][0]["energy_mJ"] < formed["strokes"][-1]["energy_mJ"]
