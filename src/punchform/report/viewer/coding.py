"""Numbers as few bytes: rounded to whole steps, foretold from their neighbours, split into byte planes, deflated.

Neighbours on a wire differ little from a straight line through the two before them. What is left of a number after
that guess is small, so most of its bytes are nil, and bytes of the same weight lie side by side.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from punchform.arrays import Floats, Ints

FORETELLERS = ("as it is", "as before", "as two before", "straight on")
"""What a number is taken to be from those before it: nothing, the last, the last but one, the line through both."""
LEVEL = 9
LIMIT = 2**31 - 2
_U32 = NDArray[np.uint32]


@dataclass
class Blob:
    """Bytes that grow by arrays; each is found again by what `add` returns."""

    parts: list[bytes] = field(default_factory=list)
    size: int = 0

    def floats(self, values: Floats, step: float) -> dict[str, object]:
        """Put in values (n,) to the nearest whole number of steps, NaN kept, and tell where and how.

        Raises OverflowError when a value is more than two thousand million steps large.
        """
        missing = ~np.isfinite(values)
        # What is missing is taken to be what it was before, which costs nothing; a mask tells that it is not there.
        known = _carried_on(values, missing) if missing.any() else values
        rounded = np.rint(known / step)
        if rounded.size and float(np.abs(rounded).max()) > LIMIT:
            raise OverflowError(f"{np.abs(known).max():.6g} is too large to be told in steps of {step:g}")
        told = self.integers(rounded.astype(np.int64)) | {"step": step}
        if missing.any():
            told["missing"] = self._put(np.packbits(missing, bitorder="little").tobytes())
        return told

    def integers(self, values: Ints) -> dict[str, object]:
        """Put in whole numbers (n,) of at most 31 bits and tell where and how."""
        tried = [_foretold(values, name) for name in FORETELLERS]
        cost = [float(np.log2(1.0 + np.abs(left)).sum()) for left in tried]
        best = int(np.argmin(cost))
        planes = np.ascontiguousarray(_unsigned(tried[best])).view(np.uint8).reshape(-1, 4).T
        used = [number for number in range(4) if planes[number].any()]
        at = self._put(b"".join(planes[number].tobytes() for number in used))
        return {"n": len(values), "at": at, "planes": used, "foretold": best}

    def deflated(self) -> bytes:
        """All that was put in, as a zlib stream."""
        return zlib.compress(b"".join(self.parts), LEVEL)

    def _put(self, new: bytes) -> int:
        at = self.size
        self.parts.append(new)
        self.size += len(new)
        return at


def _carried_on(values: Floats, missing: NDArray[np.bool_]) -> Floats:
    """Values (n,) with the last known one where they are missing, the first known one before that, or 0."""
    known = np.where(missing, -1, np.arange(len(values)))
    last = np.maximum.accumulate(known)
    first = int(np.argmax(~missing)) if not missing.all() else -1
    source = np.where(last < 0, first, last)
    return np.where(source < 0, 0.0, values[source])


def _foretold(values: Ints, how: str) -> Ints:
    """What is left of whole numbers (n,) after the guess."""
    left = values.copy()
    if how == "as before":
        left[1:] -= values[:-1]
    elif how == "as two before":
        left[2:] -= values[:-2]
    elif how == "straight on":
        left[2:] -= 2 * values[1:-1] - values[:-2]
    return left


def _unsigned(left: Ints) -> _U32:
    """Small numbers of either sign as small unsigned ones: 0, -1, 1, -2, ... become 0, 1, 2, 3, ... modulo 2^32."""
    wrapped = left.astype(np.int64).astype(np.uint32).view(np.int32).astype(np.int64)
    return np.asarray(((wrapped << 1) ^ (wrapped >> 31)) & 0xFFFFFFFF, dtype=np.uint32)
