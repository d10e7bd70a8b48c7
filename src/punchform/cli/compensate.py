"""`punchform compensate`: from a case to the punch whose released shape is its target."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from punchform.case import Case, parse, read_text, write_case
from punchform.cli.exits import Exit
from punchform.cli.lengths import length_above_zero
from punchform.cli.talk import WRITING, Talk, notes
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.punch_files import write_punch
from punchform.optimise.compensated import Compensated, Wish, compensate_case
from punchform.optimise.compensation import Limits
from punchform.optimise.compensation_files import CONVERGENCE, compensation_json, convergence_csv
from punchform.optimise.correction_space import Kind
from punchform.punch import surface as surface_of
from punchform.report.compensate import write_compensation_report
from punchform.report.compensate_words import explained, remedies, solve_rows
from punchform.store import CASE, RESULT, check_folder, write_folder


def compensate_punch(
    path: str,
    output: str,
    *,
    surface: Kind,
    solves: str,
    relaxation: str,
    to: str | None,
    compare: bool,
    response: bool,
    overwrite: bool,
    voice: Voice,
    as_json: bool,
) -> Exit:
    """Compensate the punch of a case and write the folder of the answer.

    Raises InputError for a case, folder or number that cannot be used, NoEquilibrium when the punch as it is cannot be
    pressed.
    """
    at_most, share = _solves(solves), _relaxation(relaxation)
    length = length_above_zero("--to", to, hint="such as --to '0.05 mm'", refusal="an rms to reach is above zero")
    source = read_text(path)
    case = parse(source)
    check_folder(output, overwrite=overwrite)
    tolerance = length if length is not None else (None if case.target is None else case.target.tolerance)
    wish = Wish(surface, Limits(tolerance, at_most, share), compare=compare, response=response)
    with Talk(voice) as talk:
        try:
            done = compensate_case(case, wish, observe=talk)
        except InputError as error:
            raise source.placed(error) from None
        talk.begin(WRITING)
        folder = write_compensation(done, output, overwrite=overwrite)
    notes(done.notes, voice)
    print((folder / RESULT).read_text(encoding="utf-8").rstrip() if as_json else summary(done, folder))
    return Exit.OUT_OF_TOLERANCE if done.within is False else Exit.DONE


def write_compensation(done: Compensated, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write the folder: table, result.json, the case with the corrected punch, its files for the workshop, figures and
    report; of the other kinds of surface case and files in folders of their own. See `write_folder` for its errors."""

    def write(folder: Path) -> None:
        (folder / CONVERGENCE).write_text(convergence_csv(done), encoding="utf-8", newline="\n")
        (folder / RESULT).write_text(compensation_json(done), encoding="utf-8", newline="\n")
        _write_case(done.case, folder, done)
        for kind, case in done.other_cases.items():
            (folder / kind).mkdir()
            _write_case(case, folder / kind, done)
        write_compensation_report(done, folder)

    return write_folder(output, write, overwrite=overwrite)


def summary(done: Compensated, folder: Path) -> str:
    """What a person wants to know first about a compensation, in some lines."""
    head, *rows = solve_rows(done)
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    table = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in (head, *rows)]
    lines = [done.given.title, *(f"  {line}" for line in table), ""]
    lines += [f"  {sentence}" for sentence in explained(done)]
    lines += [f"  - {hint}" for hint in remedies(done)]
    return "\n".join([*lines, "", f"  case    {folder / CASE}", f"  report  {folder / 'report.html'}"])


def _write_case(case: Case, folder: Path, done: Compensated) -> None:
    (folder / CASE).write_text(write_case(case), encoding="utf-8", newline="\n")
    edge = float(np.hypot(*done.run.formed.whole.flat[:, :2].T).max())
    write_punch(folder, surface_of(case.tool), radius=max(edge, case.tool.rim_radius))


def _solves(text: str) -> int:
    try:
        count = int(text)
    except ValueError:
        count = 0
    if count < 1:
        raise InputError.of("a whole number from 1 on is needed", where=f"--solves {text}", hint="such as --solves 6")
    return count


def _relaxation(text: str) -> float:
    try:
        share = float(text)
    except ValueError:
        share = math.nan
    if not 0 < share <= 1:
        raise InputError.of("a number above 0 and up to 1 is needed", where=f"--relaxation {text}", hint="such as 0.7")
    return share
