"""Pulling the wire ends on the blank's edge: a load that follows the wires, Eq. (5.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.grid import Grid
from punchform.mechanics.frames import State


@dataclass(frozen=True)
class Pull:
    """An outward force on every wire end of the two families [N], along the wire."""

    grid: Grid
    force: tuple[float, float]

    def forces(self, state: State) -> Floats:
        """Forces on the nodes, (N, 3) [N], along the wires as they lie in this state.

        A wire in a mirror plane belongs to the solved part with half of its force.
        """
        ends = self.grid.wire_ends
        outwards = ends[:, :, 1].astype(float) - ends[:, :, 0]
        share = np.where(self.grid.on_mirror[:, ::-1], 0.5, 1.0)
        size = outwards * share * np.asarray(self.force)
        return np.asarray(np.einsum("nw,nwc->nc", size, state.tangents))
