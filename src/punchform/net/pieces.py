"""A height function f(rho) as polynomial pieces that agree with it to rounding."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from punchform.arrays import Floats
from punchform.punch import functions
from punchform.punch.curves import HeightFunction

DEGREE = 10
ROUNDING = 32 * np.finfo(np.float64).eps
FINEST = 1e-4
"""Narrowest piece relative to the whole: what needs a narrower one is not smooth enough for pieces."""


@dataclass(frozen=True)
class Piece:
    """f = sum c_k t^k with t = (rho - origin) scale for low <= rho <= high; coefficients highest power first."""

    low: float
    high: float
    origin: float
    scale: float
    coefficients: tuple[float, ...]


def pieces(function: HeightFunction, end: float, knots: tuple[float, ...] = ()) -> list[Piece] | None:
    """The pieces of f over 0 <= rho <= end, in order; None when f is not smooth enough between its knots."""
    match function:
        case functions.Parabola(focal_length=focal_length):
            return [Piece(0.0, end, 0.0, 1.0, (-0.25 / focal_length, 0.0, 0.0))]
        case functions.Polynomial(coefficients=coefficients):
            return [Piece(0.0, end, 0.0, 1.0, coefficients[::-1])]
        case functions.Spline(cubic=cubic):
            rho, columns = cubic.x, cubic.c.T
            return [
                Piece(float(low), float(high), float(low), 1.0, tuple(map(float, column)))
                for low, high, column in zip(rho[:-1], rho[1:], columns, strict=True)
                if low < end
            ]
        case _:
            return _fitted(function, end, knots)


def _fitted(function: HeightFunction, end: float, knots: tuple[float, ...]) -> list[Piece] | None:
    """Pieces halved until each agrees with f, to rounding, between its own points."""
    allowed = ROUNDING * max(end, float(np.abs(function(np.linspace(0.0, end, 257))[0]).max()))
    joints = [0.0, *(knot for knot in knots if 0.0 < knot < end), end]
    waiting = list(pairwise(joints))[::-1]
    found: list[Piece] = []
    while waiting:
        low, high = waiting.pop()
        piece, error = _fit(function, low, high)
        if error <= allowed:
            found.append(piece)
            continue
        if not high - low > FINEST * end:
            return None
        middle = 0.5 * (low + high)
        waiting += [(middle, high), (low, middle)]
    return found


def _fit(function: HeightFunction, low: float, high: float) -> tuple[Piece, float]:
    """The interpolant in the Chebyshev points of a piece, and its largest error between them."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)

    def heights(t: Floats) -> Floats:
        return function(np.clip(middle + half * t, low, high))[0]

    chebyshev = Chebyshev.interpolate(heights, DEGREE)
    powers = chebyshev.convert(kind=Polynomial).coef
    between = np.cos(np.linspace(0.0, np.pi, 4 * DEGREE))
    error = float(np.abs(np.polynomial.polynomial.polyval(between, powers) - heights(between)).max())
    coefficients = np.zeros(DEGREE + 1)
    coefficients[: len(powers)] = powers
    return Piece(low, high, middle, 1.0 / half, tuple(map(float, coefficients[::-1]))), error
