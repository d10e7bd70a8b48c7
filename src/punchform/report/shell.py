"""The report of a gridshell: the same page, without what belongs to a punch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.figure import Figure

from punchform.case import Case
from punchform.export.result import largest
from punchform.gridshell import Gridshell
from punchform.report.figures.conclusions import found
from punchform.report.figures.files import save, save_for_page
from punchform.report.figures.gallery import GALLERY
from punchform.report.figures.picture import Picture
from punchform.report.figures.wires import draw_wires
from punchform.report.numbers import energy_rows, solve_rows, span
from punchform.report.page import FIGURES, PAGE, render
from punchform.report.quantities import STRAIN
from punchform.report.section import Images, Rows
from punchform.report.viewer import pack, scene_of_shell
from punchform.report.words import energy, percent, place, size
from punchform.shell import Shell

if TYPE_CHECKING:
    from punchform.run import Run

SHAPE = Picture(
    "shape",
    "The gridshell",
    "The wires as their ends hold them, true to scale; colour is height, near wires are thicker.",
    draw_wires,
    wide=True,
)
CAPTIONS = {
    "axial_x": "Plan view. Red wires are pulled, blue wires are pressed; the scale goes with the root of the force.",
    "axial_y": "The same for the other family, on the same scale.",
    "stress": "The largest stress in each wire piece, both families. It is largest where the wires bend most.",
}
"""What to see in the other figures of a gridshell, by their names in the gallery."""


@dataclass(frozen=True)
class _View:
    """What these figures look at in a run."""

    case: Case
    formed: Gridshell


def write_shell_report(done: Shell, folder: Path) -> None:
    """Write `folder`/figures/*.png and `folder`/report.html. Raises OSError when the disk refuses."""
    (folder / FIGURES).mkdir(parents=True, exist_ok=True)
    (folder / PAGE).write_text(_page(done, _draw(done, folder / FIGURES, save)), encoding="utf-8", newline="\n")


def shell_page_alone(done: Shell) -> str:
    """The HTML of the report of a gridshell, without files beside it."""
    with TemporaryDirectory() as aside:
        return _page(done, _draw(done, Path(aside), save_for_page))


def _page(done: Shell, images: Images) -> str:
    return render(
        done.case,
        subtitle="A flat grid of wires whose ends are moved to given points: an elastic gridshell",
        good=done.formed.outcome.name == "CONVERGED",
        verdict=_verdict(done.formed),
        results=(("Gridshell", _shell_rows(done)), ("Grid", _grid_rows(done))),
        details_title="Energy and solve",
        details=(("Where the energy is", energy_rows(done.formed)), ("Solve", solve_rows(done.formed))),
        images=images,
        scenes=(pack(scene_of_shell(done)),),
        notes=done.formed.notes,
        beside="nodes.csv and wires.csv (tables), shape.vtp (for ParaView), result.json, case.toml",
    )


def _draw(done: Shell, folder: Path, keep: Callable[[Figure, Path], None]) -> Images:
    whole = done.formed.whole
    missing = set() if np.isfinite(whole.stress).any() else {"stress"}
    others = [
        replace(picture, caption=CAPTIONS[picture.name])
        for picture in GALLERY
        if picture.name in CAPTIONS and picture.name not in missing
    ]
    view = cast("Run", _View(done.case, done.formed))
    drawn = []
    for picture in (SHAPE, *others):
        path = folder / f"{picture.name}.png"
        keep(picture.draw(view), path)
        drawn.append((replace(picture, found=found(picture.name, view)), path))
    return tuple(drawn)


def _verdict(formed: Gridshell) -> tuple[str, ...]:
    if formed.outcome.name == "CONVERGED":
        ending = f"The solve {formed.outcome.value}: the grid stands {place(formed.height)} high"
    else:
        ending = (
            f"The solve did not reach a minimum ({formed.outcome.value}); it left the grid {place(formed.height)} high"
        )
    reaction = float(np.linalg.norm(formed.reactions, axis=1).max())
    stress = largest(formed.whole.stress)
    most = (
        "The stress in the wires is not known, because their stiffness was given as a matrix."
        if stress is None
        else f"The largest stress in a wire is {size(stress, 'MPa', 3)}."
    )
    return (
        f"{ending}, storing {energy(formed.energy)} of elastic energy.",
        f"An end needs up to {size(reaction, 'N', 3)} to be held.",
        most,
        "The ends are held in position and turn freely; there is no gravity.",
    )


def _shell_rows(done: Shell) -> Rows:
    formed, force = done.formed, done.formed.whole.F[:, 0]
    stress, ratio = largest(formed.whole.stress), largest(formed.whole.stress_ratio)
    across = float(np.hypot(formed.reactions[:, 0], formed.reactions[:, 1]).max())
    upright = formed.reactions[:, 2]
    return (
        ("Height above the lowest end", size(formed.height, "mm")),
        ("Elastic energy", energy(formed.energy)),
        ("Largest reaction of an end", size(float(np.linalg.norm(formed.reactions, axis=1).max()), "N")),
        ("Largest reaction along the ground", size(across, "N")),
        ("Reactions along z", span(float(upright.min()), float(upright.max()), "N")),
        ("Axial force in the wires", span(float(force.min()), float(force.max()), "N")),
        (f"Largest {STRAIN.label}", percent(formed.max_axial_strain)),
        ("Largest stress", "not known" if stress is None else size(stress, "MPa")),
        ("Largest stress / yield strength", "not known" if ratio is None else size(ratio, "", 3)),
        ("Largest shear angle", size(math.degrees(formed.max_shear), "°", 4)),
    )


def _grid_rows(done: Shell) -> Rows:
    whole, case = done.formed.whole, done.case
    return (
        ("Nodes", f"{len(whole.positions)}"),
        ("Wire elements", f"{len(whole.family)}"),
        ("Ends that are held", f"{len(done.ends)}"),
        ("Step", " × ".join(f"{step:g} mm" for step in dict.fromkeys(case.grid.step))),
        ("Wire diameter", f"{case.wire.diameter:g} mm"),
    )
