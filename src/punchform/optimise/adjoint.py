"""The gradient of an rms by any number of settings from one more solve with each factored matrix, Eq. (13.26).

With the rms J of the last stage, and what that stage is held by from the stage before,

    H2 lam2 = -∂J/∂z2,   H1 lam1 = -(∂J/∂z1 + ∂(lam2 · g2)/∂z1),   dJ/dp = ∂/∂p (J + lam2 · g2 + lam1 · g1),

the last at fixed unknowns of both stages. However many settings there are, the two solves are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from punchform.accuracy import Measure, rms_gradient
from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.holds import followed
from punchform.mechanics import sweeps
from punchform.optimise.equilibria import Equilibria, Rest
from punchform.optimise.figures import Deviation
from punchform.optimise.knots import FOUR, Knot, between, slope
from punchform.optimise.tangents import Moved, crossings, judged, pressed_at, released_at, released_at_all
from punchform.whole import fold_vectors

ALONG = 1e-4
"""How far the unknowns move for a derivative of forces along the adjoint: the largest shift [mm] or turn [rad]."""


@dataclass(frozen=True)
class Adjoint:
    """The multipliers of an rms: of the press (n1,) and of the release (n2,), None without one or nothing held."""

    rest: Equilibria
    measure: Measure
    fitted: bool
    pressed: Floats
    released: Floats | None

    def slope(self, knots: Sequence[Knot]) -> float:
        """dJ/dp of the setting whose knots these are, Eq. (13.26)."""
        return float(slope([self._bordered(knot) for knot in knots], between(knots)))

    def _bordered(self, knot: Knot) -> float:
        """J + lam2 · g2 + lam1 · g1 at a knot, before any unknown follows."""
        formed = pressed_at(self.rest, self.rest.pressed, self.rest.trail[-1], knot, None)
        total = float(self.pressed @ formed.residual)
        last = self._last(knot, formed)
        if self.released is not None:
            total += float(self.released @ last.residual)
        return total + judged(self.rest, knot, last.state, self.measure, fitted=self.fitted).rms

    def _last(self, knot: Knot, formed: Moved) -> Moved:
        if self.rest.run.released is None:
            return formed
        if self.released is None:
            return released_at_all(self.rest, [knot], [formed.state])[0]
        return released_at(self.rest, knot, formed.state)


def adjoint(rest: Equilibria, of: Deviation) -> Adjoint:
    """The multipliers of an rms of a run. Raises InputError for a run without a target, or with a past."""
    run = rest.run
    if rest.remembers:
        raise InputError.of("the adjoint of wires that yield would have to go back through all strokes", where="wire")
    measure, fitted = of.judged(run.case)
    if run.accuracy is None:
        raise InputError.of("the run was not judged against a target", where="target")
    last, whole = rest.released or rest.pressed, run.final.whole
    points = crossings(rest, run.final.state)
    by_points = rms_gradient(points, whole.cells, run.accuracy, measure=measure, fitted=fitted)
    by_nodes = _on_wires(last, fold_vectors(rest.ready.grid, by_points))
    if run.released is None:
        return Adjoint(rest, measure, fitted, _multipliers(rest.pressed, by_nodes), None)
    if rest.released is None:
        return Adjoint(rest, measure, fitted, np.zeros(rest.pressed.energy.kinematics.count), None)
    freed = _multipliers(rest.released, by_nodes)
    through = _held_part(rest, by_nodes + _forces_along(rest.released, freed))
    return Adjoint(rest, measure, fitted, _multipliers(rest.pressed, through), freed)


def _multipliers(rest: Rest, by_frames: Floats) -> Floats:
    """-H⁻¹ Rᵀ of a derivative by shifts and spin vectors (2 N, 6)."""
    kinematics = rest.energy.kinematics
    reduced = np.zeros(kinematics.count)
    sweeps.reduce(rest.chart.R, by_frames, kinematics.unknowns, reduced)
    return -rest.factor.solve(reduced)


def _on_wires(rest: Rest, by_nodes: Floats) -> Floats:
    """A derivative by the nodes (N, 3) as one by shifts and spin vectors (2 N, 6), once with a wire that passes."""
    grid = rest.energy.grid
    frames = np.zeros((grid.nodes, 2, 6))
    frames[np.arange(grid.nodes), np.where(grid.passes[:, 0], 0, 1), :3] = by_nodes
    return frames.reshape(-1, 6)


def _forces_along(rest: Rest, z: Floats) -> Floats:
    """The derivative of the forces on all frames (2 N, 6) along the unknowns z (n,)."""
    size = max(rest.chart.size(z))
    if size == 0.0:
        return np.zeros((2 * rest.energy.grid.nodes, 6))
    step = ALONG / size
    states = [rest.chart.moved(step * offset * z) for offset in FOUR]
    return slope([rest.energy.gradient(rest.energy.kinematics.chart(state)).G for state in states], step)


def _held_part(rest: Equilibria, by_frames: Floats) -> Floats:
    """What of a derivative by the released frames (2 N, 6) is one by the formed ones: that of what is held."""
    run = rest.run
    assert run.released is not None
    assert run.case.release is not None
    held, formed = run.released.hold, run.formed.state.positions
    ahead, here = (followed(held, formed, formed + nudge, run.case.release, rest.ready.grid) for nudge in (1.0, 0.0))
    kept = np.zeros((rest.ready.grid.nodes, 2, 6))
    # A rib at a height of its own does not ask where the press left the crossing.
    kept[:, :, :3] = ((held.held[:, None] | held.fixed) * (ahead - here))[:, None]
    kept[:, :, 3:] = held.held[:, None, None]
    return kept.reshape(-1, 6) * by_frames
