"""A packed scene read back by the description of its format alone, as another program would."""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.report.viewer import Packed


class Unpacked:
    """The header of a packed scene and its arrays."""

    def __init__(self, packed: Packed) -> None:
        self.header: dict[str, Any] = json.loads(packed.text)
        self.blob = zlib.decompress(base64.b64decode(self.header["blob"]))
        assert len(self.blob) == self.header["size"]

    def whole(self, told: dict[str, Any]) -> Ints:
        """Whole numbers: byte planes, signs in the last bit, then what each adds to its neighbours."""
        count, values = told["n"], np.zeros(told["n"], dtype=np.int64)
        for place, plane in enumerate(told["planes"]):
            first = told["at"] + place * count
            values |= np.frombuffer(self.blob, np.uint8, count, first).astype(np.int64) << 8 * plane
        values = np.where(values & 1, -(values + 1) // 2, values // 2)
        how = told["foretold"]
        for k in range(1 if how == 1 else 2, count if how else 0):
            values[k] += (0, values[k - 1], values[k - 2], 2 * values[k - 1] - values[k - 2])[how]
        return values

    def floats(self, told: dict[str, Any]) -> Floats:
        """Numbers with NaN for what is missing."""
        values = self.whole(told) * float(told["step"])
        if "missing" in told:
            mask = np.frombuffer(self.blob, np.uint8, -(-told["n"] // 8), told["missing"])
            values[np.unpackbits(mask, bitorder="little")[: told["n"]] == 1] = np.nan
        return np.asarray(values, dtype=np.float64)

    def points(self, told: list[dict[str, Any]]) -> Floats:
        """Points (n, 3)."""
        return np.column_stack([self.floats(axis) for axis in told])

    def figures(self, pose: int, key: str) -> Floats:
        """The figures of a quantity in a pose."""
        return self.floats(self.header["poses"][pose]["figures"][key])
