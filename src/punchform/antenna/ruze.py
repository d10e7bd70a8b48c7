"""Loss of gain by a random error of the surface, after J. Ruze: Eqs. (9.19) and (9.20).

Source: J. Ruze, Antenna tolerance theory, Proc. IEEE 54(4), 633-640, 1966, doi 10.1109/PROC.1966.4784.
The error is the rms of the half-path-length deviation after the best fit that the feed may follow. It holds for
errors without order; a systematic shape, such as four lobes, also turns and deforms the beam.
"""

from __future__ import annotations

import math

import numpy as np

from punchform.arrays import Floats

SPEED_OF_LIGHT = 299.792458
"""[mm GHz]"""

_DECIBEL = 10.0 * math.log10(math.e)
_FACTOR = _DECIBEL * (4.0 * math.pi) ** 2


def loss(error: float, wavelength: float) -> float:
    """Loss of gain [dB] by an rms half-path-length error at a wavelength [mm, mm], Eq. (9.19).

    >>> round(loss(1.0, 1.0), 4)
    685.8104
    """
    return _FACTOR * (error / wavelength) ** 2


def error_for_loss(decibel: float, wavelength: float) -> float:
    """The rms half-path-length error [mm] that costs so many dB at a wavelength [mm]."""
    return wavelength * math.sqrt(decibel / _FACTOR)


def wavelength_for_loss(error: float, decibel: float) -> float:
    """The wavelength [mm] at which an rms half-path-length error [mm] costs so many dB."""
    return error * math.sqrt(_FACTOR / decibel)


def highest_frequency(error: float, decibel: float) -> float:
    """The frequency [GHz] up to which an rms half-path-length error [mm] costs at most so many dB; inf for none."""
    return SPEED_OF_LIGHT / wavelength_for_loss(error, decibel) if error > 0 else math.inf


def gain_with_scatter(
    error: Floats, amplitude: Floats, area: Floats, *, wavelength: float, correlation: float = 0.0
) -> float:
    """Gain on the axis over that of the perfect reflector, with what is scattered back into the beam, Eq. (9.20).

    error (n,): rms half-path-length error [mm] at n points of the aperture, amplitude (n,): of the feed there,
    area (n,): projected area of each [mm²]; correlation [mm]: length c of errors that are correlated as
    exp(-s²/c²); 0 leaves the coherent part alone.
    """
    variance = (4.0 * math.pi * error / wavelength) ** 2
    whole = float(np.sum(amplitude * area)) ** 2
    coherent = float(np.sum(amplitude * area * np.exp(-0.5 * variance))) ** 2
    scattered = math.pi * correlation**2 * float(np.sum(amplitude**2 * area * _scatter(variance)))
    return (coherent + scattered) / whole


def _scatter(x: Floats) -> Floats:
    """exp(-x) times the sum over n >= 1 of x^n / (n n!), (n,)."""
    term = np.exp(-x)
    total = np.zeros_like(x)
    last = int(np.max(x, initial=0.0)) + 40
    for n in range(1, last):
        term = term * x / n
        total += term / n
        if n > 20 and not np.any(term > 1e-18 * total):
            break
    return total
