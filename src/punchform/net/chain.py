"""The meridian of a surface of revolution as tables that a kernel can read.

Each segment becomes an implicit curve F(rho, z) = 0, F > 0 on the grid's side, which costs no iteration:

    line    F = (rho - rho_0) n_rho + (z - z_0) n_z
    conic   F = ±((rho - rho_c)²/a² + (z - z_c)²/b² - 1)/2      arcs, ellipses
    graph   F = z - lift - f(rho)                               f in polynomial pieces

Parabolas, polynomials and splines are polynomial pieces already; an expression is cut into pieces until these
agree with it to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.net.pieces import Piece, pieces
from punchform.punch import Revolution, Surface
from punchform.punch.curves import EllipseArc, Graph
from punchform.punch.feet import Segment
from punchform.punch.segments import Arc, Line

LINE, CONIC, GRAPH = 0, 1, 2
AT_AXIS = 1e-9


class Chain(NamedTuple):
    """A meridian for the kernels.

    kinds (k,); sizes (k, 5): the numbers of each segment, in the order of its formula above (a graph: lift, first
    and last piece); joints (k - 1, 4): rho, z of the end of each segment and the direction (rho, z) in which the
    next one begins.
    Pieces: lows, highs (p,) in rho; origins, scales (p,) of the local variable (rho - origin) scale;
    coefficients (p, degree + 1), highest power first.
    """

    kinds: Ints
    sizes: Floats
    joints: Floats
    lows: Floats
    highs: Floats
    origins: Floats
    scales: Floats
    coefficients: Floats


def chain(surface: Surface) -> Chain | None:
    """The tables of a surface of revolution; None for any other surface and for what has no such tables."""
    if type(surface) is not Revolution:
        return None
    segments = _endless(surface.chain.segments)
    rows = _Rows()
    if not all(rows.add(segment) for segment in segments):
        return None
    return Chain(
        np.array(rows.kinds, dtype=np.int64),
        np.array(rows.sizes),
        np.array([_joint(a, b) for a, b in pairwise(segments)]).reshape(-1, 4),
        *_columns(rows.pieces),
    )


@dataclass
class _Rows:
    kinds: list[int] = field(default_factory=list)
    sizes: list[tuple[float, ...]] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)

    def add(self, segment: Segment) -> bool:
        """Append the rows of a segment; False when it has none."""
        match segment:
            case Line(start=(rho, z), direction=(along, up)):
                return self._append(LINE, (rho, z, -up, along, 0.0))
            case Arc(centre=(rho, z), radius=radius, side=side):
                return self._append(CONIC, (rho, z, radius, radius, side))
            case EllipseArc(radius=a, half_height=b, centre=z):
                return self._append(CONIC, (0.0, z, a, b, 1.0))
            case Graph(function=function, end=end, lift=lift, knots=knots):
                found = pieces(function, end, knots)
                if found is None:
                    return False
                first = len(self.pieces)
                self.pieces += found
                return self._append(GRAPH, (lift, first, len(self.pieces) - 1, 0.0, 0.0))
        return False

    def _append(self, kind: int, sizes: tuple[float, ...]) -> bool:
        self.kinds.append(kind)
        self.sizes.append(sizes)
        return True


def _endless(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    """The segments with the straight continuation that a surface without a flange has beyond its end."""
    last = segments[-1]
    if isinstance(last, Line):
        return (*segments[:-1], Line(last.start, last.direction, np.inf))
    rho, z, n_rho, n_z = _end(last)
    if rho <= AT_AXIS * abs(z):
        return segments
    return (*segments, Line((rho, z), (n_z, -n_rho), np.inf))


def _end(segment: Segment) -> tuple[float, float, float, float]:
    """End of a segment (rho, z) and the normal there."""
    feet = segment.trace(2, np.inf)
    return float(feet.rho[-1]), float(feet.z[-1]), float(feet.normal_rho[-1]), float(feet.normal_z[-1])


def _joint(before: Segment, after: Segment) -> tuple[float, float, float, float]:
    """Where the next segment begins: beyond the normal at the joint, or beyond its rho next to a graph.

    The normal tells arcs and walls apart, but could cut off a far part of a graph that is wavy.
    """
    rho, z, n_rho, n_z = _end(before)
    if isinstance(before, Graph) or isinstance(after, Graph):
        return rho, z, 1.0, 0.0
    return rho, z, n_z, -n_rho


def _columns(found: list[Piece]) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    degree = max((len(piece.coefficients) for piece in found), default=1)
    coefficients = np.zeros((len(found), degree))
    for row, piece in zip(coefficients, found, strict=True):
        row[degree - len(piece.coefficients) :] = piece.coefficients
    lows, highs, origins, scales = (
        np.array([getattr(piece, name) for piece in found], dtype=np.float64)
        for name in ("low", "high", "origin", "scale")
    )
    return lows, highs, origins, scales, coefficients
