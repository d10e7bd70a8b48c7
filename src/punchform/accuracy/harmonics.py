"""Which lobes a deviation has: its parts cos m phi and sin m phi, Eqs. (9.14) and (9.15)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats, Ints

HIGHEST = 8
"""The largest number of lobes m that is looked for."""
ORDERS = 4
"""Radial functions per m, where there are nodes enough."""
NODES_PER_TERM = 4
ROUNDING = 1e-14
"""Relative to the radius of the aperture: a deviation below this is none, and has no lobes."""
DEPENDENT = 1e-11
"""Eigenvalues of the normal equations below this part of the largest belong to terms that bring nothing new."""


@dataclass(frozen=True)
class Harmonic:
    """The part of a deviation with m lobes around the axis.

    share: of the variance, 0 to 1 (on scattered points, where the parts are not quite orthogonal, it may pass these
    by a little); rms [mm]; cosine, sine [mm]: its factors of cos m phi and sin m phi at the edge of the aperture.
    """

    m: int
    share: float
    rms: float
    cosine: float
    sine: float

    @property
    def amplitude(self) -> float:
        """Height of the lobes at the edge of the aperture [mm]."""
        return math.hypot(self.cosine, self.sine)


@dataclass(frozen=True)
class Harmonics:
    """A deviation split by m: mean [mm] and sigma [mm] of the whole, its parts, and the share that is left over.

    The part m = 0 is without the mean. Shares and residual add up to 1 (to 0 where sigma is 0). orders: radial
    functions per m.
    """

    mean: float
    sigma: float
    parts: tuple[Harmonic, ...]
    residual: float
    orders: int


def harmonics(values: Floats, points: Floats, weights: Floats, radius: float) -> Harmonics | None:
    """Split values (n,) [mm] at points (n, 2 or 3) [mm] by weighted least squares, Eqs. (9.14), (9.15).

    weights (n,) >= 0; radius [mm]: of the aperture. None when there are too few points to tell the parts apart.
    """
    orders = min(ORDERS, int((weights > 0).sum()) // (NODES_PER_TERM * (1 + 2 * HIGHEST)))
    if orders < 1:
        return None
    share = weights / weights.sum()
    root = np.sqrt(share)
    mean = float(share @ values)
    left = root * (values - mean)
    total = float(left @ left)
    if total <= (ROUNDING * radius) ** 2:
        total = 0.0
    terms, owner, is_cosine = _terms(points / radius, orders)
    factors = _factors(root[:, None] * terms, left)
    scale = 1.0 / total if total > 0 else 0.0
    parts, rest = [], left
    for m in range(HIGHEST + 1):
        own = owner == m
        part = terms[:, own] @ factors[own]
        part = root * (part - share @ part)
        rest = rest - part
        at_edge = float(factors[own & is_cosine].sum()), float(factors[own & ~is_cosine].sum())
        parts.append(Harmonic(m, float(part @ left) * scale, float(np.linalg.norm(part)), *at_edge))
    return Harmonics(mean, float(np.linalg.norm(left)), tuple(parts), float(rest @ rest) * scale, orders)


def powers(m: int, orders: int) -> list[int]:
    """Powers of rho that go with m lobes: of the parity of m, from min(m, 4 or 5) on; for m = 0 from 2 on.

    A function that is smooth on the axis starts with rho^m; ripples of many lobes, made at the rim, reach further in.
    """
    first = 2 if m == 0 else min(m, 4 + m % 2)
    return [first + 2 * k for k in range(orders)]


def _terms(points: Floats, orders: int) -> tuple[Floats, Ints, Bools]:
    """Columns (n, k) at points relative to the aperture, their m (-1 for the mean), and which are cosines."""
    rho, phi = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    columns, owner, cosines = [np.ones_like(rho)], [-1], [True]
    for m in range(HIGHEST + 1):
        for wave, is_cosine in ((np.cos(m * phi), True), (np.sin(m * phi), False))[: 1 if m == 0 else 2]:
            columns += [rho**p * wave for p in powers(m, orders)]
            owner += [m] * orders
            cosines += [is_cosine] * orders
    return np.column_stack(columns), np.array(owner, dtype=np.int64), np.array(cosines)


def _factors(columns: Floats, values: Floats) -> Floats:
    """Least-squares factors (k,) of columns (n, k), the smallest where the columns depend on each other.

    By the normal equations, much cheaper than a QR of so tall a matrix; the second pass mends their rounding.
    """
    size = np.linalg.norm(columns, axis=0)
    unit = columns / np.where(size > 0, size, 1.0)
    inverse = np.linalg.pinv(unit.T @ unit, rcond=DEPENDENT, hermitian=True)
    factors = inverse @ (unit.T @ values)
    factors += inverse @ (unit.T @ (values - unit @ factors))
    return np.asarray(factors / np.where(size > 0, size, 1.0))
