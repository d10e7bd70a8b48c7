"""When a best fit with lateral shifts says less than it seems to: Eq. (9.13)."""

from __future__ import annotations

import math

import numpy as np

from punchform.accuracy.deviation import slopes
from punchform.accuracy.fit import Fit, implied_shift
from punchform.accuracy.target import Target
from punchform.arrays import Floats

TAKEN = 0.5
"""The wider fit is looked at when it leaves less than this part of the rms of the narrower one."""
CANCELLED = 3.0
"""A lateral shift is doubted when it alone would do this many times the error that is there."""
ROUNDING = 1e-9
"""Relative to the extent of the points: an rms below this is none."""


def hidden_error(points: Floats, weights: Floats, target: Target, narrow: Fit, wide: Fit) -> str | None:
    """A warning when the lateral shifts of the wide fit hide error that the narrow one shows, else None.

    points (n, 3) [mm], weights (n,); wide has u and v, narrow has not; both of one measure.
    A lateral shift and a tilt change the surface almost alike. Where the fit sets a large shift against a large
    tilt, their small difference imitates an error of shape; where the points really are displaced, the shift
    alone does not do more than the error that is seen, Eq. (9.13).
    """
    if narrow.rms <= ROUNDING * float(np.abs(points).max(initial=0.0)) or wide.rms >= TAKEN * narrow.rms:
        return None
    share = weights / weights.sum()
    root = np.sqrt(share)[:, None]
    value, jacobian = slopes(points, target, target.pose, wide.measure)
    upright = root * jacobian[:, [2, 5] if target.focal_length is not None else [2]]
    seen = root[:, 0] * value
    seen -= upright @ np.linalg.lstsq(upright, seen, rcond=None)[0]
    shifted = root[:, 0] * (jacobian[:, :2] @ wide.pose.shift[:2])
    if float(np.linalg.norm(shifted)) < CANCELLED * float(np.linalg.norm(seen)):
        return None
    moved = float(np.linalg.norm(implied_shift(target, wide.pose)))
    what = "vertex" if target.focal_length is None else "focus"
    return (
        f"the {len(wide.free)}-parameter best fit hides error: it leaves {wide.rms:.3g} mm rms where the "
        f"{len(narrow.free)}-parameter one leaves {narrow.rms:.3g} mm, by moving the vertex "
        f"{math.hypot(wide.pose.u, wide.pose.v):.3g} mm sideways against a tilt of "
        f"{math.degrees(wide.pose.tilt):.3g} deg (condition number {wide.condition:.0f}); the {what} would have to "
        f"follow by {moved:.3g} mm. Judge the {len(narrow.free)}-parameter fit unless the feed is moved there"
    )
