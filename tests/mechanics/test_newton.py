"""Newton's method: how fast it ends, every way it can end, and that start and linear solver do not show."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.util import find_spec
from itertools import pairwise

import numpy as np
import pytest
from small_grids import (
    BLANK,
    PUNCH,
    STEP,
    Plane,
    bars,
    dead,
    dense,
    differences,
    energy_of,
    free_frames,
    grid,
    outline,
    pinned,
    wires,
)

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State, squared
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome
from punchform.progress import Progress
from punchform.punch import Surface
from punchform.remarks import largest_pull
from punchform.start import flat_start
from punchform.testing import assert_equilibrium
from punchform.wire import Element

LIBRARIES = {"rslab": "rslab", "pardiso": "pymklpardiso", "scipy": "scipy"}
KINEMATICS = ("pinned", "welded", "differences")


def case(kinematics: str = "pinned", *, surface: Surface = PUNCH, symmetry: str = "quarter") -> tuple[Energy, State]:
    """The energy of a small grid on a punch and the paper's start."""
    laid = grid(BLANK, symmetry=symmetry)
    start = flat_start(laid, surface)
    if kinematics == "differences":
        return pinned(energy_of(differences(laid, surface)), start), start
    energy = energy_of(free_frames(laid, surface, welded=kinematics == "welded"))
    return pinned(energy, start), squared(start) if kinematics == "welded" else start


def disturbed(energy: Energy, state: State, seed: int, amount: float) -> State:
    rng = np.random.default_rng(seed)
    return energy.kinematics.chart(state).moved(amount * rng.uniform(-1.0, 1.0, energy.kinematics.count))


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_newton_is_quadratic_near_the_answer(kinematics: str) -> None:
    # The decrement relative to the energy goes with the square of the distance, so it is squared by every step.
    energy, start = case(kinematics)
    solution = minimise(energy, start, tolerance=1e-20)
    assert solution.outcome is Outcome.CONVERGED
    decrements = [step.decrement for step in solution.history if step.hessian == "exact" and step.decrement < 1e-3]
    assert len(decrements) >= 2
    for before, after in pairwise(decrements):
        assert after < 10 * before**2 + 1e-24


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_the_answer_is_a_minimum_in_equilibrium(kinematics: str) -> None:
    energy, start = case(kinematics)
    solution = minimise(energy, start)
    assert solution.outcome is Outcome.CONVERGED
    assert solution.negative_eigenvalues == 0
    assert solution.factorisations == len(solution.history) <= 8
    assert_equilibrium(energy, solution.state, tolerance=1e-20)
    hessian = energy.model(energy.kinematics.chart(solution.state), Hessian.EXACT).values
    assert np.linalg.eigvalsh(dense(energy, hessian))[0] > 0


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_no_neighbour_has_less_energy(kinematics: str) -> None:
    energy, start = case(kinematics)
    answer = minimise(energy, start).state
    least = energy.at(answer)
    for seed in range(20):
        assert energy.at(disturbed(energy, answer, seed, 0.02)) > least


@pytest.mark.parametrize(
    ("kinematics", "symmetry"),
    # Central differences do not see a zigzag: on the whole grid they have more minima than one.
    [("pinned", "quarter"), ("pinned", "full"), ("welded", "quarter"), ("welded", "full"), ("differences", "quarter")],
)
def test_the_answer_does_not_depend_on_the_start(kinematics: str, symmetry: str) -> None:
    energy, start = case(kinematics, symmetry=symmetry)
    expected = minimise(energy, start, tolerance=1e-18)
    for seed in range(3):
        found = minimise(energy, disturbed(energy, start, seed, 0.05), tolerance=1e-18)
        assert found.outcome is Outcome.CONVERGED
        assert energy.at(found.state) == pytest.approx(energy.at(expected.state), rel=1e-9)
        if symmetry == "quarter":
            np.testing.assert_allclose(found.state.positions, expected.state.positions, rtol=0, atol=1e-7)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_the_answer_does_not_depend_on_the_linear_solver(kinematics: str, library: str) -> None:
    if find_spec(LIBRARIES[library]) is None:
        pytest.skip(f"{LIBRARIES[library]} is not installed: the extra `fast` brings it where there are wheels")
    energy, start = case(kinematics, symmetry="full")
    expected = minimise(energy, start)
    found = minimise(energy, start, linear=library)
    assert found.linear_solver == library
    assert found.outcome is Outcome.CONVERGED
    assert energy.at(found.state) == pytest.approx(energy.at(expected.state), rel=1e-12)
    np.testing.assert_allclose(found.state.positions, expected.state.positions, rtol=1e-9, atol=1e-9 * STEP)
    np.testing.assert_allclose(found.state.tangents, expected.state.tangents, rtol=0, atol=1e-9)


def test_energy_falls_with_every_step() -> None:
    for kinematics in KINEMATICS:
        energy, start = case(kinematics)
        far = disturbed(energy, start, 0, 0.3)
        solution = minimise(energy, far)
        energies = [step.energy for step in solution.history]
        assert energies[0] == pytest.approx(energy.at(far), rel=1e-12)
        assert (np.diff(energies) <= 1e-12 * energies[-1]).all()
        assert energy.at(solution.state) <= energies[-1] * (1 + 1e-12)


def test_the_observer_sees_every_step_of_the_history() -> None:
    energy, start = case()
    seen: list[Progress] = []
    solution = minimise(energy, start, stage="press", observe=seen.append)
    assert [(event.step, event.energy) for event in seen] == [(step.number, step.energy) for step in solution.history]
    assert {event.stage for event in seen} == {"press"}


def test_seconds_are_split_without_a_rest() -> None:
    energy, start = case()
    seconds = minimise(energy, start).seconds
    assert set(seconds) == {"kernel", "assembly", "factorisation", "solve", "other", "total"}
    assert min(seconds.values()) >= 0
    assert sum(seconds.values()) == pytest.approx(2 * seconds["total"], rel=1e-6)


def test_a_start_at_the_answer_ends_at_once() -> None:
    energy, start = case()
    answer = minimise(energy, start, tolerance=1e-18)
    again = minimise(energy, answer.state)
    assert again.outcome is Outcome.CONVERGED
    assert again.factorisations <= 2
    np.testing.assert_allclose(again.state.positions, answer.state.positions, rtol=0, atol=1e-10)


# --- every way a solve can end ------------------------------------------------------------------------------


def test_too_few_steps_end_at_the_limit() -> None:
    energy, start = case()
    solution = minimise(energy, start, max_steps=2)
    assert solution.outcome is Outcome.STEP_LIMIT
    assert not solution.outcome.usable
    assert len(solution.history) == 2


def held_in_the_plane(strain: float, surface: Surface | None) -> tuple[Energy, State]:
    """A flat grid of thin straight wires whose edge is held nearer to the axis: everything is compressed alike."""
    laid = grid(4.2 * STEP, symmetry="full")
    flat = flat_start(laid, Plane())
    state = State(flat.positions * (1 - strain), flat.normals, flat.tangents)
    thin = bars(wires(diameter=0.3, straight=True, height=0.0))
    return energy_of(free_frames(laid, surface, held=outline(laid)), made_of=thin), state


def test_a_compressed_grid_that_could_buckle_is_stationary_but_no_minimum() -> None:
    energy, flat = held_in_the_plane(0.02, None)
    solution = minimise(energy, flat)
    assert solution.outcome is Outcome.SADDLE
    assert solution.outcome.usable
    hessian = energy.model(energy.kinematics.chart(solution.state), Hessian.EXACT).values
    assert solution.negative_eigenvalues == (np.linalg.eigvalsh(dense(energy, hessian)) < 0).sum() > 8
    # On a plane, which keeps it flat, the same grid is stable; and so it is when it is pulled a little instead.
    for other, state in (held_in_the_plane(0.02, Plane()), held_in_the_plane(-1e-4, None)):
        assert minimise(other, state).outcome is Outcome.CONVERGED


def thin_wire() -> Element:
    return wires(diameter=0.3, straight=True, height=0.0)[0]


def test_the_frame_at_one_end_limits_the_tension_of_thin_wires() -> None:
    # What Eq. (3.5) does not mend yet: turning the frame at O shortens D1, so a wire that is pulled hard seems to gain
    # by it. It begins at the centre line, whose nodes are O for the elements on both sides: their frames turn by theta,
    # the next by - theta / 2, then theta / 4 ..., against 3 EI / s² (the bulk of the wire would bear 4).
    element = thin_wire()
    C, section = element.C, element.section
    assert section is not None
    onset = element.length * (C[1, 1] - C[1, 5] ** 2 / C[5, 5])
    assert onset == pytest.approx(3 * section.EI / STEP**2, rel=1e-3)
    for share, stable in ((0.5, True), (0.99, True), (1.03, False), (3.0, False)):
        solution = minimise(*held_in_the_plane(-share * onset / section.EA, Plane()))
        assert (solution.outcome is Outcome.CONVERGED) == stable
        assert solution.outcome in (Outcome.CONVERGED, Outcome.SADDLE)


def test_the_largest_pull_that_a_user_is_told_of_is_still_sound() -> None:
    element = thin_wire()
    assert element.section is not None
    strain = 0.99 * largest_pull(element) / element.section.EA
    assert minimise(*held_in_the_plane(-strain, Plane())).outcome is Outcome.CONVERGED


def test_a_grid_that_may_buckle_does_so_once_it_is_disturbed() -> None:
    energy, flat = held_in_the_plane(0.02, None)
    solution = minimise(energy, disturbed(energy, flat, 0, 0.01), max_steps=200)
    assert solution.outcome is Outcome.CONVERGED
    assert solution.negative_eigenvalues == 0
    assert energy.at(solution.state) < 0.2 * energy.at(flat)
    assert np.abs(solution.state.positions[:, 2]).max() > 1.0


def test_a_saddle_with_few_modes_is_left_even_from_an_undisturbed_start() -> None:
    # Thick wires under a strain at which only few modes are unstable; every entry of the gradient is zero.
    laid = grid(5.2 * STEP, symmetry="full")
    flat = flat_start(laid, Plane())
    start = State(0.95 * flat.positions, flat.normals, flat.tangents)
    energy = energy_of(free_frames(laid, Plane(), held=outline(laid)), made_of=bars(wires(straight=True, height=0.0)))
    model = energy.model(energy.kinematics.chart(start), Hessian.EXACT)
    unstable = int((np.linalg.eigvalsh(dense(energy, model.values)) < 0).sum())
    assert 0 < unstable <= 8
    assert np.abs(model.gradient).max() < 1e-9
    solution = minimise(energy, start)
    assert solution.outcome is Outcome.CONVERGED
    assert energy.at(solution.state) < 0.5 * energy.at(start)


@pytest.mark.parametrize("library", LIBRARIES)
def test_wires_of_nothing_make_a_singular_matrix(library: str) -> None:
    if find_spec(LIBRARIES[library]) is None:
        pytest.skip(f"{LIBRARIES[library]} is not installed: the extra `fast` brings it where there are wheels")
    energy, start = case()
    weightless = replace(energy.bars, C=energy.bars.C * np.array([1.0, 0.0])[:, None, None])
    solution = minimise(replace(energy, bars=weightless), start, linear=library)
    assert solution.outcome is Outcome.SINGULAR
    assert not solution.outcome.usable


@dataclass(frozen=True)
class Trap(Plane):
    """A plane that has no height off the lines of the flat grid: whoever leaves his place is lost."""

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        away = np.abs(points[:, :2] / STEP - np.round(points[:, :2] / STEP)).max(axis=1) > 1e-12
        return np.where(away, np.nan, points[:, 2]), self.gap(points).gradient


def test_where_no_step_can_be_made_the_solve_says_so() -> None:
    laid = grid(3.2 * STEP)
    energy = energy_of(free_frames(laid, Trap()), loads=dead(laid, np.full((laid.nodes, 3), 5.0)))
    start = flat_start(laid, Plane())
    solution = minimise(energy, start)
    assert solution.outcome is Outcome.NO_DESCENT
    np.testing.assert_array_equal(solution.state.positions, start.positions)


def test_an_unloaded_flat_grid_is_at_rest() -> None:
    laid = grid(3.2 * STEP)
    energy = energy_of(free_frames(laid, Plane()), crossing=100.0)
    solution = minimise(energy, flat_start(laid, Plane()))
    assert solution.outcome is Outcome.CONVERGED
    assert energy.at(solution.state) < 1e-20


def test_a_solver_that_is_not_there_is_an_input_error() -> None:
    energy, start = case()
    with pytest.raises(InputError, match="no such linear solver"):
        minimise(energy, start, linear="abacus")


def test_every_outcome_has_its_own_advice() -> None:
    texts = [outcome.value for outcome in Outcome]
    assert len(set(texts)) == len(texts) == 6
    assert [outcome.name for outcome in Outcome if outcome.usable] == ["CONVERGED", "STATIONARY", "SADDLE"]
