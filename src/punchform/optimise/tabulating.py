"""The table of a sweep: one row for each design, in CSV as the rows come, and in Parquet when all have come."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from punchform.case import Case, unit
from punchform.errors import InputError
from punchform.optimise.evaluations import Evaluation
from punchform.optimise.figures import FIGURES
from punchform.store import replace_file

TABLE, PARQUET = "table.csv", "table.parquet"
DONE, FAILED = "done", "failed"
CLOSING = ("outcome", "message", "seconds", "key")
"""The columns after settings and figures."""


def columns(case: Case, places: Sequence[str]) -> tuple[str, ...]:
    """The head of the table: the settings that are varied and the figures, each with its unit, and how it went."""
    settings = [_headed(place, unit(case, place)) for place in places]
    return (*settings, *(_headed(name, figure.unit) for name, figure in FIGURES.items()), *CLOSING)


def row(evaluation: Evaluation, places: Sequence[str]) -> tuple[Any, ...]:
    """One row of the table: numbers in internal units, words, None for what is not there."""
    return (
        *(evaluation.changes.get(place) for place in places),
        *(evaluation.figures.get(name) for name in FIGURES),
        FAILED if evaluation.failed else DONE,
        evaluation.failure,
        evaluation.seconds,
        evaluation.key,
    )


class GrowingTable:
    """table.csv while a sweep goes on: what is known at first, then a row for each evaluation as it comes."""

    def __init__(self, path: Path, case: Case, places: Sequence[str], known: Iterable[Evaluation]) -> None:
        """Begin the table anew with what is known. Raises OSError."""
        self._places = tuple(places)
        self._head = columns(case, places)
        self._path = path
        replace_file(path, self._text(known))
        self._file = path.open("a", encoding="utf-8", newline="")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def add(self, evaluation: Evaluation) -> None:
        """Add a row and give it to the system. Raises OSError."""
        self._file.write(_csv([row(evaluation, self._places)]))
        self._file.flush()

    def ordered(self, evaluations: Sequence[Evaluation]) -> None:
        """The whole table again, in this order. Raises OSError."""
        replace_file(self._path, self._text(evaluations))

    def write_parquet(self, path: Path, evaluations: Sequence[Evaluation]) -> None:
        """The same table as a Parquet file. Raises OSError."""
        rows = [row(evaluation, self._places) for evaluation in evaluations]
        _write_parquet(path, dict(zip(self._head, zip(*rows, strict=True), strict=True)))

    def _text(self, evaluations: Iterable[Evaluation]) -> str:
        return _csv([self._head, *(row(evaluation, self._places) for evaluation in evaluations)])


def check_parquet() -> None:
    """Raises InputError when Parquet cannot be written."""
    if find_spec("pyarrow") is None:
        raise InputError.of(
            "PyArrow is not installed, which --format parquet needs", hint="pip install 'punchform[parquet]'"
        )


def _write_parquet(path: Path, table: Mapping[str, Sequence[Any]]) -> None:
    import pyarrow
    from pyarrow import parquet

    aside = path.with_name(f".{path.name}.new")
    try:
        parquet.write_table(pyarrow.table({name: _alike(values) for name, values in table.items()}), aside)
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def _alike(values: Sequence[Any]) -> list[Any]:
    """The values of a column, all numbers or all words: a setting may take both."""
    plain = all(value is None or isinstance(value, int | float) for value in values)
    return [value if plain or value is None else str(value) for value in values]


def _headed(name: str, own: str) -> str:
    return f"{name} [{own}]" if own else name


def _csv(rows: Iterable[Sequence[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
