"""The antenna room: what a deviation costs in gain."""

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
    "loss",
    "wavelength_for_loss",
]
