"""The meridian of a surface of revolution: a chain of segments with a continuous tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.punch.feet import Feet, Segment


@dataclass(frozen=True)
class Meridian:
    """Segments from the axis outwards, each beginning where the one before ends, with the same tangent."""

    segments: tuple[Segment, ...]

    def foot(self, rho: Floats, z: Floats) -> Feet:
        """Nearest points of the chain to points (rho, z), both (n,), rho >= 0."""
        best = np.full(rho.shape, np.inf)
        found = np.empty((5, rho.size))
        # Closed forms first: they spare most of the iterations on curves that lie further away.
        for segment in sorted(self.segments, key=lambda segment: not segment.closed_form):
            near = np.flatnonzero(~segment.out_of_reach(rho, z, best))
            if near.size == rho.size:
                score, feet = segment.nearest(rho, z)
                better = score < best
            else:
                score, feet = segment.nearest(rho[near], z[near])
                better = score < best[near]
            at = near[better]
            best[at] = score[better]
            for row, values in zip(found, feet, strict=True):
                row[at] = values[better]
        return Feet(*found)

    def height(self, rho: Floats) -> Floats:
        """Height z (n,) over rho (n,); NaN beyond the end of the chain.

        On a vertical wall, where any height between its ends would do, it is that of the segment outside it.
        """
        starts = np.array([segment.span[0] for segment in self.segments])
        number = np.searchsorted(starts, rho, side="right") - 1
        z = np.full(rho.shape, np.nan)
        for k, segment in enumerate(self.segments):
            here = number == k
            if here.any():
                z[here] = segment.height(rho[here])
        last = self.segments[-1].span[1]
        z[rho > last * (1 + 1e-12)] = np.nan
        return z

    def points(self, count: int, radius: float) -> Floats:
        """(count, 2) points (rho, z) on the chain, all joints among them, denser where it bends.

        The chain is cut off at `radius`. Raises ValueError for fewer points than joints.
        """
        shown = [segment for segment in self.segments if segment.span[0] < radius]
        if count < len(shown) + 1:
            raise ValueError(f"a meridian of {len(shown)} segments needs at least {len(shown) + 1} points")
        shares = np.array([_share(segment.trace(65, radius), radius) for segment in shown])
        spare = count - 1 - len(shown)
        ends = np.rint(spare * np.cumsum(shares) / shares.sum()).astype(np.int64)
        counts = 1 + np.diff(ends, prepend=0)
        traces = [segment.trace(int(n) + 1, radius) for segment, n in zip(shown, counts, strict=True)]
        rows = [np.column_stack((feet.rho, feet.z))[:-1] for feet in traces]
        last = traces[-1]
        return np.vstack([*rows, [[last.rho[-1], last.z[-1]]]])


def _share(feet: Feet, radius: float) -> float:
    """Length in units of the radius, plus the angle turned through."""
    length = float(np.hypot(np.diff(feet.rho), np.diff(feet.z)).sum())
    turned = float(np.abs(np.diff(np.arctan2(feet.normal_rho, feet.normal_z))).sum())
    return length / radius + turned
