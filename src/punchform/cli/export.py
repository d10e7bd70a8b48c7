"""`punchform export`: a run as files for the workshop, other programs and measuring machines."""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory

from punchform import __version__
from punchform.case import Case, write_case
from punchform.cli.exits import Exit
from punchform.cli.talk import notes, say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.formats import FORMATS
from punchform.export.heading import UNITS, frame_of
from punchform.export.result import RESULT_SCHEMA
from punchform.run import Run
from punchform.shell import Shell
from punchform.store import CASE, RESULT, check_folder, keep_apart, load, write_folder


def export_run(run: str, to: list[str], output: str, *, overwrite: bool, voice: Voice, as_json: bool) -> Exit:
    """Write the files of a run folder in the formats named, or in all of them that can be written here and show it.

    Raises InputError for a folder that is not a run, for one that cannot be written or would replace the run, and for
    what a format cannot show.
    """
    keep_apart(output, run)
    check_folder(output, overwrite=overwrite)
    done = load(run)
    names = tuple(FORMATS) if "all" in to else tuple(dict.fromkeys(to))
    files: list[dict[str, str]] = []

    def write(folder: Path) -> None:
        for name in names:
            if voice is not Voice.QUIET:
                say(f"writing {name}: {FORMATS[name].what}")
            try:
                written = _written(name, done, folder)
            except InputError as error:
                if name in to:
                    raise
                notes([f"{name} is left out: {error.problems[0].message}"], voice)
                continue
            files.extend({"name": file.name, "format": name} for file in written)
        (folder / CASE).write_text(write_case(done.case), encoding="utf-8", newline="\n")
        (folder / RESULT).write_text(_result(done.case, files), encoding="utf-8", newline="\n")

    folder = write_folder(output, write, overwrite=overwrite)
    print(_result(done.case, files).rstrip() if as_json else _summary(files, folder))
    return Exit.DONE


def _written(name: str, done: Run | Shell, folder: Path) -> tuple[Path, ...]:
    """The files of a format, all of them or none."""
    with TemporaryDirectory(dir=folder, prefix=".") as aside:
        files = FORMATS[name].write(done, Path(aside))
        return tuple(file.rename(folder / file.name) for file in files)


def _result(case: Case, files: list[dict[str, str]]) -> str:
    content = {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "case_title": case.title,
        "units": UNITS,
        "frame": frame_of(case),
        "files": files,
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _summary(files: list[dict[str, str]], folder: Path) -> str:
    width = max(len(file["format"]) for file in files)
    return "\n".join(
        [f"{len(files)} files in {folder}", *(f"  {one['format']:<{width}}  {one['name']}" for one in files)]
    )
