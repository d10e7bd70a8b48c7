"""The check case of docs/theory.md, section 11: the figures of an independent prototype, to their digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from small_grids import assert_equal_grids

from punchform import Formed, read_case, run
from punchform.case import Case, HoldFrom, ReleaseCase
from punchform.mechanics.outcome import Outcome
from punchform.release import Released
from punchform.whole import Whole


def changed(case: Case, **sections: dict[str, Any]) -> Case:
    """The case with some settings of some sections replaced."""
    parts = {name: getattr(case, name).model_copy(update=settings) for name, settings in sections.items()}
    return case.model_copy(update=parts)


@pytest.fixture(scope="session")
def case() -> Case:
    return read_case("packaged:check")


@pytest.fixture(scope="session")
def formed(case: Case) -> Formed:
    return run(case).formed


@pytest.fixture(scope="session")
def released(case: Case) -> Released:
    return released_with(case, ReleaseCase(hold=HoldFrom(from_radius=300.0)))


def released_with(case: Case, release: ReleaseCase) -> Released:
    found = run(case.model_copy(update={"release": release})).released
    assert found is not None
    return found


@pytest.fixture(scope="session")
def formed_whole(case: Case) -> Formed:
    return run(changed(case, grid={"symmetry": "full"})).formed


@pytest.fixture(scope="session")
def papers_case(case: Case) -> Case:
    return changed(case, grid={"weave": "same"}, press={"kinematics": "differences", "offset": "lower"})


def at(whole: Whole, i: int, j: int) -> int:
    return int(np.flatnonzero((whole.index == (i, j)).all(axis=1))[0])


def test_the_grid_has_the_size_of_the_prototype(formed: Formed) -> None:
    assert formed.grid.quarter
    assert formed.solved_nodes == 1703
    assert formed.grid.elements == 3312
    # 46 nodes on each half axis are shared by two quarters, the one in the middle by four.
    assert len(formed.whole.index) == 4 * (1703 - 2 * 46 - 1) + 4 * 46 + 1


def test_the_energy_is_that_of_the_prototype(formed: Formed) -> None:
    assert formed.outcome is Outcome.CONVERGED
    assert formed.negative_eigenvalues == 0
    assert formed.energy == pytest.approx(6600.058, rel=1e-6)


@pytest.mark.parametrize(
    ("node", "position"),
    [
        ((10, 0), (74.72575, 0.0, 79.65979)),
        ((10, 10), (74.72546, 74.72585, 74.07588)),
        ((20, 20), (147.87856, 147.87598, 41.50836)),
        ((30, 0), (218.26221, 0.0, 37.60534)),
    ],
)
def test_the_positions_are_those_of_the_prototype(
    formed: Formed, node: tuple[int, int], position: tuple[float, float, float]
) -> None:
    found = formed.whole.positions[at(formed.whole, *node)]
    np.testing.assert_allclose(found, position, rtol=0, atol=1e-4)


def test_the_papers_kinematics_give_the_energy_of_the_prototype(papers_case: Case) -> None:
    formed = run(papers_case).formed
    assert formed.outcome is Outcome.CONVERGED
    assert formed.energy == pytest.approx(7007.043, rel=1e-6)
    assert formed.factorisations <= 8


def test_few_factorisations_lead_from_the_papers_start_to_the_same_answer(case: Case, formed: Formed) -> None:
    from_flat = run(changed(case, press={"start": "flat"})).formed
    assert from_flat.factorisations <= 8
    assert from_flat.history[0].energy > 1000 * formed.energy
    assert from_flat.energy == pytest.approx(formed.energy, rel=1e-9)
    assert_equal_grids(from_flat.whole, formed.whole, 1e-7)


def test_fewer_lead_there_from_the_inextensible_net(formed: Formed) -> None:
    assert formed.factorisations <= 4


def test_quarter_and_whole_grid_agree(formed: Formed, formed_whole: Formed) -> None:
    assert not formed_whole.grid.quarter
    assert formed_whole.energy == pytest.approx(formed.energy, rel=1e-9)
    assert formed_whole.negative_eigenvalues == 0
    assert_equal_grids(formed_whole.whole, formed.whole)


def test_the_answer_does_not_depend_on_the_linear_solver(case: Case, formed: Formed) -> None:
    again = run(changed(case, solver={"linear": "scipy"})).formed
    assert again.linear_solver == "scipy" != formed.linear_solver
    assert again.energy == pytest.approx(formed.energy, rel=1e-9)
    np.testing.assert_allclose(again.whole.positions, formed.whole.positions, rtol=0, atol=1e-9 * 345.0)


def test_the_formed_grid_has_the_symmetry_of_its_weave(formed: Formed) -> None:
    # C2v: both mirrors and the half turn, but not the mirror of the diagonal, which changes every sigma.
    whole = formed.whole
    places = {tuple(node): k for k, node in enumerate(whole.index.tolist())}
    swapped = np.array([places[j, i] for i, j in whole.index.tolist()])
    by_diagonal = np.abs(whole.positions[swapped][:, [1, 0, 2]] - whole.positions).max()
    assert 1e-4 < by_diagonal < 1e-1


def test_every_node_lies_on_the_punch(formed: Formed) -> None:
    assert np.abs(formed.surface.gap(formed.whole.positions).value).max() < 1e-9


def test_the_released_energy_is_that_of_the_prototype(case: Case, released: Released) -> None:
    assert case.release == ReleaseCase(hold=HoldFrom(from_radius=300.0))
    assert released.outcome is Outcome.CONVERGED
    assert released.energy == pytest.approx(2414.094, abs=1e-3)
    assert released.stability.negative == 0
    assert released.factorisations <= 20


def test_the_released_grid_sinks_as_the_prototype_does(released: Released) -> None:
    assert released.apex == pytest.approx(0.6587, abs=1e-4)
    assert released.max_sag == pytest.approx(-19.048, abs=1e-3)
    assert tuple(released.whole.index[released.lowest]) == (22, 21)


@pytest.mark.parametrize(
    ("node", "position"),
    [((10, 0), (74.76265, 0.0, 80.86535)), ((20, 20), (143.36103, 143.36733, 23.41329))],
)
def test_the_released_positions_are_those_of_the_prototype(
    released: Released, node: tuple[int, int], position: tuple[float, float, float]
) -> None:
    found = released.whole.positions[at(released.whole, *node)]
    np.testing.assert_allclose(found, position, rtol=0, atol=1e-3)


def test_what_holds_the_released_grid_is_symmetric_and_in_balance(released: Released) -> None:
    whole, reactions = released.whole, released.reactions
    on_axis = whole.index == 0
    assert not reactions[:, :2][on_axis].any()
    np.testing.assert_allclose(reactions.sum(axis=0), 0.0, atol=1e-6 * released.largest_reaction)
    held = np.linalg.norm((whole.positions - released.moved)[:, :2], axis=1) >= 300.0 * (1 - 1e-9)
    assert not reactions[~held].any()


def test_on_its_rim_alone_the_released_quarter_is_not_what_the_whole_grid_keeps(case: Case) -> None:
    on_rim = released_with(case, ReleaseCase(hold="rim"))
    assert on_rim.outcome is Outcome.CONVERGED
    assert on_rim.negative_eigenvalues == 0
    assert on_rim.stability.negative == 1
    assert on_rim.stability.mode is not None
    assert any('release.symmetry = "full"' in note for note in on_rim.notes)


def test_the_chord_gives_the_figures_that_the_theory_tells(case: Case) -> None:
    done = run(changed(case, press={"frame": "chord"}))
    assert done.formed.energy == pytest.approx(6614.378, abs=1e-3)
    found = done.formed.whole.positions[at(done.formed.whole, 20, 20)]
    np.testing.assert_allclose(found, (147.87361, 147.87091, 41.51132), rtol=0, atol=1e-4)
    gone = done.released
    assert gone is not None
    assert gone.energy == pytest.approx(2385.606, abs=1e-3)
    assert gone.apex == pytest.approx(1.1041, abs=1e-4)
    assert gone.max_sag == pytest.approx(-19.0594, abs=1e-4)
    assert tuple(gone.whole.index[gone.lowest]) == (22, 21)
    np.testing.assert_allclose(
        gone.whole.positions[at(gone.whole, 20, 20)], (143.27996, 143.28392, 23.42411), rtol=0, atol=1e-4
    )
