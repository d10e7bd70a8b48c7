"""The punch goes down in strokes: each begins where the one before ended, on a punch a little deeper (Eq. (12.20)).

What a grid of elastic wires becomes depends on where the punch ends alone, and one stroke finds it. Where something is
remembered on the way, as how far the flange has slipped, a stroke is short enough for what it remembers to be taken
from its beginning.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.case import PressCase
from punchform.errors import NoEquilibrium
from punchform.grid import Grid
from punchform.holder import Grasp, Grip, Holder
from punchform.mechanics.assembly import Energy
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, is_finite, perpendicular, unit
from punchform.mechanics.friction import Friction
from punchform.mechanics.outcome import Solution
from punchform.progress import Observer, Progress, silent
from punchform.punch import Surface, lowered, project
from punchform.solved import joined
from punchform.start import flat, flat_start

USUAL = 12
"""Strokes of a press in which it matters what happens on the way."""
SHORTEST = 1.0 / 16
"""The shortest part of a stroke that is tried."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """One stroke of the whole grid: the share of the depth at its end, its steps and factorisations, the elastic energy
    at its end and the work done against friction in it [mJ]; positions (N, 3) of the solved nodes at its end [mm]."""

    share: float
    steps: int
    factorisations: int
    energy: float
    friction_work: float
    positions: Floats


@dataclass(frozen=True)
class Lying:
    """The grid at a share of the depth, and what its holder remembers there."""

    share: float
    state: State
    grasp: Grasp | None


@dataclass(frozen=True)
class Descent:
    """How the punch came down: the energy of the last stroke, all strokes as one solution, each of them, and what the
    holder did."""

    energy: Energy
    solution: Solution
    strokes: tuple[Stroke, ...]
    grip: Grip | None


@dataclass(frozen=True)
class Task:
    """What one stroke is asked to find: the minimum of the energy on a tool, which has gone down by a share of its
    depth, from a start and under a friction. before: the energy of the last stroke, None in the first."""

    tool: Surface
    share: float
    start: State
    friction: Friction | None
    before: Energy | None


Form = Callable[[Task], tuple[Energy, Solution]]
"""Carries out a task; raises NoEquilibrium or returns a solution that is not usable where it fails."""

Settle = Callable[[Energy, State], State]
"""What a grid remembers of an accepted stroke: the state with which the next begins."""


def strokes_of(case: PressCase, *, yields: bool = False) -> int:
    """In how many strokes a case is pressed: one unless it matters what happens on the way."""
    if case.strokes is not None:
        return case.strokes
    return USUAL if yields or case.hold is not None else 1


def remembered(energy: Energy, state: State) -> State:
    """What wires that yield remember; elastic ones nothing."""
    return energy.settled(state)


def go_down(
    grid: Grid,
    surface: Surface,
    count: int,
    form: Form,
    *,
    held: Bools,
    holder: Holder | None = None,
    settle: Settle = remembered,
    observe: Observer = silent,
) -> Descent:
    """Press the grid in `count` strokes; one that fails is halved, down to a sixteenth.

    held (N,): nodes that stay where they lie flat. Raises NoEquilibrium with the depth at which it ends.
    """
    older = here = Lying(0.0, flat(grid), None if holder is None else holder.at_rest())
    ahead = [(number + 1) / count for number in range(count)]
    energy: Energy | None = None
    solutions: list[Solution] = []
    strokes: list[Stroke] = []
    while ahead:
        if count > 1:
            observe(Progress("press", done=count * here.share, total=count))
        tool = lowered(surface, ahead[0])
        start = carried(older, here, tool, ahead[0], held) if here.share else flat_start(grid, tool)
        rubbing = None if holder is None or here.grasp is None else holder.friction(here.state, here.grasp)
        found, failure = _tried(form, Task(tool, ahead[0], start, rubbing, energy))
        if found is None:
            middle = 0.5 * (here.share + ahead[0])
            if middle - here.share < SHORTEST / count * (1 - 1e-9):
                raise NoEquilibrium(_where(here.share, ahead[0], failure))
            ahead.insert(0, middle)
            continue
        energy, solution = found
        state = settle(energy, solution.state)
        grasp = here.grasp
        if holder is not None and grasp is not None and rubbing is not None:
            grasp = holder.settled(rubbing, here.state, state, grasp)
        older, here = here, Lying(ahead.pop(0), state, grasp)
        solutions.append(replace(solution, state=state))
        strokes.append(_stroke(grid, energy, solutions[-1], older, here))
    if count > 1:
        observe(Progress("press", done=count, total=count))
    assert energy is not None
    grip = None if holder is None or here.grasp is None else holder.grip(here.grasp)
    return Descent(energy, _as_one(solutions), tuple(strokes), grip)


def carried(older: Lying, here: Lying, tool: Surface, share: float, held: Bools) -> State:
    """The start at the next share: the line through both last states, laid onto the punch there, Eq. (12.21)."""
    before, earlier = here.state, older.state
    times = (share - here.share) / (here.share - older.share)
    near = before.positions * (1.0, 1.0, share / here.share)
    on_punch = near.copy()
    moving = ~held
    near[moving, :2] += times * (before.positions - earlier.positions)[moving, :2]
    positions = np.where(held[:, None], on_punch, project(tool, near, normals_of(tool.gap(near))))
    lost = ~np.isfinite(positions).all(axis=1)
    positions[lost] = on_punch[lost]
    normals = unit(_onwards(earlier.normals, before.normals, times))
    along = _onwards(earlier.tangents, before.tangents, times)
    tangents = np.stack([perpendicular(along[:, w], normals) for w in range(2)], axis=1)
    return replace(
        before,
        positions=positions,
        normals=np.where(held[:, None], before.normals, normals),
        tangents=np.where(held[:, None, None], before.tangents, tangents),
        history=None if before.history is None else before.history.foreseen(times),
    )


def _onwards(earlier: Floats, before: Floats, times: float) -> Floats:
    return np.asarray(before + times * (before - earlier))


def _tried(form: Form, task: Task) -> tuple[tuple[Energy, Solution] | None, str]:
    """What a stroke finds, or None and why it ended nowhere."""
    if not is_finite(task.start):
        return None, "the grid could not be laid onto the punch"
    try:
        found = form(task)
    except NoEquilibrium as error:
        return None, str(error)
    outcome = found[1].outcome
    return (found, "") if outcome.usable else (None, outcome.value)


def _where(share: float, tried: float, failure: str) -> str:
    return (
        f"the press came down to {share:.3g} of the depth of the punch and found no equilibrium at {tried:.3g}, also "
        f"in shorter strokes: {failure}. Over sharp bends grid.subdivide = 2 or a smaller step helps"
    )


def _stroke(grid: Grid, energy: Energy, solution: Solution, older: Lying, here: Lying) -> Stroke:
    elastic = float(energy.elastic(here.state)[2] @ grid.weight) + energy.springs(here.state)
    work = 0.0 if here.grasp is None or older.grasp is None else here.grasp.work - older.grasp.work
    return Stroke(
        share=here.share,
        steps=solution.steps,
        factorisations=solution.factorisations,
        energy=grid.copies * elastic,
        friction_work=grid.copies * work,
        positions=here.state.positions,
    )


def _as_one(solutions: list[Solution]) -> Solution:
    """All strokes as one solution; of the curves that of the last, whose energy is that of the answer."""
    return replace(joined(solutions), history=solutions[-1].history)
