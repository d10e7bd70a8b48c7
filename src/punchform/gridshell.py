"""An elastic gridshell: no punch, the ends of the wires are moved to given points, and the grid arches up between them.

Ends are held in position only and turn freely; the mechanics is that of the release, Eq. (7.1), with the elements seen
from their chords: the wires bend far.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from punchform.arch import arched
from punchform.arrays import Floats, Ints
from punchform.case import CrossingSpring, End, PressCase, SolverCase
from punchform.ends import nodes_of
from punchform.errors import NoEquilibrium
from punchform.holds import Held
from punchform.mechanics.frames import squared
from punchform.mechanics.newton import minimise
from punchform.progress import Observer, silent
from punchform.release import ROUGH, free_energy, node_forces, softened
from punchform.solved import Solved, joined, solved
from punchform.whole import numbers_in_whole
from punchform.wire import Element, Section, along, straight_line
from punchform.wires import LaidWires


@dataclass(frozen=True)
class Gridshell(Solved):
    """The grid with its wire ends at the given points.

    ends (K,): nodes of the whole grid that are held, in the order in which they were given; reactions (K, 3): the
    forces that hold them [N].
    """

    ends: Ints
    reactions: Floats

    @property
    def height(self) -> float:
        """How far the highest node stands above the lowest end [mm]."""
        z = self.whole.positions[:, 2]
        return float(z.max() - z[self.ends].min())


def straight_elements(laid: LaidWires, section: Section) -> tuple[Element, ...]:
    """The elements of straight wires of one section, one for each kind of piece."""
    return tuple(along(straight_line(float(length)), section) for length in laid.lengths)


def gridshell(
    laid: LaidWires,
    elements: tuple[Element, ...],
    ends: Sequence[End],
    *,
    frame: Literal["O", "chord"] = "chord",
    up: Literal[1, -1] = 1,
    crossing: str | CrossingSpring = "pinned",
    solver: SolverCase | None = None,
    yield_strength: float | None = None,
    observe: Observer = silent,
) -> Gridshell:
    """The equilibrium of the grid with its wire ends at the given points: the minimum of its energy, Eq. (3.3).

    elements: one for each kind of piece of the grid; up: the side of the ends to which the wires arch, +1 towards +z.
    Raises InputError for ends that do not exist or leave the grid loose, and NoEquilibrium when none is found.
    """
    solver = solver or SolverCase()
    grid = laid.grid
    held_at = nodes_of(laid, ends)
    points = np.array([end.point for end in ends], dtype=np.float64)
    start = arched(grid, laid.nodes, held_at, points, up)
    if crossing == "welded":
        start = squared(start)
    fixed = np.zeros((grid.nodes, 3), dtype=bool)
    fixed[held_at] = True
    held = Held(np.zeros(grid.nodes, dtype=bool), fixed, start.positions)
    energy = free_energy(grid, elements, PressCase(frame=frame), held, start, crossing=crossing)
    passes, state = [], start
    for one, tolerance in ((softened(energy), max(ROUGH, solver.tolerance)), (energy, solver.tolerance)):
        passes.append(
            minimise(
                one,
                state,
                max_steps=solver.max_steps,
                tolerance=tolerance,
                linear=solver.linear,
                stage="ends",
                observe=observe,
            )
        )
        state = passes[-1].state
    solution = joined(passes)
    if not solution.outcome.usable:
        raise NoEquilibrium(f"gridshell: {solution.outcome.value}")
    done = solved(energy, solution, elements, np.zeros(grid.nodes), yield_strength)
    reactions = node_forces(energy, solution.state)[held_at]
    return Gridshell(**vars(done), ends=numbers_in_whole(grid)[held_at], reactions=reactions)
