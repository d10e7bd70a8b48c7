"""The antenna room: what a deviation and the openings of the mesh cost in gain."""

from punchform.antenna.mesh import leak, leaks_above
from punchform.antenna.ruze import (
    SPEED_OF_LIGHT,
    error_for_loss,
    gain_with_scatter,
    highest_frequency,
    loss,
    wavelength_for_loss,
)

__all__ = [
    "SPEED_OF_LIGHT",
    "error_for_loss",
    "gain_with_scatter",
    "highest_frequency",
    "leak",
    "leaks_above",
    "loss",
    "wavelength_for_loss",
]
