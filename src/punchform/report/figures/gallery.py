"""All figures of a run in the order of the report, each with its caption: how to read it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from punchform.report.figures.after import accuracy_pictures, loaded_pictures, released_pictures
from punchform.report.figures.axial import draw_axial
from punchform.report.figures.contact import draw_contact
from punchform.report.figures.picture import Picture
from punchform.report.figures.plastic import yielding_pictures
from punchform.report.figures.progress import draw_progress
from punchform.report.figures.sections import draw_sections
from punchform.report.figures.shape import draw_shape
from punchform.report.figures.shear import draw_shear
from punchform.report.figures.stress import draw_stress

if TYPE_CHECKING:
    from punchform.run import Run

HARDENED = (
    "Plan view. The largest stress in each wire piece, both families, as if each section had yielded throughout. Where "
    "it is above the yield strength the wire has hardened. On fine grids the larger value lies on top."
)
"""How to read the stress of wires that yield."""

GALLERY = (
    Picture(
        "shape",
        "The formed grid",
        "The grid as it lies on the punch, true to scale; colour is height above the plane of the rim. "
        "On fine grids only some of the wires are drawn.",
        draw_shape,
        wide=True,
    ),
    Picture(
        "shear",
        "Shear of the cells",
        "Plan view. Each cell is coloured by how far the angle between its wires has left 90°: zero where "
        "the squares stay square, largest where they close to rhombs. The ring marks one most sheared cell, "
        "the dashed circle is the rim. Cells that shear too far wrinkle or lock.",
        draw_shear,
    ),
    Picture(
        "contact",
        "Contact force on the nodes",
        "Plan view. The force of the tool on each node along the surface normal: where it is red the punch "
        "pushes the grid; where it is blue the grid would lift off, and an upper tool or the rim has to hold "
        "it down. The scale goes with the root of the force.",
        draw_contact,
    ),
    Picture(
        "axial_x",
        "Axial force, wires along x",
        "Plan view, both families on one scale: red wires are pulled, blue wires are pressed. Pressed wires "
        "may buckle out between the crossings. The scale goes with the root of the force, so that small "
        "forces show beside those at the rim.",
        partial(draw_axial, family=1),
    ),
    Picture(
        "axial_y",
        "Axial force, wires along y",
        "The same for the other family, on the same scale.",
        partial(draw_axial, family=2),
    ),
    Picture(
        "stress",
        "Stress in the wires, in the tool",
        "Plan view. The largest stress in each wire piece, both families. Where it passes the yield strength the wire "
        "stays bent, which this elastic answer does not follow. On fine grids the larger value lies on top.",
        draw_stress,
    ),
    Picture(
        "sections",
        "Sections",
        "Formed nodes within half a step of the section against the punch, with the nodes of the flat blank "
        "as ticks at z = 0. The distance between the last tick and the last node is the draw-in.",
        draw_sections,
    ),
    Picture(
        "progress",
        "How the solve went",
        "Energy above its last value and largest entry of its gradient against the step, on logarithmic "
        "scales; of several strokes the last. A Newton solve should end in a steep fall; a flat end means that it has "
        "not converged.",
        draw_progress,
    ),
)


def gallery(run: Run) -> tuple[Picture, ...]:
    """The figures this run can show, section by section: no progress without two recorded steps, no surface without
    a cell, no stress where the stiffness was given, and of the later stages those that the case asks for."""
    missing = set() if len(run.formed.history) > 1 else {"progress"}
    if not len(run.formed.whole.cells):
        missing |= {"shape", "shear"}
    if not np.isfinite(run.formed.whole.stress).any():
        missing |= {"stress"}
    after = (*accuracy_pictures(run), *released_pictures(run), *loaded_pictures(run), *yielding_pictures(run))
    return (*after, *(_fitting(run, picture) for picture in GALLERY if picture.name not in missing))


def _fitting(run: Run, picture: Picture) -> Picture:
    """The picture with the caption that fits the wire: an elastic answer does not follow what yields."""
    if picture.name != "stress" or run.formed.hardening is None:
        return picture
    return replace(picture, caption=HARDENED)
