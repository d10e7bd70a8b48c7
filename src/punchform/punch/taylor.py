"""Arithmetic on (f, f', f''): exact derivatives of a formula without symbols (second-order Taylor)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats


@dataclass(frozen=True)
class Taylor:
    """A function of rho at n points: value, first and second derivative, all (n,)."""

    value: Floats
    first: Floats
    second: Floats

    def __add__(self, other: Taylor) -> Taylor:
        return Taylor(self.value + other.value, self.first + other.first, self.second + other.second)

    def __neg__(self) -> Taylor:
        return Taylor(-self.value, -self.first, -self.second)

    def __sub__(self, other: Taylor) -> Taylor:
        return self + (-other)

    def __mul__(self, other: Taylor) -> Taylor:
        return Taylor(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    def __truediv__(self, other: Taylor) -> Taylor:
        value = self.value / other.value
        first = (self.first - value * other.first) / other.value
        second = (self.second - 2 * first * other.first - value * other.second) / other.value
        return Taylor(value, first, second)


def variable(rho: Floats) -> Taylor:
    """rho itself."""
    return Taylor(rho, np.ones_like(rho), np.zeros_like(rho))


def constant(value: float, rho: Floats) -> Taylor:
    """A number, at as many points as rho has."""
    return Taylor(np.full_like(rho, value), np.zeros_like(rho), np.zeros_like(rho))


def power(u: Taylor, p: float) -> Taylor:
    """u^p. Small whole powers are products, so that they are finite and exact at u = 0."""
    if p == 0:
        return constant(1.0, u.value)
    if p == 1:
        return u
    if p == 2:
        return u * u
    outer = u.value ** (p - 2) * (p * (p - 1))
    inner = u.value ** (p - 1) * p
    return _chain(u, u.value**p, inner, outer)


def _chain(u: Taylor, g: Floats, g1: Floats, g2: Floats) -> Taylor:
    """g(u) from g, g', g'' at u."""
    return Taylor(g, g1 * u.first, g2 * u.first * u.first + g1 * u.second)


def _sqrt(u: Taylor) -> Taylor:
    root = np.sqrt(u.value)
    return _chain(u, root, 0.5 / root, -0.25 / (u.value * root))


def _exp(u: Taylor) -> Taylor:
    e = np.exp(u.value)
    return _chain(u, e, e, e)


def _log(u: Taylor) -> Taylor:
    return _chain(u, np.log(u.value), 1 / u.value, -1 / u.value**2)


def _sin(u: Taylor) -> Taylor:
    s, c = np.sin(u.value), np.cos(u.value)
    return _chain(u, s, c, -s)


def _cos(u: Taylor) -> Taylor:
    s, c = np.sin(u.value), np.cos(u.value)
    return _chain(u, c, -s, -c)


def _tan(u: Taylor) -> Taylor:
    t = np.tan(u.value)
    return _chain(u, t, 1 + t * t, 2 * t * (1 + t * t))


def _asin(u: Taylor) -> Taylor:
    x = u.value
    g1 = 1 / np.sqrt((1 - x) * (1 + x))
    return _chain(u, np.arcsin(x), g1, x * g1**3)


def _acos(u: Taylor) -> Taylor:
    x = u.value
    g1 = -1 / np.sqrt((1 - x) * (1 + x))
    return _chain(u, np.arccos(x), g1, x * g1**3)


def _atan(u: Taylor) -> Taylor:
    x = u.value
    g1 = 1 / (1 + x * x)
    return _chain(u, np.arctan(x), g1, -2 * x * g1**2)


def _sinh(u: Taylor) -> Taylor:
    s, c = np.sinh(u.value), np.cosh(u.value)
    return _chain(u, s, c, s)


def _cosh(u: Taylor) -> Taylor:
    s, c = np.sinh(u.value), np.cosh(u.value)
    return _chain(u, c, s, c)


def _tanh(u: Taylor) -> Taylor:
    t = np.tanh(u.value)
    return _chain(u, t, 1 - t * t, -2 * t * (1 - t * t))


FUNCTIONS: dict[str, Callable[[Taylor], Taylor]] = {
    "sqrt": _sqrt,
    "exp": _exp,
    "log": _log,
    "sin": _sin,
    "cos": _cos,
    "tan": _tan,
    "asin": _asin,
    "acos": _acos,
    "atan": _atan,
    "sinh": _sinh,
    "cosh": _cosh,
    "tanh": _tanh,
}
"""The functions that an expression may use."""
