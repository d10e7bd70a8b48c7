"""Whether a correction leaves a punch that a grid can follow: its bends, its slope, its depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.errors import Problem
from punchform.punch.corrected import Corrected
from punchform.punch.correction import HeightField, RadialCorrection
from punchform.punch.protocol import Surface
from punchform.punch.sharpness import Bends, runs

WHERE = "punch.correction"
STEEPEST = 1.0
"""The slope that a correction may have: a steeper one is another punch, or in another unit."""
DEEPEST = 0.01
"""How far a corrected punch may dip below its flange, in its heights."""
FLANGE = 0.01
"""A flange that a correction changes by less [mm] is left as it is: no spline ends between two of its points."""
NOTICED = 0.9
"""A bend is that of the correction where it makes the radius smaller by more than a tenth."""
FINER = 2
"""Pieces that a cell of the correction is cut into along each line that is looked at."""


@dataclass(frozen=True)
class _Lines:
    """Points (lines, count, 2) [mm] in plan along parallel lines: to the axis of this number, from the axis out."""

    xy: Floats
    axis: int


def check_correction(surface: Corrected, step: float) -> tuple[tuple[Problem, ...], tuple[Problem, ...]]:
    """Errors and warnings about a correction, for a grid whose wires have nodes every `step` [mm].

    Errors: it is steeper than 45 degrees, it lowers the punch below its flange, or it adds a bend by more than
    3 degrees with a radius below one step; a warning: below two steps. Bends of the profile itself are not told again.
    """
    errors, doubts = [], []
    lines = _lines(surface)
    for told in (_steep(surface, lines), _deep(surface, lines)):
        errors += [told] if told else []
    bent = [(some, _bends(some, surface)) for some in lines]
    if sharp := _sharpest(surface, bent, step, step, "sharper than"):
        errors.append(sharp)
    elif tight := _sharpest(surface, bent, step, 2 * step, "hardly wider than"):
        doubts.append(tight)
    if told := _on_flange(surface, lines):
        doubts.append(told)
    return tuple(errors), tuple(doubts)


def _lines(surface: Corrected) -> tuple[_Lines, ...]:
    match surface.correction:
        case RadialCorrection(rho=rho):
            x = _finer(rho)
            return (_Lines(np.stack((x, np.zeros_like(x)), axis=1)[None], 0),)
        case HeightField(x=x, y=y):
            along_x = np.stack(np.meshgrid(_finer(x), y), axis=2)
            along_y = np.stack(np.meshgrid(x, _finer(y), indexing="ij"), axis=2)
            return _Lines(along_x, 0), _Lines(along_y, 1)
    return ()


def _finer(points: Floats) -> Floats:
    """The points with others between them."""
    numbers = np.linspace(0, len(points) - 1, FINER * (len(points) - 1) + 1)
    return np.interp(numbers, np.arange(len(points)), points)


def _steep(surface: Corrected, lines: tuple[_Lines, ...]) -> Problem | None:
    xy = _all(lines)
    slope = np.linalg.norm(surface.correction.gradient(xy), axis=1)
    worst = int(np.argmax(slope))
    if slope[worst] <= STEEPEST:
        return None
    return Problem(
        f"the correction rises by {slope[worst]:.3g} mm per mm {_at(surface, xy[worst])}, steeper than 45 degrees",
        where=WHERE,
        hint="are its heights in mm? what is so steep belongs in the profile",
    )


def _deep(surface: Corrected, lines: tuple[_Lines, ...]) -> Problem | None:
    xy = _all(lines)
    height = surface.height(xy)
    worst = int(np.argmin(height))
    if height[worst] >= -DEEPEST * surface.height_at_axis:
        return None
    return Problem(
        f"the correction takes the punch {-height[worst]:.3g} mm below its flange {_at(surface, xy[worst])}",
        where=WHERE,
        hint="heights count upwards and are added to the profile; is a sign wrong?",
    )


def _on_flange(surface: Corrected, lines: tuple[_Lines, ...]) -> Problem | None:
    xy = _all(lines)
    size = np.where(np.hypot(*xy.T) > surface.rim_radius, np.abs(surface.correction.value(xy)), 0.0)
    worst = int(np.argmax(size))
    if size[worst] <= FLANGE:
        return None
    return Problem(
        f"the correction changes the flange by {size[worst]:.3g} mm {_at(surface, xy[worst])}, beyond the rim at "
        f"{surface.rim_radius:g} mm",
        where=WHERE,
        hint="let it die out before the fillet, unless the flange is to be machined too",
    )


def _sharpest(
    surface: Corrected, bent: list[tuple[_Lines, Bends]], step: float, radius: float, how: str
) -> Problem | None:
    """The sharpest of the bends below a radius that the correction adds; None without any."""
    found: list[tuple[float, float, Floats]] = []
    for some, bends in bent:
        sharp: Bools = bends.radius < radius
        if not sharp.any():
            continue
        added = sharp & (bends.radius < NOTICED * _bends(some, surface.base).radius)
        middle = 0.5 * (some.xy[:, 1:] + some.xy[:, :-1])
        # A straight piece between two lines, so that no bend runs on from the one into the other.
        places = np.concatenate((middle, middle[:, -1:]), axis=1).reshape(-1, 2)
        for run in runs(added, bends):
            worst = run.start + int(np.argmin(bends.radius[run]))
            found.append((float(bends.radius[worst]), abs(float(bends.turned[run].sum())), places[worst]))
    if not found:
        return None
    least, turned, place = min(found, key=lambda bend: bend[0])
    return Problem(
        f"the correction bends the punch with a radius of {least:.4g} mm by {np.degrees(turned):.3g} degrees "
        f"{_at(surface, place)}, {how} the grid step of {step:g} mm",
        where=WHERE,
        hint=f"smooth the correction until its bends have a radius of at least {2 * step:g} mm, or take a finer grid",
    )


def _bends(lines: _Lines, surface: Surface) -> Bends:
    """The bends of the surface along lines, one after the other, in their upright planes."""
    shape = lines.xy.shape[:2]
    xy = lines.xy.reshape(-1, 2)
    z = surface.height(xy)
    normals = surface.distance_gradient(np.column_stack((xy, z)))[1]
    angle = np.arctan2(normals[:, lines.axis], normals[:, 2]).reshape(shape)
    places, heights = lines.xy[:, :, lines.axis], z.reshape(shape)
    length = np.hypot(np.diff(places, axis=1), np.diff(heights, axis=1))
    turned = np.diff(angle, axis=1)
    with np.errstate(divide="ignore"):
        radius = length / np.abs(turned)
    straight = np.full((shape[0], 1), np.inf), np.zeros((shape[0], 1))
    flat_radius, flat_turned = (np.hstack((a, b)).ravel() for a, b in zip((radius, turned), straight, strict=True))
    far = np.hypot(*lines.xy[:, : shape[1]].reshape(-1, 2).T)
    return Bends(far, flat_radius, flat_turned, np.zeros(flat_turned.size, dtype=np.int64))


def _all(lines: tuple[_Lines, ...]) -> Floats:
    return np.concatenate([some.xy.reshape(-1, 2) for some in lines])


def _at(surface: Corrected, xy: Floats) -> str:
    if isinstance(surface.correction, RadialCorrection):
        return f"at rho = {xy[0]:.4g} mm"
    return f"at x = {xy[0]:.4g} mm, y = {xy[1]:.4g} mm"
