"""What a solve says of the whole grid: its wires, where its energy is, and how fast it came about."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import PressCase
from punchform.grid import Grid
from punchform.mechanics.assembly import Energy
from punchform.mechanics.bars import Bars
from punchform.mechanics.fibres import round_points
from punchform.mechanics.frames import State
from punchform.mechanics.history import Yielding
from punchform.mechanics.outcome import Outcome, Solution, Step
from punchform.whole import Whole, unfold
from punchform.wire import Element, Hardening, axial_compliance, stations, stress


@dataclass(frozen=True)
class Shaped:
    """A grid in a shape: what all stages tell. Energies [mJ] are of the whole grid.

    energy_kinds: stretch ½ D1 F1, bend ½ (D3 F3 + D5 F5), in_plane ½ (D2 F2 + D6 F6), twist ½ D4 F4, and what the
    crossing springs hold. grid and state are of the solved part, `whole` is the whole grid; hardening: how the wires
    yield, None for elastic ones; flow_work: what flow has taken from the whole grid up to now [mJ].
    """

    grid: Grid
    state: State
    whole: Whole
    energy: float
    energy_kinds: dict[str, float]
    notes: tuple[str, ...]
    hardening: Hardening | None
    flow_work: float

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
        """Largest strain of a wire between two crossings by its pull, Eq. (3.9), what has flowed included [-]."""
        return float(self.whole.axial_strain.max())

    @property
    def max_plastic_strain(self) -> float:
        """Largest equivalent plastic strain in a section of a wire [-]."""
        return float(self.whole.plastic_strain.max())

    @property
    def max_thinning(self) -> float:
        """Largest part of its diameter that a wire has lost by being stretched for good [-]."""
        return float(1 - 1 / np.sqrt(self.whole.stretch.max()))

    @property
    def yielded(self) -> float:
        """Share of the wire pieces in which something has flowed."""
        return float((self.whole.plastic_strain > 0).mean())

    @property
    def strain_to_break(self) -> float | None:
        """Largest true strain of a wire over that at which it breaks, Eq. (12.34); None where nobody says that."""
        if self.hardening is None or self.hardening.breaks_at is None:
            return None
        return float(np.log1p(self.max_axial_strain)) / self.hardening.breaks_at


@dataclass(frozen=True)
class Solved(Shaped):
    """A stage that was solved: how that went; seconds by what they were spent on."""

    outcome: Outcome
    history: tuple[Step, ...]
    steps: int
    factorisations: int
    negative_eigenvalues: int | None
    linear_solver: str
    seconds: dict[str, float]


def bars_of(elements: tuple[Element, ...], case: PressCase) -> Bars:
    """What the energy needs to know of the wires, in the convention of offsets and the frame that the case asks for.

    elements: one for each kind of piece, as `Grid.kind` numbers them; their offsets by Eq. (7.5).
    """
    share = 0.5 if case.offset == "centred" else 1.0
    return Bars(
        C=np.stack([element.C for element in elements]),
        offset=np.array([share * element.height - element.drop for element in elements]),
        length=np.array([element.length for element in elements]),
        rise=np.array([_rise(element) for element in elements]),
        chord=case.chord,
        yielding=_yielding(elements),
    )


def _yielding(elements: tuple[Element, ...]) -> Yielding | None:
    """What wires need to know that yield; None for elastic ones."""
    first = elements[0]
    if first.hardening is None:
        return None
    assert first.section is not None, "a wire that yields has a known section"
    at = [stations(element) for element in elements]
    section = first.section
    return Yielding(
        H=np.stack([one.H for one in at]),
        lever=np.stack([one.lever for one in at]),
        weight=np.stack([one.weight for one in at]),
        curving=at[0].curving,
        string=at[0].string,
        C=np.stack([element.C for element in elements]),
        height=np.array([_rise(element) for element in elements]),
        length=np.array([element.length for element in elements]),
        curve=first.hardening.curve,
        kinematic=first.hardening.kinematic,
        wire=np.array([section.youngs_modulus, section.shear_modulus, section.diameter]),
        points=np.empty((0, 3)) if first.fibres is None else round_points(*first.fibres),
    )


def _rise(element: Element) -> float:
    """How far the wire itself rises [mm]: not at all where straight wires are stacked at the height of the element."""
    return element.height if element.centreline is None else element.centreline.rise


def solved(
    energy: Energy,
    solution: Solution,
    elements: tuple[Element, ...],
    contact: Floats,
    yield_strength: float | None,
) -> Solved:
    """The stage that a solution makes, still without notes; contact (N,) as `unfold` takes it."""
    whole = whole_of(energy, solution.state, elements, contact, yield_strength)
    kinds = kinds_of(whole) | {"crossing": energy.grid.copies * energy.springs(solution.state)}
    return Solved(
        grid=energy.grid,
        state=solution.state,
        whole=whole,
        outcome=solution.outcome,
        history=tuple(replace(step, energy=energy.grid.copies * step.energy) for step in solution.history),
        energy=sum(kinds.values()),
        energy_kinds=kinds,
        steps=solution.steps,
        factorisations=solution.factorisations,
        negative_eigenvalues=solution.negative_eigenvalues,
        linear_solver=solution.linear_solver,
        seconds=solution.seconds,
        notes=(),
        hardening=elements[0].hardening,
        flow_work=flow_work(energy.grid, solution.state),
    )


def flow_work(grid: Grid, state: State) -> float:
    """Work that flow has taken from the whole grid by the time of a state of its solved part [mJ]."""
    return 0.0 if state.history is None else float(grid.copies * (state.history.work @ grid.weight))


def whole_of(
    energy: Energy, state: State, elements: tuple[Element, ...], contact: Floats, yield_strength: float | None
) -> Whole:
    """The whole grid in a state of its solved part."""
    grid = energy.grid
    D, F, energies = energy.elastic(state)
    flowed = energy.flowed(state, F)
    largest = np.empty(grid.elements)
    for kind, element in enumerate(elements):
        largest[grid.kind == kind] = stress(element, F[grid.kind == kind])
    compliance = np.array([axial_compliance(element) for element in elements])
    return unfold(
        grid,
        state,
        D=D,
        F=F,
        energy=energies,
        contact=contact,
        stress=largest if flowed is None else flowed.stress,
        axial_strain=F[:, 0] * compliance[grid.kind] if flowed is None else flowed.elongation,
        stretch=np.ones(grid.elements) if flowed is None else flowed.stretch,
        plastic_strain=np.zeros(grid.elements) if flowed is None else flowed.plastic_strain,
        yield_strength=yield_strength,
    )


def joined(passes: list[Solution]) -> Solution:
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


def kinds_of(whole: Whole) -> dict[str, float]:
    """The energy of all elements by what resists, [mJ]; the kinds add up to the energy."""
    each = 0.5 * np.sum(whole.D * whole.F, axis=0)
    return {
        "stretch": float(each[0]),
        "bend": float(each[2] + each[4]),
        "in_plane": float(each[1] + each[5]),
        "twist": float(each[3]),
    }
