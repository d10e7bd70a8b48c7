"""The energy and its gradient as a function of one vector: what a general minimiser such as L-BFGS-B wants.

The unknowns stay those of the chart around the start; away from its middle its rates are exact, so that no restart is
needed. The gradient is computed without any matrix, the elements on both cores: a minimiser without a Hessian must not
pay for one. All but the return to the surface, which is the package's own, is compiled.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np
from numba import njit

from punchform.arrays import Floats, Ints
from punchform.mechanics import sweeps
from punchform.mechanics.assembly import STRIPS, WORTH_STRIPS, Energy, Hessian
from punchform.mechanics.element import end_force, gradient, loads, modes, wire_ends
from punchform.mechanics.footing import shifted
from punchform.mechanics.frames import State
from punchform.mechanics.kinematics import FreeChart


@dataclass(frozen=True)
class OneChart:
    """The energy of the press as a function of z (n,), z = 0 being the start; free frames on a surface, no loads."""

    energy: Energy
    chart: FreeChart

    def __call__(self, z: Floats) -> tuple[float, Floats]:
        """Energy [mJ] and gradient (n,)."""
        chart, nodes = self.chart, self.energy.grid.nodes
        unknowns, surface = self.energy.kinematics.unknowns, chart.kinematics.surface
        assert surface is not None
        shift = np.empty((nodes, 3))
        normals, tangents = np.empty((nodes, 3)), np.empty((2 * nodes, 3))
        R = np.zeros((2 * nodes, 6, 5))
        begin = chart.state.normals, chart.state.tangents.reshape(-1, 3)
        _turn(z, unknowns, self._first, *begin, chart.shift_basis, chart.tilt_basis, shift, normals, tangents, R)
        positions = shifted(surface, chart.state.positions, shift, chart.across, chart.kinematics.held)
        _lift(surface.distance_gradient(positions)[1], chart.across, chart.shift_basis, R)
        value, G = self._sweep(State(positions, normals, tangents.reshape(nodes, 2, 3)))
        reduced = np.zeros(len(z))
        sweeps.reduce(R, G, unknowns, reduced)
        return value, reduced

    @cached_property
    def _first(self) -> Ints:
        """The rows (N,) that hold the shifts and tilts of the nodes: those of a wire that passes."""
        return np.arange(0, 2 * self.energy.grid.nodes, 2) + np.where(self.energy.grid.passes[:, 0], 0, 1)

    @cached_property
    def diagonal(self) -> Floats:
        """The diagonal of the Gauss-Newton matrix at the start, (n,): what a careful user scales the unknowns by."""
        # The diagonal comes first in each sorted row of an upper triangle.
        values = self.energy.model(self.chart, Hessian.GAUSS_NEWTON).values
        return np.asarray(values[self.energy.pattern.indptr[:-1]])

    @cached_property
    def _shares(self) -> list[Ints]:
        elements = self.energy.grid.elements
        return np.array_split(np.arange(elements), STRIPS if elements > WORTH_STRIPS else 1)

    def _sweep(self, state: State) -> tuple[float, Floats]:
        """Energy, and its gradient G (2 N, 6) to shifts and spin vectors."""
        arguments = self.energy._of(state)

        def half(chosen: Ints) -> tuple[float, Floats]:
            G = np.zeros((2 * self.energy.grid.nodes, 6))
            return _gradients(chosen, *arguments, G), G

        begun = perf_counter()
        if len(self._shares) == 1:
            halves = [half(self._shares[0])]
        else:
            with ThreadPoolExecutor(STRIPS) as pool:
                halves = list(pool.map(half, self._shares))
        self.energy.clock.kernel += perf_counter() - begun
        return sum(value for value, _ in halves), np.asarray(sum(G for _, G in halves))


@njit(cache=True)  # type: ignore[untyped-decorator,unused-ignore]
def _turn(
    z: Any, unknowns: Any, first: Any, normals: Any, tangents: Any, along: Any, across: Any, shift: Any, turned: Any,
    led: Any, R: Any,
) -> None:  # fmt: skip
    """Write the shifts (N, 3), the turned normals (N, 3) and tangents (2 N, 3), and the rates of the spin vectors.

    A tangent is spun about the normal before both are tilted, Eq. (4.1). When the tilt grows, exp([tilt]×) turns at
    I sin a/a + [tilt]× (1 - cos a)/a² + tilt tiltᵀ (1 - sin a/a)/a², a = |tilt|.
    """
    tilt, value, part = np.empty(3), np.empty(5), np.empty(3)
    for node in range(len(normals)):
        for slot in range(5):
            unknown = unknowns[first[node], slot]
            value[slot] = z[unknown] if unknown >= 0 else 0.0
        for c in range(3):
            shift[node, c] = along[node, c, 0] * value[0] + along[node, c, 1] * value[1]
            tilt[c] = across[node, c, 0] * value[2] + across[node, c, 1] * value[3]
        square = tilt[0] * tilt[0] + tilt[1] * tilt[1] + tilt[2] * tilt[2]
        angle = np.sqrt(square)
        if angle > 1e-3:
            sine, versine = np.sin(angle) / angle, 2.0 * np.sin(0.5 * angle) ** 2 / square
            rest = (1.0 - sine) / square
        else:
            sine, versine, rest = 1.0 - square / 6.0, 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
        normal = normals[node]
        _tilted(normal, tilt, sine, versine, turned[node])
        for w in range(2):
            row = 2 * node + w
            unknown = unknowns[row, 4]
            spin = z[unknown] if unknown >= 0 else 0.0
            _cross(normal, tangents[row], part)
            for c in range(3):
                part[c] = np.cos(spin) * tangents[row, c] + np.sin(spin) * part[c]
            _tilted(part, tilt, sine, versine, led[row])
            for k in range(2):
                _cross(tilt, across[node, :, k], part)
                inside = 0.0
                for c in range(3):
                    inside += tilt[c] * across[node, c, k]
                for c in range(3):
                    R[row, 3 + c, 2 + k] = sine * across[node, c, k] + versine * part[c] + rest * inside * tilt[c]
            for c in range(3):
                R[row, 3 + c, 4] = turned[node, c]


@njit(cache=True)  # type: ignore[untyped-decorator,unused-ignore]
def _lift(gradients: Any, normals: Any, along: Any, R: Any) -> None:
    """Write the rates of the shifts: a node stays on the surface, above its place in the tangent plane at the start."""
    for node in range(len(normals)):
        out = 0.0
        for c in range(3):
            out += gradients[node, c] * normals[node, c]
        for k in range(2):
            slope = 0.0
            for c in range(3):
                slope += gradients[node, c] * along[node, c, k]
            for c in range(3):
                rate = along[node, c, k] - normals[node, c] * slope / out
                R[2 * node, c, k] = R[2 * node + 1, c, k] = rate


@njit(cache=True)  # type: ignore[untyped-decorator,unused-ignore]
def _cross(a: Any, b: Any, made: Any) -> None:
    """Write a × b."""
    made[0] = a[1] * b[2] - a[2] * b[1]
    made[1] = a[2] * b[0] - a[0] * b[2]
    made[2] = a[0] * b[1] - a[1] * b[0]


@njit(cache=True)  # type: ignore[untyped-decorator,unused-ignore]
def _tilted(vector: Any, tilt: Any, sine: float, versine: float, made: Any) -> None:
    """Write the vector turned by the tilt: Rodrigues' formula with sin a/a and (1 - cos a)/a²."""
    once, twice = np.empty(3), np.empty(3)
    _cross(tilt, vector, once)
    _cross(tilt, once, twice)
    for c in range(3):
        made[c] = vector[c] + sine * once[c] + versine * twice[c]


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator,unused-ignore]
def _gradients(
    chosen: Any, x: Any, normals: Any, tangents: Any, family: Any, piece: Any, start: Any, end: Any, direction: Any,
    sigma: Any, weight: Any, C: Any, offset: Any, length: Any, rise: Any, chord: Any, rest: Any, G: Any,
) -> Any:  # fmt: skip
    """Add the chosen elements to G (2 N, 6) and return their energy: `sweeps.models` without its matrices."""
    D, F, g = np.empty(6), np.empty(6), np.empty(12)
    total = 0.0
    for number in range(len(chosen)):
        m = chosen[number]
        w, own = family[m], piece[m]
        e = offset[own]
        d, t, j, n, n_b, t_b = wire_ends(x, normals, tangents, family, start, end, direction, sigma, e, m)
        modes(d, t, j, n, n_b, t_b, sigma[m], e, length[own], D)
        total += weight[m] * end_force(C[own], D, F)
        pulls = loads(d, t, j, n, n_b, t_b, sigma[m], e, F)
        gradient(t, j, n, n_b, t_b, pulls, g)
        for c in range(6):
            G[2 * start[m] + w, c] += weight[m] * g[c]
            G[2 * end[m] + w, c] += weight[m] * g[6 + c]
    return total
