"""`punchform export`: a run as files for the workshop, other programs and measuring machines."""

from __future__ import annotations

import json
from pathlib import Path

from punchform import __version__
from punchform.case import write_case
from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.formats import FORMATS
from punchform.export.heading import FRAME, UNITS
from punchform.export.result import RESULT_SCHEMA
from punchform.store import CASE, RESULT, check_folder, load_run, write_folder


def export_run(run: str, to: list[str], output: str, *, overwrite: bool, voice: Voice, as_json: bool) -> Exit:
    """Write the files of a run folder in the formats named, or in all of them that can be written here and show it.

    Raises InputError for a folder that is not a run or cannot be written, and for what a format cannot show.
    """
    check_folder(output, overwrite=overwrite)
    done = load_run(run)
    names = tuple(dict.fromkeys(to))
    if "all" in names:
        names = tuple(name for name, one in FORMATS.items() if one.there or name in to)
        for name in FORMATS.keys() - set(names):
            say(f"note: {name} is left out: the extra that it needs is not installed (`--to {name}` says which)")
    files: list[dict[str, str]] = []

    def write(folder: Path) -> None:
        for name in names:
            if voice is not Voice.QUIET:
                say(f"writing {name}: {FORMATS[name].what}")
            try:
                written = FORMATS[name].write(done, folder)
            except InputError as error:
                if name in to:
                    raise
                say(f"note: {name} is left out: {error.problems[0].message}")
                continue
            files.extend({"name": file.name, "format": name} for file in written)
        (folder / CASE).write_text(write_case(done.case), encoding="utf-8", newline="\n")
        (folder / RESULT).write_text(_result(done.case.title, files), encoding="utf-8", newline="\n")

    folder = write_folder(output, write, overwrite=overwrite)
    print(_result(done.case.title, files).rstrip() if as_json else _summary(files, folder))
    return Exit.DONE


def _result(title: str, files: list[dict[str, str]]) -> str:
    content = {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "case_title": title,
        "units": UNITS,
        "frame": FRAME,
        "files": files,
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _summary(files: list[dict[str, str]], folder: Path) -> str:
    width = max(len(file["format"]) for file in files)
    return "\n".join(
        [f"{len(files)} files in {folder}", *(f"  {one['format']:<{width}}  {one['name']}" for one in files)]
    )
