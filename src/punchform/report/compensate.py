"""The report of a compensation: verdict, convergence, the correction and what it does to the deviation."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from punchform.optimise.compensation_files import CONVERGENCE
from punchform.optimise.correction_space import WORDS
from punchform.report.compensate_words import NAMES, explained, remedies, solve_rows
from punchform.report.figures.compensation import (
    draw_after,
    draw_before_and_after,
    draw_convergence,
    draw_correction,
    draw_reach,
    draw_sections,
)
from punchform.report.figures.files import save
from punchform.report.figures.picture import Picture
from punchform.report.page import FIGURES, PAGE, render
from punchform.report.section import Images, Matrix, Rows, Section
from punchform.report.words import size

if TYPE_CHECKING:
    from punchform.optimise.compensated import Compensated

Draw = Callable[["Compensated"], Figure]
FIRST_GUESS = "First guess, if the shape followed the punch one to one"
FOLLOWS = "Follows: which part of the last change of the punch the released shape has taken."


def write_compensation_report(done: Compensated, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    lead = explained(done)
    head, *rows = solve_rows(done)
    marked = tuple(number for number, row in enumerate(rows) if row[-1] == "best")
    table = Matrix("Presses and releases", head, tuple(rows), marked, FOLLOWS, wide=True)
    html = render(
        done.given,
        subtitle="The punch whose released shape is the target",
        good=done.within is not False and (done.moved or done.within is True),
        lead=lead[:1],
        advice=remedies(done),
        verdict=lead[1:],
        sections=(Section("compensation", "How it went", matrices=(table,)),),
        results=(("The punch", _punch_rows(done)), (FIRST_GUESS, _floor_rows(done))),
        details_title="Search",
        details=(("Search", _search_rows(done)), *((("Reach", _reach_rows(done)),) if done.reach else ())),
        images=_draw(done, folder / FIGURES),
        notes=done.notes,
        beside=f"{CONVERGENCE}, result.json, case.toml (the case with the best punch), the files of that punch; other "
        "kinds of surface in folders of their own",
    )
    (folder / PAGE).write_text(html, encoding="utf-8", newline="\n")


def _pictures(done: Compensated) -> list[tuple[str, str, str, Draw, bool]]:
    """Name, title, caption, what draws it, whether it is wide; those that this compensation has."""
    shown: list[tuple[str, str, str, Draw, bool]] = [
        (
            "convergence",
            "How it went",
            "The rms deviation of every press and release, on a logarithmic scale; dotted lines are the floors of each "
            "kind of punch: where a line ends on its floor, only another kind of punch goes lower.",
            draw_convergence,
            False,
        )
    ]
    if done.moved:
        shown += [
            (
                "correction",
                "The correction of the punch",
                "Heights that are added to the profile of the punch, seen from above. Red is higher, blue is lower; "
                "the inner dashed circle is where the correction begins to die out towards the rim.",
                draw_correction,
                False,
            ),
            (
                "before_and_after",
                "Deviation before and after",
                "The judged crossings over the punch as it was and over the corrected one, on one scale: what is pale "
                "on the right has been answered by the punch.",
                draw_before_and_after,
                True,
            ),
            (
                "correction_sections",
                "The correction along three directions",
                "Where the lines lie together a turned punch is as good as a milled one; they part by the lobes "
                "that a lathe cannot make. The dashed line is where the correction begins to die out.",
                draw_sections,
                False,
            ),
            (
                "deviation_after",
                "What is left",
                "The deviation over the corrected punch on a scale of its own: what this kind of surface could not "
                "answer, or what another solve would.",
                draw_after,
                False,
            ),
        ]
    if done.reach is not None:
        shown.append(
            (
                "reach",
                "What the punch can reach",
                "Bars: how much of the squared error lies in each shape that small changes of the punch make. Dots: "
                "how far that shape follows the punch. Bars under low dots, and the last one, are out of its reach.",
                draw_reach,
                False,
            )
        )
    return shown


def _draw(done: Compensated, folder: Path) -> Images:
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for name, title, caption, draw, wide in _pictures(done):
        path = folder / f"{name}.png"
        save(draw(done), path)
        drawn.append((Picture(name, title, caption, _of(draw, done), wide), path))
    return tuple(drawn)


def _of(draw: Draw, done: Compensated) -> Callable[[object], Figure]:
    return lambda run: draw(done)


def _punch_rows(done: Compensated) -> Rows:
    best = done.found.best
    return (
        ("Kind of surface", WORDS[done.kind]),
        ("Largest correction at a crossing", size(best.correction, "mm", 3)),
        (
            "It dies out from, to",
            f"{size(done.found.space.start, '')} to {size(done.found.space.end, 'mm')} from the axis",
        ),
        ("Rms before", size(done.before.rms, "mm")),
        ("Rms after", size(done.after.rms, "mm")),
        ("p95 before, after", f"{size(done.before.p95, 'mm')}, {size(done.after.p95, 'mm')}"),
        ("Largest before, after", f"{size(done.before.largest, 'mm')}, {size(done.after.largest, 'mm')}"),
    )


def _floor_rows(done: Compensated) -> Rows:
    return tuple((NAMES[kind], f"{size(floor, 'mm', 3)} rms would be left") for kind, floor in done.floors.items())


def _search_rows(done: Compensated) -> Rows:
    seconds = sum(one.seconds for one in done.found.solves)
    return (
        ("Ended", done.found.ending.value),
        ("Numbers that were looked for", f"{len(done.found.space.terms)}"),
        ("Seconds", f"{seconds:.1f}"),
    )


def _reach_rows(done: Compensated) -> Rows:
    reach = done.reach
    assert reach is not None
    return (
        ("Singular values of the response", ", ".join(size(value, "", 2) for value in reach.values)),
        ("Share of the squared error in each", ", ".join(size(100 * share, "%", 2) for share in reach.shares)),
        ("Rms in shapes that the punch does not move", size(reach.left, "mm", 3)),
        ("Presses and releases that this took", f"{reach.solves}" if reach.solves else "none, by tangents"),
    )
