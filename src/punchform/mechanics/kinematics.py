"""Which unknowns there are and how they move the frames: free frames (docs/theory.md, section 4).

A *kinematics* numbers the unknowns; its *chart* around a state says what they do there: the matrix R from unknowns to
the frame variables (shift of the node, spin vector of each wire's frame), its second-order term, and the state that a
step leads to. Everything else in `mechanics` is the same for all kinematics.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.grid import Grid
from punchform.mechanics.footing import bending, normals_of, shifted
from punchform.mechanics.frames import State, basis, turn
from punchform.punch import Gap, Surface

UNUSED = -1


class Chart(Protocol):
    """The unknowns around one state.

    R (2 N, 6, S): per node and wire (row 2 node + family) the rates of the shift [mm] and of the spin vector [rad]
    with the S unknowns of that node and wire.
    """

    @property
    def state(self) -> State:
        """The state in the middle of the chart."""

    @property
    def R(self) -> Floats:
        """Rates (2 N, 6, S) of shift and spin vector with the unknowns."""

    def curvature(self, G: Floats) -> Floats:
        """Second-order term (2 N, S, S) of the energy for its gradient G (2 N, 6) to shifts and spin vectors."""

    def moved(self, z: Floats) -> State:
        """The state after the step z (n,); not finite where the step cannot be made."""

    def size(self, z: Floats) -> tuple[float, float]:
        """The largest shift [mm] and the largest rotation [rad] of the step z, to first order."""

    def contact(self, G: Floats) -> Floats:
        """Normal force of the tool on each node, (N,), for the gradient G of the energy, Eq. (4.4) [N]."""


class Kinematics(Protocol):
    """A choice of unknowns: `unknowns` (2 N, S) holds their numbers, -1 for none, and `count` how many there are."""

    @property
    def unknowns(self) -> Ints:
        """Numbers of the unknowns, (2 N, S)."""

    @property
    def count(self) -> int:
        """How many unknowns there are."""

    @property
    def pins(self) -> tuple[int, ...]:
        """Unknowns left out of the natural count, so that rigid motions are gone."""

    def chart(self, state: State) -> Chart:
        """The unknowns around a state."""


@dataclass(frozen=True)
class FreeFrames:
    """Node frames are unknowns: two shifts on the punch (three without), two tilts, one spin per wire.

    surface: what the nodes lie on; held (N,): nodes that keep position and frames; welded: both wires share the spin;
    pins: unknowns left out of the natural count, so that rigid motions are gone; fixed (N, 3): directions in which a
    node without a surface does not shift; odd: for the mirror planes x = 0 and y = 0 of a quarter, whether motions
    change their sign across it instead of being mirrored.
    The slots of a node and wire are shift (2 or 3), tilt (2), spin (1).
    """

    grid: Grid
    surface: Surface | None
    held: Bools
    welded: bool = False
    pins: tuple[int, ...] = ()
    fixed: Bools | None = None
    odd: tuple[bool, bool] = (False, False)

    @cached_property
    def shifts(self) -> int:
        """Number of shift slots."""
        return 3 if self.surface is None else 2

    @cached_property
    def unknowns(self) -> Ints:
        """Numbers of the unknowns (2 N, S), counted node by node."""
        free = self._free()
        shared = free[:, : self.shifts + 2]
        spins = free[:, self.shifts + 2 :]
        numbers = (np.cumsum(free) - 1).reshape(free.shape)
        numbers[~free] = UNUSED
        if self.welded:
            one = np.where(spins[:, 0], numbers[:, -2], numbers[:, -1])
            numbers[:, -2:] = one[:, None]
        rows = [np.column_stack((numbers[:, : shared.shape[1]], numbers[:, -2 + w])) for w in range(2)]
        passes = self.grid.passes
        for w in range(2):
            rows[w][~passes[:, w]] = UNUSED
        return without(np.stack(rows, axis=1).reshape(2 * self.grid.nodes, self.shifts + 3), self.pins)

    @cached_property
    def count(self) -> int:
        """How many unknowns there are."""
        return int(self.unknowns.max(initial=-1)) + 1

    def _free(self) -> Bools:
        """Which of shift, tilt, spin 1, spin 2 are unknown, (N, shifts + 4)."""
        free = np.ones((self.grid.nodes, self.shifts + 4), dtype=bool)
        tilt = self.shifts
        free[:, tilt + 2 :] = self.grid.passes
        for axis in range(2):
            # A mirror plane leaves shifts in the plane, the turn about its own normal, and no spin about the node
            # normal; a motion that changes sign across it has just the others.
            even = np.ones(self.shifts + 4, dtype=bool)
            even[[axis, tilt + 1 - axis, tilt + 2, tilt + 3]] = False
            free[self.grid.on_mirror[:, axis]] &= ~even if self.odd[axis] else even
        if self.fixed is not None:
            free[:, :3] &= ~self.fixed
        if self.welded:
            free[:, tilt + 3] &= ~free[:, tilt + 2]
        free[self.held] = False
        return free

    def chart(self, state: State) -> FreeChart:
        """The unknowns around a state."""
        gap = None if self.surface is None else self.surface.gap(state.positions)
        return FreeChart(self, state, gap)


@dataclass(frozen=True)
class FreeChart:
    """Free frames around one state; `gap` belongs to its positions."""

    kinematics: FreeFrames
    state: State
    gap: Gap | None

    @cached_property
    def across(self) -> Floats:
        """Unit normals of the surface at the nodes, (N, 3)."""
        assert self.gap is not None
        return normals_of(self.gap)

    @cached_property
    def shift_basis(self) -> Floats:
        """Directions of the shifts as columns, (N, 3, 2 or 3)."""
        if self.gap is None:
            return np.broadcast_to(np.eye(3), (len(self.state.positions), 3, 3))
        return basis(self.across)

    @cached_property
    def tilt_basis(self) -> Floats:
        """Directions of the tilts as columns, (N, 3, 2)."""
        return basis(self.state.normals)

    @cached_property
    def R(self) -> Floats:
        """Rates (2 N, 6, S) of shift and spin vector with the unknowns, Eq. (4.1)."""
        shifts, nodes = self.kinematics.shifts, self.kinematics.grid.nodes
        R = np.zeros((nodes, 2, 6, shifts + 3))
        R[:, :, :3, :shifts] = self.shift_basis[:, None]
        R[:, :, 3:, shifts : shifts + 2] = self.tilt_basis[:, None]
        R[:, :, 3:, shifts + 2] = self.state.normals[:, None]
        return R.reshape(2 * nodes, 6, shifts + 3)

    def curvature(self, G: Floats) -> Floats:
        """Tilt and spin do not commute, Eq. (4.1), and a shift follows the surface, Eq. (4.4)."""
        shifts, nodes = self.kinematics.shifts, self.kinematics.grid.nodes
        K = np.zeros((nodes, 2, shifts + 3, shifts + 3))
        moments = G.reshape(nodes, 2, 6)[:, :, 3:]
        # With tilts about b1 and b2 = n × b1 the products b × n are -b2 and b1.
        swerve = np.stack((-self.tilt_basis[:, :, 1], self.tilt_basis[:, :, 0]), axis=2)
        mixed = 0.5 * (moments @ swerve)
        spin = shifts + 2
        K[:, :, shifts:spin, spin] = K[:, :, spin, shifts:spin] = mixed
        if self.gap is not None:
            # The shift belongs to both wires of a node: count its term once, with a wire that passes.
            first = np.where(self.kinematics.grid.passes[:, 0], 0, 1)
            K[np.arange(nodes), first, :2, :2] += bending(self.gap, self.shift_basis, self.contact(G))
        return K.reshape(2 * nodes, shifts + 3, shifts + 3)

    def contact(self, G: Floats) -> Floats:
        """Normal force of the tool on each node, (N,), Eq. (4.4) [N]; zero without a surface."""
        if self.gap is None:
            return np.zeros(len(self.state.positions))
        force = G.reshape(-1, 2, 6)[:, :, :3].sum(axis=1)
        return np.asarray(np.sum(force * self.across, axis=1))

    def _step(self, z: Floats) -> tuple[Floats, Floats, Floats]:
        """The step z as shifts (N, 3), tilts (N, 3) and spins (N, 2)."""
        shifts, nodes = self.kinematics.shifts, self.kinematics.grid.nodes
        values = spread(self.kinematics.unknowns, z).reshape(nodes, 2, shifts + 3)
        shared = np.where(self.kinematics.grid.passes[:, 0, None], values[:, 0], values[:, 1])
        shift = np.einsum("nca,na->nc", self.shift_basis, shared[:, :shifts])
        tilt = np.einsum("nca,na->nc", self.tilt_basis, shared[:, shifts : shifts + 2])
        return shift, tilt, values[:, :, shifts + 2]

    def moved(self, z: Floats) -> State:
        """The state after the step z (n,); the shift returns to the surface along the normal it left."""
        shift, tilt, spin = self._step(z)
        surface, held = self.kinematics.surface, self.kinematics.held
        if surface is None:
            positions = self.state.positions + shift
        else:
            positions = shifted(surface, self.state.positions, shift, self.across, held)
        return turn(self.state, positions, tilt, spin)

    def size(self, z: Floats) -> tuple[float, float]:
        """The largest shift [mm] and the largest rotation [rad] of the step z."""
        shift, tilt, spin = self._step(z)
        turned = np.abs(spin).max(axis=1) + np.linalg.norm(tilt, axis=1)
        return float(np.linalg.norm(shift, axis=1).max()), float(turned.max())


def without(unknowns: Ints, pins: tuple[int, ...]) -> Ints:
    """The numbers of the unknowns once the pinned ones are left out."""
    kept = np.ones(unknowns.max(initial=-1) + 2, dtype=bool)
    kept[[*pins, -1]] = False
    renumbered = np.cumsum(kept) - 1
    renumbered[~kept] = UNUSED
    return np.asarray(renumbered[unknowns])


def spread(unknowns: Ints, z: Floats) -> Floats:
    """The values of the step z at their slots, zero where there is none."""
    return np.asarray(np.append(z, 0.0)[unknowns])
