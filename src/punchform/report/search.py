"""The report of a design search: what is best, what holds it back, and how the search came to it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from punchform.case import Case
from punchform.optimise.asking import Answer
from punchform.optimise.downhill import BOTTOM
from punchform.optimise.problem import Question, unit_of
from punchform.optimise.search import Found
from punchform.optimise.search_folder import BEST, DESIGNS, FRONT, TABLE, front_name
from punchform.report.figures.files import save
from punchform.report.figures.picture import Picture
from punchform.report.figures.search import draw_front, draw_search
from punchform.report.page import FIGURES, PAGE, render
from punchform.report.section import Images, Matrix, Rows, Section
from punchform.report.words import size
from punchform.run import Run

MOST_ROWS = 40


def write_search_report(found: Found, case: Case, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    html = render(
        case,
        subtitle="A search for the best design",
        good=found.best.allowed and not _out_of_tolerance(found),
        verdict=sentences(found),
        sections=(Section("front", "The front", matrices=(_front(found),)),) if several(found) else (),
        results=(("The compromise" if several(found) else "The best design", _best_rows(found)),),
        details_title="How it was found",
        details=(("Search", _search_rows(found)),),
        images=_draw(found, folder / FIGURES),
        notes=_failures(found),
        beside=f"{TABLE} (all designs), {FRONT}, {BEST}"
        + (f", {DESIGNS}/{front_name(1)} and on (cases that `punchform form` runs)" if several(found) else ""),
    )
    (folder / PAGE).write_text(html, encoding="utf-8", newline="\n")


def several(found: Found) -> bool:
    """Whether there are several objectives, and so a front."""
    return len(found.question.objectives) > 1


def sentences(found: Found) -> tuple[str, ...]:
    """What a person wants to hear first: what is best, which constraints bind, what limits. No HTML."""
    return (*_what(found), *_out_of_tolerance(found), *_limits(found))


def _out_of_tolerance(found: Found) -> tuple[str, ...]:
    """That the best design does not keep the tolerance of the target, which no constraint asked for."""
    target, rms = found.question.case.target, found.best.evaluation.figures.get("rms")
    if target is None or rms is None or rms <= target.tolerance:
        return ()
    return (
        f"It is out of the {size(target.tolerance, 'mm')} of [target] with {size(rms, 'mm')} rms: compensate its punch "
        f"(`punchform compensate`), or write constraints = {{ rms = {{ most = {target.tolerance:g} }} }}.",
    )


def settings_words(question: Question, answer: Answer) -> str:
    """A design in words, such as "wire.diameter = 0.8315 mm, grid.crossing = welded"."""
    words = []
    for one in question.space.variables:
        value = one.value(float(answer.design[question.space.variables.index(one)]))
        number = isinstance(value, int | float) and not isinstance(value, bool)
        words.append(f"{one.place} = {size(float(str(value)), one.unit, 5) if number else value}")
    return ", ".join(words)


def figures_words(question: Question, answer: Answer) -> str:
    """The asked figures of a design in words."""
    known = [(name, answer.told.get(name)) for name in question.figures]
    return ", ".join(f"{name} {size(value, unit_of(name))}" for name, value in known if value is not None)


def _what(found: Found) -> tuple[str, ...]:
    question, best = found.question, found.best
    told = f"{settings_words(question, best)}: {figures_words(question, best)}"
    if not best.allowed:
        return (
            f"No design of {len(found.answers)} keeps all constraints. Nearest comes {told}.",
            f"It misses {' and '.join(_missed(found))}.",
        )
    if several(found):
        names = " and ".join(", ".join(one.words for one in question.objectives).rsplit(", ", 1))
        return (
            f"{len(found.front)} of {len(found.answers)} designs are beaten by no other in {names}.",
            f"The compromise, nearest to the best of each: {told}.",
        )
    return (f"Best of {len(found.answers)} designs is {told}.", *_against_the_case(found))


def _against_the_case(found: Found) -> tuple[str, ...]:
    """How the best design compares with the case as it stands, where that was tried."""
    at, objective = found.question.space.of(found.question.case), found.question.objectives[0]
    first = found.answers[0]
    if at is None or first.number == found.best.number or (first.design != at).any():
        return ()
    value = first.told.get(objective.figure)
    if value is None:
        return ()
    broken = "" if first.allowed else ", and breaks a constraint"
    return (f"The case as it stands has {objective.figure} {size(value, unit_of(objective.figure))}{broken}.",)


def _missed(found: Found) -> list[str]:
    merit = found.best.merit
    assert merit is not None, "the best design has figures"
    pairs = zip(found.question.limits, merit.excesses, strict=True)
    return [f"{one.words} by {size(100 * float(excess), '%', 2)}" for one, excess in pairs if excess > 0]


def _limits(found: Found) -> tuple[str, ...]:
    """What keeps the best design from being better."""
    words = []
    which = "the compromise" if several(found) else "the best design"
    if found.best.allowed and found.binding:
        words.append(f"What holds {which} back: {', '.join(found.binding)}.")
    for place, end in found.at_end:
        words.append(f"{place} is at the {end} value of its range in {which}: a wider range might do better.")
    if found.best.allowed and not words and found.ended == BOTTOM:
        words.append("No constraint binds and no range ends there: only other variables can do better nearby.")
    return tuple(words)


def _failures(found: Found) -> tuple[str, ...]:
    failed = [answer for answer in found.answers if answer.merit is None]
    return (f"{len(failed)} designs failed, the first of them: {failed[0].why}",) if failed else ()


def _draw(found: Found, folder: Path) -> Images:
    folder.mkdir(parents=True, exist_ok=True)
    pictures: list[tuple[str, str, str, Callable[[Found], Figure], str]] = []
    if several(found):
        caption = (
            "Every pair of objectives. Blue designs are beaten by no other in all objectives together: choose among "
            "them by what matters most; grey ones are beaten. The star is nearest to the best of each."
        )
        pictures.append(("front", "The front", caption, draw_front, "front"))
    caption = (
        "Each objective in the order in which designs were tried. Where the last third brings nothing better, more "
        "evaluations would hardly help; where it still falls, they would."
    )
    pictures.append(("search", "How the search came on", caption, draw_search, "search"))
    drawn = []
    for name, title, words, draw, section in pictures:
        path = folder / f"{name}.png"
        save(draw(found), path)
        drawn.append((Picture(name, title, words, _of(draw, found), True, section), path))
    return tuple(drawn)


def _of(draw: Callable[[Found], Figure], found: Found) -> Callable[[Run], Figure]:
    return lambda run: draw(found)


def _front(found: Found) -> Matrix:
    """The front as a table; of a long one evenly chosen rows, the compromise among them."""
    question, rows = found.question, list(found.front)
    if len(rows) > MOST_ROWS:
        chosen = {round(k * (len(rows) - 1) / (MOST_ROWS - 1)) for k in range(MOST_ROWS)}
        rows = [one for k, one in enumerate(rows) if k in chosen or one.number == found.best.number]
    numbers = {answer.number: count for count, answer in enumerate(found.front, start=1)}
    shown = tuple(
        (
            f"{numbers[one.number]}",
            *(_cell(value) for value in question.space.changes(one.design).values()),
            *(_cell(one.told.get(name)) for name in question.figures),
        )
        for one in rows
    )
    heads = [(one.place, one.unit) for one in question.space.variables] + [
        (name, unit_of(name)) for name in question.figures
    ]
    return Matrix(
        "Designs that no other beats",
        ("front", *(f"{name} [{unit}]" if unit else name for name, unit in heads)),
        shown,
        marked=tuple(k for k, one in enumerate(rows) if one.number == found.best.number),
        note=f"{len(rows)} of {len(found.front)}; the compromise is marked. {FRONT} has all, with all figures.",
        wide=True,
    )


def _cell(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "" if value is None else str(value)
    return size(float(value), "")


def _best_rows(found: Found) -> Rows:
    question, best = found.question, found.best
    changes = question.space.changes(best.design)
    units = {one.place: one.unit for one in question.space.variables}
    settings = (
        (place, f"{_cell(value)} {units[place] if not isinstance(value, str) else ''}".rstrip())
        for place, value in changes.items()
    )
    figures = ((name, size(value, unit_of(name))) for name, value in best.told.items() if value is not None)
    return (*settings, *figures)


def _search_rows(found: Found) -> Rows:
    question = found.question
    return (
        ("Objectives", ", ".join(one.words for one in question.objectives)),
        ("Constraints", ", ".join(one.words for one in question.limits) or "none"),
        ("Method", f"{found.way}: {found.why}"),
        ("Designs evaluated", f"{len(found.answers)} of {question.asked.evaluations} allowed"),
        ("How it ended", found.ended),
        ("Seed", f"{question.asked.seed}"),
    )
