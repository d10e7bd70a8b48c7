"""Tables of points from CSV files, for centrelines, profiles and flow curves."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

from pydantic import ValidationInfo

from punchform.case.parts import MisfitError

LARGEST_TABLE = 100_000
"""Rows a table may have; more points than this do not describe a smooth curve any better."""


def points_in_place_of_file(values: Any, info: ValidationInfo) -> Any:
    """Replace `file` by the `points` in it, read from the folder in the validation context.

    Raises MisfitError when both or neither are given, or when the file cannot be used.
    """
    if not isinstance(values, dict) or values.get("file") is None:
        return values
    if values.get("points") is not None:
        raise MisfitError("give either `points` or `file`, not both", key=("file",))
    file = values["file"]
    if not isinstance(file, str):
        raise MisfitError("expected the name of a file in quotes", key=("file",))
    folder = (info.context or {}).get("folder", Path())
    return {**{key: value for key, value in values.items() if key != "file"}, "points": _rows(folder / file)}


def _rows(path: Path) -> list[list[float]]:
    rows: list[list[float]] = []
    named = False
    for number, line in enumerate(lines_of(path, key=("file",)), start=1):
        words = [word for word in re.split(r"[,;\s]+", line.split("#")[0].strip()) if word]
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            if not rows and not named:
                named = True
                continue
            raise MisfitError(
                f"line {number} of {path.name} is not a row of numbers: '{line.strip()[:60]}'",
                key=("file",),
                hint="write bare numbers (mm, MPa), separated by commas; the first row may hold names",
            ) from None
        if {",", ";"} <= set(line.split("#")[0]):
            raise MisfitError(
                f"line {number} of {path.name} has semicolons and commas, so its numbers are not sure: "
                f"'{line.strip()[:60]}'",
                key=("file",),
                hint="write decimals with a point, and only one kind of sign between the numbers",
            )
        if not all(math.isfinite(value) for value in row):
            raise MisfitError(f"line {number} of {path.name} has a number that is not finite", key=("file",))
        rows.append(row)
    if not rows:
        raise MisfitError(f"{path.name} holds no rows of numbers", key=("file",))
    if len(rows) > LARGEST_TABLE:
        raise MisfitError(f"{path.name} holds {len(rows)} rows; at most {LARGEST_TABLE} can be used", key=("file",))
    return rows


def lines_of(path: Path, *, key: tuple[str, ...]) -> list[str]:
    """The lines of a file that the case names at `key`. Raises MisfitError when it cannot be read."""
    try:
        return path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise MisfitError(f"{path.name} is not UTF-8 text", key=key) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise MisfitError(
            f"cannot read {path}: {reason}",
            key=key,
            hint="the name is relative to the folder of the case file",
        ) from None
