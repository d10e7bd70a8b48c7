"""What an energy is made of: wires as the elements see them, and forces that do not change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.mechanics.frames import State
from punchform.mechanics.history import Yielding


@dataclass(frozen=True)
class Bars:
    """What the elements are made of, by kind of piece as `Grid.kind` numbers them, in element axes (mm, N).

    C (P, 6, 6): stiffness; offset (P,): e of Eq. (3.1); length (P,): the step s; rise (P,): how far the piece that C
    describes rises, h of Eq. (3.10); chord: whether D is read from the chord, Eq. (3.12), or at O, Eq. (3.2);
    yielding: what wires need to know that do not stay elastic, which are seen from the chord.
    """

    C: Floats
    offset: Floats
    length: Floats
    rise: Floats
    chord: bool = False
    yielding: Yielding | None = None


@dataclass(frozen=True)
class Loads:
    """Dead forces (N, 3) on the nodes [N], and the positions (N, 3) from which their work counts [mm]."""

    forces: Floats
    anchors: Floats

    def work(self, state: State) -> Floats:
        """Work of each force component, (N, 3) [mJ]."""
        return np.asarray(self.forces * (state.positions - self.anchors))
