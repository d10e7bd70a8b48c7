"""The press: from the flat grid to the grid on the punch, and what is known of it there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Bools
from punchform.between import between
from punchform.case import CrossingSpring, PressCase, SolverCase
from punchform.coarse import coarsened, doubled, refined
from punchform.errors import InputError, NoEquilibrium
from punchform.grid import Grid, undivided
from punchform.holder import Grip, holder
from punchform.mechanics.assembly import Clock, Energy
from punchform.mechanics.bars import Loads
from punchform.mechanics.compiled import compile_kernels, kernels_are_compiled
from punchform.mechanics.descent import descend
from punchform.mechanics.differences import Differences
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, squared
from punchform.mechanics.friction import Friction
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Solution
from punchform.mechanics.rigid import free_motions, unturned
from punchform.progress import Observer, Progress, silent
from punchform.pull import Pull
from punchform.punch import Surface
from punchform.remarks import largest_pull, remarks, slide
from punchform.solved import Solved, bars_of, joined, solved
from punchform.start import begin, flat_start
from punchform.strokes import Descent, Settle, Stroke, Task, go_down, remembered, strokes_of
from punchform.wire import Element, together

FOLLOWED = 1e-9
"""The pull has found its direction when no wire end turns by more than this [rad] between two passes."""
PULL_PASSES = 30
AT_THE_RIM = 1e-9
"""A node on the rim, to this relative size, is clamped."""
ROUGH = 1e-6
"""Relative decrement at which a coarser grid is near enough to start from."""


@dataclass(frozen=True)
class Formed(Solved):
    """The grid on the punch.

    surface: of the punch; held (N,): solved nodes that the clamp held, or the holder gripped; strokes: in which it went
    down; grip: what the holder did, None without one; draw_in: largest inward move of a wire end [mm]. steps,
    factorisations and seconds are those of all strokes, history that of the last.
    """

    surface: Surface
    held: Bools
    strokes: tuple[Stroke, ...] = ()
    grip: Grip | None = None

    @property
    def draw_in(self) -> float:
        """How far the wire ends moved towards the centre of the grid at most [mm], a slide of the whole apart."""
        ends = self.grid.wire_ends.any(axis=(1, 2))
        flat = np.linalg.norm(self.grid.flat[ends], axis=1)
        formed = np.linalg.norm(self.state.positions[ends, :2] - slide(self.whole, self.surface), axis=1)
        return float((flat - formed).max(initial=0.0))

    @property
    def push(self) -> float:
        """Vertical force of the punch on the grid where it pushes [N]; as much holds the grid down elsewhere."""
        upwards = normals_of(self.surface.gap(self.whole.positions))[:, 2]
        return float(np.sum(np.maximum(self.whole.contact, 0.0) * upwards))


def press(
    grid: Grid,
    elements: tuple[Element, ...],
    surface: Surface,
    case: PressCase,
    *,
    crossing: str | CrossingSpring = "pinned",
    solver: SolverCase | None = None,
    yield_strength: float | None = None,
    start: State | None = None,
    settle: Settle = remembered,
    observe: Observer = silent,
) -> Formed:
    """Press the grid onto the surface: the minimum of its energy among all grids that lie there, Eq. (3.3).

    In one stroke, or in several where `case.strokes` or a holder asks for them. start: where one stroke begins, as
    `case.start` says when it is not given; a clamp then holds what lies there at or beyond the rim. settle: what is
    remembered of a stroke. Raises InputError for settings that contradict each other, NoEquilibrium when there is none.
    """
    solver = solver or SolverCase()
    if case.pull is not None and case.kinematics == "free" and not case.chord:
        _demand_moderate(case.pull, elements)
    count = strokes_of(case, yields=elements[0].hardening is not None)
    if start is None and (case.hold is not None or count > 1):
        down = _in_strokes(count, grid, elements, surface, case, crossing, solver, settle, observe)
        return formed_by(down, elements, surface, case, yield_strength)
    first, doubts = _begin(grid, elements, surface, case, crossing, solver) if start is None else (start, ())
    first = squared(first) if crossing == "welded" else first
    held = None if start is None or case.rim != "clamp" else _in_the_clamp(start, surface)
    energy = energy_of(grid, elements, surface, case, crossing=crossing, start=first, held=held)
    energy, solution = _minimised(energy, first, surface, case, solver, observe)
    if case.method == "newton" and not solution.outcome.usable:
        raise NoEquilibrium(solution.outcome.value)
    solution = replace(solution, state=settle(energy, solution.state))
    formed = formed_by(Descent(energy, solution, (), None), elements, surface, case, yield_strength)
    return replace(formed, notes=formed.notes + doubts)


def _in_strokes(
    count: int,
    grid: Grid,
    elements: tuple[Element, ...],
    surface: Surface,
    case: PressCase,
    crossing: str | CrossingSpring,
    solver: SolverCase,
    settle: Settle,
    observe: Observer,
) -> Descent:
    """The punch goes down stroke by stroke, Eq. (12.20), against the friction of the holder if there is one."""

    def form(task: Task) -> tuple[Energy, Solution]:
        start = squared(task.start) if crossing == "welded" else task.start
        before, rubbing = task.before, task.friction
        if before is None or _rubs(before.friction) != _rubs(rubbing):
            energy = energy_of(grid, elements, task.tool, case, crossing=crossing, start=start, friction=rubbing)
        else:
            # What is left out of the unknowns stays so, and with it the pattern of the matrix.
            assert isinstance(before.kinematics, FreeFrames | Differences)
            lower = replace(before.kinematics, surface=task.tool)
            energy = replace(before, kinematics=lower, friction=rubbing, loads=None, clock=Clock())
        return _minimised(energy, start, task.tool, case, solver, observe, stage=f"press, {task.share:.0%} down")

    holding = None if case.hold is None else holder(grid, surface.rim_radius, case.hold)
    held = _held_flat(grid, surface, case)
    return go_down(grid, surface, count, form, held=held, holder=holding, settle=settle, observe=observe)


def _minimised(
    energy: Energy,
    start: State,
    surface: Surface,
    case: PressCase,
    solver: SolverCase,
    observe: Observer,
    *,
    stage: str = "press",
) -> tuple[Energy, Solution]:
    """The minimum nearest to a start, and the energy with the loads that act there."""
    if not kernels_are_compiled(yields=energy.bars.yielding is not None):
        observe(Progress("press", message="compiling the kernels; only the first run does this"))
        compile_kernels(energy, start)
    if case.pull is None:
        return energy, _solve(energy, start, case, solver, observe, stage)
    return _solve_pulled(energy, start, Pull(energy.grid, surface, case.pull), case, solver, observe, stage)


def _begin(
    grid: Grid,
    elements: tuple[Element, ...],
    surface: Surface,
    case: PressCase,
    crossing: str | CrossingSpring,
    solver: SolverCase,
) -> tuple[State, tuple[str, ...]]:
    """The net; where there is none the answer of a coarser grid, and without that the flat start, with notes."""
    if grid.subdivide > 1:
        first, doubts = _begin(undivided(grid), _uncut(grid, elements), surface, case, crossing, solver)
        return between(grid, first, surface), doubts
    first, doubts = begin(grid, surface, case)
    coarse = coarsened(grid) if case.start == "net" and (doubts or case.rim == "clamp") else None
    if coarse is None:
        return first, doubts
    wires = doubled(elements[0]), doubled(elements[1])
    rough = SolverCase(linear=solver.linear, tolerance=max(ROUGH, solver.tolerance))
    alike = case.model_copy(update={"frame": "chord", "kinematics": "free", "pull": None, "method": "newton"})
    try:
        answer = press(coarse, wires, surface, alike, crossing=crossing, solver=rough)
    except (InputError, NoEquilibrium):
        return first, doubts
    held = _held_flat(grid, surface, case)
    return refined(grid, flat_start(grid, surface), coarse, answer.state, surface, held), doubts


def _uncut(grid: Grid, elements: tuple[Element, ...]) -> tuple[Element, ...]:
    """The wires of both families, each from crossing to crossing, from their pieces."""
    wires = (elements[: grid.subdivide], elements[grid.subdivide :])
    return tuple(
        replace(wire[-1], C=together(wire), length=sum(one.length for one in wire), drop=0.0) for wire in wires
    )


def energy_of(
    grid: Grid,
    elements: tuple[Element, ...],
    surface: Surface,
    case: PressCase,
    *,
    crossing: str | CrossingSpring = "pinned",
    start: State,
    friction: Friction | None = None,
    held: Bools | None = None,
) -> Energy:
    """The energy that `press` minimises, Eq. (3.3), without the unknowns of the rigid motions free at the start.

    held (N,): nodes that keep position and frames; those that a clamp holds of the flat grid when it is not given.
    """
    held = _held_flat(grid, surface, case) if held is None else held
    kinematics = _kinematics(grid, surface, case, crossing, held)
    return Energy(
        grid,
        bars_of(elements, case),
        kinematics
        if _rubs(friction)
        else replace(kinematics, pins=free_motions(grid, kinematics, kinematics.chart(start))),
        crossing=crossing.stiffness if isinstance(crossing, CrossingSpring) else 0.0,
        friction=friction,
    )


def _rubs(friction: Friction | None) -> bool:
    """Whether friction resists anywhere, and so holds a grid that could else turn about the axis."""
    return friction is not None and bool(friction.capacity.any())


def _kinematics(
    grid: Grid, surface: Surface, case: PressCase, crossing: str | CrossingSpring, held: Bools
) -> FreeFrames | Differences:
    if case.kinematics == "free":
        return FreeFrames(grid, surface, held, welded=crossing == "welded")
    if crossing == "welded":
        raise InputError.of(
            "welded crossings need the free kinematics: with differences the tangents follow from the positions",
            where="press.kinematics",
            hint="use kinematics = 'free', or a crossing spring",
        )
    return Differences(grid, surface, held)


def clamped(grid: Grid, surface: Surface) -> Bools:
    """The nodes that a clamp holds from the rim outwards, (N,)."""
    return np.asarray(np.linalg.norm(grid.flat, axis=1) >= surface.rim_radius * (1 - AT_THE_RIM))


def _held_flat(grid: Grid, surface: Surface, case: PressCase) -> Bools:
    """The nodes (N,) of the flat grid that stay where they lie: none without a clamp."""
    return clamped(grid, surface) if case.rim == "clamp" else np.zeros(grid.nodes, dtype=bool)


def _in_the_clamp(start: State, surface: Surface) -> Bools:
    """The nodes that a clamp holds of a grid that was formed before, (N,), Eq. (7.10)."""
    held = np.asarray(np.linalg.norm(start.positions[:, :2], axis=1) >= surface.rim_radius * (1 - AT_THE_RIM))
    if not held.any():
        raise InputError.of(
            "nothing of the grid lies at or beyond the rim, so nothing can be clamped",
            where="press.rim",
            hint='write rim = "draw" for this press, or trim less before it',
        )
    return held


def _solve(
    energy: Energy, start: State, case: PressCase, solver: SolverCase, observe: Observer, stage: str
) -> Solution:
    if case.method == "descent":
        how = case.descent
        return descend(
            energy,
            start,
            rule=how.rule,
            step_length=how.step_length,
            max_steps=how.max_steps,
            observe=observe,
        )
    return minimise(
        energy,
        start,
        max_steps=solver.max_steps,
        tolerance=solver.tolerance,
        linear=solver.linear,
        stage=stage,
        observe=observe,
    )


def _solve_pulled(
    energy: Energy, start: State, pull: Pull, case: PressCase, solver: SolverCase, observe: Observer, stage: str
) -> tuple[Energy, Solution]:
    """Passes with the pull along the wire ends of the pass before, Eq. (5.2), until these no longer turn."""
    passes: list[Solution] = []
    state = start
    for _ in range(PULL_PASSES):
        energy = replace(energy, loads=Loads(pull.forces(state), state.positions))
        passes.append(_solve(energy, state, case, solver, observe, stage))
        turned = pull.forces(passes[-1].state) - pull.forces(state)
        state = passes[-1].state
        if not passes[-1].outcome.usable or np.abs(turned).max() <= FOLLOWED * max(map(abs, pull.force)):
            return energy, joined(passes)
    raise NoEquilibrium(
        f"the pulled wire ends still turn after {PULL_PASSES} passes: the grid slides about on the punch; give it a "
        "wider flange, weld the crossings, or use its mirror planes (grid.symmetry = 'quarter')"
    )


def _demand_moderate(pull: tuple[float, float], elements: tuple[Element, ...]) -> None:
    """Refuse a pull that the element cannot bear, Eq. (3.8)."""
    for force, element in zip(np.repeat(pull, len(elements) // 2), elements, strict=True):
        if force > largest_pull(element):
            raise InputError.of(
                f"a pull of {force:.4g} N is beyond the {largest_pull(element):.3g} N that the element of this wire "
                "and step can describe",
                where="press.pull",
                hint="write press.frame = 'chord', which has no such limit, or take a smaller step",
            )


def formed_by(
    down: Descent,
    elements: tuple[Element, ...],
    surface: Surface,
    case: PressCase,
    yield_strength: float | None,
) -> Formed:
    """The stage that a press makes which ended so."""
    energy, solution = down.energy, down.solution
    if energy.kinematics.pins:
        solution = replace(solution, state=unturned(energy.grid, solution.state))
    chart = energy.kinematics.chart(solution.state)
    contact = chart.contact(energy.gradient(chart).G)
    done = solved(energy, solution, elements, contact, yield_strength)
    notes = remarks(energy.grid, elements, done.whole, surface, case) + (() if down.grip is None else down.grip.notes)
    once = Stroke(1.0, solution.steps, solution.factorisations, done.energy, 0.0, solution.state.positions)
    return Formed(
        **{**vars(done), "notes": notes},
        surface=surface,
        held=_held(energy),
        strokes=down.strokes or (once,),
        grip=down.grip,
    )


def _held(energy: Energy) -> Bools:
    """The solved nodes (N,) that the clamp holds or the holder grips."""
    assert isinstance(energy.kinematics, FreeFrames | Differences)
    gripped = energy.friction is not None and energy.friction.capacity > 0
    return np.asarray(energy.kinematics.held | gripped)
