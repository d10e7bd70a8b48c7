"""The search where all is smooth: downhill by gradients from the case as it stands, by SciPy's SLSQP, Eq. (13.46)."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.errors import NoEquilibrium
from punchform.optimise.asking import Answer, Asking, SpentError
from punchform.optimise.problem import Merit
from punchform.optimise.slopes import Slopes

APART = 2e-4
"""How far neighbours are for differences, in ranges: figures are exact to more digits than that loses."""
ENOUGH = 1e-6
"""Change of the objective, as a part of its first value, that ends the search."""
BAD = 10.0
BOTTOM = "no way further down"
"""How a search downhill ends that has found a minimum."""


class _Hill:
    """Objective and constraints as SLSQP takes them, at positions (n,) in the ranges."""

    def __init__(self, asking: Asking, slopes: Slopes | None, first: Merit) -> None:
        self.asking = asking
        self.slopes = slopes
        objective = asking.question.objectives[0]
        self.square = objective.figure.startswith("rms") and objective.sign > 0
        self.scale = abs(self._smooth(float(first.objectives[0]))) or 1.0
        self._near: dict[bytes, tuple[Floats, Floats]] = {}

    def height(self, at: Floats) -> float:
        """The objective, squared where it is a norm, in units of its first value."""
        merit = self._answer(at).merit
        return BAD if merit is None else self._smooth(float(merit.objectives[0])) / self.scale

    def room(self, at: Floats) -> Floats:
        """How far each constraint is from being missed (q,)."""
        merit = self._answer(at).merit
        count = len(self.asking.question.limits)
        return np.full(count, -BAD) if merit is None else -merit.excesses

    def slope(self, at: Floats) -> Floats:
        """The derivative of `height` (n,)."""
        return self._derivatives(at)[0]

    def slope_of_room(self, at: Floats) -> Floats:
        """The derivatives of `room` (q, n)."""
        return self._derivatives(at)[1]

    def _smooth(self, objective: float) -> float:
        return objective * objective if self.square else objective

    def _answer(self, at: Floats) -> Answer:
        return self.asking(self.asking.question.space.nearest(at[None, :]))[0]

    def _derivatives(self, at: Floats) -> tuple[Floats, Floats]:
        design = self.asking.question.space.nearest(at[None, :])[0]
        name = design.tobytes()
        if name not in self._near:
            known = self._by_tangents(design)
            self._near[name] = self._by_differences(design) if known is None else known
        return self._near[name]

    def _by_tangents(self, design: Floats) -> tuple[Floats, Floats] | None:
        question = self.asking.question
        table = None if self.slopes is None else self.slopes(question.space.changes(design))
        merit = self._answer(design).merit
        if table is None or merit is None:
            return None
        spans = np.array([one.high - one.low for one in question.space.variables])
        rows = {name: np.array([row[one.place] for one in question.space.variables]) for name, row in table.items()}
        objective = question.objectives[0]
        chain = 2 * float(merit.objectives[0]) if self.square else 1.0
        height = chain * objective.sign * rows[objective.figure] * spans / self.scale
        room = [-one.sign * rows[one.figure] * spans / (abs(one.limit) or 1.0) for one in question.limits]
        return height, np.array(room).reshape(len(question.limits), len(spans))

    def _by_differences(self, design: Floats) -> tuple[Floats, Floats]:
        """From a neighbour in each variable, all asked for at once, on the other side where the first one fails."""
        space = self.asking.question.space
        count = len(design)
        here, room = self.height(design), self.room(design)
        slopes, of_room = np.zeros(count), np.zeros((len(room), count))
        left = list(range(count))
        for side in (1, -1):
            steps = [side * APART if design[k] + side * APART <= 1 else -side * APART for k in left]
            beside = np.tile(design, (len(left), 1))
            beside[range(len(left)), left] += steps
            beside = np.clip(beside, 0.0, 1.0)
            answers = self.asking(space.nearest(beside)) if left else []
            for k, answer in zip(left, answers, strict=True):
                if answer.merit is not None:
                    apart = answer.design[k] - design[k]
                    slopes[k] = (self._smooth(float(answer.merit.objectives[0])) / self.scale - here) / apart
                    of_room[:, k] = (-answer.merit.excesses - room) / apart
            left = [k for k, answer in zip(left, answers, strict=True) if answer.merit is None]
        return slopes, of_room


def downhill(asking: Asking, start: Floats, slopes: Slopes | None = None) -> str:
    """Go downhill from a design (n,) until it is lowest, or all evaluations are spent; returns how it ended.

    Raises NoEquilibrium when the first design has no figures.
    """
    from scipy.optimize import minimize

    first = asking(start[None, :])[0]
    if first.merit is None:
        raise NoEquilibrium(f"the design to begin with has no figures: {first.why}")
    hill = _Hill(asking, slopes, first.merit)
    limits = [{"type": "ineq", "fun": hill.room, "jac": hill.slope_of_room}] if asking.question.limits else []
    try:
        done = minimize(
            hill.height,
            first.design,
            jac=hill.slope,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(start),
            constraints=limits,
            options={"ftol": ENOUGH, "maxiter": 10 * asking.question.asked.evaluations},
        )
    except SpentError:
        return "all evaluations are spent"
    return BOTTOM if done.success else f"SLSQP: {done.message}"
