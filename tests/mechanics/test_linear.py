"""The linear solvers: one answer and one inertia, whoever factors; a singular matrix is refused, not answered."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import pytest
from scipy.sparse import csr_array
from small_grids import dense, differences, energy_of, free_frames, grid, pinned, random_state

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.mechanics import linear
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.linear import Factor, SingularMatrix, Solver, chosen_solver, multiply, solver_for
from punchform.mechanics.pattern import Pattern

MODULES = {"rslab": "rslab", "pardiso": "pymklpardiso", "scipy": "scipy"}


@pytest.fixture(params=MODULES)
def library(request: pytest.FixtureRequest) -> str:
    name = str(request.param)
    if find_spec(MODULES[name]) is None:
        pytest.skip(f"{MODULES[name]} is not installed: the extra `fast` brings it where there are wheels")
    return name


def _stiffness(kind: Hessian, amount: float, energy: Energy) -> tuple[Pattern, Floats, Floats]:
    """Pattern, values and full matrix of a grid."""
    state = random_state(energy.kinematics, energy.grid, np.random.default_rng(1), amount=amount)
    values = energy.model(energy.kinematics.chart(state), kind).values
    return energy.pattern, values, dense(energy, values)


def _whole_grid() -> Energy:
    energy = energy_of(free_frames(grid(symmetry="full")))
    return pinned(energy, random_state(energy.kinematics, energy.grid, np.random.default_rng(1), amount=0.0))


MATRICES: dict[str, Callable[[], tuple[Pattern, Floats, Floats]]] = {
    "definite": lambda: _stiffness(Hessian.GAUSS_NEWTON, 0.2, energy_of(free_frames(grid()))),
    "definite, whole": lambda: _stiffness(Hessian.GAUSS_NEWTON, 0.2, _whole_grid()),
    "indefinite": lambda: _stiffness(Hessian.EXACT, 0.2, energy_of(free_frames(grid()))),
    "indefinite, whole": lambda: _stiffness(Hessian.EXACT, 0.2, _whole_grid()),
    "indefinite, welded": lambda: _stiffness(Hessian.EXACT, 0.2, energy_of(free_frames(grid(), welded=True))),
    "definite, differences": lambda: _stiffness(Hessian.GAUSS_NEWTON, 0.2, energy_of(differences(grid()))),
    "exact, differences": lambda: _stiffness(Hessian.EXACT, 0.2, energy_of(differences(grid()))),
}


@pytest.mark.parametrize("name", MATRICES)
def test_solution_and_inertia_are_those_of_the_full_matrix(name: str, library: str) -> None:
    pattern, values, full = MATRICES[name]()
    negative = int((np.linalg.eigvalsh(full) < 0).sum())
    assert (negative > 0) == name.startswith("indefinite")
    factor = solver_for(pattern, library).factor(values)
    # SuperLU may leave the diagonal for a pivot; then it does not know, and says so.
    assert factor.negative == negative or (library == "scipy" and negative and factor.negative is None)
    expected = np.random.default_rng(2).standard_normal(len(full))
    solution = factor.solve(full @ expected)
    assert np.abs(solution - expected).max() < 1e-15 * np.linalg.cond(full) * np.abs(expected).max()
    left = np.linalg.norm(full @ solution - full @ expected)
    assert left <= 1e-12 * np.linalg.norm(full @ expected)


def test_one_analysis_serves_many_matrices(library: str) -> None:
    pattern, values, full = MATRICES["definite"]()
    solver = solver_for(pattern, library)
    b = np.ones(len(full))
    first = solver.factor(values).solve(b)
    for scale in (1.0, 1e-6, 1e6):
        np.testing.assert_allclose(solver.factor(scale * values).solve(b), first / scale, rtol=1e-9)


def test_a_matrix_with_a_row_of_zeros_is_singular(library: str) -> None:
    pattern, values, _ = MATRICES["definite"]()
    rows = np.repeat(np.arange(len(pattern.indptr) - 1), np.diff(pattern.indptr))
    values[(rows == 5) | (pattern.indices == 5)] = 0.0
    solver = solver_for(pattern, library)
    with pytest.raises(SingularMatrix):
        solver.factor(values)


def test_a_matrix_that_is_not_finite_is_singular(library: str) -> None:
    pattern, values, _ = MATRICES["definite"]()
    values[7] = np.nan
    solver = solver_for(pattern, library)
    with pytest.raises(SingularMatrix):
        solver.factor(values)


def test_a_solver_works_again_after_a_singular_matrix(library: str) -> None:
    pattern, values, full = MATRICES["definite"]()
    solver = solver_for(pattern, library)
    b = np.ones(len(full))
    expected = np.linalg.solve(full, b)
    with pytest.raises(SingularMatrix):
        solver.factor(np.zeros_like(values))
    np.testing.assert_allclose(solver.factor(values).solve(b), expected, rtol=1e-8)


def test_refinement_mends_a_poor_factor() -> None:
    # A solve that is off by 1e-4 relative: each refinement wins four digits.
    _, _, full = MATRICES["definite"]()
    inverse = np.linalg.inv(full)
    rng = np.random.default_rng(3)
    poor = (1 + 1e-4) * inverse
    b = rng.standard_normal(len(full))
    factor = Factor(lambda b: poor @ b, 0, csr_array(np.triu(full)))
    rough = np.linalg.norm(full @ factor.raw_solve(b) - b)
    refined = np.linalg.norm(full @ factor.solve(b) - b)
    assert rough > 1e-5 * np.linalg.norm(b)
    assert refined < 1e-10 * np.linalg.norm(b)


def test_the_upper_triangle_stands_for_the_symmetric_matrix() -> None:
    rng = np.random.default_rng(4)
    full = rng.standard_normal((9, 9))
    full += full.T
    x = rng.standard_normal(9)
    np.testing.assert_allclose(multiply(csr_array(np.triu(full)), x), full @ x, rtol=1e-12)


def test_auto_takes_the_first_that_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    there = {"pymklpardiso", "rslab", "scipy"}
    monkeypatch.setattr(linear, "find_spec", lambda name: object() if name in there else None)
    for expected, module in (("rslab", "rslab"), ("pardiso", "pymklpardiso"), ("scipy", "scipy")):
        assert chosen_solver() == expected
        there.remove(module)


def test_a_library_that_is_missing_is_named_with_the_way_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linear, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"solver\.linear: .*'pardiso' is not installed\n.*pip install py-mkl-pardiso"):
        chosen_solver("pardiso")
    with pytest.raises(InputError, match="no such linear solver: 'cholmod'"):
        chosen_solver("cholmod")


def test_solvers_say_who_they_are(library: str) -> None:
    pattern, _, _ = MATRICES["definite"]()
    solver: Solver = solver_for(pattern, library)
    assert solver.name == library
