"""`punchform sensitivity`: which numbers of a case matter, and what tolerance each needs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from punchform.case import Case, number, parse, read_text, write_case
from punchform.case.parts import Quantity
from punchform.cli.exits import Exit
from punchform.cli.sweeping import Means, workers_of
from punchform.cli.talk import Talk, say
from punchform.cli.voice import Voice
from punchform.errors import InputError
from punchform.export.result import plain
from punchform.optimise.figures import figure
from punchform.optimise.looks import Many, Seen, shared
from punchform.optimise.sensitivity import sensitivities
from punchform.optimise.tolerance_table import Table, csv, result, table
from punchform.progress import Observer, Progress
from punchform.report.sensitivity import lines, words, write_sensitivity_report
from punchform.run import run
from punchform.store import CASE, RESULT, check_folder, write_folder
from punchform.units import LENGTH, UnitError

TABLE = "sensitivity.csv"


def sensitivity(
    path: str,
    output: str | None,
    *,
    of: list[str],
    vary: list[str],
    allowed: str | None,
    workers: int | None,
    overwrite: bool,
    voice: Voice,
    as_json: bool,
) -> Exit:
    """Run a case, find what its figures depend on, print the table, and write the folder when one is named.

    of: names of figures; vary: places of numbers, all when there are none; allowed: the rms to keep. Raises InputError
    and NoEquilibrium as a run does.
    """
    source = read_text(path)
    case = parse(source)
    if output is not None:
        check_folder(output, overwrite=overwrite)
    names, keep = tuple(dict.fromkeys(of)) or ("rms",), _allowed(allowed)
    for name in names:
        _demand_known(name, case)
    for place in vary:
        number(case, place)
    if case.target is not None and keep is None:
        keep = case.target.tolerance
    with workers_of(Means(workers, None, voice)) as crew, Talk(voice, at_once=crew.count) as talk:
        try:
            found = sensitivities(run(case, observe=talk), vary or None, names=names, many=counted(shared(crew), talk))
        except InputError as error:
            raise source.placed(error) from None
    tables = tuple(table(found, name, keep) for name in names)
    content = json.dumps(plain(result(tables)), indent=2, ensure_ascii=False)
    print(content if as_json else text(tables))
    if output is not None:

        def write(folder: Path) -> None:
            (folder / CASE).write_text(write_case(case), encoding="utf-8", newline="\n")
            (folder / RESULT).write_text(content + "\n", encoding="utf-8", newline="\n")
            for one in tables:
                name = TABLE if len(tables) == 1 else f"sensitivity_{one.figure}.csv"
                (folder / name).write_text(csv(one), encoding="utf-8", newline="\n")
            write_sensitivity_report(tables, folder)

        folder = write_folder(output, write, overwrite=overwrite)
        if voice is not Voice.QUIET:
            say(f"report: {folder / 'report.html'}")
    return Exit.DONE


def counted(many: Many, observe: Observer) -> Many:
    """The same runs, telling how many of them are done."""

    def counting(cases: Sequence[Case], names: Sequence[str]) -> Iterator[Seen | str]:
        observe(Progress("runs", total=len(cases)))
        for finished, one in enumerate(many(cases, names), start=1):
            observe(Progress("runs", done=finished, total=len(cases)))
            yield one

    return counting


def text(tables: tuple[Table, ...]) -> str:
    """All tables, each with what to conclude."""
    parts = [tables[0].whole.case.title]
    for one in tables:
        parts += ["", *lines(one), "", *(f"  {sentence}" for sentence in words(one))]
    return "\n".join(parts)


def _demand_known(name: str, case: Case) -> None:
    if figure(name).deviation is not None and case.target is None:
        raise InputError.of(
            f"`{name}` is not known without a [target]",
            where="target",
            hint="say which shape is wanted, or ask for another figure, such as --of max_shear",
        )


def _allowed(given: str | None) -> float | None:
    if given is None:
        return None
    try:
        return Quantity(LENGTH, above=0.0).read(given)
    except UnitError as problem:
        raise InputError.of(
            problem.message, where=f"--allowed {given}", hint=problem.hint or "such as '0.5 mm'"
        ) from problem
