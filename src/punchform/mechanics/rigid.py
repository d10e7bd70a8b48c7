"""Motions that cost nothing because the tool lets the grid move as a rigid body: found, and removed exactly.

A whole grid on a punch of revolution may turn about the axis, one on a bare sphere about every axis. Such a motion
leaves the energy as it is, so leaving out one unknown that takes part in it changes no answer and loads nothing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import qr

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.mechanics.frames import State, turned
from punchform.mechanics.kinematics import UNUSED, Chart, FreeFrames, Kinematics

REPRESENTED = 1e-9
"""A rigid motion is free when the unknowns follow it to this fraction of its size, rms over the nodes."""

TURNS_LAST = 1e-3
"""How much less a frame's turn weighs than a far node's shift when an unknown is chosen."""


def free_motions(grid: Grid, kinematics: Kinematics, chart: Chart) -> tuple[int, ...]:
    """One unknown for each independent rigid motion that nodes and frames can follow at this state."""
    x, frames = chart.state.positions, isinstance(kinematics, FreeFrames)
    rows = np.flatnonzero(grid.passes)
    rates, unknowns = chart.R[rows], kinematics.unknowns[rows]
    if not frames:
        # Frames that follow from the shifts turn with the grid by themselves.
        rates = np.concatenate((rates[:, :3], np.zeros_like(rates[:, 3:])), axis=1)
    generators = np.zeros((len(rows), 6, 6))
    generators[:, :3, :3] = np.eye(3)
    generators[:, 3:, :3] = np.cross(np.eye(3), x[rows // 2, None]) / np.abs(x).max()
    # In turns over the whole extent, so that a frame that cannot turn counts like a far node that cannot move.
    generators[:, 3:, 3:] = frames * np.eye(3)
    followed = (generators @ rates) * (unknowns != UNUSED)[:, None]
    missed = generators - followed @ rates.transpose(0, 2, 1)
    # Singular values, not eigenvalues of the squares: what counts lies at the square root of rounding there.
    triangle = qr(missed.transpose(0, 2, 1).reshape(-1, 6), mode="r")[0][:6]
    combinations, sizes, _ = np.linalg.svd(triangle.T)
    free = combinations[:, sizes < REPRESENTED * np.sqrt(grid.nodes)]
    if not free.size:
        return ()
    # A shift is the better pin: it holds the grid, not only one frame, where that was. Turns come last.
    weights = np.where(np.abs(rates[:, :3]).sum(axis=1) > 0, 1.0, TURNS_LAST)
    motions = np.einsum("gm,ngs->mns", free, followed * weights[:, None]).reshape(free.shape[1], -1)
    order = qr(motions, mode="r", pivoting=True)[1][: free.shape[1]]
    return tuple(sorted(int(number) for number in unknowns.ravel()[order]))


def unturned(grid: Grid, state: State) -> State:
    """The state turned back about the z axis so that the nodes have not, on the whole, turned against the flat."""
    (x, y), (u, v) = grid.flat.T, state.positions[:, :2].T
    back = -np.arctan2(np.sum(x * v - y * u), np.sum(x * u + y * v))
    rotation = np.broadcast_to((0.0, 0.0, back), state.positions.shape)

    def turn(vectors: Floats) -> Floats:
        return turned(vectors, rotation)

    return replace(
        state,
        positions=turn(state.positions),
        normals=turn(state.normals),
        tangents=np.stack([turn(state.tangents[:, w]) for w in range(2)], axis=1),
    )
