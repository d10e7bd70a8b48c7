"""`punchform examples`: the cases that come with the program, to look at and to copy."""

from __future__ import annotations

import json
import shutil
import textwrap
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from punchform.case import PREFIX, TEMPLATE, Case, introduction, packaged_cases, packaged_text, read_case
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError

NARROWEST = 60
"""The table is not made narrower than this."""
SLOW, SLOWER = 5_000, 300_000
"""Crossings times strokes (yielding ones three times) from which a case takes some ten seconds, and minutes."""


@dataclass(frozen=True)
class Listed:
    """One packaged case: what it is called on the command line, its title, what it shows in a sentence, the crossings
    of its whole grid, and how long it takes."""

    name: str
    title: str
    shows: str
    crossings: int
    takes: str


def examples(
    name: str | None, *, every: bool, output: str | None, overwrite: bool, voice: Voice, as_json: bool
) -> Exit:
    """List the packaged cases, or copy one or all of them.

    Raises InputError for an unknown name, for files that are there already, and for options that do not fit.
    """
    known = tuple(one for one in packaged_cases() if one != TEMPLATE)
    if name is None and not every:
        if output is not None:
            raise InputError.of(
                "what is to be copied is not said", where=f"-o {output}", hint="name an example, or give --all"
            )
        listed = tuple(map(described, known))
        print(json.dumps([asdict(one) for one in listed], indent=2, ensure_ascii=False) if as_json else table(listed))
        if voice is not Voice.QUIET and not as_json:
            say("`punchform examples NAME` copies one; `punchform form packaged:NAME -o results` runs it as it is")
        return Exit.DONE
    if name is not None and every:
        raise InputError.of("--all copies every example, none is named then", where=name)
    if name is not None:
        name = name.removeprefix(PREFIX)
        copies = {Path(output or f"{name}.toml"): packaged_text(name)}
    else:
        folder = Path(output or ".")
        copies = {folder / f"{one}.toml": packaged_text(one) for one in known}
        folder.mkdir(parents=True, exist_ok=True)
    copy(copies, overwrite=overwrite)
    if as_json:
        print(json.dumps([str(file) for file in copies], indent=2, ensure_ascii=False))
    if voice is not Voice.QUIET:
        for file in copies:
            say(f"wrote {file}")
        first = next(iter(copies))
        say(f"next: punchform form {first} -o {Path('runs') / first.stem}")
    return Exit.DONE


def copy(copies: Mapping[Path, str], *, overwrite: bool) -> None:
    """Write all files or none. Raises InputError where one cannot be written."""
    there = [file for file in copies if file.exists() and (file.is_dir() or not overwrite)]
    if there:
        folder = there[0].is_dir()
        raise InputError.of(
            "is a folder" if folder else "the file is there already",
            where=str(there[0]),
            hint="give the name of a file" if folder else "give --overwrite to replace it, or another name with -o",
        )
    for file, text in copies.items():
        file.write_text(text, encoding="utf-8", newline="\n")


def described(name: str) -> Listed:
    """What is told of a packaged case."""
    case = read_case(PREFIX + name)
    crossings, work = _size(case)
    takes = "minutes" if work > SLOWER else "half a minute" if work > SLOW else "seconds"
    return Listed(PREFIX + name, case.title, introduction(packaged_text(name)), crossings, takes)


def table(listed: tuple[Listed, ...]) -> str:
    """The list for a person: name, time, size and title of each, and below what it shows."""
    width = max(NARROWEST, shutil.get_terminal_size().columns)
    names, times = (max(len(getattr(one, of)) for one in listed) for of in ("name", "takes"))
    lines = []
    for one in listed:
        lines.append(f"{one.name:<{names}}  {one.takes:<{times}}  {one.crossings:>6} crossings  {one.title}")
        lines.append(textwrap.fill(one.shows, width, initial_indent=" " * 4, subsequent_indent=" " * 4))
    return "\n".join(lines)


def _size(case: Case) -> tuple[int, float]:
    """How many crossings the whole grid has, and a measure of the work of pressing it."""
    from punchform.prepare import prepare
    from punchform.shell import prepare_shell
    from punchform.strokes import strokes_of

    if case.press.ends is not None:
        grid = prepare_shell(case).laid.grid
        return int(grid.crossings.sum()), float(grid.nodes)
    grid = prepare(case).grid
    yields = case.wire.yields
    work = grid.nodes * strokes_of(case.press, yields=yields) * (3 if yields else 1)
    return round(grid.copies * float(grid.node_weight[grid.crossings].sum())), float(work)
