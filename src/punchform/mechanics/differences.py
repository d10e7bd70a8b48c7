"""The paper's kinematics: normals from the surface P(12), tangents from central differences of the positions P(17).

The only unknowns are two shifts per node along the surface, so the same energy is minimised over fewer unknowns: an
upper bound. The frame of a wire at a node follows from three nodes of that wire::

        before ──── node ──── after         tau = c_- x_before + c_0 x_node + c_+ x_after        P(17)
                                            t = q / |q|,  q = (I - n nᵀ) tau                     Eq. (4.2)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.grid import Grid
from punchform.mechanics.footing import bending, normals_of, shifted
from punchform.mechanics.frames import State, basis, unit
from punchform.mechanics.kinematics import UNUSED, spread, without
from punchform.punch import Gap, Surface

STENCIL = 3
NODE = 1
"""Place of the node itself among (before, node, after)."""


@dataclass(frozen=True)
class Differences:
    """Shifts along the surface are the only unknowns; held (N,): nodes that keep their position; pins as elsewhere.

    The slots of a node and wire are the two shifts of the node before, of the node itself and of the node after.
    """

    grid: Grid
    surface: Surface
    held: Bools
    pins: tuple[int, ...] = ()

    @cached_property
    def stencil(self) -> Ints:
        """Nodes before, at and after each node along each wire, (N, 2, 3); the node itself stands in for none."""
        own = np.broadcast_to(np.arange(self.grid.nodes)[:, None], (self.grid.nodes, 2))
        before, after = self.grid.neighbours[:, :, 0], self.grid.neighbours[:, :, 1]
        return np.stack((np.where(before >= 0, before, own), own, np.where(after >= 0, after, own)), axis=2)

    @cached_property
    def weights(self) -> Floats:
        """The weights c of P(17), (N, 2, 3) [1/mm]: central, one-sided at a wire end, zero across a mirror plane."""
        before, after = self.grid.neighbours[:, :, 0] >= 0, self.grid.neighbours[:, :, 1] >= 0
        c = np.zeros((self.grid.nodes, 2, STENCIL))
        c[before & after] = (-0.5, 0.0, 0.5)
        c[before & ~after] = (-1.0, 1.0, 0.0)
        c[~before & after] = (0.0, -1.0, 1.0)
        c[self.grid.on_mirror] = 0.0
        return np.asarray(c * self.grid.subdivide / np.asarray(self.grid.step)[:, None])

    @cached_property
    def constants(self) -> Floats:
        """The part of tau that does not move, (N, 2, 3): a wire crosses a mirror plane at a right angle."""
        fixed = self.grid.on_mirror | ~self.grid.passes
        return np.asarray(fixed[:, :, None] * np.eye(3)[None, :2])

    @cached_property
    def unknowns(self) -> Ints:
        """Numbers of the unknowns, (2 N, 6)."""
        own = np.ones((self.grid.nodes, 2), dtype=bool)
        own[self.held] = False
        own &= ~self.grid.on_mirror
        numbers = (np.cumsum(own) - 1).reshape(own.shape)
        numbers[~own] = UNUSED
        slots = numbers[self.stencil]
        slots[(self.weights == 0)] = UNUSED
        slots[:, :, NODE] = numbers[:, None]
        slots[~self.grid.passes] = UNUSED
        return without(slots.reshape(2 * self.grid.nodes, 2 * STENCIL), self.pins)

    @cached_property
    def own_shifts(self) -> Ints:
        """Numbers of the two shifts of each node, (N, 2)."""
        slots = self.unknowns.reshape(self.grid.nodes, 2, STENCIL, 2)[:, :, NODE]
        return np.where(self.grid.passes[:, 0, None], slots[:, 0], slots[:, 1])

    @cached_property
    def count(self) -> int:
        """How many unknowns there are."""
        return int(self.unknowns.max(initial=-1)) + 1

    def taus(self, positions: Floats) -> Floats:
        """The differences tau of P(17), (N, 2, 3)."""
        moving = np.einsum("nwk,nwkc->nwc", self.weights, positions[self.stencil])
        return np.asarray(moving + self.constants)

    def state(self, positions: Floats) -> State:
        """The state with the frames that these positions have."""
        normals = normals_of(self.surface.gap(positions))
        tau = self.taus(positions)
        along = np.einsum("nwc,nc->nw", tau, normals)
        return State(positions, normals, unit(tau - along[:, :, None] * normals[:, None]))

    def chart(self, state: State) -> DifferenceChart:
        """The unknowns around a state, whose frames are taken anew from its positions."""
        return DifferenceChart(self, self.state(state.positions), self.surface.gap(state.positions))


@dataclass(frozen=True)
class DifferenceChart:
    """The paper's kinematics around one state. Arrays over node and wire: n, t, j (N, 2, 3), rates (N, 2, 3, 6)."""

    kinematics: Differences
    state: State
    gap: Gap

    @cached_property
    def shift_basis(self) -> Floats:
        """Directions of the shifts as columns, (N, 3, 2)."""
        return basis(self.state.normals)

    @cached_property
    def normal_rates(self) -> Floats:
        """The matrix dn/dx, (N, 3, 3) [1/mm]."""
        return _normal_rates(self.gap)

    @cached_property
    def _tau(self) -> tuple[Floats, Floats, Floats]:
        """tau (N, 2, 3), its part along the normal (N, 2), and |q| (N, 2)."""
        tau = self.kinematics.taus(self.state.positions)
        along = np.einsum("nwc,nc->nw", tau, self.state.normals)
        return tau, along, np.einsum("nwc,nwc->nw", tau, self.state.tangents)

    @cached_property
    def _across(self) -> Floats:
        """j = n × t, (N, 2, 3)."""
        return np.cross(self.state.normals[:, None], self.state.tangents)

    @cached_property
    def _spatial(self) -> Floats:
        """Rates of the spin vector with the positions of the three nodes, (N, 2, 3, 3 nodes, 3), Eq. (4.2)."""
        n, j, dn = self.state.normals, self._across, self.normal_rates
        _, along, length = self._tau
        spin = self.kinematics.weights[..., None] * (j / length[..., None])[:, :, None]
        spin[:, :, NODE] -= np.einsum("nwc,ncd->nwd", j, dn) * (along / length)[..., None]
        rates = n[:, None, :, None, None] * spin[:, :, None]
        rates[:, :, :, NODE] += np.cross(n[:, :, None], dn, axis=1)[:, None]
        return np.asarray(rates)

    @cached_property
    def R(self) -> Floats:
        """Rates (2 N, 6, 6) of shift and spin vector with the unknowns."""
        nodes = self.kinematics.grid.nodes
        R = np.zeros((nodes, 2, 6, STENCIL, 2))
        R[:, :, :3, NODE] = self.shift_basis[:, None]
        R[:, :, 3:] = self._on_slots(self._spatial)
        return R.reshape(2 * nodes, 6, 2 * STENCIL)

    def _on_slots(self, spatial: Floats) -> Floats:
        """Rates with positions (N, 2, a, 3, 3) as rates with shifts (N, 2, a, 3, 2)."""
        bases = self.shift_basis[self.kinematics.stencil]
        return np.asarray(np.einsum("nwakc,nwkcs->nwaks", spatial, bases, optimize=True))

    def _forces(self, G: Floats) -> Floats:
        """Gradient of the energy to the positions, with what the frames pass on, (N, 3)."""
        nodes = self.kinematics.grid.nodes
        G = G.reshape(nodes, 2, 6) * self.kinematics.grid.passes[:, :, None]
        total = G[:, :, :3].sum(axis=1)
        passed_on = np.einsum("nwa,nwakc->nwkc", G[:, :, 3:], self._spatial)
        np.add.at(total, self.kinematics.stencil, passed_on)
        return np.asarray(total)

    def contact(self, G: Floats) -> Floats:
        """Normal force of the tool on each node, (N,), Eq. (4.4) [N]."""
        return np.asarray(np.sum(self._forces(G) * self.state.normals, axis=1))

    def curvature(self, G: Floats) -> Floats:
        """Second-order term (2 N, 6, 6): Eq. (4.3) for the frames, Eq. (4.4) for the shifts."""
        nodes = self.kinematics.grid.nodes
        m = G.reshape(nodes, 2, 6)[:, :, 3:]
        n, t, j = self.state.normals, self.state.tangents, self._across
        tau, along, length = self._tau
        turning = np.zeros((nodes, 2, 3, STENCIL, 2))
        turning[:, :, :, NODE] = (self.normal_rates @ self.shift_basis)[:, None]
        dn = turning.reshape(nodes, 2, 3, 2 * STENCIL)
        spatial = self.kinematics.weights[:, :, None, :, None] * np.eye(3)[:, None, :]
        dtau = self._on_slots(spatial).reshape(nodes, 2, 3, 2 * STENCIL)
        spin = np.einsum("nc,nwcs->nws", n, self.R.reshape(nodes, 2, 6, -1)[:, :, 3:])

        def rate(v: Floats, of: Floats) -> Floats:
            return np.asarray(np.einsum("nwc,nwcs->nws", np.broadcast_to(v, (nodes, 2, 3)), of))

        jn, tn, pull = rate(j, dn), rate(t, dn), rate(t, dtau) - rate(t, dn) * along[..., None]
        sheer = rate(tau, dn) + rate(n[:, None], dtau)
        about = np.einsum("nwc,nc->nw", m, n)
        K = _paired(spin, rate(m, dn))
        K += about[..., None, None] * (
            _paired(tn, jn) - 2 / length[..., None, None] * (_paired(jn, sheer) + _paired(spin, pull))
        )
        K = K.reshape(nodes, 2, STENCIL, 2, STENCIL, 2)
        c = np.cross(m, n[:, None]) - (about * along / length)[..., None] * j
        K[:, :, NODE, :, NODE] += self._normal_bending(c)
        first = np.where(self.kinematics.grid.passes[:, 0], 0, 1)
        K[np.arange(nodes), first, NODE, :, NODE] += bending(self.gap, self.shift_basis, self.contact(G))
        return K.reshape(2 * nodes, 2 * STENCIL, 2 * STENCIL)

    def _normal_bending(self, c: Floats) -> Floats:
        """The form c · n'' of Eq. (4.3) on the shifts, (N, 2, 2, 2): n'' by central differences of dn/dx."""
        reach = 1e-4 * min(self.kinematics.grid.step)
        bent = np.empty((*self.normal_rates.shape, 3))
        for axis in range(3):
            nudge = reach * np.eye(3)[axis]
            ahead = _normal_rates(self.kinematics.surface.gap(self.state.positions + nudge))
            behind = _normal_rates(self.kinematics.surface.gap(self.state.positions - nudge))
            bent[..., axis] = (ahead - behind) / (2 * reach)
        form = np.einsum("nwi,niab->nwab", c, 0.5 * (bent + bent.transpose(0, 1, 3, 2)))
        B = self.shift_basis
        return np.asarray(np.einsum("nas,nwab,nbr->nwsr", B, form, B))

    def _shift(self, z: Floats) -> Floats:
        values = spread(self.kinematics.own_shifts, z)
        return np.asarray(np.einsum("nca,na->nc", self.shift_basis, values))

    def moved(self, z: Floats) -> State:
        """The state after the step z (n,)."""
        kinematics = self.kinematics
        shift = self._shift(z)
        return kinematics.state(
            shifted(kinematics.surface, self.state.positions, shift, self.state.normals, kinematics.held)
        )

    def size(self, z: Floats) -> tuple[float, float]:
        """The largest shift [mm] and the largest rotation [rad] of the step z."""
        turned = np.einsum("ras,rs->ra", self.R[:, 3:], spread(self.kinematics.unknowns, z))
        shift = np.linalg.norm(self._shift(z), axis=1)
        return float(shift.max()), float(np.linalg.norm(turned, axis=1).max())


def _normal_rates(gap: Gap) -> Floats:
    """dn/dx = (I - n nᵀ) ∇²gap / |∇gap|, (N, 3, 3)."""
    n = normals_of(gap)
    size = np.linalg.norm(gap.gradient, axis=1)[:, None, None]
    return np.asarray((gap.hessian - n[:, :, None] * (n[:, None] @ gap.hessian)) / size)


def _paired(a: Floats, b: Floats) -> Floats:
    """The symmetric matrix of the form (a · z)(b · z)."""
    product = a[..., :, None] * b[..., None, :]
    return np.asarray(0.5 * (product + np.swapaxes(product, -1, -2)))
