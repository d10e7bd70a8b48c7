"""A case with some of its settings changed: what a sweep, a search or a derivative does to it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from punchform.case.places import Path as KeyPath
from punchform.case.places import dotted, undotted
from punchform.case.whole import Case
from punchform.case.wording import explain
from punchform.errors import InputError, Problem

LEFT = "default_factory_not_called"
"""What pydantic says of a key that follows another one which is wrong itself."""


def varied(case: Case, changes: Mapping[str, object]) -> Case:
    """The case with other values at some places such as "wire.diameter" or "punch.profile.points[3][1]".

    Values are what a case file may hold there: numbers in internal units, texts with units, words, tables. What the
    case left out follows the new values as it would in its file. Raises InputError for places that are not there and
    values that cannot be, all at once.
    """
    document = case.model_dump(exclude_unset=True, by_alias=True)
    whole = case.model_dump(by_alias=True)
    for place, value in changes.items():
        _put(document, whole, place, value)
    try:
        return Case.model_validate(document)
    except ValidationError as error:
        found = (explain(each, "", Case, document) for each in error.errors(include_url=False) if each["type"] != LEFT)
        # A pair such as grid.step complains of each of its two alike.
        raise InputError(dict.fromkeys(Problem(words, dotted(path[1:]), hint) for path, words, hint in found)) from None


def setting(case: Case, place: str) -> Any:
    """What the case holds at a place: a number in internal units, a word, a table. Raises InputError for no place."""
    return _at(case.model_dump(by_alias=True), undotted(place), place)


def written(case: Case, place: str) -> Any:
    """What stands at a place as the file would say it: a quantity with its unit. Raises InputError for no place."""
    return _at(case.model_dump(mode="json", by_alias=True), undotted(place), place)


def unit(case: Case, place: str) -> str:
    """The internal unit of the quantity at a place, "" for a plain number or a word."""
    text = written(case, place)
    text = text[0] if isinstance(text, list) and text else text
    if not isinstance(text, str) or not isinstance(setting(case, place), float | tuple):
        return ""
    return text.partition(" ")[2]


def number(case: Case, place: str) -> float:
    """The number at a place, in internal units; of a pair of equal ones, such as `grid.step`, the one.

    Raises InputError when there is none.
    """
    value = setting(case, place)
    if isinstance(value, tuple) and len(value) == 2 and value[0] == value[1]:
        value = value[0]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError.of("is not a number that could vary", where=place, hint="`punchform schema` lists the numbers")
    return float(value)


def _put(document: dict[str, Any], whole: Any, place: str, value: object) -> None:
    """Set the value at a place; tables on the way that the case left out are filled in as the case resolved them."""
    *way, last = _path(place)
    here: Any = document
    for step in way:
        whole = _below(whole, step, place)
        inner = here.get(step) if isinstance(here, dict) else here[step]
        if isinstance(inner, tuple):
            inner = list(inner)
        inner = whole if inner is None else inner
        if not isinstance(inner, dict | list | tuple):
            raise _nowhere(place)
        here[step] = inner = dict(inner) if isinstance(inner, dict) else list(inner)
        here = inner
    if isinstance(here, list):
        _below(here, last, place)
    elif isinstance(last, int):
        raise _nowhere(place)
    here[last] = value


def _at(whole: Any, path: KeyPath, place: str) -> Any:
    for step in path:
        whole = _below(whole, step, place)
    return whole


def _below(whole: Any, step: str | int, place: str) -> Any:
    try:
        return whole[step]
    except (KeyError, IndexError, TypeError):
        raise _nowhere(place) from None


def _path(place: str) -> KeyPath:
    path = undotted(place)
    if len(path) < 2:
        raise _nowhere(place)
    return path


def _nowhere(place: str) -> InputError:
    return InputError.of(
        "the case has no such setting",
        where=place,
        hint="name a setting as the file does: section, dot, key, as in wire.diameter or punch.profile.focal_length",
    )
