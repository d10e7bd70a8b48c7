"""From a case file to a Case: all that is wrong with the file is told at once, each with its line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from punchform.case.checks import findings
from punchform.case.grid import GridCase
from punchform.case.load import LoadCase
from punchform.case.optimise import OptimiseCase
from punchform.case.packaged import PREFIX, packaged_text
from punchform.case.places import Path as KeyPath
from punchform.case.places import dotted, key_lines, line_of, repeated, undotted
from punchform.case.press import PressCase, SolverCase
from punchform.case.punch import PunchCase
from punchform.case.release import ReleaseCase
from punchform.case.scatter import ScatterCase
from punchform.case.scattering import scatter_findings
from punchform.case.stages import StagesCase
from punchform.case.target import TargetCase
from punchform.case.whole import CHECKED, NO_PUNCH, NO_PUNCH_HINT, SCHEMA, SECTIONS, STAGED, Case
from punchform.case.wire import WireCase
from punchform.case.wording import UNKNOWN, explain, meant
from punchform.errors import InputError, Problem
from punchform.units import as_written

LARGEST_FILE = 10_000_000
"""Bytes that a case file may have: beyond it, it is some other file."""

_MODELS: dict[str, type[BaseModel]] = {
    "grid": GridCase,
    "wire": WireCase,
    "punch": PunchCase,
    "press": PressCase,
    "solver": SolverCase,
    "release": ReleaseCase,
    "load": LoadCase,
    "target": TargetCase,
    "optimise": OptimiseCase,
    "scatter": ScatterCase,
}
_Found = tuple[KeyPath, str, str]
_NEEDED = ("grid", "wire")


@dataclass(frozen=True)
class CaseText:
    """The text of a case, the name by which messages call it, and the folder its files are relative to."""

    text: str
    name: str
    folder: Path = Path()

    def placed(self, error: InputError) -> InputError:
        """The same error with the line of each key that it names, as in "dish.toml:14: wire.diameter"."""
        lines = key_lines(self.text)
        problems = []
        for problem in error.problems:
            path = undotted(problem.where)
            known = bool(path) and path[0] in ("stages", *SECTIONS)
            where = f"{self.name}:{line_of(lines, path)}: {problem.where}" if known else problem.where
            problems.append(replace(problem, where=where))
        return InputError(problems)


def read_case(path: str | Path) -> Case:
    """Read a case file, or a packaged case when the path is "packaged:NAME".

    Raises InputError with all that is wrong with the file.
    """
    return parse(read_text(path))


def case_from_text(text: str, name: str = "case", *, folder: str | Path = ".") -> Case:
    """The case in a text; `name` stands for the file in messages, files named in it are relative to `folder`.

    Raises InputError with all that is wrong with the text.
    """
    return parse(CaseText(text, name, Path(folder)))


def read_text(path: str | Path) -> CaseText:
    """The text of a case file or of a packaged case. Raises InputError when it cannot be read."""
    name = str(path)
    if name.startswith(PREFIX):
        return CaseText(packaged_text(name.removeprefix(PREFIX)), name)
    if not name:
        raise InputError.of("the name of a case file is empty", hint="`punchform new FILE` writes a case to start from")
    file = Path(path)
    try:
        if file.is_dir():
            raise InputError.of("is a folder, not a case file", where=name, hint=f"give a file in {name}")
        size = file.stat().st_size
        if not file.is_file():
            raise InputError.of("is not a regular file", where=name)
        if size > LARGEST_FILE:
            raise InputError.of("is too large for a case file", where=name)
        content = file.read_bytes()
    except (OSError, ValueError) as problem:
        reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        absent = isinstance(problem, FileNotFoundError)
        hint = "`punchform new FILE` writes a case to start from" if absent else ""
        raise InputError.of(f"cannot be read: {reason}", where=name, hint=hint) from None
    try:
        return CaseText(content.decode("utf-8-sig"), name, file.parent)
    except UnicodeDecodeError as problem:
        line = content.count(b"\n", 0, problem.start) + 1
        raise InputError.of(
            "is not UTF-8 text", where=f"{name}:{line}", hint="save the file as UTF-8 in your editor"
        ) from None


def parse(source: CaseText) -> Case:
    """The case in a text. Raises InputError with all problems in the order of their lines."""
    document = _document(source)
    problems: list[_Found] = list(_top_level(document))
    sections: dict[str, Any] = dict.fromkeys(("stages", *SECTIONS))
    sections["stages"] = _stages(document, source, problems)
    for name, raw in document.items():
        if name not in _MODELS:
            continue
        try:
            sections[name] = _MODELS[name].model_validate(raw, context={"folder": source.folder})
        except ValidationError as error:
            problems += [
                explain(each, name, _MODELS[name], raw)
                for each in error.errors(include_url=False)
                if each["type"] != "default_factory_not_called"
            ]
    if any(name in document and sections[name] is None for name in ("stages", *STAGED)):
        # Of stages that are not all known nothing can be told, nor of what loads act on.
        known = sections | {"stages": None, "load": sections["load"] if "stages" not in document else None}
    else:
        known = sections
    checked = {name: known[name] for name in ("stages", *CHECKED)}
    problems += [(found.key, found.message, found.hint) for found in findings(**checked)]
    if problems:
        raise _all(problems, source)
    given = {name: section for name, section in sections.items() if section is not None}
    title = {"title": document["title"]} if "title" in document else {}
    case = Case(**title, **given)
    problems += [(found.key, found.message, found.hint) for found in scatter_findings(case)]
    if problems:
        raise _all(problems, source)
    return case


def _stages(document: Mapping[str, Any], source: CaseText, problems: list[_Found]) -> Any:
    """The stages of a document, None without any or after adding what is wrong with them to the problems."""
    if "stages" not in document:
        return None
    raw = {"stages": document["stages"]}
    try:
        return StagesCase.model_validate(raw, context={"folder": source.folder}).stages
    except ValidationError as error:
        for each in error.errors(include_url=False):
            path, message, hint = explain(each, "", StagesCase, raw)
            problems.append((path[1:], message, hint))
        return None


def _document(source: CaseText) -> dict[str, Any]:
    # An editor on Windows may save CRLF; a lone CR is what the parser should complain about.
    try:
        return tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(str(error), source) from None
    except RecursionError:
        raise InputError.of("lists or tables are nested too deeply", where=source.name) from None


def _syntax_error(message: str, source: CaseText) -> InputError:
    words, _, place = message.partition(" (at ")
    found = re.match(r"line (\d+), column (\d+)", place)
    lines = source.text.replace("\r\n", "\n").split("\n")
    number = int(found.group(1)) if found else len(lines)
    if words.startswith(("Cannot overwrite", "Cannot declare", "Cannot mutate", "Duplicate")):
        until = int(found.group(2)) - 1 if found else len(lines[-1])
        twice = repeated("\n".join((*lines[: number - 1], lines[number - 1][:until])))
        if twice is not None:
            return _repetition(source, *twice)
    line = lines[min(number, len(lines)) - 1]
    unquoted = re.search(r"=\s*([+-]?[0-9.]+(?:e[+-]?[0-9]+)?\s*[A-Za-z°µ][^#]*)", line)
    hint = f'a quantity with a unit stands in quotes: "{unquoted.group(1).strip()}"' if unquoted else ""
    return InputError.of(f"not valid TOML: {words[0].lower()}{words[1:]}", where=f"{source.name}:{number}", hint=hint)


def _repetition(source: CaseText, path: KeyPath, first: int, again: int) -> InputError:
    return InputError.of(
        f"stands twice, here and on line {first}",
        where=f"{source.name}:{again}: {dotted(path)}",
        hint="leave out one of them",
    )


def _top_level(document: Mapping[str, Any]) -> list[_Found]:
    problems: list[_Found] = []
    version = document.get("schema")
    if version is None:
        problems.append((("schema",), "is missing", f"write schema = {SCHEMA} as the first line"))
    elif type(version) is not int or version != SCHEMA:
        problems.append(
            (
                ("schema",),
                f"this program reads case files of schema {SCHEMA}, not {as_written(version)}",
                "a newer file needs a newer punchform" if isinstance(version, int) else "",
            )
        )
    title = document.get("title", "")
    if not isinstance(title, str) or len(title) > 200:
        problems.append((("title",), f"expected a short text in quotes, not {as_written(title)}", ""))
    problems += [
        ((name,), "this section is missing", f"add a table [{name}]; `punchform new FILE` shows one")
        for name in _NEEDED
        if name not in document
    ]
    press = document.get("press")
    if "punch" not in document and not (isinstance(press, Mapping) and "ends" in press):
        problems.append((("punch",), NO_PUNCH, NO_PUNCH_HINT))
    known = ("schema", "title", "stages", *SECTIONS)
    problems += [((name,), UNKNOWN, meant(name, known)) for name in document if name not in known]
    return problems


def _all(problems: list[_Found], source: CaseText) -> InputError:
    lines = key_lines(source.text)
    in_order = sorted(_refined(problems), key=lambda found: line_of(lines, found[0]))
    return InputError(
        Problem(message, f"{source.name}:{line_of(lines, path)}: {dotted(path)}", hint)
        for path, message, hint in in_order
    )


def _refined(problems: list[_Found]) -> Iterator[_Found]:
    """Each problem once; a misspelt key is not missing too, and a key of another section is told its home."""
    misspelt = {(path[:-1], hint) for path, message, hint in problems if message == UNKNOWN}
    for path, message, hint in dict.fromkeys(problems):
        if message.startswith("is missing") and _given_otherwise(path, misspelt):
            continue
        homes = [name for name, model in _MODELS.items() if path[-1] in model.model_fields]
        if message == UNKNOWN and homes and not hint.startswith("write "):
            yield path, message, f"`{path[-1]}` belongs in [{homes[0]}]"
        else:
            yield path, message, hint


def _given_otherwise(path: KeyPath, misspelt: set[tuple[KeyPath, str]]) -> bool:
    """Whether a key beside this one was told that it should have been this one."""
    meanings = (f"did you mean `{path[-1]}`?", f"write {path[-1]} = ")
    return any(beside == path[:-1] and hint.startswith(meanings) for beside, hint in misspelt)
