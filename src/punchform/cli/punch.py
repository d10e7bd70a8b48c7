"""`punchform punch`: the punch of a case as files for the workshop."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from punchform import __version__
from punchform.case import Case, parse, read_text, write_case
from punchform.case.parts import Quantity
from punchform.cli.exits import Exit
from punchform.cli.talk import notes
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.punch_files import EDGE, TOLERANCE, write_punch
from punchform.export.result import RESULT_SCHEMA
from punchform.prepare import prepare
from punchform.punch import Corrected, Tool
from punchform.store import CASE, RESULT, check_folder, write_folder
from punchform.units import LENGTH, UnitError

MOST_POINTS = 4_000_000
"""Points of a height field: a file of some hundred megabytes."""
SIZE = Quantity(LENGTH, above=0.0, least=1e-6, most=1e9)


def punch_case(
    path: str,
    output: str,
    *,
    overwrite: bool,
    voice: Voice,
    as_json: bool,
    radius: str | None = None,
    step: str | None = None,
    tolerance: str | None = None,
) -> Exit:
    """Write the files of the punch of a case; radius, step and tolerance are lengths as in a case file.

    Raises InputError for a case, folder or length that cannot be used.
    """
    source = read_text(path)
    case = parse(source)
    check_folder(output, overwrite=overwrite)
    out, every, within = _size(radius, "radius"), _size(step, "step"), _size(tolerance, "tolerance")
    try:
        ready = prepare(case)
    except InputError as error:
        raise source.placed(error) from None
    out = EDGE * ready.punch.rim_radius if out is None else out
    if every is not None and (2 * out / every) ** 2 > MOST_POINTS:
        raise InputError.of(
            f"the height field would have more than {MOST_POINTS} points",
            where=f"--step {step}",
            hint=f"take {2 * out / MOST_POINTS**0.5:.1g} mm or more, or a smaller --radius",
        )
    told = _told(ready.punch, out)

    def write(folder: Path) -> None:
        files = write_punch(folder, ready.punch, radius=out, step=every, tolerance=within or TOLERANCE)
        (folder / CASE).write_text(write_case(case), encoding="utf-8", newline="\n")
        content = {
            "schema": RESULT_SCHEMA,
            "version": __version__,
            "case_title": case.title,
            "punch": told,
            "files": [file.name for file in files],
            "notes": [doubt.message for doubt in ready.doubts],
        }
        text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
        (folder / RESULT).write_text(text, encoding="utf-8", newline="\n")

    folder = write_folder(output, write, overwrite=overwrite)
    notes((f"{doubt.where}: {doubt.message}" for doubt in ready.doubts), voice)
    print((folder / RESULT).read_text(encoding="utf-8").rstrip() if as_json else _summary(case, told, folder))
    return Exit.DONE


def _told(punch: Tool, radius: float) -> dict[str, float | None]:
    """What a person wants to know of a punch [mm]."""
    added = punch.correction if isinstance(punch, Corrected) else None
    top = float(punch.height(np.zeros((1, 2)))[0])
    return {
        "rim_radius_mm": punch.rim_radius,
        "height_on_axis_mm": top,
        "height_of_profile_mm": punch.height_at_axis,
        "largest_correction_mm": None if added is None else added.largest,
        "radius_of_files_mm": radius,
    }


def _summary(case: Case, told: dict[str, float | None], folder: Path) -> str:
    largest = told["largest_correction_mm"]
    facts = {
        "rim": f"{told['rim_radius_mm']:.6g} mm from the axis; the files reach to {told['radius_of_files_mm']:.6g} mm",
        "height": f"{told['height_on_axis_mm']:.6g} mm on the axis",
        "correction": "none" if largest is None else f"at most {largest:.4g} mm",
        "files": str(folder),
    }
    width = max(map(len, facts))
    return "\n".join([case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])


def _size(text: str | None, name: str) -> float | None:
    if text is None:
        return None
    try:
        return SIZE.read(text)
    except UnitError as problem:
        raise InputError.of(problem.message, where=f"--{name} {text}", hint=problem.hint) from problem
