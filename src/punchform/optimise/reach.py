"""Which part of an error the punch can reach: the response of the released shape, its singular values, Eq. (13.8)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case
from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.correction_space import Space, Term
from punchform.optimise.equilibria import equilibria
from punchform.optimise.knots import knots, slope
from punchform.optimise.misfit import Misfit, judged_rows
from punchform.optimise.tangents import judged, tangent_runs
from punchform.progress import Observer, Progress, silent
from punchform.run import Run

PROBES = (Term(0, 0), Term(2, 0), Term(4, 0), Term(6, 0), Term(4, 4), Term(6, 4), Term(8, 8))
"""The shapes whose response is measured, as wide as the error: four of revolution, two of four lobes, one of eight."""
NUDGE = 1e-3
"""How far they are changed for tangents, in steps of the grid."""
SHARE = 0.1
"""A probe is so large a part of the rms that it is to explain,"""
STEPS = 0.05
"""but no larger than this part of a step of the grid."""
MOVED = 0.5
"""A shape that takes less than this part of what the punch is changed by is not moved by it."""
LOBES = 8
"""The largest number of lobes that is told of."""


@dataclass(frozen=True, eq=False)
class Reach:
    """What the punch can do about an error, by small changes of it.

    values (k,): singular values of the response, largest first: 1 for a shape that follows the punch, near 0 for one
    that does not; shares (k,): of the mean square of the error that lie in their shapes; left [mm]: rms of the error in
    shapes that take less than half of what the punch is changed by, those that were not probed included; lobes: rms of
    that part by its number of lobes [mm]; rms [mm]: of the whole error; solves: presses that it took, 0 by tangents.
    """

    values: Floats
    shares: Floats
    left: float
    lobes: dict[int, float]
    rms: float
    solves: int

    @property
    def beyond(self) -> float:
        """Share of the mean square of the error that the punch does not move."""
        return (self.left / self.rms) ** 2 if self.rms > 0 else 0.0


def probing(space: Space) -> Space:
    """The space of the shapes that are probed."""
    return replace(space, kind="field", terms=PROBES)


def reach_by_tangents(cases: Callable[[Floats], Case], here: Misfit, space: Space, *, step: float) -> Reach:
    """The response around the run of `here` by its tangents: what is held stays the same crossings.

    cases: from the numbers of a space of probes to the case. Raises InputError where `why_not` finds a reason.
    """
    run, nudge = here.run, NUDGE * step
    assert run is not None
    rest = equilibria(run)

    def along(number: int) -> Callable[[float], Case]:
        numbers = np.zeros(len(space.terms))
        numbers[number] = 1.0
        return lambda change: cases(change * numbers)

    columns = []
    for number in range(len(space.terms)):
        at = knots(rest.ready, along(number), nudge)
        looks = zip(at, tangent_runs(rest, at), strict=True)
        fitted = _fitted(run)
        found = [judged(rest, knot, one.final.state, "normal", fitted=fitted).deviations for knot, one in looks]
        columns.append(_spread(slope(found, nudge), run))
    return analysed(np.column_stack(columns), here, space, solves=0)


def reach(
    press: Callable[[Floats], Misfit],
    here: Misfit,
    space: Space,
    *,
    step: float,
    central: bool,
    observe: Observer = silent,
) -> Reach | None:
    """Measure the response around the punch of `here` by differences of presses; None where one fails.

    press: takes numbers of a space of probes; step [mm]: of the grid; central: press on both sides, for elastic wires;
    one-sided differences for those that yield, whose ways up and down differ.
    """
    size = min(SHARE * here.rms, STEPS * step)
    columns = []
    for number in range(len(space.terms)):
        told = f"response of the shape {number + 1} of {len(space.terms)}"
        observe(Progress("response", message=told, done=number, total=len(space.terms)))
        numbers = np.zeros(len(space.terms))
        numbers[number] = size
        try:
            above = press(numbers).deviation
            below = press(-numbers).deviation if central else here.deviation
        except (NoEquilibrium, InputError):
            return None
        columns.append((above - below) / (2 * size if central else size))
    return analysed(np.column_stack(columns), here, space, solves=len(columns) * (2 if central else 1))


def analysed(response: Floats, here: Misfit, space: Space, *, solves: int) -> Reach:
    """The reach from the response (n, k) of the deviations to the numbers of a space, weighted by what is judged."""
    root = np.sqrt(here.judged)
    _, lengths = np.linalg.qr(root[:, None] * here.shapes(space))
    moved = np.linalg.solve(lengths.T, (root[:, None] * response).T).T
    shapes, values, _ = np.linalg.svd(moved, full_matrices=False)
    error = root * here.deviation
    parts = shapes.T @ error
    follow = values >= MOVED
    left = error - shapes[:, follow] @ parts[follow]
    total = float(error @ error)
    return Reach(
        values=values,
        shares=parts**2 / total if total > 0 else np.zeros(len(parts)),
        left=float(np.linalg.norm(left)),
        lobes=_lobes(left / np.where(root > 0, root, 1.0), here),
        rms=float(np.sqrt(total)),
        solves=solves,
    )


def _fitted(run: Run) -> bool:
    return run.accuracy is not None and run.accuracy.judge.alignment == "best fit"


def _spread(values: Floats, run: Run) -> Floats:
    """Values of the judged nodes as those of all crossings of a misfit, 0 elsewhere."""
    assert run.accuracy is not None
    everywhere = np.zeros(len(run.accuracy.mask))
    everywhere[run.accuracy.mask] = values
    return everywhere[judged_rows(run)]


def _lobes(values: Floats, here: Misfit) -> dict[int, float]:
    """Rms of the parts of values (n,) by their number of lobes [mm]; those of revolution hold the mean."""
    from punchform.accuracy.harmonics import harmonics

    seen = here.judged > 0
    radius = float(np.hypot(*here.places[seen].T).max())
    split = harmonics(values[seen], here.places[seen], here.judged[seen], radius)
    if split is None:
        return {}
    sizes = {part.m: part.rms for part in split.parts}
    sizes[0] = float(np.hypot(sizes[0], split.mean))
    return sizes
