"""The inextensible net alone: positions, shear, flat pattern and wire lengths without a solve, Eq. (6.5)."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.case import Case
from punchform.drawing import drawing_room
from punchform.errors import InputError, Problem
from punchform.grid import Grid
from punchform.mechanics.frames import State
from punchform.net import (
    Net,
    NetStart,
    frames,
    interpolated,
    kernels_are_compiled,
    lay_net,
    length_within,
    outline,
    touching,
)
from punchform.prepare import prepare
from punchform.progress import Observer, Progress, silent
from punchform.punch import Surface
from punchform.whole import Whole, unfold

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DIRECTIONS = 360


@dataclass(frozen=True)
class RimLine:
    """The flat outline that lands on the rim.

    directions (d,) [rad] to x on the flat blank; flat (d, 2): its points there [mm]; positions (d, 3): where they
    lie on the punch [mm]. Rows are NaN where the blank, or the net, ends before the rim.
    """

    directions: Floats
    flat: Floats
    positions: Floats

    @property
    def radius(self) -> Floats:
        """Distance of the flat points from the axis, (d,) [mm]."""
        return np.asarray(np.hypot(*self.flat.T))


@dataclass(frozen=True)
class Wires:
    """Every wire of the grid: family (W,) 1 | 2; number (W,): its j or i; offset (W,): its flat distance from the
    axis [mm]; pieces (W,): edges between crossings; length (W,): their sum [mm]; inside (W,): what of it lies
    within the rim [mm], NaN where the net does not reach all of the wire.
    """

    family: Ints
    number: Ints
    offset: Floats
    pieces: Ints
    length: Floats
    inside: Floats


@dataclass(frozen=True)
class Draped:
    """The whole grid of the net on its surface; what stands for `Formed` where only positions are shown.

    In `whole` positions, normals and tangents of nodes that the net does not reach are NaN, and so is everything
    that only a solve knows: D, F, energy, contact, stress. hardening: none, since nothing yields in a net.
    """

    whole: Whole
    surface: Surface
    hardening: None = None


@dataclass(frozen=True)
class Drape:
    """A case and its inextensible net; `net` and `grid` are of the part that was laid, `formed` is the whole.

    origin (x, y) [mm]: where the axis of the grid lies on the punch; direction [rad] of the first wires there.
    """

    case: Case
    origin: tuple[float, float]
    direction: float
    grid: Grid
    net: Net
    formed: Draped
    rim: RimLine
    wires: Wires
    notes: tuple[str, ...]
    seconds: dict[str, float]

    @property
    def draw_in(self) -> float:
        """How far the wire ends move towards the axis of the grid at most, in plan [mm]."""
        ends = self.grid.wire_ends.any(axis=(1, 2)) & self.net.reached
        flat = np.linalg.norm(self.grid.flat[ends], axis=1)
        return float((flat - np.linalg.norm(self.net.positions[ends, :2] - self.origin, axis=1)).max(initial=0.0))

    def plot(self) -> Figure:
        """A figure of the net on its surface, seen from the side and above."""
        figure: Figure = drawing_room().plot_drape(self)
        return figure

    def _repr_html_(self) -> str:
        shown: str = drawing_room().html_of_drape(self)
        return shown


def drape(
    case: Case,
    *,
    origin: tuple[float, float] | None = None,
    direction: float = 0.0,
    shear_limit: float | None = None,
    observe: Observer = silent,
) -> Drape:
    """Lay the grid of a case on its punch with wires of constant length.

    origin (x, y) [mm] and direction [rad] of the first wire in plan: on the axis and along x when not given.
    shear_limit [rad]: where the net locks; when not given, where neighbouring wires touch.
    Raises InputError when the case cannot be draped, for an origin that is not within the rim, and for a limit that
    is not between 0 and a right angle. A net that locks or ends is an answer: see its notes.
    """
    begun = perf_counter()
    _refuse(case.tool.rim_radius, origin, shear_limit)
    straight = origin is None and direction == 0.0
    if not kernels_are_compiled(geodesics=not straight):
        observe(Progress("drape", message="compiling the kernels; only the first run does this"))
    ready = prepare(_crossings_only(case if straight else _whole_grid(case)))
    grid, punch = ready.grid, ready.punch
    laid = perf_counter()
    net = lay_net(grid, punch, shear_limit=_limit(case, shear_limit), origin=origin, direction=direction)
    netted = perf_counter()
    whole = _whole(grid, frames(grid, punch, net))
    level = np.hypot(whole.positions[:, 0], whole.positions[:, 1]) - punch.rim_radius
    rim = _rim_line(whole, level)
    done = perf_counter()
    return Drape(
        case=case,
        origin=origin or (0.0, 0.0),
        direction=direction,
        grid=grid,
        net=net,
        formed=Draped(whole, punch),
        rim=rim,
        wires=_wires(whole, level, case.grid.step),
        notes=(*(doubt.message for doubt in ready.doubts), *grid.notes, *net.notes, *_rim_notes(rim, origin)),
        seconds={"grid": laid - begun, "net": netted - laid, "pattern": done - netted, "total": done - begun},
    )


def placed(formed: Draped) -> Draped:
    """The part of the whole grid that the net reaches: what can be drawn."""
    whole = formed.whole
    nodes = np.isfinite(whole.positions[:, 0])
    if nodes.all():
        return formed
    number = np.where(nodes, np.cumsum(nodes) - 1, -1)
    pieces = nodes[whole.start] & nodes[whole.end]
    cells = nodes[whole.cells].all(axis=1)
    renumbered = {"start": number[whole.start][pieces], "end": number[whole.end][pieces], "cells": number[whole.cells]}
    per_node = {"index", "between", "flat", "positions", "normals", "tangents", "contact"}
    kept = {}
    for name in (field.name for field in fields(whole)):
        values = renumbered.get(name, getattr(whole, name))
        rows = nodes if name in per_node else cells if name.startswith("cell") else pieces
        kept[name] = values if name in ("start", "end") else values[rows]
    return Draped(Whole(**kept), formed.surface)


def _refuse(rim_radius: float, origin: tuple[float, float] | None, shear_limit: float | None) -> None:
    """Raise InputError with all that is wrong with what is given beside the case."""
    problems = []
    if origin is not None and not math.hypot(*origin) < rim_radius:
        problems.append(
            Problem(
                f"{math.hypot(*origin):g} mm from the axis, but the rim of the punch is at {rim_radius:g} mm",
                "origin",
                "choose a point of the punch within its rim",
            )
        )
    if shear_limit is not None and not 0.0 < shear_limit < 0.5 * math.pi:
        problems.append(
            Problem(
                f"a limit of {math.degrees(shear_limit):.6g} deg: a cell is closed at 90 deg and not sheared at 0 deg",
                "shear_limit",
                "choose a limit in between, or leave it out for the one at which neighbouring wires touch",
            )
        )
    if problems:
        raise InputError(problems)


def _whole_grid(case: Case) -> Case:
    """The case without its mirror planes."""
    return case.model_copy(update={"grid": case.grid.model_copy(update={"symmetry": "full"})})


def _crossings_only(case: Case) -> Case:
    """The case without nodes between crossings: the net has straight edges."""
    return case.model_copy(update={"grid": case.grid.model_copy(update={"subdivide": 1})})


def _limit(case: Case, shear_limit: float | None) -> float:
    if shear_limit is not None:
        return shear_limit
    return touching(case.wire.diameter, case.grid.step)


def _whole(grid: Grid, start: NetStart) -> Whole:
    """The whole grid with NaN for all that is not known of it."""
    modes = np.full((grid.elements, 6), np.nan)
    return unfold(
        grid,
        State(start.positions, start.normals, start.tangents),
        D=modes,
        F=modes,
        energy=modes[:, 0],
        contact=np.full(grid.nodes, np.nan),
        stress=modes[:, 0],
        axial_strain=modes[:, 0],
        stretch=modes[:, 0],
        plastic_strain=modes[:, 0],
        yield_strength=None,
    )


def _rim_line(whole: Whole, level: Floats) -> RimLine:
    directions: Floats = np.linspace(0.0, 2.0 * math.pi, DIRECTIONS, endpoint=False)
    flat = outline(whole.index, whole.flat[:, :2], level, directions)
    return RimLine(directions, flat, interpolated(whole.index, whole.flat[:, :2], whole.positions, flat))


def _rim_notes(rim: RimLine, origin: tuple[float, float] | None) -> tuple[str, ...]:
    missing = int(np.isnan(rim.radius).sum())
    if not missing:
        return ()
    return (
        f"in {missing} of {len(rim.directions)} directions the blank or the net ends before the rim, so the outline "
        "that lands on the rim is not known there; make the blank larger"
        + (", or put the origin nearer to the axis" if origin else ""),
    )


def _wires(whole: Whole, level: Floats, step: tuple[float, float]) -> Wires:
    across = 2 - whole.family
    number, offset = whole.index[whole.start, across], whole.flat[whole.start, across]
    # One number for every wire: first all of the first family, then all of the second.
    low = number.min()
    count = number.max() - low + 1
    wire = (whole.family - 1) * count + number - low
    there, first = np.unique(wire, return_index=True)
    length = np.asarray(step)[whole.family - 1]
    inside = length_within(whole.start, whole.end, level, length)
    return Wires(
        family=whole.family[first],
        number=number[first],
        offset=offset[first],
        pieces=np.bincount(wire)[there],
        length=np.bincount(wire, length)[there],
        inside=np.bincount(wire, inside)[there],
    )
