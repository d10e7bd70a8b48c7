"""The report of an inextensible net: the same page, without what only a solve knows."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from punchform.case import Case
from punchform.drape import Drape, Draped, placed
from punchform.export.drape import LENGTHS, OUTLINE, reached_nodes
from punchform.report.figures.conclusions import found
from punchform.report.figures.files import save
from punchform.report.figures.gallery import GALLERY
from punchform.report.figures.picture import Picture
from punchform.report.page import FIGURES, PAGE, render
from punchform.report.section import Rows
from punchform.report.viewer import pack, scene_of_net
from punchform.report.words import drawn_in, size

if TYPE_CHECKING:
    from punchform.run import Run

SHOWN = ("shape", "shear", "sections")


@dataclass(frozen=True)
class _View:
    """What these figures look at in a run."""

    case: Case
    formed: Draped


def write_drape_report(done: Drape, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    net = done.net
    html = render(
        done.case,
        subtitle="A flat grid of wires of constant length laid over a punch: the inextensible net",
        good=net.complete and not net.locked.any(),
        verdict=_verdict(done),
        results=(("Net", _net_rows(done)), ("Flat pattern", _pattern_rows(done))),
        details_title="Effort",
        details=(("Seconds", tuple((part, f"{seconds:.3f}") for part, seconds in done.seconds.items())),),
        images=_draw(done, folder / FIGURES),
        scenes=(pack(scene_of_net(done)),),
        notes=done.notes,
        beside=f"nodes.csv, {OUTLINE} and {LENGTHS} (tables), shape.vtp (for ParaView), result.json, case.toml",
    )
    (folder / PAGE).write_text(html, encoding="utf-8", newline="\n")


def _draw(done: Drape, folder: Path) -> tuple[tuple[Picture, Path], ...]:
    folder.mkdir(parents=True, exist_ok=True)
    shown = placed(done.formed)
    if not len(shown.whole.cells):
        return ()
    view = cast("Run", _View(done.case, shown))
    drawn = []
    for picture in (picture for picture in GALLERY if picture.name in SHOWN):
        path = folder / f"{picture.name}.png"
        save(picture.draw(view), path)
        words = drawn_in(done.draw_in) if picture.name == "sections" else found(picture.name, view)
        drawn.append((replace(picture, found=words), path))
    return tuple(drawn)


def _verdict(done: Drape) -> tuple[str, ...]:
    net = done.net
    nodes, reached = len(done.formed.whole.index), reached_nodes(done)
    placing = (
        f"All {nodes} crossings have a place on the punch with wires of constant length."
        if net.complete
        else f"Only {reached} of {nodes} crossings have a place on the punch with wires of constant length."
    )
    shear = f"The cells shear by up to {size(math.degrees(net.max_shear), '°', 3)}"
    locking = f"the net locks at {size(math.degrees(net.limit), '°', 3)}"
    end = f"{shear}, beyond where {locking}." if net.locked.any() else f"{shear}; {locking}."
    return placing, end, "Forces, bending and contact are not part of this answer: `punchform form` gives them."


def _net_rows(done: Drape) -> Rows:
    net, whole = done.net, done.formed.whole
    return (
        ("Crossings", f"{len(whole.index)} ({reached_nodes(done)} reached)"),
        ("Origin of the grid", f"x = {done.origin[0]:.6g} mm, y = {done.origin[1]:.6g} mm"),
        ("Direction of the first wires", size(math.degrees(done.direction), "°")),
        ("Largest shear angle", size(math.degrees(net.max_shear), "°")),
        ("Shear at which the net locks", size(math.degrees(net.limit), "°")),
        ("Locked cells", f"{int(net.locked.sum()) * (4 if done.grid.quarter else 1)}"),
        ("Largest draw-in of the edge", size(done.draw_in, "mm")),
        ("Depth of the shell", size(float(np.nanmax(whole.positions[:, 2])), "mm")),
    )


def _pattern_rows(done: Drape) -> Rows:
    radius = done.rim.radius[np.isfinite(done.rim.radius)]
    known = bool(radius.size)
    return (
        ("Nearest point that lands on the rim", size(float(radius.min()), "mm", 5) if known else "not known"),
        ("Farthest point that lands on the rim", size(float(radius.max()), "mm", 5) if known else "not known"),
        ("Radius of the rim", size(done.case.tool.rim_radius, "mm")),
        ("Wires", f"{len(done.wires.length)}"),
        ("Length of all wires", size(float(done.wires.length.sum()) / 1000, "m", 5)),
        ("Longest wire", size(float(done.wires.length.max()), "mm", 5)),
    )
