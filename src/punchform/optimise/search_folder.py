"""The folder of a design search: it grows while the search goes on, and the same command goes on from it.

search.json marks it, case.toml says what was asked for, record.jsonl holds every evaluation. Only the record is needed
to go on; everything else is written anew at the end.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from punchform import __version__
from punchform.case import Case, case_from_text, varied, write_case
from punchform.errors import InputError
from punchform.optimise.asking import Answer
from punchform.optimise.figures import FIGURES
from punchform.optimise.problem import Question, unit_of
from punchform.optimise.search import Found
from punchform.store import CASE, RESULT, check_growing_folder, replace_file

SEARCH, RECORD, TABLE, FRONT, BEST = "search.json", "record.jsonl", "table.csv", "front.csv", "best.toml"
DESIGNS = "front"
"""The folder of the cases of the front."""


def open_folder(folder: str | Path, case: Case, *, overwrite: bool = False) -> Path:
    """The folder, made or ready to go on: with another [optimise] the evaluations that fit are used again.

    Raises InputError when it holds something else, or a search in another case.
    """
    path, known = check_growing_folder(folder, SEARCH)
    if known and not overwrite and not _alike(path / CASE, case):
        raise InputError.of(
            "the folder holds a search in another case",
            where=str(folder),
            hint="give --overwrite to begin anew, or name another folder",
        )
    try:
        path.mkdir(parents=True, exist_ok=True)
        if overwrite:
            (path / RECORD).unlink(missing_ok=True)
        for name in (RESULT, TABLE, FRONT, BEST):
            (path / name).unlink(missing_ok=True)
        replace_file(path / CASE, write_case(case))
        replace_file(path / SEARCH, json.dumps({"schema": 1, "version": __version__}) + "\n")
    except OSError as problem:
        raise InputError.of(f"the folder cannot be written: {problem.strerror}", where=str(folder)) from problem
    return path


def write_found(folder: Path, found: Found) -> str:
    """Write tables and cases of what was found, and result.json last; returns its text. Raises OSError."""
    replace_file(folder / TABLE, table(found, found.answers))
    replace_file(folder / FRONT, table(found, found.front))
    replace_file(folder / BEST, write_case(case_of(found.question, found.best)))
    designs = folder / DESIGNS
    designs.mkdir(exist_ok=True)
    for old in designs.glob("front_*.toml"):
        old.unlink()
    if len(found.question.objectives) > 1:
        for count, answer in enumerate(found.front, start=1):
            replace_file(designs / front_name(count), write_case(case_of(found.question, answer, f"front {count}")))
    elif not any(designs.iterdir()):
        designs.rmdir()
    text = json.dumps(result(found), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    replace_file(folder / RESULT, text)
    return text


def front_name(count: int) -> str:
    """The file of the how many-th design of the front, from 1."""
    return f"front_{count:03d}.toml"


def case_of(question: Question, answer: Answer, which: str = "best design") -> Case:
    """The case of a design, as `punchform form` runs it. Its title says which design it is."""
    made = varied(question.case, question.space.changes(answer.design))
    return made.model_copy(update={"title": f"{made.title}: {which}"[:200]})


def table(found: Found, answers: Sequence[Answer]) -> str:
    """Designs with their settings and figures as CSV, each with its unit; `front` and `allowed` are 0 or 1."""
    question = found.question
    figures = _figures(question)
    settings = [_headed(one.place, one.unit) for one in question.space.variables]
    head = ["number", *settings, *(_headed(name, unit_of(name)) for name in figures)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*head, "allowed", "front", "outcome", "message", "seconds", "key"])
    of_front = {answer.number for answer in found.front}
    for one in answers:
        told = [one.told.get(name) for name in figures]
        marks = (int(one.allowed), int(one.number in of_front), "failed" if one.merit is None else "done", one.why)
        settings_of = question.space.changes(one.design).values()
        writer.writerow(
            [one.number, *settings_of, *told, *marks, one.evaluation.seconds, one.evaluation.key],
        )
    return text.getvalue()


def result(found: Found) -> dict[str, Any]:
    """The content of result.json."""
    question = found.question
    return {
        "schema": 1,
        "version": __version__,
        "case_title": question.case.title,
        "objectives": [
            {"figure": one.figure, "unit": unit_of(one.figure), "sense": sense(one.sign)} for one in question.objectives
        ],
        "constraints": [one.words for one in question.limits],
        "search": {
            "way": found.way,
            "why": found.why,
            "seed": question.asked.seed,
            "evaluations": len(found.answers),
            "failed": sum(answer.merit is None for answer in found.answers),
            "ended": found.ended,
        },
        "best": _told(found, found.best),
        "binding": list(found.binding),
        "at_end_of_range": dict(found.at_end),
        "front": [_told(found, answer) for answer in found.front] if len(question.objectives) > 1 else [],
    }


def sense(sign: float) -> str:
    """What is done to an objective."""
    return "minimise" if sign > 0 else "maximise"


def _told(found: Found, answer: Answer) -> dict[str, Any]:
    return {
        "number": answer.number,
        "allowed": answer.allowed,
        "changes": found.question.space.changes(answer.design),
        "figures": {name: answer.told.get(name) for name in _figures(found.question)},
    }


def _figures(question: Question) -> tuple[str, ...]:
    """Those that are asked for first, then all others of a run."""
    own = [
        name for name, there in (("gain_loss", question.asked.frequency), ("cost", question.cost)) if there is not None
    ]
    return tuple(dict.fromkeys((*question.figures, *own, *FIGURES)))


def _headed(name: str, own: str) -> str:
    return f"{name} [{own}]" if own else name


def _alike(path: Path, case: Case) -> bool:
    """Whether a case file holds the same case but for what no figure depends on."""
    try:
        earlier = case_from_text(path.read_text(encoding="utf-8"), str(path), folder=path.parent)
    except (OSError, UnicodeDecodeError, InputError):
        return False
    return _plain(earlier) == _plain(case)


def _plain(case: Case) -> Case:
    return case.model_copy(update={"optimise": None, "title": ""})
