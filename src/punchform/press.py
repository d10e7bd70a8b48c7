"""The press: from the flat grid to the grid on the punch, and what is known of it there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Bools
from punchform.case import CrossingSpring, PressCase, SolverCase
from punchform.errors import InputError, NoEquilibrium
from punchform.grid import Grid
from punchform.mechanics.assembly import Bars, Energy, Hessian, Loads
from punchform.mechanics.compiled import compile_kernels, kernels_are_compiled
from punchform.mechanics.descent import descend
from punchform.mechanics.differences import Differences
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, squared
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.mechanics.outcome import Outcome, Solution, Step
from punchform.mechanics.rigid import free_motions, unturned
from punchform.progress import Observer, Progress, silent
from punchform.pull import Pull
from punchform.punch import Surface
from punchform.remarks import largest_pull, remarks, slide
from punchform.start import begin
from punchform.whole import Whole, unfold
from punchform.wire import Element, axial_compliance, stress

FOLLOWED = 1e-9
"""The pull has found its direction when no wire end turns by more than this [rad] between two passes."""
PULL_PASSES = 30


@dataclass(frozen=True)
class Formed:
    """The grid on the punch. Energies [mJ] are of the whole grid; seconds by what they were spent on.

    energy_kinds: stretch ½ D1 F1, bend ½ (D3 F3 + D5 F5), in_plane ½ (D2 F2 + D6 F6), twist ½ D4 F4, and what the
    crossing springs hold. draw_in: largest inward move of a wire end [mm]; max_shear [rad]; max_axial_strain:
    largest strain of a wire by its pull, Eq. (3.9). grid and state are of the solved part, `whole` is the whole grid.
    """

    grid: Grid
    surface: Surface
    state: State
    whole: Whole
    outcome: Outcome
    history: tuple[Step, ...]
    energy: float
    energy_kinds: dict[str, float]
    steps: int
    factorisations: int
    negative_eigenvalues: int | None
    linear_solver: str
    seconds: dict[str, float]
    notes: tuple[str, ...]

    @property
    def solved_nodes(self) -> int:
        """Number of nodes that were solved."""
        return self.grid.nodes

    @property
    def max_shear(self) -> float:
        """Largest shear of a cell, without its sign [rad]."""
        return float(np.abs(self.whole.cell_shear).max(initial=0.0))

    @property
    def max_axial_strain(self) -> float:
        """Largest strain of a wire between two crossings by its pull, Eq. (3.9) [-]."""
        return float(self.whole.axial_strain.max())

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
    elements: tuple[Element, Element],
    surface: Surface,
    case: PressCase,
    *,
    crossing: str | CrossingSpring = "pinned",
    solver: SolverCase | None = None,
    yield_strength: float | None = None,
    start: State | None = None,
    observe: Observer = silent,
) -> Formed:
    """Press the grid onto the surface: the minimum of its energy among all grids that lie there, Eq. (3.3).

    start: where the search begins, as `case.start` says when it is not given. Raises InputError for settings that
    contradict each other and NoEquilibrium when the solve ends without an equilibrium.
    """
    solver = solver or SolverCase()
    first, doubts = begin(grid, surface, case) if start is None else (start, ())
    if crossing == "welded":
        first = squared(first)
    energy = energy_of(grid, elements, surface, case, crossing=crossing, start=first)
    if not kernels_are_compiled():
        observe(Progress("press", message="compiling the kernels; only the first run does this"))
        compile_kernels(energy, first)
    if case.pull is not None and case.kinematics == "free":
        _demand_moderate(case.pull, elements)
    if case.pull is None:
        solution = _solve(energy, first, case, solver, observe)
    else:
        energy, solution = _solve_pulled(energy, first, Pull(grid, surface, case.pull), case, solver, observe)
    if case.method == "newton" and not solution.outcome.usable:
        raise NoEquilibrium(solution.outcome.value)
    if energy.kinematics.pins:
        solution = replace(solution, state=unturned(grid, solution.state))
    formed = _formed(energy, solution, elements, surface, case, yield_strength)
    return replace(formed, notes=formed.notes + doubts)


def energy_of(
    grid: Grid,
    elements: tuple[Element, Element],
    surface: Surface,
    case: PressCase,
    *,
    crossing: str | CrossingSpring = "pinned",
    start: State,
) -> Energy:
    """The energy that `press` minimises, Eq. (3.3), without the unknowns of the rigid motions free at the start."""
    kinematics = _kinematics(grid, surface, case, crossing)
    return Energy(
        grid,
        _bars(elements, case),
        replace(kinematics, pins=free_motions(grid, kinematics, kinematics.chart(start))),
        crossing=crossing.stiffness if isinstance(crossing, CrossingSpring) else 0.0,
    )


def _bars(elements: tuple[Element, Element], case: PressCase) -> Bars:
    share = 0.5 if case.offset == "centred" else 1.0
    return Bars(
        C=np.stack([element.C for element in elements]),
        offset=np.array([share * element.height for element in elements]),
        length=np.array([element.length for element in elements]),
    )


def _kinematics(
    grid: Grid, surface: Surface, case: PressCase, crossing: str | CrossingSpring
) -> FreeFrames | Differences:
    held = clamped(grid, surface) if case.rim == "clamp" else np.zeros(grid.nodes, dtype=bool)
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
    return np.asarray(np.linalg.norm(grid.flat, axis=1) >= surface.rim_radius * (1 - 1e-9))


def _solve(energy: Energy, start: State, case: PressCase, solver: SolverCase, observe: Observer) -> Solution:
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
        observe=observe,
    )


def _solve_pulled(
    energy: Energy, start: State, pull: Pull, case: PressCase, solver: SolverCase, observe: Observer
) -> tuple[Energy, Solution]:
    """Passes with the pull along the wire ends of the pass before, Eq. (5.2), until these no longer turn."""
    passes: list[Solution] = []
    state = start
    for _ in range(PULL_PASSES):
        energy = replace(energy, loads=Loads(pull.forces(state), state.positions))
        passes.append(_solve(energy, state, case, solver, observe))
        turned = pull.forces(passes[-1].state) - pull.forces(state)
        state = passes[-1].state
        if not passes[-1].outcome.usable or np.abs(turned).max() <= FOLLOWED * max(map(abs, pull.force)):
            return energy, _joined(passes)
    raise NoEquilibrium(
        f"the pulled wire ends still turn after {PULL_PASSES} passes: the grid slides about on the punch; give it a "
        "wider flange, weld the crossings, or use its mirror planes (grid.symmetry = 'quarter')"
    )


def _demand_moderate(pull: tuple[float, float], elements: tuple[Element, Element]) -> None:
    """Refuse a pull that the element cannot bear, Eq. (3.8)."""
    for force, element in zip(pull, elements, strict=True):
        if force > largest_pull(element):
            raise InputError.of(
                f"a pull of {force:.4g} N is beyond the {largest_pull(element):.3g} N that the element of this wire "
                "and step can describe",
                where="press.pull",
                hint="pull less, or take a smaller step: the limit grows with its inverse square",
            )


def _joined(passes: list[Solution]) -> Solution:
    """All passes as one solution that ends like the last; its history is that of the first."""
    # Every pass has a potential of its own, so only one belongs into a curve: the first, in which most happens.
    return replace(
        passes[-1],
        history=passes[0].history,
        steps=sum(one.steps for one in passes),
        factorisations=sum(one.factorisations for one in passes),
        evaluations=sum(one.evaluations for one in passes),
        seconds={key: sum(one.seconds[key] for one in passes) for key in passes[-1].seconds},
    )


def _formed(
    energy: Energy,
    solution: Solution,
    elements: tuple[Element, Element],
    surface: Surface,
    case: PressCase,
    yield_strength: float | None,
) -> Formed:
    grid, state = energy.grid, solution.state
    D, F, energies = energy.elastic(state)
    chart = energy.kinematics.chart(state)
    contact = chart.contact(energy.model(chart, Hessian.GAUSS_NEWTON).G)
    largest = np.empty(grid.elements)
    for family, element in enumerate(elements):
        largest[grid.family == family] = stress(element, F[grid.family == family])
    whole = unfold(
        grid,
        state,
        D=D,
        F=F,
        energy=energies,
        contact=contact,
        stress=largest,
        axial_compliance=np.array([axial_compliance(element) for element in elements]),
        yield_strength=yield_strength,
    )
    kinds = _kinds(whole) | {"crossing": grid.copies * energy.springs(state)}
    return Formed(
        grid=grid,
        surface=surface,
        state=state,
        whole=whole,
        outcome=solution.outcome,
        history=tuple(replace(step, energy=grid.copies * step.energy) for step in solution.history),
        energy=sum(kinds.values()),
        energy_kinds=kinds,
        steps=solution.steps,
        factorisations=solution.factorisations,
        negative_eigenvalues=solution.negative_eigenvalues,
        linear_solver=solution.linear_solver,
        seconds=solution.seconds,
        notes=remarks(grid, elements, whole, surface, case),
    )


def _kinds(whole: Whole) -> dict[str, float]:
    """The energy of all elements by what resists, [mJ]; the kinds add up to the energy."""
    each = 0.5 * np.sum(whole.D * whole.F, axis=0)
    return {
        "stretch": float(each[0]),
        "bend": float(each[2] + each[4]),
        "in_plane": float(each[1] + each[5]),
        "twist": float(each[3]),
    }
