"""Read a cloud of measured points: `read_cloud`, whatever the format; all bad rows are told at once."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from punchform.errors import InputError, Problem
from punchform.measured.cloud import Cloud
from punchform.measured.solids import read_ply, read_stl
from punchform.measured.text import Found, read_text_points

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
"""Millimetres in the units that a cloud may have."""
TEXT_FORMATS = (".csv", ".txt", ".xyz", ".asc")
FORMATS = (*TEXT_FORMATS, ".ply", ".stl")
_WORDS = {"millimetre": "mm", "millimeter": "mm", "metre": "m", "meter": "m", "inch": "in", "centimetre": "cm"}
SHOWN = 20
"""So many bad rows are told one by one."""
FEWEST = 4


def read_cloud(path: str | Path, *, unit: str | None = None, skip_bad_rows: bool = False) -> Cloud:
    """The points of a file, in mm.

    unit: one of UNITS, against what the file says or does not say. With `skip_bad_rows` rows that cannot be used are
    left out and counted. Raises InputError for a file that cannot be read, for bad rows (all of them, with their
    lines), and for fewer than four points.
    """
    where = str(path)
    found = _found(Path(os.path.expanduser(path)), where)
    if found.problems and not skip_bad_rows:
        raise InputError(_told(found.problems, where))
    if len(found.points) < FEWEST:
        raise InputError.of(f"holds {len(found.points)} usable points; at least {FEWEST} are needed", where=where)
    said = _known_unit(found.unit, where) if unit is None else None
    chosen = unit or said or "mm"
    factor = UNITS[chosen]
    nodes = np.array([node or (0, 0) for node in found.nodes], dtype=np.int64)
    cloud = Cloud(
        points=factor * np.array(found.points),
        names=found.names,
        nodes=nodes,
        named=np.array([node is not None for node in found.nodes]),
        sigma=_sigma(found, factor),
        lines=np.array(found.lines, dtype=np.int64),
        source=where,
        unit=chosen,
        stated=unit is not None or said is not None,
        notes=found.notes,
    )
    if not found.problems:
        return cloud
    count = len(found.problems)
    places = ", ".join(problem.where.rpartition(":")[2] for problem in found.problems[:SHOWN])
    note = f"{count} bad row{'s' if count > 1 else ''} left out (line {places}{', ...' if count > SHOWN else ''})"
    return replace(cloud, skipped=count, notes=(*cloud.notes, note))


def check_size(cloud: Cloud, reach: float) -> tuple[str, ...]:
    """Notes on a cloud whose size does not fit that of the run, `reach` [mm]: rms distance from the middle.

    Raises InputError when the unit is not stated and another one would explain the size.
    """
    size = math.sqrt(float(((cloud.points - np.median(cloud.points, axis=0)) ** 2).sum(axis=1).mean()))
    ratio = size / reach
    if 1 / 3 < ratio < 3:
        return ()
    told = f"the cloud is {_times(ratio)} the run, read in {cloud.unit}"
    fits = {unit: abs(math.log(max(ratio, 1e-300) * factor / UNITS[cloud.unit])) for unit, factor in UNITS.items()}
    best = min(fits, key=lambda unit: fits[unit])
    if cloud.stated or best == cloud.unit or fits[best] > math.log(3):
        return (f"{told}: does it cover only a part of it, or is it of another one?",)
    raise InputError.of(
        f"{told}; in {best} it would fit",
        where=cloud.source,
        hint=f"say which it is: --units {best}, or --units {cloud.unit} if it is right as it stands",
    )


def _found(path: Path, where: str) -> Found:
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise InputError.of(
            f"the name of a file of points ends in {', '.join(FORMATS)}", where=where, hint="save it as CSV: id,x,y,z"
        )
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise InputError.of(f"cannot be read: {problem.strerror}", where=where) from problem
    if kind == ".ply":
        return read_ply(content, where=where)
    if kind == ".stl":
        return read_stl(content, where=where)
    if b"\0" in content[:4096]:
        raise InputError.of("holds binary data, not text", where=where)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return read_text_points(text, where=where)


def _told(problems: tuple[Problem, ...], where: str) -> tuple[Problem, ...]:
    hint = "mend them, or leave them out with --skip-bad-rows"
    shown = problems[:SHOWN]
    rest = len(problems) - len(shown)
    if rest:
        return (*shown, Problem(f"and {rest} more bad rows", where, hint))
    return (*shown[:-1], replace(shown[-1], hint=hint))


def _known_unit(written: str | None, where: str) -> str | None:
    if written is None:
        return None
    unit = next((short for word, short in _WORDS.items() if written in (word, word + "s", word + "es")), written)
    if unit not in UNITS:
        raise InputError.of(
            f"states the unit {written!r}; known are {', '.join(UNITS)}", where=where, hint="state it with --units"
        )
    return unit


def _sigma(found: Found, factor: float) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
    """Uncertainties [mm]; a point without one takes the median of the others."""
    if found.sigma is None:
        return None
    sigma = factor * np.array(found.sigma)
    known = np.isfinite(sigma)
    if not known.any():
        return None
    return np.where(known, sigma, np.median(sigma[known]))


def _times(ratio: float) -> str:
    if ratio < 1:
        return f"{1 / max(ratio, 1e-300):.3g} times smaller than"
    return f"{ratio:.3g} times larger than"
