"""Does the grid fit into the memory of this machine?"""

from __future__ import annotations

import math
import os

from punchform.case.grid import Blank, CircleBlank, GridCase, PolygonBlank, RectangleBlank, WiresBlank

BYTES_PER_NODE = 25_000
"""Memory per solved node, mostly the sparse factors (6 to 7 unknowns per node)."""

ASSUMED_MEMORY = 8 * 2**30
"""What a machine is taken to have when it does not say."""


def machine_memory() -> int:
    """Memory of this machine [bytes]; 8 GiB where the system does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return ASSUMED_MEMORY


def solved_nodes(grid: GridCase) -> float:
    """About how many nodes will be solved: area over step, those between crossings; a quarter with mirror planes."""
    crossings = blank_area(grid.blank) / (grid.step[0] * grid.step[1]) / (4.0 if _has_quarter(grid) else 1.0)
    return crossings * (2 * grid.subdivide - 1)


def blank_area(blank: Blank) -> float:
    """Area of the blank, or of the rectangle that single wires span [mm²]."""
    match blank:
        case CircleBlank(radius=radius):
            return math.pi * radius * radius
        case RectangleBlank(size=(width, depth)):
            return width * depth
        case PolygonBlank(points=points):
            following = points[1:] + points[:1]
            pairs = zip(points, following, strict=True)
            return 0.5 * abs(math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairs))
        case WiresBlank():
            (x0, x1), (y0, y1) = _spans(blank)
            return (x1 - x0) * (y1 - y0)


def blank_reach(blank: Blank) -> float:
    """The farthest point of the blank from the axis [mm]."""
    match blank:
        case CircleBlank(radius=radius):
            return radius
        case RectangleBlank(size=(width, depth)):
            return 0.5 * math.hypot(width, depth)
        case PolygonBlank(points=points):
            return max(math.hypot(x, y) for x, y in points)
        case WiresBlank():
            return math.hypot(*(max(map(abs, span)) for span in _spans(blank)))


def _spans(blank: WiresBlank) -> tuple[tuple[float, float], ...]:
    """From where to where the wires of each family reach along themselves [mm]."""
    both = ([wire for wire in blank.wires if wire.family == family] for family in (1, 2))
    return tuple((min(wire.low for wire in own), max(wire.high for wire in own)) for own in both)


def _has_quarter(grid: GridCase) -> bool:
    if grid.symmetry == "full" or grid.centre == "cell":
        return False
    match grid.blank:
        case PolygonBlank(points=points):
            corners = {(round(x, 6), round(y, 6)) for x, y in points}
            return corners == {(-x, y) for x, y in corners} == {(x, -y) for x, y in corners}
        case WiresBlank():
            return False
        case _:
            return True
