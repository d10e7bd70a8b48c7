"""One design, computed once: its key, what came of it, and the record from which a sweep or a search goes on.

An evaluation is a case with some settings changed, run, and read by its figures. It depends on nothing but the
resolved case: not on the order of evaluations, not on threads, not on the process.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from types import TracebackType
from typing import Any, Self, TextIO

from punchform import __version__
from punchform.case import Case, number, setting, varied, written
from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.figures import FIGURES, figures
from punchform.run import Run, run

WITHOUT_EFFECT = ("title", "scatter", "optimise")
"""What a case says that no figure of its run depends on."""


@dataclass(frozen=True)
class Evaluation:
    """What came of one design.

    key: of the design, see `designed`; changes: what it changes in the case, numbers in internal units; figures: by
    their names, None for those the run does not have, none at all of a design that failed; seconds: of the run;
    failure: why there are no figures, None when there are.
    """

    key: str
    changes: Mapping[str, Any]
    figures: Mapping[str, float | None] = field(default_factory=dict)
    seconds: float = 0.0
    failure: str | None = None

    @property
    def failed(self) -> bool:
        """Whether there is nothing but a message."""
        return self.failure is not None


@dataclass(frozen=True)
class Design:
    """A case with changes, before it is run: its key, the changes with numbers in internal units, and the case that
    they make, or why they make none."""

    key: str
    changes: Mapping[str, Any]
    case: Case | None
    failure: str | None = None


@dataclass(frozen=True)
class Task:
    """What a worker needs to evaluate a design: small, and made of texts and numbers only."""

    case: str
    changes: Mapping[str, Any]


def evaluate(case: Case, changes: Mapping[str, object], *, keep: Callable[[Run], None] | None = None) -> Evaluation:
    """Run the case with these changes and read its figures; `keep` is given the run itself.

    What goes wrong with this one design (settings that cannot be, no equilibrium, anything else) is a recorded
    failure, not an error: the next design may do better.
    """
    design = designed(case, changes)
    if design.case is None:
        return Evaluation(design.key, design.changes, failure=design.failure)
    begun, found, failure = perf_counter(), {}, None
    try:
        done = run(design.case)
        if done.formed.outcome.usable:
            found = {name: None if value is None else float(value) for name, value in figures(done).items()}
            if keep is not None:
                keep(done)
        else:
            failure = done.formed.outcome.value
    except Exception as error:
        failure = told(error)
    return Evaluation(design.key, design.changes, found, perf_counter() - begun, failure)


def designed(case: Case, changes: Mapping[str, object]) -> Design:
    """The design that changes make of a case, with its key: the SHA-256 of the resolved case, of the version of the
    program and of the names of the figures. The same design has the same key however its changes are written."""
    try:
        made = varied(case, changes)
    except InputError as error:
        # No resolved case: the words of the file and of the changes stand for it.
        content = {"case": _content(case), "changes": {place: str(value) for place, value in changes.items()}}
        return Design(_key(content), dict(changes), None, told(error))
    return Design(_key(_content(made)), {place: internal(made, place) for place in changes}, made)


def internal(case: Case, place: str) -> Any:
    """What stands at a place: a number in internal units where there is one, else what the file says."""
    value = setting(case, place)
    if isinstance(value, int):
        return value
    try:
        return number(case, place)
    except InputError:
        return written(case, place)


def told(error: BaseException) -> str:
    """An error on one line, as a table can hold it."""
    if isinstance(error, InputError):
        each = (f"{one.where}: {one.message}" if one.where else one.message for one in error.problems)
        return " ".join("; ".join(each).split())
    words = " ".join(str(error).split())
    if isinstance(error, NoEquilibrium):
        return f"no equilibrium: {words}"
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


def sent(case: Case) -> str:
    """The case as a task carries it: what its file left out is left out, and follows what is changed."""
    return case.model_dump_json(exclude_unset=True, by_alias=True)


def work(given: Task) -> Evaluation:
    """Evaluate a design in a worker, on one core: the other cores have workers of their own."""
    from punchform.mechanics.cores import at_most

    with at_most(1):
        return evaluate(_case_of(given.case), given.changes)


@lru_cache(maxsize=1)
def _case_of(text: str) -> Case:
    return Case.model_validate_json(text)


def _content(case: Case) -> dict[str, Any]:
    content = case.model_dump(mode="json", by_alias=True)
    return {name: value for name, value in content.items() if name not in WITHOUT_EFFECT}


def _key(content: Mapping[str, Any]) -> str:
    whole = {"version": __version__, "figures": sorted(FIGURES), **content}
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


class Record:
    """The evaluations made so far, one JSON line each, in a file that only grows; in memory alone without a path.

    Every evaluation is on the disk before `add` returns. A last line that a crash has cut is dropped when the record
    is opened again. One program at a time writes a record. Use it as a context manager.
    """

    def __init__(self, path: Path | None = None) -> None:
        """Open the record, or begin one. Raises InputError for a file that is something else or that another program
        is writing, OSError."""
        self.path = path
        self._known: dict[str, Evaluation] = {}
        self._file = None if path is None else path.open("a", encoding="utf-8", newline="\n")
        if path is None or self._file is None:
            return
        try:
            _claim(self._file, path)
            for count, line in enumerate(_mended(path).splitlines(), start=1):
                evaluation = _read(line, f"{path}:{count}")
                self._known[evaluation.key] = evaluation
        except BaseException:
            self._file.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __iter__(self) -> Iterator[Evaluation]:
        """All evaluations in the order in which they came."""
        return iter(tuple(self._known.values()))

    def __len__(self) -> int:
        return len(self._known)

    def __contains__(self, key: str) -> bool:
        return key in self._known

    def __getitem__(self, key: str) -> Evaluation:
        return self._known[key]

    def add(self, evaluation: Evaluation) -> bool:
        """Keep an evaluation; False, and nothing is written, when its design is known already. Raises OSError."""
        if evaluation.key in self._known:
            return False
        if self._file is not None:
            self._file.write(json.dumps(asdict(evaluation)) + "\n")
            self._file.flush()
            os.fsync(self._file.fileno())
        self._known[evaluation.key] = evaluation
        return True

    def evaluated(self, case: Case, changes: Mapping[str, object]) -> Evaluation:
        """The evaluation of a design: the recorded one, or one made now and recorded."""
        key = designed(case, changes).key
        if key not in self:
            self.add(evaluate(case, changes))
        return self[key]

    def close(self) -> None:
        """Close the file; what was added stays readable."""
        if self._file is not None:
            self._file.close()


def recorded(path: Path) -> tuple[Evaluation, ...]:
    """What a record that nobody writes holds on the disk. Raises InputError and OSError as `Record` does."""
    with Record(path) as record:
        return tuple(record)


def _claim(file: TextIO, path: Path) -> None:
    """Keep other programs from writing the file for as long as it is open here."""
    if find_spec("fcntl") is None:
        return
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InputError.of(
            "another punchform is writing here", where=str(path), hint="wait for it to end, or name another folder"
        ) from None
    except OSError:
        # Some network file systems have no locks; the record works without.
        return


def _mended(path: Path) -> str:
    """The whole lines of a record; a last one without its end is cut off the file."""
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if len(whole) < len(content):
        os.truncate(path, len(whole))
    return whole.decode("utf-8", errors="replace")


def _read(line: str, where: str) -> Evaluation:
    try:
        return Evaluation(**json.loads(line))
    except (ValueError, TypeError):
        raise InputError.of(
            "the record of evaluations is damaged here, or is none",
            where=where,
            hint="delete this line to have its design computed again, or begin anew with --overwrite",
        ) from None
