"""The next step of an iteration from what the last ones have shown: Anderson's multisecant step, Eq. (13.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats

MEMORY = 3
"""How many old differences are looked at."""
CAREFUL = 1e-3
"""How little a difference is held back, relative to the size of all of them."""
FURTHEST = 5.0
"""A step may be so many times that without memory."""


@dataclass(frozen=True, eq=False)
class Tried:
    """Numbers (k,) that were tried, and the step (k,) that the error found there asks for."""

    numbers: Floats
    wish: Floats


def next_step(here: Tried, others: Sequence[Tried], metric: Floats, *, relaxation: float = 1.0) -> Floats:
    """The step (k,) from `here`, with what the latest of the others have shown of how the wish changes, Eq. (13.6).

    metric (r, k): numbers times this are the lengths by which steps are compared.
    """
    plain = relaxation * here.wish
    latest = others[-MEMORY:]
    if not latest:
        return np.asarray(plain)
    moves = np.column_stack([here.numbers - other.numbers for other in latest])
    changes = np.column_stack([here.wish - other.wish for other in latest])
    seen = metric @ changes
    careful = CAREFUL * float(np.linalg.norm(seen)) * np.eye(len(latest))
    target = np.concatenate((metric @ here.wish, np.zeros(len(latest))))
    shares = np.linalg.lstsq(np.vstack((seen, careful)), target, rcond=None)[0]
    step = relaxation * (here.wish - changes @ shares) - moves @ shares
    size, most = float(np.linalg.norm(metric @ step)), FURTHEST * float(np.linalg.norm(metric @ here.wish))
    return np.asarray(step if size <= most else most / size * step)
