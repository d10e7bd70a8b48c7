"""What a mesh of wires lets through: Eq. (9.21).

Source: M. I. Kontorovich's averaged boundary conditions of wire meshes, M. I. Astrakhan's for square ones. For wires
that touch where they cross, a wave that falls on the mesh squarely, and openings well below half a wavelength.
"""

from __future__ import annotations

import math

from punchform.antenna.ruze import SPEED_OF_LIGHT

OPEN = 0.1
"""Beyond this part of a wavelength from wire to wire a mesh is told to leak."""


def leak(step: float, diameter: float, wavelength: float) -> float:
    """Loss [dB] through a square mesh of round wires at a wavelength [all mm], Eq. (9.21).

    >>> round(leak(7.5, 0.75, 75.0), 3)
    0.227
    """
    alpha = 2 * step / wavelength * math.log(step / (math.pi * diameter))
    return 10 * math.log10(1 + alpha**2)


def leaks_above(step: float) -> float:
    """The frequency [GHz] at which the step [mm] is a tenth of the wavelength, above which the mesh leaks."""
    return OPEN * SPEED_OF_LIGHT / step
