"""`punchform drape`: the inextensible net of a case, without a solve."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from punchform.case import parse, read_text, write_case
from punchform.case.parts import Quantity
from punchform.cli.exits import Exit
from punchform.cli.talk import WRITING, Talk, notes
from punchform.cli.voice import Voice
from punchform.drape import Drape, drape
from punchform.errors import InputError
from punchform.export.drape import LENGTHS, OUTLINE, drape_json, reached_nodes, write_drape_tables
from punchform.export.vtp import SHAPE
from punchform.report.drape import write_drape_report
from punchform.store import CASE, NODES, RESULT, check_folder, write_folder
from punchform.units import ANGLE, LENGTH, UnitError, quantity

ANGLES = {
    "direction": (Quantity(ANGLE, least=-2.0 * math.pi, most=2.0 * math.pi), "such as '30 deg'"),
    "shear_limit": (Quantity(ANGLE, above=0.0, below=0.5 * math.pi), "left out, it is where neighbouring wires touch"),
}
"""Limits of the angles, and advice: a direction of more than a turn is most likely in degrees without their unit."""


def drape_case(
    path: str,
    output: str,
    *,
    overwrite: bool,
    voice: Voice,
    as_json: bool,
    origin: str | None = None,
    direction: str | None = None,
    shear_limit: str | None = None,
) -> Exit:
    """Lay the net of a case and write its folder; OUT_OF_TOLERANCE when it locks or ends before the blank does.

    origin ("x, y"), direction and shear_limit are quantities as in a case file. Raises InputError for a case,
    folder or quantity that cannot be used.
    """
    source = read_text(path)
    case = parse(source)
    check_folder(output, overwrite=overwrite)
    start, angle, limit = _origin(origin), _angle(direction, "direction"), _angle(shear_limit, "shear_limit")
    with Talk(voice) as talk:
        try:
            done = drape(case, origin=start, direction=angle or 0.0, shear_limit=limit, observe=talk)
        except InputError as error:
            given = {"origin": origin, "shear_limit": shear_limit}
            raise source.placed(_as_typed(error, given)) from None
        talk.begin(WRITING)
        folder = write_drape(done, output, overwrite=overwrite)
    notes(done.notes, voice)
    print((folder / RESULT).read_text(encoding="utf-8").rstrip() if as_json else summary(done, folder))
    return Exit.DONE if done.net.complete and not done.net.locked.any() else Exit.OUT_OF_TOLERANCE


def summary(done: Drape, folder: Path) -> str:
    """What a person wants to know first about a net, in a few lines."""
    net, rim = done.net, done.rim.radius
    known = rim[np.isfinite(rim)]
    facts = {
        "grid": f"{len(done.formed.whole.index)} crossings, {reached_nodes(done)} of them reached",
        "effort": f"{done.seconds['total']:.2f} s",
        "largest shear": f"{math.degrees(net.max_shear):.4g} deg (locks at {math.degrees(net.limit):.4g} deg)",
        "draw-in": f"{done.draw_in:.4g} mm",
        "outline": f"{known.min():.6g} to {known.max():.6g} mm from the axis lands on the rim" if known.size else "-",
        "wire": f"{done.wires.length.sum() / 1000:.6g} m in {len(done.wires.length)} wires",
        "report": str(folder / "report.html"),
    }
    width = max(map(len, facts))
    return "\n".join([done.case.title, *(f"  {name:<{width}}  {fact}" for name, fact in facts.items())])


def write_drape(done: Drape, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write the folder of a net and return its path; see `write_folder` for what it raises.

    case.toml, result.json, nodes.csv, outline.csv, wire_lengths.csv, shape.vtp, figures and report.html.
    """

    def write(folder: Path) -> None:
        (folder / CASE).write_text(write_case(done.case), encoding="utf-8", newline="\n")
        (folder / RESULT).write_text(drape_json(done), encoding="utf-8", newline="\n")
        write_drape_tables(
            done,
            nodes=folder / NODES,
            shape=folder / SHAPE,
            outline=folder / OUTLINE,
            lengths=folder / LENGTHS,
        )
        write_drape_report(done, folder)

    return write_folder(output, write, overwrite=overwrite)


def _origin(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        x, y = (quantity(part.strip(), LENGTH) for part in text.split(","))
    except (UnitError, ValueError) as problem:
        raise InputError.of(
            "the origin is two lengths with a comma", where=_option("origin", text), hint="such as '10 mm, 0 mm'"
        ) from problem
    return x, y


def _angle(text: str | None, name: str) -> float | None:
    if text is None:
        return None
    angle, advice = ANGLES[name]
    try:
        return angle.read(text)
    except UnitError as problem:
        raise InputError.of(problem.message, where=_option(name, text), hint=problem.hint or advice) from problem


def _as_typed(error: InputError, given: Mapping[str, str | None]) -> InputError:
    """The same error with the options as they were typed, for the names that `drape` gives them."""
    return InputError(
        replace(problem, where=_option(problem.where, given[problem.where])) if problem.where in given else problem
        for problem in error.problems
    )


def _option(name: str, text: str | None) -> str:
    return f"--{name.replace('_', '-')} {text}"
