"""`punchform optimise`: search for the best design of a case, or for the front of several objectives."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from punchform.case import parse, read_text
from punchform.cli.exits import Exit
from punchform.cli.sweeping import Means, workers_of
from punchform.cli.talk import Talk, notes, say
from punchform.errors import InputError
from punchform.progress import Progress

if TYPE_CHECKING:
    from punchform.optimise.asking import Answer, Ask
    from punchform.optimise.evaluations import Record
    from punchform.optimise.pools import Workers
    from punchform.optimise.problem import Question
    from punchform.optimise.search import Found
    from punchform.optimise.slopes import Slopes


def optimise_case(path: str, output: str, *, means: Means, overwrite: bool, as_json: bool) -> Exit:
    """Search, and write the folder of the search, or go on with it.

    Raises InputError for a case or a folder that cannot be used, NoEquilibrium when no design has figures.
    """
    from punchform.optimise.problem import question_of
    from punchform.optimise.search import way_of
    from punchform.optimise.search_folder import RECORD, open_folder, write_found
    from punchform.report.search import write_search_report

    source = read_text(path)
    case = parse(source)
    try:
        _ = case.tool
        question = question_of(case)
        way, why = way_of(question)
    except InputError as error:
        raise source.placed(error) from None
    with _crew(means, way) as workers:
        folder = open_folder(output, case, overwrite=overwrite)
        found = _found(question, folder / RECORD, workers, means, f"method {way}: {why}")
    text = write_found(folder, found)
    write_search_report(found, case, folder)
    print(text.rstrip() if as_json else summary(found, folder))
    return Exit.DONE if found.best.allowed else Exit.OUT_OF_TOLERANCE


def _found(question: Question, path: Path, workers: Workers | None, means: Means, how: str) -> Found:
    """What the search finds; its record says how much is done when it is interrupted. workers: None downhill."""
    from punchform.optimise.evaluations import Record, recorded
    from punchform.optimise.search import search
    from punchform.optimise.slopes import is_slopes

    try:
        with (
            Record(path) as record,
            Talk(means.voice, at_once=1 if workers is None else workers.count) as talk,
            _evaluates(question, record, workers) as (ask, slopes),
        ):
            notes([how], means.voice)
            if workers is None and (means.workers or means.scheduler):
                idle = "downhill goes one design after the other, here: other workers have nothing to do"
                notes([idle], means.voice)
            known = {evaluation.key for evaluation in record}
            return search(question, ask, slopes=slopes, observe=_Telling(question, talk, known))
    except KeyboardInterrupt:
        kept = sum(not is_slopes(one) for one in recorded(path))
        say(f"note: {kept} designs are done")
        raise


@contextmanager
def _crew(means: Means, way: str) -> Iterator[Workers | None]:
    """Who evaluates designs: the workers that are asked for; None where a search goes downhill, in this process."""
    if way == "gradient":
        yield None
        return
    with workers_of(means) as workers:
        yield workers


@contextmanager
def _evaluates(question: Question, record: Record, workers: Workers | None) -> Iterator[tuple[Ask, Slopes | None]]:
    """What evaluates designs: going downhill one after the other here, with tangents; else the workers."""
    from punchform.optimise.asking import evaluator
    from punchform.optimise.slopes import Kept

    if workers is None:
        kept = Kept(question, record)
        yield kept.ask, kept.slopes
        return
    with evaluator(question.case, record, workers) as ask:
        yield ask, None


class _Telling:
    """Tells how far a search has come; known: keys of the designs that an earlier search has evaluated."""

    def __init__(self, question: Question, talk: Talk, known: Collection[str]) -> None:
        self._question = question
        self._talk = talk
        self._known = known
        self._at_no_cost = 0
        talk(self._far(0))
        self._best: float | None = None

    def __call__(self, answer: Answer) -> None:
        """Tell of one more design."""
        objective = self._question.objectives[0]
        value = answer.told.get(objective.figure)
        if answer.allowed and value is not None and (self._best is None or objective.sign * (value - self._best) < 0):
            self._best = value
        self._at_no_cost += answer.evaluation.key in self._known
        self._talk(self._far(answer.number), known=self._at_no_cost)
        self._talk.show("" if self._best is None else f"best {objective.figure} {self._best:.4g}")

    def _far(self, done: int) -> Progress:
        return Progress("designs", done=done, total=self._question.asked.evaluations, limit=True)


def summary(found: Found, folder: Path) -> str:
    """What a person wants to know first about a search."""
    from punchform.optimise.search_folder import BEST, FRONT
    from punchform.report.search import sentences, several

    lines = [found.question.case.title, *(f"  {one}" for one in sentences(found))]
    lines.append(f"  {len(found.answers)} designs evaluated; {found.ended}")
    lines.append(f"  {'compromise' if several(found) else 'best design':<12}  {folder / BEST}")
    if several(found):
        lines.append(f"  {'front':<12}  {folder / FRONT}")
    lines.append(f"  {'report':<12}  {folder / 'report.html'}")
    return "\n".join(lines)
