"""Pulling the wire ends on the blank's edge: a load that follows the wires along the surface, Eq. (5.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.mechanics.footing import normals_of
from punchform.mechanics.frames import State, perpendicular
from punchform.punch import Surface


@dataclass(frozen=True)
class Pull:
    """An outward force on every wire end of the two families [N], along the wire and along the surface."""

    grid: Grid
    surface: Surface
    force: tuple[float, float]

    def forces(self, state: State) -> Floats:
        """Forces on the nodes, (N, 3) [N], along the wires as they lie in this state.

        A wire in a mirror plane belongs to the solved part with half of its force. A wire end at the edge of a
        rectangle counts like every other.
        """
        ends = self.grid.wire_ends
        outwards = ends[:, :, 1].astype(float) - ends[:, :, 0]
        share = np.where(self.grid.on_mirror[:, ::-1], 0.5, 1.0)
        size = outwards * share * np.asarray(self.force)
        pulled = np.flatnonzero(ends.any(axis=(1, 2)))
        normals = normals_of(self.surface.gap(state.positions[pulled]))
        forces = np.zeros_like(state.positions)
        for family in range(2):
            along = perpendicular(state.tangents[pulled, family], normals)
            forces[pulled] += size[pulled, family, None] * along
        return forces
