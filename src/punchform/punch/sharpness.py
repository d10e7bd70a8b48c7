"""Whether the grid can follow the bends of a punch: radii against the grid step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.errors import Problem
from punchform.punch.revolution import Revolution

TURN = np.deg2rad(3.0)
TRACE = 2049
FILLET_FROM_END = 2
"""The fillet is the last segment but the flange."""


@dataclass(frozen=True)
class Bends:
    """Short pieces of a curve in an upright plane: distance from the axis and radius [mm], angle turned [rad, signed],
    number of the segment."""

    rho: Floats
    radius: Floats
    turned: Floats
    segment: Ints


def check_sharpness(
    surface: Revolution, step: float, *, where: str = "punch"
) -> tuple[tuple[Problem, ...], tuple[Problem, ...]]:
    """Errors and warnings about bends of the meridian that turn by more than 3 degrees.

    `step` is the grid step [mm]; `where` begins the place of every problem ("target" for the wanted shape).
    An error: the radius is below one step; a warning: below two steps.
    """
    bends = _bends(surface)
    sharp = runs(bends.radius < step, bends)
    tight = [run for run in runs(bends.radius < 2 * step, bends) if not any(_overlap(run, worse) for worse in sharp)]
    fillet = len(surface.chain.segments) - FILLET_FROM_END if math.isfinite(surface.rim_radius) else None

    def problem(run: slice, how: str) -> Problem:
        return _problem(bends, run, step, where=where, fillet=fillet, how=how)

    return tuple(problem(run, "sharper than") for run in sharp), tuple(
        problem(run, "hardly wider than") for run in tight
    )


def _bends(surface: Revolution) -> Bends:
    rho, radius, turned, segment = [], [], [], []
    for number, piece in enumerate(surface.chain.segments):
        feet = piece.trace(TRACE, 1.1 * surface.rim_radius)
        lengths = np.hypot(np.diff(feet.rho), np.diff(feet.z))
        # The sine of a small angle, which unlike a difference of angles keeps its digits.
        n0, n1 = feet.normal_rho, feet.normal_z
        angles = np.arcsin(np.clip(n0[1:] * n1[:-1] - n1[1:] * n0[:-1], -1.0, 1.0))
        with np.errstate(divide="ignore"):
            radius.append(lengths / np.abs(angles))
        rho.append(feet.rho[:-1])
        turned.append(angles)
        segment.append(np.full(angles.size, number))
    return Bends(np.concatenate(rho), np.concatenate(radius), np.concatenate(turned), np.concatenate(segment))


def runs(sharp: Bools, bends: Bends) -> list[slice]:
    """Contiguous sharp pieces that turn by more than 3 degrees together, all to the same side."""
    side = np.where(sharp, np.sign(bends.turned), 0.0)
    edges = np.flatnonzero(np.diff(side, prepend=0.0, append=0.0))
    runs = [slice(int(a), int(b)) for a, b in pairwise(edges)]
    return [run for run in runs if side[run.start] != 0 and abs(bends.turned[run].sum()) > TURN]


def _overlap(a: slice, b: slice) -> bool:
    return bool(a.start < b.stop and b.start < a.stop)


def _problem(bends: Bends, run: slice, step: float, *, where: str, fillet: int | None, how: str) -> Problem:
    radii = bends.radius[run]
    worst = run.start + int(np.argmax(radii <= 1.001 * radii.min()))
    degrees = abs(np.rad2deg(bends.turned[run].sum()))
    at_fillet = bends.segment[worst] == fillet
    what = "the fillet" if at_fillet else "the profile"
    return Problem(
        f"{what} bends with a radius of {bends.radius[worst]:.4g} mm by {degrees:.3g} degrees near "
        f"rho = {bends.rho[worst]:.4g} mm, {how} the grid step of {step:g} mm",
        where=f"{where}.fillet" if at_fillet else f"{where}.profile",
        hint=f"take a radius of at least {2 * step:g} mm, or a finer grid",
    )
