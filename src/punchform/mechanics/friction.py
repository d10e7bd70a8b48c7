"""Friction of nodes that slide in a plane: a potential for each stroke of the press (docs/theory.md, section 12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.frames import State


@dataclass(frozen=True)
class Friction:
    """Resistance of nodes to sliding in plan, smooth near rest, Eq. (12.22).

    anchors (N, 2): x and y from which each node's slip counts [mm]; capacity (N,): the largest force [N], 0 for none,
    of the solved part; slack: the slip [mm] at which 0.7 of the capacity is reached.
    """

    anchors: Floats
    capacity: Floats
    slack: float

    def slip(self, state: State) -> Floats:
        """How far each node is from its anchor in plan, (N,) [mm]."""
        return np.asarray(np.linalg.norm(state.positions[:, :2] - self.anchors, axis=1))

    def energies(self, slip: Floats) -> Floats:
        """The potential of each node at a slip (N,) [mJ]."""
        # Without the difference of nearly equal numbers that sqrt(r² + slack²) - slack is at rest.
        return np.asarray(self.capacity * slip**2 / (np.hypot(slip, self.slack) + self.slack))

    def gradient(self, state: State) -> Floats:
        """Slope of the potential to each node's x and y, (N, 2) [N]."""
        apart = state.positions[:, :2] - self.anchors
        return np.asarray(apart * (self.capacity / np.hypot(self.slip(state), self.slack))[:, None])

    def hessian(self, state: State) -> Floats:
        """Second derivatives to each node's x and y, (N, 2, 2) [N/mm]: never negative."""
        apart = state.positions[:, :2] - self.anchors
        length = np.hypot(self.slip(state), self.slack)[:, None, None]
        once = np.eye(2) - apart[:, :, None] * apart[:, None] / length**2
        return np.asarray(self.capacity[:, None, None] * once / length)
