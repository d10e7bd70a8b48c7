"""The release and the load on small grids: what is held, equilibrium, symmetry, stability, and what is refused."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from small_grids import PUNCH, STEP, grid, wire_case, wires

import punchform.release as release_module
from punchform import read_case, run
from punchform.arrays import Bools, Floats
from punchform.case import (
    CrossingSpring,
    HoldFrom,
    HoldNodes,
    HoldPoints,
    HoldRing,
    LoadCase,
    PointForce,
    PressCase,
    ReleaseCase,
    Rib,
    SolverCase,
    WindCase,
)
from punchform.case.release import Hold
from punchform.errors import InputError, NoEquilibrium
from punchform.grid import Grid
from punchform.holds import holds
from punchform.load import Loaded, load
from punchform.mechanics.assembly import Hessian
from punchform.mechanics.linear import solver_for
from punchform.mechanics.outcome import Outcome, Solution
from punchform.press import Formed, press
from punchform.progress import Progress
from punchform.release import SHARES, Released, free_energy, release
from punchform.testing import assert_equilibrium
from punchform.whole import state_on

RADIUS = 5.2 * STEP
RIM = 4.0 * STEP
SPRING = CrossingSpring(stiffness=300.0)
HOLDS: dict[str, Hold] = {
    "from": HoldFrom(from_radius=RIM),
    "ring": HoldRing(ring=RIM),
    "rim": "rim",
    "points": HoldPoints(points=8, radius=RIM),
    "nodes": HoldNodes(nodes=((4, 0), (-4, 0), (0, 4), (0, -4), (3, 3), (-3, -3), (3, -3), (-3, 3))),
}
DOWN = LoadCase(gravity=(0.0, 0.0, -1.0))


@cache
def formed(symmetry: str = "quarter", crossing: str | CrossingSpring = "pinned") -> Formed:
    laid = grid(RADIUS, symmetry=symmetry)
    return press(laid, wires(laid.step), PUNCH, PressCase(), crossing=crossing)


def let_go(
    hold: Hold = "nothing",
    *ribs: Rib,
    symmetry: str = "quarter",
    crossing: str | CrossingSpring = "pinned",
    full_grid: Grid | None = None,
    **settings: Any,
) -> Released:
    before = formed(symmetry, crossing)
    case = ReleaseCase(hold=hold, ribs=ribs)
    return release(
        before, wires(before.grid.step), case, PressCase(), crossing=crossing, full_grid=full_grid, **settings
    )


def loaded(released: Released, case: LoadCase, **settings: Any) -> Loaded:
    wire = wire_case().model_copy(update={"density": 7850.0})
    return load(released, wires(released.grid.step), case, wire, PressCase(), **settings)


def nodes_at(released: Released, *numbers: tuple[int, int]) -> list[int]:
    """Places of nodes of the whole grid."""
    return [int(np.flatnonzero((released.whole.index == number).all(axis=1))[0]) for number in numbers]


# --- what is held -------------------------------------------------------------------------------------------


def where_held(released: Released) -> Bools:
    """Which directions of the whole grid's nodes carry a reaction, (N, 3)."""
    return np.asarray(np.abs(released.reactions) > 1e-9 * released.largest_reaction)


def test_held_from_a_radius_nodes_keep_places_and_frames() -> None:
    before, after = formed().whole, let_go(HOLDS["from"]).whole
    outer = np.linalg.norm(before.positions[:, :2], axis=1) >= RIM
    for name in ("positions", "normals", "tangents"):
        np.testing.assert_allclose(getattr(after, name)[outer], getattr(before, name)[outer], rtol=0, atol=1e-12)
    assert np.linalg.norm(after.positions - before.positions, axis=1)[~outer].min() > 1e-3


def test_a_ring_keeps_heights_alone() -> None:
    released = let_go(HOLDS["ring"])
    radius = np.linalg.norm(formed().whole.positions[:, :2], axis=1)
    on = np.abs(radius - RIM) <= 0.5 * STEP
    assert on.any()
    np.testing.assert_allclose(released.moved[on, 2], 0.0, atol=1e-12)
    assert np.linalg.norm(released.moved[on, :2], axis=1).max() > 0.01
    np.testing.assert_array_equal(where_held(released).any(axis=0), (False, False, True))
    assert not where_held(released)[~on].any()


def test_the_rim_keeps_the_places_of_the_wire_ends_which_turn_freely() -> None:
    released = let_go("rim")
    i, j = released.whole.index.T
    there = {tuple(node) for node in released.whole.index.tolist()}
    ends = np.array(
        [len({(a + 1, b), (a - 1, b), (a, b + 1), (a, b - 1)} & there) < 4 for a, b in zip(i, j, strict=True)]
    )
    np.testing.assert_allclose(released.moved[ends], 0.0, atol=1e-12)
    assert not where_held(released)[~ends].any()
    assert released.hold.count == np.count_nonzero(released.hold.fixed.all(axis=1))
    turned = np.abs(released.whole.normals - formed().whole.normals)[ends].max()
    assert turned > 0.01


@pytest.mark.parametrize(("points", "first"), [(4, 0.0), (4, np.pi / 4), (8, 0.0), (2, np.pi / 2)])
def test_supports_stand_under_the_nearest_crossings(points: int, first: float) -> None:
    released = let_go(HoldPoints(points=points, radius=30.0, first=first))
    angles = first + 2 * np.pi * np.arange(points) / points
    places = 30.0 * np.column_stack((np.cos(angles), np.sin(angles)))
    before = formed().whole.positions
    nearest = np.linalg.norm(before[:, None, :2] - places[None], axis=2).argmin(axis=0)
    np.testing.assert_allclose(released.moved[nearest], 0.0, atol=1e-12)
    others = np.ones(len(before), dtype=bool)
    others[nearest] = False
    assert not where_held(released)[others].any()


def test_a_quarter_holds_no_image_that_was_not_named() -> None:
    with pytest.raises(InputError, match=r"mirror images \(-3, -2\), \(-3, 2\), \(0, 4\), \(3, -2\) too"):
        let_go(HoldNodes(nodes=((3, 2), (0, -4))))


def test_chosen_nodes_keep_their_places() -> None:
    released = let_go(HoldNodes(nodes=((3, 2), (-3, 2), (3, -2), (-3, -2), (0, 4), (0, -4))))
    held = nodes_at(released, (3, 2), (-3, 2), (3, -2), (-3, -2), (0, 4), (0, -4))
    np.testing.assert_allclose(released.moved[held], 0.0, atol=1e-12)
    assert set(np.flatnonzero(where_held(released).any(axis=1))) <= set(held)


def test_nothing_holds_the_flat_grid() -> None:
    released = let_go()
    assert released.energy == 0.0
    assert released.outcome is Outcome.CONVERGED
    assert released.hold.count == 0
    np.testing.assert_allclose(released.whole.positions, released.whole.flat, atol=1e-12)
    assert any("spring back to the flat grid" in note for note in released.notes)


@pytest.mark.parametrize(
    ("rib", "lift"),
    [(Rib(radius=2 * STEP), 0.0), (Rib(radius=2 * STEP, lift=0.5), 0.5), (Rib(spokes=4, lift=-0.3), -0.3)],
    ids=["hoop", "raised", "spokes"],
)
@pytest.mark.parametrize("hold", ["from", "points"])
def test_a_rib_holds_heights_at_its_lift(hold: str, rib: Rib, lift: float) -> None:
    released = let_go(HOLDS[hold], rib)
    before = formed().whole.positions
    if rib.spokes is None:
        on = np.abs(np.hypot(*before[:, :2].T) - 2 * STEP) <= 0.5 * STEP
    else:
        on = np.abs(before[:, :2]).min(axis=1) <= 0.5 * STEP
    on &= ~where_kept(released)
    assert on.sum() >= 8
    np.testing.assert_allclose(released.moved[on, 2], lift, atol=1e-12)
    assert np.linalg.norm(released.moved[on, :2], axis=1).max() > 1e-3


def where_kept(released: Released) -> Bools:
    """Nodes that the hold itself keeps at their height."""
    return np.asarray(np.abs(released.moved[:, 2]) < 1e-12) & where_held(released)[:, :2].any(axis=1)


def test_a_hoop_may_stand_at_a_height_of_its_own() -> None:
    height = formed().whole.positions[:, 2].max() - 2.0
    released = let_go(HOLDS["ring"], Rib(radius=2 * STEP, height=height))
    on = np.abs(np.hypot(*formed().whole.positions[:, :2].T) - 2 * STEP) <= 0.5 * STEP
    np.testing.assert_allclose(released.whole.positions[on, 2], height, atol=1e-12)


def test_the_extremes_are_told_of_the_whole_grid() -> None:
    released = let_go(HOLDS["from"])
    assert released.apex == released.moved[nodes_at(released, (0, 0))[0], 2]
    assert released.max_sag == released.moved[:, 2].min() < 0
    # Of mirror images that sank alike the one in the first quadrant is named.
    assert (released.whole.index[released.lowest] >= 0).all()
    assert released.largest_reaction == np.linalg.norm(released.reactions, axis=1).max()


# --- equilibrium --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("crossing", ["pinned", "welded", SPRING], ids=["pinned", "welded", "spring"])
@pytest.mark.parametrize("hold", HOLDS)
def test_without_the_tool_every_free_node_is_in_balance(hold: str, crossing: str | CrossingSpring) -> None:
    released = let_go(HOLDS[hold], crossing=crossing)
    energy = free_energy(
        released.grid, wires(released.grid.step), PressCase(), released.hold, released.state, crossing=crossing
    )
    assert_equilibrium(energy, released.state, tolerance=1e-11)
    assert not released.whole.contact.any()
    assert released.energy == pytest.approx(released.grid.copies * energy.at(released.state), rel=1e-12)
    # What holds it is in balance as a whole.
    np.testing.assert_allclose(released.reactions.sum(axis=0), 0.0, atol=1e-6 * released.largest_reaction)


@pytest.mark.parametrize("hold", ["from", "ring", "points"])
@pytest.mark.parametrize("crossing", ["pinned", SPRING], ids=["pinned", "spring"])
def test_quarter_and_whole_grid_find_the_same_release(hold: str, crossing: str | CrossingSpring) -> None:
    quarter = let_go(HOLDS[hold], crossing=crossing)
    assert quarter.stability.negative == 0
    again = let_go(HOLDS[hold], crossing=crossing, full_grid=grid(RADIUS, symmetry="full"))
    assert not again.grid.quarter
    assert again.energy == pytest.approx(quarter.energy, rel=1e-9)
    # Without a hold sideways the whole grid may shift and turn as it likes: compare what that leaves.
    for one, other in (
        (again.whole.positions[:, 2], quarter.whole.positions[:, 2]),
        (again.moved[:, 2], quarter.moved[:, 2]),
    ):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-5)
    size = quarter.largest_reaction
    np.testing.assert_allclose(again.reactions[:, 2], quarter.reactions[:, 2], rtol=0, atol=1e-4 * size)
    if hold != "ring":
        np.testing.assert_allclose(again.reactions, quarter.reactions, rtol=0, atol=1e-4 * size)


@pytest.mark.parametrize("hold", ["from", "points"])
def test_quarter_and_whole_grid_bear_a_load_alike(hold: str) -> None:
    quarter = loaded(let_go(HOLDS[hold]), DOWN)
    whole = loaded(let_go(HOLDS[hold], full_grid=grid(RADIUS, symmetry="full")), DOWN)
    assert whole.mass == pytest.approx(quarter.mass)
    assert whole.compliance == pytest.approx(quarter.compliance, rel=1e-6)
    for name in ("moved", "applied", "reactions"):
        one, other = getattr(whole, name), getattr(quarter, name)
        np.testing.assert_allclose(one, other, rtol=0, atol=2e-5 * np.abs(other).max(), err_msg=name)


def test_a_force_on_the_axis_is_shared_by_the_quarters() -> None:
    case = LoadCase(forces=(PointForce(node=(0, 0), force=(0.0, 0.0, -2.0)),))
    quarter = loaded(let_go(HOLDS["from"]), case)
    whole = loaded(let_go(HOLDS["from"], full_grid=grid(RADIUS, symmetry="full")), case)
    assert quarter.load == whole.load == pytest.approx(2.0)
    np.testing.assert_allclose(whole.moved, quarter.moved, rtol=0, atol=1e-6 * quarter.largest_deflection)


# --- stability ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hold", "ribs"),
    [
        ("from", (Rib(spokes=4, lift=-0.5),)),
        ("rim", (Rib(radius=2 * STEP, lift=1.0),)),
        ("from", (Rib(radius=2 * STEP, height=14.0),)),
        ("points", (Rib(radius=2 * STEP, height=14.0),)),
        ("from", ()),
    ],
    ids=["spokes", "hoop", "crushed", "crushed on points", "stable"],
)
def test_the_kinds_of_motions_count_what_the_whole_grid_counts(hold: str, ribs: tuple[Rib, ...]) -> None:
    """Eq. (7.2): negative eigenvalues of four small matrices are those of the large one, at the same state."""
    quarter = let_go(HOLDS[hold], *ribs)
    full = grid(RADIUS, symmetry="full")
    state = state_on(full, quarter.whole)
    held = holds(full, state_on(full, formed().whole).positions, ReleaseCase(hold=HOLDS[hold], ribs=ribs))
    energy = free_energy(full, wires(full.step), PressCase(), held, state, crossing="pinned")
    assert_equilibrium(energy, state, tolerance=1e-10)
    values = energy.model(energy.kinematics.chart(state), Hessian.EXACT).values
    negative = solver_for(energy.pattern).factor(values).negative
    assert quarter.stability.negative == negative
    assert (negative == 0) == (hold == "from" and not ribs)
    unstable = any("the whole grid would leave" in note for note in quarter.notes)
    assert unstable == bool(negative)


@pytest.mark.parametrize("hold", ["from", "rim"])
def test_the_whole_grid_leaves_an_unstable_quarter_for_less_energy(hold: str) -> None:
    ribs = (Rib(spokes=4, lift=-0.5),) if hold == "from" else (Rib(radius=2 * STEP, lift=1.0),)
    quarter = let_go(HOLDS[hold], *ribs)
    whole = let_go(HOLDS[hold], *ribs, full_grid=grid(RADIUS, symmetry="full"))
    assert quarter.outcome is whole.outcome is Outcome.CONVERGED
    assert whole.stability.negative == 0
    assert whole.energy < quarter.energy * (1 - 1e-3)


def test_the_lowest_mode_moves_what_is_free_by_one_at_most() -> None:
    quarter = let_go(HOLDS["from"], Rib(spokes=4, lift=-0.5))
    mode = quarter.stability.mode
    assert mode is not None
    assert np.linalg.norm(mode, axis=1).max() == pytest.approx(1.0)
    outer = np.linalg.norm(formed().whole.positions[:, :2], axis=1) >= RIM
    np.testing.assert_allclose(mode[outer], 0.0, atol=1e-12)
    # It is not symmetric: it changes its sign across a mirror plane.
    image = nodes_at(quarter, *((-i, j) for i, j in quarter.whole.index.tolist()))
    other = nodes_at(quarter, *((i, -j) for i, j in quarter.whole.index.tolist()))
    odd = [
        np.allclose(mode[there] * flip, -mode, atol=1e-9) for there, flip in ((image, (-1, 1, 1)), (other, (1, -1, 1)))
    ]
    assert any(odd)


def test_a_coarse_dish_on_its_rim_is_left_by_the_whole_grid() -> None:
    """The check case with twice the step: what its fine grid does too, only quicker."""
    case = read_case("packaged:check")
    coarse = case.grid.model_copy(update={"step": (15.0, 15.0)})
    found = []
    for symmetry in ("as pressed", "full"):
        how = ReleaseCase.model_validate({"hold": "rim", "symmetry": symmetry})
        released = run(case.model_copy(update={"grid": coarse, "release": how})).released
        assert released is not None
        found.append(released)
    quarter, whole = found
    assert quarter.stability.negative == 1
    assert any('release.symmetry = "full"' in note for note in quarter.notes)
    assert whole.stability.negative == 0
    assert whole.energy < quarter.energy - 1.0


# --- how it is solved ---------------------------------------------------------------------------------------


def with_failing(monkeypatch: pytest.MonkeyPatch, failing: dict[int, Outcome]) -> list[Floats | None]:
    """Let the passes with these numbers fail; the loads of all passes are noted."""
    minimised, loads = release_module._minimised, []

    def counted(energy: Any, *arguments: Any, **settings: Any) -> Solution:
        solution = minimised(energy, *arguments, **settings)
        loads.append(None if energy.loads is None else energy.loads.forces)
        outcome = failing.get(len(loads) - 1, solution.outcome)
        return Solution(**{**vars(solution), "outcome": outcome})

    monkeypatch.setattr(release_module, "_minimised", counted)
    return loads


@pytest.mark.parametrize(
    "failing",
    [{0: Outcome.SINGULAR}, {0: Outcome.STEP_LIMIT, 1: Outcome.NO_DESCENT}],
    ids=["soft pass singular", "both passes fail"],
)
def test_a_grid_that_cannot_be_let_go_at_once_is_let_go_bit_by_bit(
    monkeypatch: pytest.MonkeyPatch, failing: dict[int, Outcome]
) -> None:
    at_once = let_go(HOLDS["from"])
    loads = with_failing(monkeypatch, failing)
    bit_by_bit = let_go(HOLDS["from"])
    assert len(loads) == len(failing) + len(SHARES)
    assert bit_by_bit.outcome is Outcome.CONVERGED
    assert bit_by_bit.energy == pytest.approx(at_once.energy, rel=1e-9)
    assert bit_by_bit.factorisations > at_once.factorisations
    shares = loads[len(failing) :]
    assert shares[-1] is None
    first = shares[0]
    assert first is not None
    for share, force in zip(SHARES[:-1], shares[:-1], strict=True):
        assert force is not None
        np.testing.assert_allclose(force / share, first / SHARES[0], rtol=1e-12)


def test_a_release_that_never_ends_says_how_it_ended() -> None:
    with pytest.raises(NoEquilibrium, match="release: the step limit was reached"):
        let_go(HOLDS["from"], solver=SolverCase(max_steps=1))


def test_a_load_that_never_ends_says_how_it_ended() -> None:
    heavy = LoadCase(forces=(PointForce(node=(0, 0), force=(0.0, 0.0, -50.0)),))
    with pytest.raises(NoEquilibrium, match="load: the step limit was reached"):
        loaded(let_go(HOLDS["from"]), heavy, solver=SolverCase(max_steps=1))


def test_both_stages_tell_how_far_they_are() -> None:
    told: list[Progress] = []
    released = let_go(HOLDS["from"], observe=told.append)
    loaded(released, DOWN, observe=told.append)
    assert [stage for stage, *_ in dict.fromkeys((one.stage,) for one in told)] == ["release", "load"]


# --- what is refused ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hold", "ribs", "message", "where"),
    [
        (HoldFrom(from_radius=90.0), (), "no crossing was formed at or beyond 90 mm", "release.hold.from_radius"),
        (HoldFrom(from_radius=0.0), (), "nothing would be let go", "release.hold.from_radius"),
        (HoldRing(ring=90.0), (), "within half a step of 90 mm", "release.hold.ring"),
        (HoldPoints(points=4, radius=90.0), (), "has no crossing within one step", "release.hold.radius"),
        (HoldPoints(points=3, radius=RIM), (), "not symmetric about both axes", "release.hold"),
        (HoldPoints(points=4, radius=RIM, first=0.3), (), "not symmetric about both axes", "release.hold"),
        (HoldNodes(nodes=((9, 9), (0, 0), (8, 0))), (), r"the grid has no crossing \(9, 9\)", "release.hold.nodes"),
        ("rim", (Rib(radius=10.0), Rib(radius=90.0)), "within half a step of this rib", "release.ribs[1]"),
    ],
    ids=["from", "all", "ring", "points", "three", "turned", "nodes", "rib"],
)
def test_holds_that_hold_nothing_are_refused(hold: Hold, ribs: tuple[Rib, ...], message: str, where: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        let_go(hold, *ribs)
    assert all(problem.where == where for problem in refused.value.problems)
    assert where == "release.hold.nodes" or refused.value.problems[0].hint


def test_all_missing_nodes_are_named_at_once() -> None:
    with pytest.raises(InputError) as refused:
        let_go(HoldNodes(nodes=((9, 9), (0, 0), (-8, 0))))
    assert [problem.message for problem in refused.value.problems] == [
        "the grid has no crossing (9, 9)",
        "the grid has no crossing (-8, 0)",
    ]


def test_three_supports_are_fine_for_a_whole_grid() -> None:
    released = let_go(HoldPoints(points=3, radius=RIM), full_grid=grid(RADIUS, symmetry="full"))
    assert released.hold.count == 3
    assert released.stability.negative == 0


@pytest.mark.parametrize(
    ("case", "message", "where"),
    [
        (LoadCase(gravity=(1.0, 0.0, -1.0)), "not symmetric about both axes", "load.gravity"),
        (LoadCase(forces=(PointForce(node=(1, 0), force=(0, 0, 1)),)), "not symmetric", "load.forces"),
        (LoadCase(forces=(PointForce(node=(0, 0), force=(1, 0, 0)),)), "not symmetric", "load.forces"),
        (LoadCase(forces=(PointForce(node=(0, 99), force=(0, 0, 1)),)), r"no crossing \(0, 99\)", "load.forces"),
    ],
    ids=["gravity", "aside", "sideways", "missing"],
)
def test_loads_that_a_quarter_cannot_bear_are_refused(case: LoadCase, message: str, where: str) -> None:
    released = let_go(HOLDS["from"])
    with pytest.raises(InputError, match=message) as refused:
        loaded(released, case)
    assert refused.value.problems[0].where == where


def test_a_whole_grid_bears_them() -> None:
    whole = let_go(HOLDS["from"], full_grid=grid(RADIUS, symmetry="full"))
    aside = LoadCase(
        gravity=(1.0, 0.0, -1.0),
        wind=WindCase(dynamic_pressure=1e-4),
        forces=(PointForce(node=(1, 0), force=(0.0, 0.5, 1.0)),),
    )
    under = loaded(whole, aside)
    assert under.outcome is Outcome.CONVERGED
    assert under.largest_deflection > 0


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"radius": 10.0, "spokes": 4}, "either a hoop with a radius or a number of spokes"),
        ({}, "either a hoop with a radius or a number of spokes"),
        ({"spokes": 4, "height": 10.0}, "a height is for a hoop"),
        ({"radius": 10.0, "height": 10.0, "lift": 1.0}, "a height is for a hoop"),
    ],
)
def test_a_rib_is_one_line_at_one_height(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Rib(**settings)


def test_a_load_without_loads_is_refused() -> None:
    with pytest.raises(ValueError, match="no load is given"):
        LoadCase()
