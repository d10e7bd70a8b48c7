"""Symmetric sparse factorisation behind one small interface; the pattern is analysed once.

`solver_for(pattern, choice)` gives a solver; `solver.factor(values)` a factor that solves and that knows the number of
negative eigenvalues (Sylvester's law of inertia). Which library and why: docs/decisions/linear-solver.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.util import find_spec
from typing import Protocol

import numpy as np
from scipy.sparse import csc_array, csr_array

from punchform.arrays import Floats, Ints
from punchform.errors import InputError
from punchform.mechanics.pattern import Pattern

RESIDUAL = 1e-13
"""Relative residual beyond which a solution is refined."""
REFINEMENTS = 3
DISSECTION = {
    "ordering": "metis",
    "nd_init_trials": 2,
    "nd_fm_passes": 4,
    "nd_move_limit": 50,
    "nd_leaf_size": 50,
}
WIDER_SUPERNODES = 32
"""One nested dissection without a race of orderings, quick refinement, small leaves: measured on matrices of grids."""
PERTURBED_PIVOTS, NEGATIVE_EIGENVALUES = 13, 22
"""Places of what PARDISO counts in its table of parameters."""


class SingularMatrix(ArithmeticError):
    """The matrix could not be factored: a pivot is zero or not finite."""


class Solver(Protocol):
    """One analysed pattern. `solve` functions of its factors take and give vectors (n,)."""

    @property
    def name(self) -> str:
        """Which library does the work."""

    def factor(self, values: Floats) -> Factor:
        """Factor the matrix with these upper CSR values; raises SingularMatrix."""


@dataclass(frozen=True)
class Factor:
    """A factored symmetric matrix.

    negative: number of negative eigenvalues, None when the library could not tell; upper: the matrix itself.
    """

    raw_solve: Callable[[Floats], Floats]
    negative: int | None
    upper: csr_array

    def solve(self, b: Floats) -> Floats:
        """The solution (n,) of A x = b, refined until the residual is at rounding level."""
        x = self.raw_solve(b)
        size = float(np.linalg.norm(b))
        for _ in range(REFINEMENTS):
            residual = b - self.times(x)
            if not np.linalg.norm(residual) > RESIDUAL * size:
                break
            x = x + self.raw_solve(residual)
        return x

    def times(self, x: Floats) -> Floats:
        """The product A x, (n,)."""
        return multiply(self.upper, x)


def _demand_finite(values: Floats) -> None:
    """Libraries treat numbers that are not finite each in its own way: none may meet them."""
    if not np.isfinite(values).all():
        raise SingularMatrix("the matrix is not finite")


def multiply(upper: csr_array, x: Floats) -> Floats:
    """The product (n,) of the symmetric matrix, given by its upper triangle, with x."""
    return np.asarray(upper @ x + upper.T @ x - upper.diagonal() * x)


def upper_matrix(pattern: Pattern, values: Floats) -> csr_array:
    """The upper triangle as a SciPy array."""
    n = len(pattern.indptr) - 1
    return csr_array((values, pattern.indices, pattern.indptr), shape=(n, n))


@dataclass(frozen=True, eq=False)
class _Structure:
    """Where the entries of a matrix stand: what its analysis depends on, and nothing else."""

    indptr: Ints
    indices: Ints

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, _Structure)
            and np.array_equal(self.indptr, other.indptr)
            and np.array_equal(self.indices, other.indices)
        )

    def __hash__(self) -> int:
        return hash((len(self.indptr), self.indices.tobytes()))


@lru_cache(maxsize=1)
def _dissected(structure: _Structure):  # type: ignore[no-untyped-def]
    """The analysis of a pattern. The last one is kept: passes, stages and sweeps solve the same pattern again."""
    import rslab

    ones = np.ones(len(structure.indices))
    n = len(structure.indptr) - 1
    # The upper triangle by rows is the lower triangle by columns.
    lower = csc_array((ones, structure.indices, structure.indptr), shape=(n, n))
    return rslab.analyze(lower, path="ldlt", nemin=WIDER_SUPERNODES, **DISSECTION)


def forget_analysis() -> None:
    """Let the kept analysis go, so that the next factorisation begins with the matrix alone."""
    _dissected.cache_clear()


@dataclass(frozen=True)
class RslabSolver:
    """Supernodal L D Lᵀ of the package rslab."""

    pattern: Pattern
    name: str = "rslab"

    @cached_property
    def _analysis(self):  # type: ignore[no-untyped-def]
        return _dissected(_Structure(self.pattern.indptr, self.pattern.indices))

    def factor(self, values: Floats) -> Factor:
        """Factor the matrix with these upper CSR values; raises SingularMatrix."""
        _demand_finite(values)
        try:
            factor = self._analysis.factor(values)
        except RuntimeError as error:
            raise SingularMatrix(str(error)) from error
        return Factor(factor.solve, int(factor.inertia[1]), upper_matrix(self.pattern, values))


@dataclass(frozen=True)
class PardisoSolver:
    """PARDISO of oneMKL, by the package py-mkl-pardiso (the extra `punchform[fast]`)."""

    pattern: Pattern
    name: str = "pardiso"

    @cached_property
    def _analysis(self):  # type: ignore[no-untyped-def]
        import pymklpardiso

        upper = upper_matrix(self.pattern, np.ones(self.pattern.entries))
        return pymklpardiso.PardisoSolver(upper, pymklpardiso.MTYPE_REAL_SYM_INDEF)

    def factor(self, values: Floats) -> Factor:
        """Factor the matrix with these upper CSR values; raises SingularMatrix."""
        solver = self._analysis
        _demand_finite(values)
        try:
            solver.refactor(values)
        except RuntimeError as error:
            raise SingularMatrix(str(error)) from error
        # PARDISO puts small numbers in the place of zero pivots and goes on.
        if solver.get_iparm_value(PERTURBED_PIVOTS) > 0:
            raise SingularMatrix("zero pivots")
        return Factor(
            solver.solve, int(solver.get_iparm_value(NEGATIVE_EIGENVALUES)), upper_matrix(self.pattern, values)
        )


@dataclass(frozen=True)
class ScipySolver:
    """SuperLU of SciPy with diagonal pivots: always there, several times slower."""

    pattern: Pattern
    name: str = "scipy"

    def factor(self, values: Floats) -> Factor:
        """Factor the matrix with these upper CSR values; raises SingularMatrix."""
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import splu

        _demand_finite(values)
        upper = upper_matrix(self.pattern, values)
        whole = csc_array(upper + upper.T - diags_array(upper.diagonal()))
        try:
            factor = splu(
                whole,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True, "Equil": False},
            )
        except RuntimeError as error:
            raise SingularMatrix(str(error)) from error
        # Only with diagonal pivots do the signs of U tell the inertia.
        symmetric = np.array_equal(factor.perm_r, factor.perm_c)
        negative = int((factor.U.diagonal() < 0).sum()) if symmetric else None
        return Factor(factor.solve, negative, upper)


# In the order of preference.
_SOLVERS: dict[str, tuple[str, Callable[[Pattern], Solver]]] = {
    "rslab": ("rslab", RslabSolver),
    "pardiso": ("pymklpardiso", PardisoSolver),
    "scipy": ("scipy", ScipySolver),
}


def chosen_solver(choice: str = "auto") -> str:
    """The name of the solver that `choice` means on this machine; raises InputError when it is not installed."""
    if choice == "auto":
        return next(name for name, (module, _) in _SOLVERS.items() if find_spec(module))
    if choice not in _SOLVERS:
        raise InputError.of(f"no such linear solver: {choice!r}", hint=f"choose one of {', '.join(_SOLVERS)}")
    if not find_spec(_SOLVERS[choice][0]):
        extra = {"pardiso": "py-mkl-pardiso"}.get(choice, choice)
        raise InputError.of(
            f"the linear solver {choice!r} is not installed",
            where="solver.linear",
            hint=f"pip install {extra}, or leave the setting out",
        )
    return choice


def solver_for(pattern: Pattern, choice: str = "auto") -> Solver:
    """A solver for one pattern; `choice` as `chosen_solver` takes it."""
    return _SOLVERS[chosen_solver(choice)][1](pattern)
