"""Checks of a law, for our tests and for laws of your own: derivatives, equilibrium, rigid motions.

Each check raises AssertionError with what differs and by how much. A law is wrong in most ways that matter when its
gradient is not the slope of its energy, so begin with `assert_derivatives` at a state that is no equilibrium:

>>> import numpy as np
>>> slope, curvature = slope_and_curvature(np.sin, 0.5)
>>> bool(abs(slope - 1) < 1e-12 and abs(curvature) < 1e-12)
True
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.assembly import Energy, Hessian
from punchform.mechanics.frames import State, turned
from punchform.mechanics.kinematics import Chart, FreeFrames
from punchform.mechanics.linear import SingularMatrix, multiply, solver_for, upper_matrix

LEVELS = 7
"""How often the reach of the differences is halved."""
REACH = 0.1
"""First reach of the differences: the largest shift in grid steps, and the largest rotation [rad]."""


def slope_and_curvature(line: Callable[[float], Any], reach: float) -> tuple[Floats, Floats]:
    """First and second derivative at 0 of a function of one number, whose value may be an array.

    Central differences at the reach and its halves, extrapolated to 0 (Richardson); of all extrapolations the one
    that its neighbours confirm best.
    """
    reaches = reach * 0.5 ** np.arange(LEVELS)
    here = np.asarray(line(0.0), dtype=np.float64)
    ahead = np.array([line(h) for h in reaches])
    behind = np.array([line(-h) for h in reaches])
    h = reaches.reshape(-1, *(1,) * here.ndim)
    return _extrapolated((ahead - behind) / (2 * h)), _extrapolated((ahead - 2 * here + behind) / h**2)


def assert_derivatives(
    energy: Energy,
    state: State,
    *,
    rng: np.random.Generator,
    directions: int = 3,
    gradient_tolerance: float = 1e-7,
    hessian_tolerance: float = 1e-6,
) -> None:
    """Gradient and exact Hessian of the energy are its derivatives on the chart around the state.

    Compared along random directions in which every unknown does about the same work, so that mm and rad count alike.
    The gradient's error is relative to slope and curvature over one unit of the direction, the Hessian's to the
    Gauss-Newton part, which must not be negative along any of the directions.
    """
    chart = energy.kinematics.chart(state)
    plain, exact = energy.model(chart, Hessian.GAUSS_NEWTON), energy.model(chart, Hessian.EXACT)
    _agree("the energy of the model", exact.energy, energy.at(chart.state), 1e-12 * exact.size)
    _agree("the two gradients", exact.gradient, plain.gradient, 1e-12 * float(np.abs(exact.gradient).max()))
    H, G = upper_matrix(energy.pattern, exact.values), upper_matrix(energy.pattern, plain.values)
    stiffness = np.sqrt(G.diagonal())
    assert stiffness.all(), f"{np.count_nonzero(stiffness == 0)} unknowns carry no stiffness"
    for _ in range(directions):
        z = _within_reach(energy, chart, rng.standard_normal(energy.kinematics.count) / stiffness)
        slope, curvature = slope_and_curvature(_along(energy, chart, z), 1.0)
        gauss_newton, foretold = float(z @ multiply(G, z)), float(z @ multiply(H, z))
        assert gauss_newton >= 0, f"the Gauss-Newton Hessian is not positive: {gauss_newton:.6g} along a direction"
        work = abs(float(slope)) + abs(float(curvature))
        _agree("the gradient along a direction", exact.gradient @ z, slope, gradient_tolerance * work)
        _agree("the Hessian along a direction", foretold, curvature, hessian_tolerance * gauss_newton)


def assert_equilibrium(energy: Energy, state: State, *, tolerance: float = 1e-12) -> None:
    """Another Newton step would gain at most this fraction of the energy, Eq. (5.1): no unit or scale enters."""
    model = energy.model(energy.kinematics.chart(state), Hessian.EXACT)
    try:
        step = solver_for(energy.pattern).factor(model.values).solve(-model.gradient)
    except SingularMatrix as error:
        raise AssertionError("the grid is held so badly that its stiffness matrix is singular") from error
    gain = abs(0.5 * float(model.gradient @ step))
    assert gain <= tolerance * model.size, (
        f"no equilibrium: a Newton step would still gain {gain:.6g} of {model.size:.6g} mJ"
    )


def assert_rigid_invariance(energy: Energy, state: State, *, rng: np.random.Generator, tolerance: float = 1e-9) -> None:
    """A rigid motion of positions and frames together changes no elastic energy and turns all forces with it.

    Also the infinitesimal form of this: forces and moments of the elements are in balance as a whole. The tool, the
    loads and the friction, which do not move with the grid, are left out.
    """
    held = np.zeros(energy.grid.nodes, dtype=bool)
    free = replace(energy, kinematics=FreeFrames(energy.grid, None, held), loads=None, friction=None)
    extent = float(np.abs(state.positions).max())
    rotation = rng.standard_normal(3)
    shift = extent * rng.standard_normal(3)
    before = free.model(free.kinematics.chart(state), Hessian.GAUSS_NEWTON)
    after = free.model(free.kinematics.chart(_moved(state, rotation, shift)), Hessian.GAUSS_NEWTON)
    _agree("the energy of the turned grid", after.energy, before.energy, tolerance * abs(before.energy))
    loads = before.G.reshape(-1, 2, 3)
    size = np.abs(loads).max(axis=(0, 2))[:, None]
    with_it = _rotated(loads, rotation)
    _agree("forces and moments of the turned grid", after.G.reshape(-1, 2, 3), with_it, tolerance * size)
    force, moment = loads.reshape(-1, 2, 2, 3).sum(axis=1).transpose(1, 0, 2)
    whole = np.cross(state.positions, force).sum(axis=0) + moment.sum(axis=0)
    _agree("the sum of all forces", force.sum(axis=0), np.zeros(3), tolerance * float(np.abs(force).sum()))
    _agree("the sum of all moments", whole, np.zeros(3), tolerance * float(extent * np.abs(force).sum()))


def _extrapolated(differences: Floats) -> Floats:
    """The limit of differences whose reach is halved from row to row, with errors in its even powers."""
    table, best = [differences], differences[0]
    doubt = np.full(best.shape, np.inf)
    for order in range(1, len(differences)):
        coarse = table[-1]
        finer = coarse[1:] + (coarse[1:] - coarse[:-1]) / (4.0**order - 1)
        change = np.maximum(np.abs(finer - coarse[1:]), np.abs(finer - coarse[:-1]))
        row = np.argmin(change, axis=0)[None]
        least = np.take_along_axis(change, row, axis=0)[0]
        best = np.where(least < doubt, np.take_along_axis(finer, row, axis=0)[0], best)
        doubt = np.minimum(least, doubt)
        table.append(finer)
    return np.asarray(best)


def _along(energy: Energy, chart: Chart, z: Floats) -> Callable[[float], float]:
    """The energy along a direction."""
    return lambda h: energy.at(chart.moved(h * z))


def _within_reach(energy: Energy, chart: Chart, z: Floats) -> Floats:
    """The direction scaled to the first reach of the differences."""
    shift, rotation = chart.size(z)
    return np.asarray(REACH / max(shift / min(energy.grid.step), rotation) * z)


def _moved(state: State, rotation: Floats, shift: Floats) -> State:
    return State(
        _rotated(state.positions, rotation) + shift,
        _rotated(state.normals, rotation),
        _rotated(state.tangents, rotation),
    )


def _rotated(vectors: Floats, rotation: Floats) -> Floats:
    rows = vectors.reshape(-1, 3)
    return turned(rows, np.broadcast_to(rotation, rows.shape)).reshape(vectors.shape)


def _agree(what: str, found: Any, expected: Any, tolerance: Any) -> None:
    difference = np.abs(np.asarray(found) - np.asarray(expected))
    if not (difference <= tolerance).all():
        worst = float(difference.max())
        size = float(np.max(np.abs(expected)))
        raise AssertionError(f"{what}: off by {worst:.6g}, of a size of {size:.6g}")
