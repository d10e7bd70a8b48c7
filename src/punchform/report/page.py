"""report.html: one page with the verdict, numbers and figures of a run, complete in itself, readable
offline."""

from __future__ import annotations

import base64
import math
import platform
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from punchform import __version__
from punchform.case import write_case
from punchform.export.result import all_notes, largest
from punchform.export.told import compared, told
from punchform.report.accuracy_words import accuracy_lead, advice
from punchform.report.after import after_sections
from punchform.report.figures.gallery import gallery
from punchform.report.figures.style import save
from punchform.report.release_words import load_words, release_words
from punchform.report.section import Images, Section, Tables
from punchform.report.section import Rows as Rows
from punchform.report.stages import stage_sections
from punchform.report.viewer import Packed, pack, program, scene_of, style
from punchform.report.words import energy, percent, size, verdict
from punchform.report.yielding import yielding_sections

if TYPE_CHECKING:
    from punchform.case import Case
    from punchform.run import Run
    from punchform.solved import Solved

PAGE, FIGURES = "report.html", "figures"
CODE = re.compile("`([^`]+)`")
SHOWN = 20
"""Entries of a long list of the case that the page shows."""
LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")
AFTER = ("accuracy", "released", "loaded")
"""Sections whose pictures compare the grid in the tool with what is left of it."""
KINDS = {
    "stretch": "stretching",
    "bend": "bending out of the surface",
    "in_plane": "bending in the surface",
    "twist": "twisting",
    "crossing": "turning of the crossings",
}


def write_report(run: Run, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    images = draw_figures(run, folder / FIGURES)
    (folder / PAGE).write_text(page(run, images), encoding="utf-8", newline="\n")


def draw_figures(run: Run, folder: Path) -> Images:
    """Draw every figure of the run into a folder, made if need be; each with the file that shows it."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    shown, left = told(run), compared(run)
    for picture in gallery(shown):
        path = folder / f"{picture.name}.png"
        save(picture.draw(left if picture.section in AFTER else shown), path)
        drawn.append((picture, path))
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
        verdict=(*release_words(left), *load_words(left), *press_words(told(run))),
        sections=(*stage_sections(run), *after_sections(left), *yielding_sections(told(run))),
        results=(("In the tool", _result_rows(run)), ("Grid and tool", _grid_rows(run))),
        details_title="Energy and solve",
        details=(
            ("Where the energy is", energy_rows(run.formed)),
            ("Solve", solve_rows(run.formed)),
            *_stroke_tables(run),
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
    case: Case,
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
    lead: tuple[str, ...] = (),
    advice: tuple[str, ...] = (),
    sections: tuple[Section, ...] = (),
    scenes: tuple[Packed, ...] = (),
) -> str:
    """A page of words, tables and figures on a case; images are embedded, and all text from the case is escaped.

    lead: what comes first; sections: told before the results, each with the images that belong to it;
    scenes: what the 3D viewers after the verdict show.
    """
    figures = [(picture, _embedded(path)) for picture, path in images]
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
        title=case.title or "Formed grid",
        subtitle=subtitle,
        good=good,
        lead=lead,
        advice=advice,
        verdict=verdict,
        sections=[(section, [pair for pair in figures if pair[0].section == section.name]) for section in sections],
        results=results,
        details_title=details_title,
        details=details,
        figures=[pair for pair in figures if pair[0].section not in named],
        notes=notes,
        case_text=cut(write_case(case)),
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


def _embedded(path: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def _result_rows(run: Run) -> Rows:
    formed = run.formed
    contact, force = formed.whole.contact, formed.whole.F[:, 0]
    stress, ratio = largest(formed.whole.stress), largest(formed.whole.stress_ratio)
    return (
        ("Elastic energy of the whole grid", energy(formed.energy)),
        ("Largest shear angle", size(math.degrees(formed.max_shear), "°", 4)),
        ("Largest draw-in of the edge", size(formed.draw_in, "mm")),
        ("Axial force in the wires", span(float(force.min()), float(force.max()), "N")),
        (
            "Largest elongation of a wire" if formed.hardening else "Largest strain of a wire by its pull",
            percent(formed.max_axial_strain),
        ),
        ("Largest stress", "not known" if stress is None else size(stress, "MPa")),
        ("Largest stress / yield strength", "not known" if ratio is None else size(ratio, "", 3)),
        ("Contact force on a node", span(float(contact.min()), float(contact.max()), "N")),
        ("Downward force of the punch", size(formed.push, "N")),
        *_holder_rows(run),
    )


def _holder_rows(run: Run) -> Rows:
    """What the holder did, where there is one."""
    grip = run.formed.grip
    if grip is None:
        return ()
    return (
        ("Work against the friction of the holder", energy(grip.work)),
        ("Longest slip through the holder", size(grip.largest_slip, "mm")),
        ("Crossings that slipped, of those in the holder at first", percent(grip.slipped)),
    )


def _grid_rows(run: Run) -> Rows:
    whole, case = run.formed.whole, run.case
    return (
        ("Nodes", f"{len(whole.positions)} ({run.formed.solved_nodes} solved)"),
        ("Wire elements", f"{len(whole.family)}"),
        ("Step", " × ".join(f"{step:g} mm" for step in dict.fromkeys(case.grid.step))),
        ("Wire diameter", f"{case.wire.diameter:g} mm"),
        ("Radius of the rim", f"{case.tool.rim_radius:g} mm"),
        ("Depth of the shell", size(float(whole.positions[:, 2].max()), "mm")),
    )


def energy_rows(stage: Solved) -> Rows:
    """Where the energy of a stage is."""
    total, kinds = stage.energy or 1.0, stage.energy_kinds
    rows = [
        (f"in {KINDS.get(kind, kind)}", f"{energy(part)} ({percent(part / total)})") for kind, part in kinds.items()
    ]
    if min(kinds.values(), default=0.0) < 0:
        rows.append(("A part can be negative: the crimp couples the ways to deform.", ""))
    return tuple(rows)


def solve_rows(stage: Solved) -> Rows:
    """How the solve of a stage went."""
    negative = stage.negative_eigenvalues
    return (
        ("Ended", stage.outcome.value),
        ("Steps", f"{stage.steps}"),
        ("Factorisations", f"{stage.factorisations} ({stage.linear_solver})"),
        ("Negative eigenvalues at the end", "not counted" if negative is None else f"{negative}"),
        *((f"Seconds: {part}", f"{seconds:.2f}") for part, seconds in stage.seconds.items()),
    )


def _stroke_tables(run: Run) -> Tables:
    """How the strokes went, where there was more than one."""
    strokes = run.formed.strokes
    if len(strokes) < 2:
        return ()
    rows = []
    for stroke in strokes:
        rubbed = "" if run.formed.grip is None else f", {energy(stroke.friction_work)} of friction"
        told = f"{energy(stroke.energy)} in the wires{rubbed}; {stroke.factorisations} factorisations"
        rows.append((f"Down to {percent(stroke.share)} of the depth", told))
    return (("Strokes", tuple(rows)),)


def span(low: float, high: float, unit: str) -> str:
    """A range in words: from low to high."""
    return f"{size(low, '')} to {size(high, unit)}"


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
