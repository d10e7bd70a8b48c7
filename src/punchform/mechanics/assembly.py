"""From elements to one energy, one gradient and one sparse matrix: the pattern is analysed once.

The energy of the grid is Eq. (3.3), plus the crossing springs of Eq. (4.5), minus the work of the pull of Eq. (5.2),
plus the friction of Eq. (12.22).
A large grid is cut into strips that touch no common unknown, so both cores can add to the same arrays; the kernels
release the interpreter lock and run in a thread pool. On one core the same strips follow each other: the sums are the
same to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from punchform.arrays import Floats, Ints
from punchform.grid import Grid
from punchform.mechanics import sweeps
from punchform.mechanics.bars import Bars, Loads
from punchform.mechanics.cores import cores
from punchform.mechanics.frames import State, crossing_angle
from punchform.mechanics.friction import Friction
from punchform.mechanics.history import Flowed, History, Recall, Response, Yielding
from punchform.mechanics.kinematics import Chart, Kinematics
from punchform.mechanics.pattern import Pattern, analyse, shares

ROUNDING = 1e-13
"""Rounding of a long sum, relative to its terms; that of a coordinate counts a tenth of it."""
STRIPS = 2
NO_REST = np.zeros((1, 10))
WORTH_STRIPS = 8000
WORTH_THREADS_TO_YIELD = 200
"""Below so many elements a second thread costs more than it saves; those that yield have more to do."""


class Hessian(Enum):
    """Which second derivatives: all; those of squares only; or all, less what is not convex element by element."""

    GAUSS_NEWTON = sweeps.GAUSS_NEWTON
    PROJECTED = sweeps.PROJECTED
    EXACT = sweeps.EXACT

    @property
    def words(self) -> str:
        """How a report calls it."""
        return {"GAUSS_NEWTON": "Gauss-Newton", "PROJECTED": "projected", "EXACT": "exact"}[self.name]


@dataclass(frozen=True)
class Gradient:
    """The energy around a chart to first order: energy [mJ], gradient (n,), and G (2 N, 6) of Eq. (3.4).

    size: the energy that counts as large here, elastic energy and work without their signs [mJ]; rounding: energies
    nearer than this are the same [mJ].
    """

    energy: float
    size: float
    rounding: float
    gradient: Floats
    G: Floats


@dataclass(frozen=True)
class Model(Gradient):
    """The energy around a chart to second order, with the upper CSR values (nnz,) of its Hessian."""

    values: Floats


@dataclass
class Clock:
    """Seconds spent in the kernels and in the assembly around them."""

    kernel: float = 0.0
    assembly: float = 0.0

    def reset(self) -> None:
        """Begin again at zero."""
        self.kernel = self.assembly = 0.0


@dataclass(frozen=True)
class Energy:
    """The energy of the grid as a function of its unknowns (one solve: grid, wire, kinematics, crossing, loads).

    crossing: stiffness of the crossing springs [N mm/rad], 0 for none; loads: dead forces on the nodes; friction:
    what resists their sliding; recall: the last answer of wires that yield, which an energy made from another with
    `replace` goes on with.
    """

    grid: Grid
    bars: Bars
    kinematics: Kinematics
    crossing: float = 0.0
    loads: Loads | None = None
    friction: Friction | None = None
    clock: Clock = field(default_factory=Clock)
    recall: Recall = field(default_factory=Recall)

    @cached_property
    def pattern(self) -> Pattern:
        """The sparse pattern with the places that every element adds to."""
        begun = perf_counter()
        ends = 2 * np.column_stack((self.grid.start, self.grid.end)) + self.grid.family[:, None]
        unknowns = self.kinematics.unknowns
        cliques = [unknowns[ends].reshape(self.grid.elements, -1), unknowns]
        if self.crossing:
            cliques.append(unknowns.reshape(self.grid.nodes, -1))
        pattern = analyse(cliques, self.kinematics.count)
        self.clock.assembly += perf_counter() - begun
        return pattern

    @cached_property
    def _shares(self) -> tuple[tuple[Ints, ...], Ints]:
        return shares(self.grid, STRIPS if self.grid.elements >= WORTH_STRIPS else 1)

    @cached_property
    def _virgin(self) -> History:
        assert self.bars.yielding is not None
        return self.bars.yielding.virgin(self.grid.kind)

    def elastic(self, state: State) -> tuple[Floats, Floats, Floats]:
        """Modes D (M, 6), end forces F (M, 6) and energies (M,) of the elements, Eq. (3.2), P(3), P(8)."""
        begun = perf_counter()
        if self.bars.yielding is None:
            D, F, energies = self._states(state)
        else:
            D, answer = self._answer(self.bars.yielding, state)
            F, energies = answer.F, answer.energies
        self.clock.kernel += perf_counter() - begun
        return D, F, energies

    def _states(self, state: State) -> tuple[Floats, Floats, Floats]:
        D, F = np.empty((self.grid.elements, 6)), np.empty((self.grid.elements, 6))
        energies = np.empty(self.grid.elements)
        sweeps.states(*self._of(state), D, F, energies)
        return D, F, energies

    def _answer(self, law: Yielding, state: State) -> tuple[Floats, Response]:
        """The modes, and what wires that yield make of them; the search begins at the forces of the last call."""
        last, of = self.recall, (state, self.grid, self.bars)
        if last.answer is None or not last.has(of):
            if last.begin is None or not last.knows(of):
                last.begin = law.beginning(self.grid.elements)
            threads = cores() if self.grid.elements >= WORTH_THREADS_TO_YIELD else 1
            last.of, last.D = of, self._states(state)[0]
            last.answer = law.respond(self._history(state), self.grid.kind, last.D, last.begin, threads)
        return last.D, last.answer

    def settled(self, state: State) -> State:
        """The state with what flowed on the way to it as its past, Eqs. (12.14)-(12.16); that of elastic wires itself.

        Pulls, torques and end moments stay what they are, but for the error of the stroke; the energy becomes that of
        the elastic strains.
        """
        law = self.bars.yielding
        if law is None:
            return state
        D, _ = self._answer(law, state)
        assert self.recall.begin is not None
        history = law.settled(self._history(state), self.grid.kind, D, self.recall.begin)
        self.recall.answer = None
        return replace(state, history=history)

    def flowed(self, state: State, F: Floats) -> Flowed | None:
        """What is left in the wires of what flowed, under end forces F (M, 6); None for elastic ones."""
        law = self.bars.yielding
        return None if law is None else law.flowed(self._history(state), self.grid.kind, F)

    def at(self, state: State) -> float:
        """The energy of the solved part [mJ]; infinite where the state is not finite."""
        if self.bars.yielding is None:
            begun = perf_counter()
            energies = np.empty(self.grid.elements)
            sweeps.energies(*self._of(state), energies)
            self.clock.kernel += perf_counter() - begun
        else:
            energies = self.elastic(state)[2]
        total = float(energies @ self.grid.weight) + self.springs(state) - self._work(state)
        total += self.rubbing(state)
        return total if np.isfinite(total) else np.inf

    def gradient(self, chart: Chart) -> Gradient:
        """Energy and gradient on a chart, without a matrix."""
        elastic, G = self._swept(chart, sweeps.NO_HESSIAN, np.empty((0, 0), dtype=np.int32), np.empty(0))
        self._add_crossings(chart, G, None)
        return self._reduced(chart, elastic, G)

    def gradient_of(self, chart: Chart, F: Floats) -> Floats:
        """What end forces F (M, 6) alone do to the unknowns, (n,), of elements seen from their chords: Rᵀ Jᵀ F."""
        elements, G = self.grid.elements, np.zeros((2 * self.grid.nodes, 6))
        sweeps.models(
            *(np.arange(elements), *self._of(chart.state), np.zeros((elements, 6, 6)), True, F, chart.R),
            *(np.empty((0, 0), dtype=np.int32), sweeps.NO_HESSIAN, np.empty(elements), G, np.empty(0)),
        )
        gradient = np.zeros(self.kinematics.count)
        sweeps.reduce(chart.R, G, self.kinematics.unknowns, gradient)
        return gradient

    def model(self, chart: Chart, hessian: Hessian) -> Model:
        """Energy, gradient and the chosen Hessian on a chart."""
        pattern = self.pattern
        values = np.zeros(pattern.entries)
        elastic, G = self._swept(chart, hessian.value, pattern.places[0], values)
        self._add_crossings(chart, G, values)
        self._add_friction(chart, values)
        first = self._reduced(chart, elastic, G)
        begun = perf_counter()
        if hessian is not Hessian.GAUSS_NEWTON:
            sweeps.scatter(chart.curvature(G), pattern.places[1], hessian.value, values)
        self.clock.assembly += perf_counter() - begun
        return Model(**vars(first), values=values)

    def _swept(self, chart: Chart, kind: int, places: NDArray[np.int32], values: Floats) -> tuple[float, Floats]:
        """Elastic energy and G (2 N, 6) of all elements, whose Hessian is added to the values."""
        begun = perf_counter()
        energies, G, R = np.empty(self.grid.elements), np.zeros((2 * self.grid.nodes, 6)), chart.R
        arguments = self._of(chart.state)
        law, forces, stiffness = self.bars.yielding, np.empty((0, 6)), np.empty((0, 6, 6))
        if law is not None:
            _, answer = self._answer(law, chart.state)
            forces, stiffness, energies = answer.F, answer.stiffness, answer.energies

        def sweep(chosen: Ints) -> None:
            sweeps.models(chosen, *arguments, stiffness, law is not None, forces, R, places, kind, energies, G, values)

        self._in_threads(sweep)
        self.clock.kernel += perf_counter() - begun
        return float(energies @ self.grid.weight), G

    def _reduced(self, chart: Chart, elastic: float, G: Floats) -> Gradient:
        """Energy and gradient with springs, loads and friction; the forces of the loads are taken off G."""
        begun = perf_counter()
        elastic += self.springs(chart.state)
        rubbing = self.rubbing(chart.state)
        energy = elastic - self._work(chart.state) + rubbing
        size = elastic + rubbing
        by_wire = G.reshape(-1, 2, 6)
        nodes = np.arange(self.grid.nodes)
        if self.loads is not None:
            size += float(np.abs(self.loads.work(chart.state)).sum())
            by_wire[nodes, self._first_wire, :3] -= self.loads.forces
        if self.friction is not None:
            by_wire[nodes, self._first_wire, :2] += self.friction.gradient(chart.state)
        gradient = np.zeros(self.kinematics.count)
        sweeps.reduce(chart.R, G, self.kinematics.unknowns, gradient)
        self.clock.assembly += perf_counter() - begun
        return Gradient(energy, size, self._rounding(chart.state, elastic, size), gradient, G)

    def _of(self, state: State) -> tuple[Any, ...]:
        """What the kernels need of state, grid and wire, in their order."""
        grid, bars = self.grid, self.bars
        tangents = state.tangents.reshape(-1, 3)
        return (
            *(state.positions, state.normals, tangents),
            *(
                grid.family,
                grid.kind,
                grid.start,
                grid.end,
                grid.direction.astype(np.float64),
                grid.sigma.astype(np.float64),
            ),
            *(grid.weight, bars.C, bars.offset, bars.length, bars.rise, bars.chord),
            NO_REST if bars.yielding is None else self._history(state).measures,
        )

    def _history(self, state: State) -> History:
        """What the wires remember; those of a state without a history are new."""
        return self._virgin if state.history is None else state.history

    def _in_threads(self, sweep: Callable[[Ints], None]) -> None:
        """The strips of the grid at the same time, then the seams between them."""
        strips, seam = self._shares
        if cores() == 1 or len(strips) == 1:
            for strip in strips:
                sweep(strip)
        else:
            with ThreadPoolExecutor(cores()) as pool:
                list(pool.map(sweep, strips))
        if len(seam):
            sweep(seam)

    @cached_property
    def _first_wire(self) -> Ints:
        return np.where(self.grid.passes[:, 0], 0, 1)

    def _shear_moment(self, state: State) -> Floats:
        """Moment of the crossing spring per node, weighted, (N,), Eq. (4.5)."""
        crossed = self.grid.passes.all(axis=1)
        turned = crossing_angle(state) - 0.5 * np.pi
        return np.asarray(self.crossing * self.grid.node_weight * crossed * turned)

    def springs(self, state: State) -> float:
        """Energy of the crossing springs of the solved part, Eq. (4.5) [mJ]."""
        if not self.crossing:
            return 0.0
        return float(0.5 * self._shear_moment(state) @ (crossing_angle(state) - 0.5 * np.pi))

    def rubbing(self, state: State) -> float:
        """Potential of the friction on the solved part, Eq. (12.22) [mJ]."""
        return 0.0 if self.friction is None else float(self.friction.energies(self.friction.slip(state)).sum())

    def _rounding(self, state: State, elastic: float, size: float) -> float:
        """What rounding does to the energy: to its sum, and to forces F ~ √(2 C11 U) times rounded coordinates."""
        forces = np.sqrt(2 * self.bars.C[:, 0, 0].max() * elastic)
        return float(ROUNDING * (size + 0.1 * np.abs(state.positions).max() * forces))

    def _work(self, state: State) -> float:
        return 0.0 if self.loads is None else float(np.sum(self.loads.work(state)))

    def _add_crossings(self, chart: Chart, G: Floats, values: Floats | None) -> None:
        """Moments and stiffness of the crossing springs, Eq. (4.5): theta' = s2 - s1 about the normal."""
        if not self.crossing:
            return
        nodes, normals = self.grid.nodes, chart.state.normals
        moment = self._shear_moment(chart.state)[:, None] * normals
        by_wire = G.reshape(nodes, 2, 6)
        by_wire[:, 0, 3:] -= moment
        by_wire[:, 1, 3:] += moment
        if values is None:
            return
        spins = np.einsum("nwcs,nc->nws", chart.R.reshape(nodes, 2, 6, -1)[:, :, 3:], normals)
        rate = np.concatenate((-spins[:, 0], spins[:, 1]), axis=1)
        crossed = self.crossing * self.grid.node_weight * self.grid.passes.all(axis=1)
        sweeps.scatter(
            crossed[:, None, None] * rate[:, :, None] * rate[:, None], self.pattern.places[2], sweeps.EXACT, values
        )

    def _add_friction(self, chart: Chart, values: Floats) -> None:
        """Stiffness of the friction, Eq. (12.22), through the shifts of each node, once with a wire that passes."""
        if self.friction is None:
            return
        nodes = np.flatnonzero(self.friction.capacity)
        rows = 2 * nodes + self._first_wire[nodes]
        rates = chart.R[rows, :2]
        stiffness = rates.transpose(0, 2, 1) @ self.friction.hessian(chart.state)[nodes] @ rates
        sweeps.scatter(stiffness, self.pattern.places[1][rows], sweeps.EXACT, values)
