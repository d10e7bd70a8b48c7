"""How a solve ended, and what it did on the way."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from punchform.mechanics.frames import State


class Outcome(Enum):
    """How a solve ended. The text is what the user reads."""

    CONVERGED = "converged to a minimum"
    STATIONARY = "stationary; the linear solver could not tell whether it is a minimum: try another solver.linear"
    SADDLE = "stationary, but not a minimum: the grid would buckle; look at the lowest mode"
    STEP_LIMIT = (
        "the step limit was reached; raise solver.max_steps (for a descent press.descent.max_steps) "
        "or start nearer to the answer"
    )
    NO_DESCENT = (
        "no step lowered the energy; a fixed step length may be too long, or the case badly scaled or under-held"
    )
    SINGULAR = "the stiffness matrix is singular: part of the grid moves freely; hold it or weld the crossings"

    @property
    def usable(self) -> bool:
        """Whether the state is an equilibrium."""
        return self in (Outcome.CONVERGED, Outcome.STATIONARY, Outcome.SADDLE)


@dataclass(frozen=True)
class Step:
    """One step of a solve: energy [mJ] and largest gradient entry before it, Newton decrement relative to the energy
    (Eq. (5.1); NaN for descent), fraction of the step taken, and which Hessian was used."""

    number: int
    energy: float
    gradient: float
    decrement: float
    length: float
    hessian: str


@dataclass(frozen=True)
class Solution:
    """Where a solve ended and how; seconds by what they were spent on."""

    state: State
    outcome: Outcome
    history: tuple[Step, ...]
    steps: int = 0
    factorisations: int = 0
    evaluations: int = 0
    negative_eigenvalues: int | None = None
    linear_solver: str = ""
    seconds: dict[str, float] = field(default_factory=dict)
