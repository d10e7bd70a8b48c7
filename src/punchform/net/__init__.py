"""The inextensible net: the grid with edges that keep their length, on any punch, Eq. (6.5).

The limit EA → ∞ of the grid, exact and fast: the kinematic answer a user may want alone, and a start of the press.
"""

from punchform.net.ground import kernels_are_compiled
from punchform.net.laying import Net, lay_net, touching
from punchform.net.pattern import interpolated, length_within, outline
from punchform.net.start import NetStart, frames, start_state

__all__ = [
    "Net",
    "NetStart",
    "frames",
    "interpolated",
    "kernels_are_compiled",
    "lay_net",
    "length_within",
    "outline",
    "start_state",
    "touching",
]
