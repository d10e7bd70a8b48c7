"""`punchform report`: the report of a run anew, or several runs on one page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from punchform.cli.exits import Exit
from punchform.cli.talk import say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.report.page import FIGURES, PAGE, page_alone, write_report
from punchform.report.shell import shell_page_alone, write_shell_report
from punchform.report.side_by_side import Side, comparison_json, sides
from punchform.report.side_page import comparison_page, table_lines
from punchform.report.side_words import comparison_words, nearest
from punchform.run import Run
from punchform.shell import Shell
from punchform.store import RESULT, load, load_run, replace_file


def report(runs: list[str], output: str | None, *, overwrite: bool, voice: Voice, as_json: bool) -> Exit:
    """Render the report of a run anew, into its folder or a file, or several runs on one page, into a file.

    Raises InputError for a folder that is not a run or is named twice, and for a file that is there or cannot be
    written. It judges nothing anew: a run out of tolerance is no failure here.
    """
    folders = _each_once(runs)
    target = None if output is None else _free(output, folders, overwrite=overwrite)
    if len(folders) == 1:
        return _one(runs[0], folders[0], target, voice=voice, as_json=as_json)
    found = sides(_named(runs, folders))
    words = comparison_words(found)
    if target is not None:
        if voice is not Voice.QUIET:
            say(f"drawing {len(found)} runs side by side")
        _write(target, comparison_page(found), str(output))
    elif voice is not Voice.QUIET:
        say("note: -o FILE writes the page with the figures side by side")
    print(comparison_json(found, words, nearest(found)).rstrip() if as_json else _summary(found, words, target))
    return Exit.DONE


def _one(name: str, folder: Path, target: Path | None, *, voice: Voice, as_json: bool) -> Exit:
    """The report of one run, whole or not at all: into a file of its own, or with its figures into the folder."""
    done = load(name)
    if voice is not Voice.QUIET:
        say(f"drawing the report of {done.case.title or folder.name}")
    if target is None:
        _into(done, folder)
    else:
        _write(target, shell_page_alone(done) if isinstance(done, Shell) else page_alone(done), str(target))
    where = folder / PAGE if target is None else target
    print((folder / RESULT).read_text(encoding="utf-8").rstrip() if as_json else f"report: {where}")
    return Exit.DONE


def _into(done: Run | Shell, folder: Path) -> None:
    """Put the report with its figures into the folder of the run, once it has been drawn elsewhere."""
    with TemporaryDirectory() as aside:
        new = Path(aside)
        if isinstance(done, Shell):
            write_shell_report(done, new)
        else:
            write_report(done, new)
        try:
            (folder / FIGURES).mkdir(exist_ok=True)
            for figure in sorted((new / FIGURES).iterdir()):
                (folder / FIGURES / figure.name).write_bytes(figure.read_bytes())
        except OSError as problem:
            raise _unwritten(problem, str(folder)) from problem
        _write(folder / PAGE, (new / PAGE).read_text(encoding="utf-8"), str(folder))


def _summary(found: Sequence[Side], words: Sequence[str], target: Path | None) -> str:
    told = [*table_lines(found), "", *(word.replace("`", "") for word in words)]
    return "\n".join([*told, *([] if target is None else [f"report: {target}"])])


def _each_once(runs: Sequence[str]) -> list[Path]:
    """The folders of the runs. Raises InputError for one that is named twice."""
    folders: list[Path] = []
    for name in runs:
        folder = Path(os.path.expanduser(name)).resolve()
        if folder in folders:
            raise InputError.of("the run is named twice", where=name, hint="compare runs of different folders")
        folders.append(folder)
    return folders


def _named(runs: Sequence[str], folders: Sequence[Path]) -> list[tuple[str, Run]]:
    """The runs by the names of their folders, or by their whole paths where two folders have one name."""
    short = [folder.name for folder in folders]
    names = short if len(set(short)) == len(short) else [name.rstrip("/") for name in runs]
    return [(name, load_run(run)) for name, run in zip(names, runs, strict=True)]


def _free(output: str, folders: Sequence[Path], *, overwrite: bool) -> Path:
    """The file to write. Raises InputError for one that is there, for a folder, and for no folder to put it in."""
    target = Path(os.path.expanduser(output))
    if target.is_dir():
        raise InputError.of("is a folder; the page is one file", where=output, hint=f"such as {target / PAGE}")
    if not target.parent.is_dir():
        raise InputError.of(f"there is no folder {target.parent}", where=output)
    if any(target.resolve().parent == folder and target.name != PAGE for folder in folders):
        raise InputError.of("the page would stand among the files of a run", where=output, hint="name another folder")
    if target.exists() and not overwrite:
        raise InputError.of("the file exists", where=output, hint="give --overwrite to replace it")
    return target


def _write(target: Path, page: str, where: str) -> None:
    try:
        replace_file(target, page)
    except OSError as problem:
        raise _unwritten(problem, where) from problem


def _unwritten(problem: OSError, where: str) -> InputError:
    return InputError.of(
        f"the report could not be written: {problem.strerror or problem}",
        where=where,
        hint="check the free space and your rights there, or name another file",
    )
