"""A punch as a solid of the OCCT kernel: exact lines and arcs, B-splines where it has none, and how near they are."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from punchform.arrays import Floats
from punchform.export.occt import arc_edge, bspline_edge, bspline_surface, line_edge, sewn_solid, turned_solid
from punchform.punch import Corrected, Tool, is_turned
from punchform.punch.feet import Segment
from punchform.punch.segments import Arc, Line

NEAR = 1e-4
"""How near B-splines of a meridian come to it [mm]."""
NEAR_FIELD = 5e-3
"""How near the B-splines of a punch that is not turned come to it [mm], if so many poles are enough:"""
MOST_ALONG, MOST_AROUND = 1025, 512
COARSE_ALONG, COARSE_AROUND = 17, 64
BETWEEN = 4
"""Places between two points of a line at which the surface is compared with the punch."""


def punch_solid(tool: Tool, *, radius: float, plate: float) -> tuple[Any, float]:
    """The solid under a punch out to `radius`, with a flat bottom at z = -plate, and by how much its surface misses the
    punch at most [mm], as measured between the points that its B-splines go through."""
    return _turned(tool, radius, plate) if is_turned(tool) else _patched(tool, radius, plate)


def _turned(tool: Tool, radius: float, plate: float) -> tuple[Any, float]:
    edges, worst = [], 0.0
    for segment in _segments(tool, radius):
        edge, missed = _edge(tool, segment, radius)
        edges.append(edge)
        worst = max(worst, missed)
    (top, _), (_, rim) = _ends(tool, radius)
    floor, foot = np.array([0.0, 0.0, -plate]), np.array([radius, 0.0, -plate])
    edges += [line_edge(rim, foot), line_edge(foot, floor), line_edge(floor, top)]
    return turned_solid(edges), worst


def _edge(tool: Tool, segment: Segment, radius: float) -> tuple[Any, float]:
    """The edge along a segment of the meridian, and by how much it misses the punch [mm]."""
    if not isinstance(tool, Corrected):
        start, middle, end = _line(tool, segment, 3, radius)
        if isinstance(segment, Line):
            return line_edge(start, end), 0.0
        if isinstance(segment, Arc):
            return arc_edge(start, middle, end), 0.0
    count = COARSE_ALONG
    while True:
        spline = _spline(_line(tool, segment, count, radius))
        missed = float(np.abs(tool.distance(spline(np.linspace(0.0, 1.0, BETWEEN * count)))).max())
        if missed <= NEAR or count >= MOST_ALONG:
            return bspline_edge(spline.c, spline.k, spline.t), missed
        count = 2 * count - 1


def _patched(tool: Tool, radius: float, plate: float) -> tuple[Any, float]:
    """Of a punch that is no surface of revolution: patches around the axis, one for each segment of its meridian."""
    around = COARSE_AROUND
    counts = dict.fromkeys(range(len(_segments(tool, radius))), COARSE_ALONG)
    while True:
        grids = [_rings(tool, segment, counts[n], around, radius) for n, segment in enumerate(_segments(tool, radius))]
        missed = [_missed(tool, grid) for grid in grids]
        along, across = (max(part) for part in zip(*missed, strict=True))
        if across > NEAR_FIELD and across >= along and around < MOST_AROUND:
            around *= 2
        elif along > NEAR_FIELD and min(counts[n] for n, one in enumerate(missed) if one[0] > NEAR_FIELD) < MOST_ALONG:
            counts = {n: 2 * c - 1 if missed[n][0] > NEAR_FIELD else c for n, c in counts.items()}
        else:
            break
    edge = grids[-1][-1]
    floor = edge * (1.0, 1.0, 0.0) - (0.0, 0.0, plate)
    skirt, bottom = np.stack((edge, floor)), np.stack((floor, np.broadcast_to((0.0, 0.0, -plate), floor.shape)))
    patches = (bspline_surface(*_patch(grid)) for grid in (*grids, skirt, bottom))
    return sewn_solid(patches), max(along, across)


def _missed(tool: Tool, grid: Floats) -> tuple[float, float]:
    """By how much the B-spline through rings (m, n, 3) misses the punch [mm]: between rings, and around them."""
    from scipy.interpolate import NdBSpline

    poles, degrees, knots = _patch(grid)
    spline = NdBSpline(knots, poles, degrees)
    m, n = grid.shape[:2]
    fine, half = np.linspace(0.0, 1.0, BETWEEN * (m - 1) + 1), (np.arange(n - 1) + 0.5) / (n - 1)
    at_rings = np.linspace(0.0, 1.0, m)

    def worst(u: Floats, v: Floats) -> float:
        points = spline(np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)).reshape(-1, 3)
        return float(np.abs(tool.distance(points)).max())

    return worst(fine, np.linspace(0.0, 1.0, n)[::4]), worst(at_rings, half)


def _patch(grid: Floats) -> tuple[Floats, tuple[int, int], tuple[Floats, Floats]]:
    """Poles, degrees and knots of the B-spline through rings (m, n, 3), whose last column is the first again: cubic,
    smooth across that seam, between two rings straight."""
    from scipy.interpolate import CubicSpline, make_interp_spline

    turn = np.linspace(0.0, 1.0, grid.shape[1])
    slope = CubicSpline(turn, grid, axis=1, bc_type="periodic")(0.0, 1)
    # The periodic cubic with its ends clamped: the same curve.
    ring = make_interp_spline(turn, grid, k=3, axis=1, bc_type=([(1, slope)], [(1, slope)]))
    poles = np.moveaxis(ring.c, 0, 1)
    degree = min(3, len(grid) - 1)
    along = make_interp_spline(np.linspace(0.0, 1.0, len(grid)), poles, k=degree, axis=0)
    return along.c, (degree, 3), (along.t, ring.t)


def _rings(tool: Tool, segment: Segment, count: int, around: int, radius: float) -> Floats:
    """Points (count, around + 1, 3) of a segment turned about the axis, closed."""
    angle = 2 * math.pi * (np.arange(around + 1) % around) / around
    feet = segment.trace(count, radius)
    points = np.empty((count, around + 1, 3))
    points[:, :, :2] = feet.rho[:, None, None] * np.column_stack((np.cos(angle), np.sin(angle)))
    points[:, :, 2] = feet.z[:, None]
    if isinstance(tool, Corrected):
        points[:, :, 2] += tool.correction.value(points[:, :, :2].reshape(-1, 2)).reshape(points.shape[:2])
    return points


def _segments(tool: Tool, radius: float) -> tuple[Segment, ...]:
    base = tool.base if isinstance(tool, Corrected) else tool
    return tuple(segment for segment in base.chain.segments if segment.span[0] < radius)


def _line(tool: Tool, segment: Segment, count: int, radius: float) -> Floats:
    """Points (count, 3) along a segment in the plane y = 0."""
    return _rings(tool, segment, count, 1, radius)[:, 0]


def _ends(tool: Tool, radius: float) -> Iterator[tuple[Floats, Floats]]:
    """Both ends of the first and of the last segment."""
    shown = _segments(tool, radius)
    for segment in (shown[0], shown[-1]):
        line = _line(tool, segment, 3, radius)
        yield line[0], line[-1]


def _spline(points: Floats) -> Any:
    """The cubic B-spline through points (n, 3), over 0 to 1."""
    from scipy.interpolate import make_interp_spline

    return make_interp_spline(np.linspace(0.0, 1.0, len(points)), points, k=3, axis=0)
