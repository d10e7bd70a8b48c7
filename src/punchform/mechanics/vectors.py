"""Vectors of three numbers inside kernels: tuples, which the compiler keeps in registers."""

from __future__ import annotations

from numba import njit

Vector = tuple[float, float, float]


@njit(cache=True, nogil=True)
def row(a, i):
    """Row i of an array (n, 3)."""
    return a[i, 0], a[i, 1], a[i, 2]


@njit(cache=True, nogil=True)
def dot(a, b):
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
def cross(a, b):
    """a × b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@njit(cache=True, nogil=True)
def scaled(c, a):
    """c a."""
    return c * a[0], c * a[1], c * a[2]


@njit(cache=True, nogil=True)
def plus(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(cache=True, nogil=True)
def minus(a, b):
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
