"""The folder of a sweep: it grows while the sweep goes on, and the same command goes on from it.

sweep.json says what was asked for, record.jsonl holds every evaluation, table.csv shows them. Only the record is
needed to go on; everything else is written anew from it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from punchform import __version__
from punchform.case import Case, write_case
from punchform.errors import InputError
from punchform.optimise.tabulating import PARQUET, TABLE
from punchform.store import CASE, RESULT, check_growing_folder, replace_file

TOLERANCES = "tolerances"
"""The command whose samples may grow in number."""
SWEEP, RECORD, REPORT = "sweep.json", "record.jsonl", "report.html"
OWN = (SWEEP, RECORD, TABLE, PARQUET, CASE, RESULT, REPORT)
"""The files of a sweep: what --overwrite removes."""


@dataclass(frozen=True)
class Request:
    """What was asked for: the command, the varied settings as written, how many samples of which seed (None for all
    combinations), and the case."""

    command: str
    over: tuple[str, ...]
    samples: int | None
    seed: int | None
    case: str


def request(
    command: str, case: Case, over: tuple[str, ...] = (), *, samples: int | None = None, seed: int | None = None
) -> Request:
    """The request, with the resolved case written out."""
    return Request(command, over, samples, seed if samples is not None else None, write_case(case))


def open_folder(folder: str | Path, asked: Request, case: Case, *, overwrite: bool = False) -> Path:
    """The folder, made or ready to go on. Raises InputError when it holds something else, or another request."""
    path, known = check_growing_folder(folder, SWEEP)
    if known and not overwrite:
        _agree(path, asked, str(folder))
        return path
    try:
        path.mkdir(parents=True, exist_ok=True)
        for name in OWN:
            (path / name).unlink(missing_ok=True)
        replace_file(path / CASE, write_case(case))
        write_state(path, asked, {})
    except OSError as problem:
        raise InputError.of(f"the folder cannot be written: {problem.strerror}", where=str(folder)) from problem
    return path


def write_state(path: Path, asked: Request, state: Mapping[str, Any]) -> str:
    """Write sweep.json: the request, and how far it has come; returns its text. Raises OSError."""
    content = {"schema": 1, "version": __version__, "request": _without_case(asked), **state}
    text = json.dumps(content, indent=2, ensure_ascii=False) + "\n"
    replace_file(path / SWEEP, text)
    return text


def _without_case(asked: Request) -> dict[str, Any]:
    return {name: value for name, value in asdict(asked).items() if name != "case"}


def _agree(path: Path, asked: Request, where: str) -> None:
    """What stands in the folder was asked for in the same way."""
    try:
        earlier = json.loads((path / SWEEP).read_text(encoding="utf-8"))["request"]
        case = (path / CASE).read_text(encoding="utf-8")
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError.of(
            f"{SWEEP} or {CASE} of an earlier sweep is damaged", where=where, hint="give --overwrite to begin anew"
        ) from None
    now = json.loads(json.dumps(_without_case(asked)))
    if asked.command == TOLERANCES and isinstance(earlier, dict):
        # The first draws of a seed are the same however many follow: more samples go on from fewer.
        now, earlier = now | {"samples": None}, earlier | {"samples": None}
    what = "another case" if case != asked.case else "other settings" if now != earlier else ""
    if what:
        raise InputError.of(
            f"the folder holds a sweep over {what}",
            where=where,
            hint="give --overwrite to begin anew, or name another folder",
        )
