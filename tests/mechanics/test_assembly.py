"""The assembled energy: its derivatives, its invariance, its unknowns; for every kinematics, crossing and hold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_grids import (
    STEP,
    Cylinder,
    bars,
    beyond,
    dead,
    dense,
    differences,
    energy_of,
    free_frames,
    grid,
    random_state,
    wires,
)

from punchform.grid import Grid
from punchform.mechanics import assembly
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.bars import Loads
from punchform.mechanics.cores import USEFUL, at_most, cores
from punchform.mechanics.frames import State
from punchform.mechanics.friction import Friction
from punchform.mechanics.pattern import shares
from punchform.punch import Paraboloid, Sphere
from punchform.testing import assert_derivatives, assert_rigid_invariance

SPHERE = Sphere(60.0)


def dead_loads(laid: Grid) -> Loads:
    return dead(laid, 20.0 * np.random.default_rng(3).standard_normal((laid.nodes, 3)))


def rubbed(laid: Grid, slack: float = 0.1) -> Friction:
    """Friction on every second node, from the flat grid: some nodes stick and some slip in a random state."""
    capacity = 30.0 * laid.node_weight * (laid.index.sum(axis=1) % 2)
    return Friction(laid.flat.astype(float), capacity, slack)


def clamped(laid: Grid) -> np.ndarray:
    return beyond(laid, 2.5 * STEP)


ENERGIES: dict[str, Callable[[], Energy]] = {
    "pinned": lambda: energy_of(free_frames(grid())),
    "pinned, whole": lambda: energy_of(free_frames(grid(symmetry="full"))),
    "welded": lambda: energy_of(free_frames(grid(), welded=True)),
    "welded, whole": lambda: energy_of(free_frames(grid(symmetry="full"), welded=True)),
    "spring": lambda: energy_of(free_frames(grid()), crossing=500.0),
    "clamped": lambda: energy_of(free_frames(laid := grid(), held=clamped(laid))),
    "clamped, welded": lambda: energy_of(free_frames(laid := grid(), held=clamped(laid), welded=True)),
    "cell": lambda: energy_of(free_frames(grid(centre="cell"))),
    "cell, same, spring": lambda: energy_of(free_frames(grid(centre="cell", weave="same")), crossing=500.0),
    "unequal steps": lambda: energy_of(free_frames(grid(step=(STEP, 7.0)))),
    "rectangle, stacked": lambda: energy_of(
        free_frames(laid := grid(size=(62.0, 41.0), weave="stacked")), made_of=bars(wires(laid.step, straight=True))
    ),
    "lower": lambda: energy_of(free_frames(grid(weave="same")), made_of=bars(wires(), share=1.0)),
    "loads": lambda: energy_of(free_frames(laid := grid()), loads=dead_loads(laid)),
    "friction": lambda: energy_of(free_frames(laid := grid()), friction=rubbed(laid)),
    "friction, whole, welded": lambda: energy_of(
        free_frames(laid := grid(symmetry="full"), welded=True), friction=rubbed(laid), loads=dead_loads(laid)
    ),
    "differences, friction": lambda: energy_of(differences(laid := grid()), friction=rubbed(laid)),
    "sphere": lambda: energy_of(free_frames(grid(symmetry="full"), SPHERE)),
    "cylinder": lambda: energy_of(free_frames(grid(symmetry="full"), Cylinder(50.0)), crossing=500.0),
    "no surface": lambda: energy_of(free_frames(grid(), None)),
    "no surface, whole": lambda: energy_of(free_frames(grid(symmetry="full"), None), crossing=500.0),
    "no surface, welded, loads": lambda: energy_of(
        free_frames(laid := grid(), None, welded=True), loads=dead_loads(laid)
    ),
    "no surface, clamped": lambda: energy_of(free_frames(laid := grid(), None, held=clamped(laid))),
    "differences": lambda: energy_of(differences(grid())),
    "differences, whole": lambda: energy_of(differences(grid(symmetry="full"))),
    "differences, cell": lambda: energy_of(differences(grid(centre="cell"))),
    "differences, spring": lambda: energy_of(differences(grid()), crossing=500.0),
    "differences, spring, whole": lambda: energy_of(differences(grid(symmetry="full")), crossing=500.0),
    "differences, clamped": lambda: energy_of(differences(laid := grid(), held=clamped(laid))),
    "differences, loads": lambda: energy_of(differences(laid := grid()), loads=dead_loads(laid)),
    "differences, lower": lambda: energy_of(differences(grid(weave="same")), made_of=bars(wires(), share=1.0)),
    "differences, unequal steps": lambda: energy_of(differences(grid(step=(STEP, 7.0)))),
    "differences, sphere": lambda: energy_of(differences(grid(symmetry="full"), SPHERE)),
    "differences, cylinder": lambda: energy_of(differences(grid(symmetry="full"), Cylinder(50.0))),
}
every_energy = pytest.mark.parametrize("name", ENERGIES)


def somewhere(energy: Energy, seed: int = 1, *, amount: float = 0.2) -> State:
    return random_state(energy.kinematics, energy.grid, np.random.default_rng(seed), amount=amount)


@every_energy
def test_gradient_and_hessian_are_the_derivatives_of_the_energy(name: str) -> None:
    energy = ENERGIES[name]()
    assert_derivatives(energy, somewhere(energy), rng=np.random.default_rng(2))


@every_energy
def test_the_gauss_newton_matrix_is_positive_semidefinite(name: str) -> None:
    energy = ENERGIES[name]()
    matrix = dense(energy, energy.model(energy.kinematics.chart(somewhere(energy)), Hessian.GAUSS_NEWTON).values)
    scale = np.sqrt(np.diag(matrix))
    assert np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0] > -1e-12


@every_energy
def test_the_projected_matrix_is_semidefinite_and_bounds_the_exact_one_from_above(name: str) -> None:
    energy = ENERGIES[name]()
    chart = energy.kinematics.chart(somewhere(energy))
    projected, exact = (dense(energy, energy.model(chart, kind).values) for kind in (Hessian.PROJECTED, Hessian.EXACT))
    scale = np.sqrt(np.diag(projected))
    for matrix in (projected, projected - exact):
        assert np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0] > -1e-12


@every_energy
def test_every_unknown_is_numbered_once_and_carries_stiffness(name: str) -> None:
    energy = ENERGIES[name]()
    used = np.unique(energy.kinematics.unknowns)
    np.testing.assert_array_equal(used[used >= 0], np.arange(energy.kinematics.count))
    # Also in the flat start, where nothing is bent that could lend an unknown its stiffness.
    for state in (somewhere(energy), somewhere(energy, amount=0.0)):
        values = energy.model(energy.kinematics.chart(state), Hessian.GAUSS_NEWTON).values
        assert np.diag(dense(energy, values)).min() > 1e-3


@every_energy
def test_a_rigid_motion_costs_nothing(name: str) -> None:
    energy = ENERGIES[name]()
    assert_rigid_invariance(energy, somewhere(energy), rng=np.random.default_rng(4))


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    amount=st.floats(0.0, 0.5),
    focal_length=st.floats(40.0, 1000.0),
    settled=st.sampled_from(("pinned", "welded", "spring", "differences", "3D")),
    quarter=st.booleans(),
    weave=st.sampled_from(("plain", "same")),
)
def test_derivatives_hold_in_random_states_of_random_grids(
    seed: int, amount: float, focal_length: float, settled: str, quarter: bool, weave: str
) -> None:
    laid = grid(2.3 * STEP, symmetry="quarter" if quarter else "full", weave=weave)
    surface = Paraboloid(focal_length)
    if settled == "differences":
        energy = energy_of(differences(laid, surface))
    else:
        tool = None if settled == "3D" else surface
        frames = free_frames(laid, tool, welded=settled == "welded")
        energy = energy_of(frames, crossing=300.0 if settled == "spring" else 0.0)
    rng = np.random.default_rng(seed)
    state = random_state(energy.kinematics, laid, rng, amount=amount)
    assert_derivatives(energy, state, rng=rng, directions=1)


def test_unknowns_of_free_frames_are_as_many_as_the_theory_says() -> None:
    # Per node two shifts, two tilts, and one spin for each wire that passes (section 4).
    whole = grid(symmetry="full")
    spins = int(whole.passes.sum())
    assert free_frames(whole).count == 4 * whole.nodes + spins
    assert free_frames(whole, None).count == 5 * whole.nodes + spins
    assert free_frames(whole, welded=True).count == 5 * whole.nodes
    assert differences(whole).count == 2 * whole.nodes
    # In a mirror plane one shift and one tilt are left and no spin; on the axis neither, but the height without a tool.
    quarter = grid()
    in_plane = int((quarter.on_mirror.sum(axis=1) == 1).sum())
    off = ~quarter.on_mirror.any(axis=1)
    expected = 4 * int(off.sum()) + int(quarter.passes[off].sum()) + 2 * in_plane
    assert free_frames(quarter).count == expected
    assert free_frames(quarter, None).count == expected + quarter.nodes
    assert differences(quarter).count == 2 * int(off.sum()) + in_plane


def test_a_node_that_one_wire_passes_has_one_spin() -> None:
    laid = grid(2.0 * STEP, symmetry="full")
    tip = int(np.flatnonzero((laid.index == (2, 0)).all(axis=1))[0])
    np.testing.assert_array_equal(laid.passes[tip], [True, False])
    assert (free_frames(laid).unknowns[2 * tip] >= 0).all()
    assert (free_frames(laid).unknowns[2 * tip + 1] == -1).all()


def test_held_nodes_do_not_move() -> None:
    laid = grid()
    held = clamped(laid)
    for kinematics in (free_frames(laid, held=held), free_frames(laid, None, held=held), differences(laid, held=held)):
        start = random_state(kinematics, laid, np.random.default_rng(0), amount=0.0)
        moved = kinematics.chart(start).moved(np.full(kinematics.count, 0.3))
        np.testing.assert_array_equal(moved.positions[held], start.positions[held])
        assert np.abs(moved.positions[~held] - start.positions[~held]).max() > 0.1


def test_nodes_on_mirror_planes_stay_there_with_their_wires_along_and_across() -> None:
    laid = grid()
    for kinematics in (free_frames(laid), free_frames(laid, None), differences(laid)):
        state = random_state(kinematics, laid, np.random.default_rng(5))
        for axis in range(2):
            on = laid.on_mirror[:, axis]
            across = np.eye(3)[axis]
            assert np.abs(state.positions[on, axis]).max() < 1e-14
            assert np.abs(state.normals[on] @ across).max() < 1e-14
            np.testing.assert_allclose(state.tangents[on, axis] @ across, 1.0, atol=1e-14)


def test_one_core_finds_what_two_find_to_the_last_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    """The strips of a large grid follow each other on one core and lie side by side on two; the sums are the same."""
    kinematics = free_frames(grid(12.5 * STEP, symmetry="full"))
    chart = kinematics.chart(somewhere(energy_of(kinematics, crossing=500.0)))
    whole = energy_of(kinematics, crossing=500.0).model(chart, Hessian.EXACT)
    monkeypatch.setattr(assembly, "WORTH_STRIPS", 0)
    together = energy_of(kinematics, crossing=500.0).model(chart, Hessian.EXACT)
    with at_most(1):
        assert cores() == 1
        alone = energy_of(kinematics, crossing=500.0).model(chart, Hessian.EXACT)
    assert cores() == USEFUL
    for name in ("energy", "gradient", "values", "G"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(together, name))
        scale = np.abs(getattr(whole, name)).max()
        np.testing.assert_allclose(getattr(together, name), getattr(whole, name), rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize(("symmetry", "threads"), [("full", 2), ("full", 3), ("quarter", 2)])
def test_strips_that_are_added_together_share_no_unknown(symmetry: str, threads: int) -> None:
    for kinematics in (free_frames(laid := grid(12.5 * STEP, symmetry=symmetry)), differences(laid)):
        energy = energy_of(kinematics)
        strips, seam = shares(laid, threads)
        assert len(strips) == threads
        np.testing.assert_array_equal(np.sort(np.concatenate((*strips, seam))), np.arange(laid.elements))
        unknowns = [np.unique(energy.kinematics.unknowns[rows(laid, strip)]) for strip in strips]
        # The rows of G are written without looking, so they must differ too.
        for written in ([one[one >= 0] for one in unknowns], [np.unique(rows(laid, strip)) for strip in strips]):
            assert len(np.unique(np.concatenate(written))) == sum(map(len, written))


def rows(laid: Grid, chosen: np.ndarray) -> np.ndarray:
    """The rows of R and G that elements use."""
    return np.asarray(2 * np.stack((laid.start[chosen], laid.end[chosen])) + laid.family[chosen])


def test_a_grid_too_narrow_for_strips_is_one_group() -> None:
    strips, seam = shares(grid(1.5 * STEP), 2)
    assert len(strips) == 1
    assert not len(seam)


def test_the_energy_of_a_state_that_is_not_finite_is_infinite() -> None:
    energy = energy_of(free_frames(grid()))
    state = somewhere(energy)
    lost = state.positions.copy()
    lost[0] = np.nan
    assert energy.at(State(lost, state.normals, state.tangents)) == np.inf


def test_the_flat_grid_on_a_plane_is_without_energy() -> None:
    # A crimped wire has D = 0 in the flat: the offset of its end is its rise.
    for weave in ("plain", "same"):
        laid = grid(weave=weave)
        state = State(
            np.column_stack((laid.flat, np.zeros(laid.nodes))),
            np.broadcast_to((0.0, 0.0, 1.0), (laid.nodes, 3)),
            np.broadcast_to(np.eye(3)[:2], (laid.nodes, 2, 3)),
        )
        assert energy_of(free_frames(laid)).at(state) < 1e-20


@pytest.mark.parametrize("name", ENERGIES)
def test_the_gradient_without_a_matrix_is_that_of_the_model(name: str) -> None:
    energy = ENERGIES[name]()
    chart = energy.kinematics.chart(somewhere(energy))
    alone, model = energy.gradient(chart), energy.model(chart, Hessian.EXACT)
    assert (alone.energy, alone.size, alone.rounding) == (model.energy, model.size, model.rounding)
    np.testing.assert_array_equal(alone.gradient, model.gradient)
    np.testing.assert_array_equal(alone.G, model.G)
