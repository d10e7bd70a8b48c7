"""report.html: one page with the verdict, numbers and figures of a run, complete in itself, readable
offline."""

from __future__ import annotations

import platform
import re
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape
from matplotlib.figure import Figure

from punchform import __version__
from punchform.case import write_case
from punchform.export.result import all_notes
from punchform.export.told import compared, told
from punchform.progress import Observer, Progress, silent
from punchform.report.accuracy_words import accuracy_lead, advice
from punchform.report.after import after_sections
from punchform.report.figures.conclusions import found
from punchform.report.figures.files import address, save, save_for_page
from punchform.report.figures.gallery import gallery
from punchform.report.numbers import energy_rows, grid_rows, result_rows, solve_rows, stroke_tables
from punchform.report.release_words import load_words, release_words
from punchform.report.section import Images, Rows, Section, Tables
from punchform.report.stages import stage_sections
from punchform.report.viewer import Packed, pack, program, scene_of, style
from punchform.report.words import tiles, verdict
from punchform.report.yielding import yielding_sections

if TYPE_CHECKING:
    from punchform.case import Case
    from punchform.run import Run

PAGE, FIGURES = "report.html", "figures"
CODE = re.compile("`([^`]+)`")
SHOWN = 20
"""Entries of a long list of the case that the page shows."""
LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")
AFTER = ("accuracy", "released", "loaded")
"""Sections whose pictures compare the grid in the tool with what is left of it."""


def write_report(run: Run, folder: Path, *, observe: Observer = silent) -> None:
    """Write `folder`/figures/*.png and *.svg, and `folder`/report.html. Raises OSError when the disk refuses.

    observe: hears of every figure that is drawn.
    """
    images = draw_figures(run, folder / FIGURES, observe=observe)
    (folder / PAGE).write_text(page(run, images), encoding="utf-8", newline="\n")


def page_alone(run: Run) -> str:
    """The HTML of the report of a run, without files beside it."""
    with TemporaryDirectory() as aside:
        return page(run, draw_figures(run, Path(aside), save_for_page))


def draw_figures(
    run: Run, folder: Path, keep: Callable[[Figure, Path], None] = save, *, observe: Observer = silent
) -> Images:
    """Draw every figure of the run into a folder, made if need be; each with the file that shows it.

    keep: how a figure becomes files; observe: hears how many of them are drawn.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    shown, left = told(run), compared(run)
    pictures = gallery(shown)
    for number, picture in enumerate(pictures):
        observe(Progress(FIGURES, done=number, total=len(pictures)))
        path = folder / f"{picture.name}.png"
        of = left if picture.section in AFTER else shown
        keep(picture.draw(of), path)
        drawn.append((replace(picture, found=found(picture.name, of)), path))
    observe(Progress(FIGURES, done=len(pictures), total=len(pictures)))
    return tuple(drawn)


def page(run: Run, images: Images) -> str:
    """The HTML of the report of a run."""
    left = compared(run)
    return render(
        run.case,
        subtitle="A flat grid of wires formed over a punch: what punchform expects",
        good=is_good(run),
        lead=accuracy_lead(left),
        advice=advice(left),
        tiles=tiles(left),
        verdict=release_words(left),
        further=(load_words(left), press_words(told(run))),
        sections=(*stage_sections(run), *after_sections(left), *yielding_sections(told(run))),
        results=(("In the tool", result_rows(run)), ("Grid and tool", grid_rows(run))),
        details_title="Energy and solve",
        details=(
            ("Where the energy is", energy_rows(run.formed)),
            ("Solve", solve_rows(run.formed)),
            *stroke_tables(run),
        ),
        images=images,
        scenes=(pack(scene_of(run)),),
        notes=all_notes(run),
        beside="nodes.csv and wires*.csv (tables), shape.vtp (for ParaView), result.json, case.toml",
    )


def is_good(run: Run) -> bool:
    """Whether all stages ended in a minimum that the whole grid keeps, within the tolerance."""
    shown = told(run)
    stages = [stage for stage in (shown.formed, shown.released, shown.loaded) if stage is not None]
    leaves = shown.released is not None and bool(shown.released.stability.negative)
    out = run.accuracy is not None and run.accuracy.within is False
    return all(stage.outcome.name == "CONVERGED" for stage in stages) and not leaves and not out


def press_words(run: Run) -> tuple[str, ...]:
    """The verdict on the press, introduced where other stages are told of before it."""
    said = verdict(run)
    return (
        said
        if run.released is None and run.accuracy is None
        else (f"In the tool {said[0][:1].lower()}{said[0][1:]}", *said[1:])
    )


def render(
    case: Case | None,
    *,
    subtitle: str,
    good: bool,
    verdict: tuple[str, ...],
    results: Tables,
    details_title: str,
    details: Tables,
    images: Images,
    notes: tuple[str, ...],
    beside: str,
    title: str = "",
    lead: tuple[str, ...] = (),
    tiles: Rows = (),
    advice: tuple[str, ...] = (),
    further: tuple[tuple[str, ...], ...] = (),
    sections: tuple[Section, ...] = (),
    scenes: tuple[Packed, ...] = (),
) -> str:
    """A page of words, tables and figures on a case; images are embedded, and all text from the case is escaped.

    case: None for a page on several, which needs a title; lead: what comes first; tiles: the few figures that are asked
    for first; verdict and further: paragraphs after that; sections: told before the results, each with the images that
    belong to it; scenes: what the 3D viewers after the verdict show.
    """
    figures = [(picture, address(path)) for picture, path in images]
    named = {section.name for section in sections}
    environment = Environment(
        loader=PackageLoader("punchform.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["spoken"] = spoken
    return environment.get_template("report.html.j2").render(
        title=title or (case and case.title) or "Formed grid",
        subtitle=subtitle,
        good=good,
        lead=lead,
        advice=advice,
        tiles=tiles,
        paragraphs=[paragraph for paragraph in (verdict, *further) if paragraph],
        sections=[(section, [pair for pair in figures if pair[0].section == section.name]) for section in sections],
        results=results,
        details_title=details_title,
        details=details,
        figures=[pair for pair in figures if pair[0].section not in named],
        notes=notes,
        case_text="" if case is None else cut(write_case(case)),
        beside=beside,
        versions=_versions(),
        scenes=scenes,
        viewer_program=program() if scenes else "",
        viewer_style=style() if scenes else "",
    )


def cut(case_text: str, shown: int = SHOWN) -> str:
    """A case without the later entries of its longest lists: many points are read in the file, not on the page.

    >>> print(cut("points = [\\n" + "    [0, 0],\\n" * 9 + "]", shown=2))
    points = [
        [0, 0],
        [0, 0],
        # 7 more in case.toml
    ]
    """

    def shorter(rows: re.Match[str]) -> str:
        lines = rows[0].splitlines(keepends=True)
        return "".join(lines[:shown]) + f"    # {len(lines) - shown} more in case.toml\n"

    return re.sub(rf"(?:    .*\n){{{2 * shown},}}", shorter, case_text)


def spoken(text: str) -> Markup:
    """A sentence as HTML: escaped, with `settings` between backticks set as code."""
    return Markup(CODE.sub(r"<code>\1</code>", str(escape(text))))


def _versions() -> str:
    return ", ".join(
        (
            f"punchform {__version__}",
            f"Python {platform.python_version()}",
            *(f"{name} {found}" for name in LIBRARIES if (found := _installed(name))),
        )
    )


def _installed(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
