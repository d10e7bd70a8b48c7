"""From what pydantic finds to what a person reads."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from punchform.case.parts import MisfitError
from punchform.case.places import Path
from punchform.units import LENGTH, UnitError, as_written, quantity, show

UNKNOWN = "no such setting"

_ALTERNATIVES = {
    "crossing": "or a table such as { stiffness = '20 N*mm/rad' }",
    "hold": "or a table such as { from_radius = '300 mm' }",
    "stiffness": "or 6 rows of 6 numbers",
    "hardening": "or a table such as { kind = 'linear', modulus = '2.5 GPa' }",
    "section": "or a table such as { rings = 3, sectors = 8 }",
    "stages": "or a table such as { release = { hold = 'rim' } }",
}
"""What else than a word a key may hold."""


def explain(error: ErrorDetails, section: str, model: type[BaseModel], raw: object) -> tuple[Path, str, str]:
    """Path, message and hint for one error that pydantic found in a section.

    Parameters: the error, its section and the model of that section, the section as it was read.
    """
    inside = _without_tags(error["loc"], raw)
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    path: Path = (section, *inside)
    absent = _is_absent(inside, raw)
    match kind:
        case "extra_forbidden":
            fields = _model_at(model, error["loc"][:-1]).model_fields
            beside = [field.alias or name for name, field in fields.items()]
            return path, UNKNOWN, _other_size(str(inside[-1]), value, beside) or meant(str(inside[-1]), beside)
        case "value_error":
            path, message, hint = _own_words(context["error"], path)
            return path, f"is missing: {message.partition(', not ')[0]}" if absent else message, hint
        case "union_tag_not_found" if isinstance(value, Mapping):
            key = _unquote(context["discriminator"])
            return (*path, key), f"is missing: expected {_listed(_choices_at(model, error['loc'], key))}", ""
        case "union_tag_invalid":
            choices = _choices_at(model, error["loc"], _unquote(context["discriminator"]))
            return (
                (*path, _unquote(context["discriminator"])),
                f"expected {_listed(choices)}, not {as_written(context['tag'])}",
                meant(context["tag"], choices),
            )
        case "literal_error":
            choices = list(_words_of(context["expected"]))
            other = _ALTERNATIVES.get(_key_of(inside)) if "<word>" in error["loc"] else None
            ending = f", {other};" if other else ","
            return path, f"expected {_listed(choices)}{ending} not {as_written(value)}", meant(value, choices)
        case "missing" if isinstance(path[-1], int):
            return path[:-1], "has too few entries", ""
        case "tuple_type":
            return path, _plain_words(kind, value, context), _as_pair(value, _field_at(model, error["loc"]))
    return path, _plain_words(kind, value, context), ""


def _key_of(path: Path) -> str:
    """The last key of a path; entries of a list have that of the list."""
    return next((part for part in reversed(path) if isinstance(part, str)), "")


def _own_words(error: object, path: Path) -> tuple[Path, str, str]:
    if isinstance(error, MisfitError):
        return (*path, *error.key), error.message, error.hint
    if isinstance(error, UnitError):
        return path, error.message, error.hint
    return path, str(error), ""


def _other_size(key: str, value: object, beside: list[str]) -> str:
    """What to write for a diameter where a radius is asked for, or a radius for a diameter; else empty."""
    for given, wanted, times, words in (
        ("diameter", "radius", 0.5, "half the diameter"),
        ("radius", "diameter", 2.0, "twice the radius"),
    ):
        name = key.replace(given, wanted)
        if name == key or name not in beside:
            continue
        try:
            size = show(times * quantity(value, LENGTH), LENGTH)
        except UnitError:
            size = "..."
        return f'write {name} = "{size}": {words}'
    return ""


def _as_pair(value: object, annotation: Any) -> str:
    """What to write where one value stands in place of two; empty where not two are asked for."""
    pairs = [one for one in (annotation, *get_args(annotation)) if get_origin(one) is tuple]
    if not pairs or len(get_args(pairs[0])) != 2 or Ellipsis in get_args(pairs[0]):
        return ""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return ""
    return f"two values are needed, one along x and one along y: write [{json.dumps(value)}, {json.dumps(value)}]"


def _plain_words(kind: str, value: object, context: Mapping[str, Any]) -> str:
    written = as_written(value)
    match kind:
        case "missing":
            return "is missing"
        case "int_type" | "int_from_float":
            return f"expected a whole number, not {written}"
        case "greater_than_equal":
            return f"must be at least {context['ge']}, not {written}"
        case "less_than_equal":
            return f"must be at most {context['le']}, not {written}"
        case "string_type":
            return f"expected text in quotes, not {written}"
        case "string_too_long":
            return f"is too long: at most {context['max_length']} characters"
        case "tuple_type":
            return f"expected a list in square brackets, not {written}"
        case "too_short":
            return f"needs at least {context['min_length']} entries, not {context['actual_length']}"
        case "too_long":
            return f"has too many entries: at most {context['max_length']}"
        case "model_type" | "model_attributes_type" | "union_tag_not_found" | "dict_type":
            return f"expected a table with settings, not {written}"
    return f"cannot be used: {kind.replace('_', ' ')} ({written})"


def _words_of(expected: str) -> list[str]:
    """The words in pydantic's text "'a', 'b' or 'c'"."""
    return [word for word in expected.replace(" or ", ", ").replace("'", "").split(", ") if word]


def _without_tags(location: Path, raw: object) -> Path:
    """The location without the names of the union members that pydantic puts in between."""
    path: list[str | int] = []
    at_union = False
    for part in location:
        if _is_tag(part):
            continue
        if isinstance(raw, Mapping):
            # Pydantic names the chosen member first, even where one of its keys is called the same.
            if at_union and part in (raw.get("kind"), raw.get("shape")):
                at_union = False
                continue
            raw = raw.get(part)
            at_union = True
        elif isinstance(raw, list) and isinstance(part, int):
            raw = raw[part] if part < len(raw) else None
        elif isinstance(part, int):
            continue
        path.append(part)
    return tuple(path)


def _is_tag(part: str | int) -> bool:
    """Whether a part of a location is our name of a union member, in angle brackets, and no key."""
    return isinstance(part, str) and part.startswith("<")


def _is_absent(path: Path, raw: object) -> bool:
    for part in path:
        if isinstance(raw, Mapping):
            if part not in raw:
                return True
            raw = raw[part]
    return False


def _choices_at(model: type[BaseModel], location: Path, key: str) -> list[str]:
    while _is_tag(location[-1]):
        location = location[:-1]
    owner = _model_at(model, location[:-1])
    members = _models_in(owner.model_fields[str(location[-1])].annotation)
    return [choice for member in members for choice in get_args(member.model_fields[key].annotation)]


def _model_at(model: type[BaseModel], location: Iterable[str | int]) -> type[BaseModel]:
    """The table that a location leads to; names of union members choose between the tables of a key."""
    candidates = [model]
    for part in location:
        if isinstance(part, int):
            continue
        if _is_tag(part):
            candidates = [one for one in candidates if part == f"<{one.__name__}>"] or candidates
        elif len(candidates) > 1:
            candidates = [one for one in candidates if part == _tag(one)]
        elif part in candidates[0].model_fields:
            candidates = list(_models_in(candidates[0].model_fields[str(part)].annotation))
    return candidates[0]


def _field_at(model: type[BaseModel], location: Path) -> Any:
    """The annotation of the key that a location leads to; None for an entry of a list."""
    field = _model_at(model, location[:-1]).model_fields.get(str(location[-1]))
    return None if field is None else field.annotation


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _models_in(argument)


def _tag(model: type[BaseModel]) -> str | None:
    for key in ("kind", "shape"):
        if key in model.model_fields:
            return str(model.model_fields[key].default)
    return None


def _listed(choices: list[str]) -> str:
    quoted = [f"'{choice}'" for choice in choices]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"


def meant(word: object, choices: Iterable[str]) -> str:
    """A hint with the choice that is nearest to a word, or with all of them."""
    known = list(choices)
    close = difflib.get_close_matches(str(word).lower(), known, n=1, cutoff=0.55)
    return f"did you mean `{close[0]}`?" if close else f"there are: {', '.join(known)}"


def _unquote(text: str) -> str:
    return text.strip("'")
