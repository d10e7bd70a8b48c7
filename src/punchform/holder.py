"""The blank holder: what it resists on the flange, and what it remembers from stroke to stroke (Eqs. (12.23), (12.24)).

Two faces press the flange between them. A crossing there slides when its wires pull harder than the friction of both
faces; where it sticks it stays with its anchor, and where it slips it drags the anchor behind it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.case import HolderCase
from punchform.errors import InputError
from punchform.forces import cloth
from punchform.grid import Grid
from punchform.mechanics.frames import State
from punchform.mechanics.friction import Friction

FACES = 2
SLACK = 2e-4
"""Slip at which 0.7 of the friction is reached, in grid steps."""
TRAIL = 7.0
"""How far an anchor is dragged behind a slipping crossing, in slacks: there 0.99 of the friction is reached."""
ALL = 1 - 1e-9


@dataclass(frozen=True)
class Grasp:
    """What the holder remembers of the solved nodes between two strokes.

    anchors (N, 2): where each stuck last [mm]; slid (N,): how far each has slipped since the start [mm]; work: of the
    friction on the solved part so far [mJ].
    """

    anchors: Floats
    slid: Floats
    work: float


@dataclass(frozen=True)
class Grip:
    """What the holder did to the whole grid.

    work: done by the wires against its friction [mJ]; largest_slip: the longest way that a crossing slipped between
    its faces [mm]; slipped: the share of the crossings that it gripped at first which slipped at all.
    """

    work: float
    largest_slip: float
    slipped: float

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know of a holder at either end of its range."""
        if self.slipped == 0:
            return (
                "the holder lets nothing slip: all stretch comes out of the wires, as behind a clamped rim; with less "
                "press.hold.force_per_length the flange would be drawn in",
            )
        if self.slipped > ALL:
            return (
                "every crossing between the faces of the holder slips: it brakes the flange but does not hold it; "
                "for that press.hold.force_per_length must be larger",
            )
        return ()


@dataclass(frozen=True)
class Holder:
    """A blank holder over the flange of a punch; force: of its two faces together on the wires, 2 mu q 2 pi R0 [N].

    slack: of the friction [mm].
    """

    grid: Grid
    rim_radius: float
    force: float
    slack: float

    def at_rest(self) -> Grasp:
        """The memory before the first stroke: every node is anchored where it lies flat."""
        return Grasp(self.grid.flat.astype(np.float64), np.zeros(self.grid.nodes), 0.0)

    def friction(self, state: State, grasp: Grasp) -> Friction:
        """The friction during a stroke that begins at a state, Eq. (12.23)."""
        area = self._between_faces(state)
        total = self.grid.copies * float(area.sum())
        capacity = self.force * area / total if total else area
        return Friction(grasp.anchors, capacity, self.slack)

    def settled(self, friction: Friction, before: State, after: State, grasp: Grasp) -> Grasp:
        """The memory after a stroke: what slipped has dragged its anchor behind it, Eq. (12.24)."""
        slip = friction.slip(after)
        kept = np.minimum(slip, TRAIL * self.slack)
        gripped = self._between_faces(before) > 0
        place = after.positions[:, :2]
        trail = (kept / np.where(slip > 0, slip, 1.0))[:, None] * (place - friction.anchors)
        lost = friction.energies(slip) - friction.energies(kept)
        return Grasp(
            anchors=np.where(gripped[:, None], place - trail, place),
            slid=grasp.slid + np.where(gripped, slip - kept, 0.0),
            work=grasp.work + float(lost.sum()),
        )

    def grip(self, grasp: Grasp) -> Grip:
        """What the memory at the end of the press says of the whole grid."""
        first = self.gripped_first * self.grid.node_weight
        slipped = float(first[grasp.slid > 0].sum() / first.sum())
        return Grip(self.grid.copies * grasp.work, float(grasp.slid.max()), slipped)

    @property
    def gripped_first(self) -> Bools:
        """Which nodes lie between the faces when the punch begins to go down, (N,)."""
        return np.asarray(self._share(np.linalg.norm(self.grid.flat, axis=1)) * cloth(self.grid) > 0)

    def _between_faces(self, state: State) -> Floats:
        """Area of cloth of each solved node that lies between the faces, (N,) [mm²]."""
        return self._share(np.linalg.norm(state.positions[:, :2], axis=1)) * cloth(self.grid)

    def _share(self, rho: Floats) -> Floats:
        """How far nodes have come beyond the rim, (n,), from 0 at the rim to 1 a step outside it."""
        return np.clip((rho - self.rim_radius) / max(self.grid.step), 0.0, 1.0)


def holder(grid: Grid, rim_radius: float, case: HolderCase) -> Holder:
    """The blank holder of a case. Raises InputError where there is no flange to hold."""
    circumference = 2 * np.pi * rim_radius
    force = FACES * case.friction * case.force_per_length * circumference
    made = Holder(grid, rim_radius, force if np.isfinite(rim_radius) else 0.0, SLACK * min(grid.step))
    if not np.isfinite(rim_radius) or not made.gripped_first.any():
        raise InputError.of(
            "no crossing lies outside the rim, where the holder would grip it",
            where="press.hold",
            hint="make the blank larger, or leave out `hold`",
        )
    return made
