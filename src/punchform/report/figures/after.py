"""The figures of what comes after the press: accuracy, release, load; each says what to see in it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from punchform.accuracy import Accuracy, Aligned
from punchform.report.figures.axial import draw_axial
from punchform.report.figures.deviation import draw_deviation, draw_lobes, draw_profiles, draw_spread
from punchform.report.figures.moves import draw_deflection, draw_mode, draw_sag
from punchform.report.figures.picture import Picture
from punchform.report.figures.sections import draw_overlay
from punchform.report.figures.stress import draw_stress
from punchform.report.words import size

if TYPE_CHECKING:
    from punchform.run import Run


def accuracy_pictures(run: Run) -> tuple[Picture, ...]:
    """Maps, spread, profiles and lobes of the deviations; none without a target."""
    accuracy = run.accuracy
    if accuracy is None:
        return ()
    judged = accuracy.aligned
    other = accuracy.fitted if judged is accuracy.as_held else accuracy.as_held
    pictures = [
        Picture(
            "deviation",
            f"Deviation, {judged.name} (judged)",
            f"Plan view of the {stage_words(run)} grid. {_colours(accuracy)} The full circle is the edge of the "
            f"aperture; what is pale is not judged.",
            partial(draw_deviation, accuracy=accuracy, aligned=judged),
        ),
        Picture(
            "deviation_other",
            f"Deviation, {other.name}",
            f"The same, {other.name}. {_other(accuracy)} Each map has its own scale.",
            partial(draw_deviation, accuracy=accuracy, aligned=other),
        ),
        Picture(
            "deviation_histogram",
            "How the deviations are spread",
            f"Share of the weighted area by its deviation, {judged.name}; dashed lines are the tolerance, the full "
            "line is the mean. A heap far from zero is an offset or a wrong depth, a wide one is a wrong shape.",
            partial(_spread, accuracy=accuracy, aligned=judged),
        ),
        Picture(
            "deviation_sections",
            "Deviation along four lines",
            f"The deviation of the nodes on lines through the axis, {judged.name}; the green band is the tolerance. "
            "Where the lines run together the error is one of the profile; where 0° and 90° leave 45° and 135° it has "
            "four lobes; a line that rises from end to end is a tilt.",
            partial(draw_profiles, accuracy=accuracy, aligned=judged),
        ),
    ]
    if judged.harmonics is not None:
        pictures.append(
            Picture(
                "lobes",
                "What the deviation is made of",
                "The rms of its mean and of its parts with m lobes around the axis; the squares of the bars of one "
                "colour add up to the square of its rms, and the figure at a bar is its share of that square in per "
                "cent. m = 0 is an error of the profile, 1 a tilt or a sideways shift, 2 a saddle, 4 what the two "
                "directions of the wires make.",
                partial(_lobes, accuracy=accuracy),
            )
        )
    return tuple(_in_section(picture, "accuracy") for picture in pictures)


def released_pictures(run: Run) -> tuple[Picture, ...]:
    """How the release moved the grid, its wires after that, and the mode of a saddle; none without a release."""
    released = run.released
    if released is None:
        return ()
    i, j = released.whole.index[released.lowest]
    lowest = f" The ring marks the lowest, ({i}, {j})." if released.max_sag < 0 else ""
    target = ", the line is the target inside its aperture" if run.accuracy is not None else ""
    pictures = [
        Picture(
            "sag",
            "How the release moves the crossings",
            f"Plan view: blue crossings sink, red ones rise when the punch has gone.{lowest} Patches that lie between "
            "the wires' directions are the mesh shearing back; a ring near the rim is the bend there letting go.",
            draw_sag,
        ),
        Picture(
            "before_after",
            "Before and after the release",
            f"Crossings within half a step of the section in the tool (grey) and released (blue){target}. The blue "
            "crossings are the shape that leaves the workshop.",
            draw_overlay,
        ),
        Picture(
            "axial_x_released",
            "Axial force after the release, wires along x",
            "Red wires are pulled, blue wires are pressed. What is left pulls or presses against the holds and the "
            "crossings; the scale goes with the root of the force.",
            partial(draw_axial, family=1, whole=released.whole),
        ),
        Picture(
            "axial_y_released",
            "Axial force after the release, wires along y",
            "The same for the other family, on the same scale.",
            partial(draw_axial, family=2, whole=released.whole),
        ),
    ]
    if np.isfinite(released.whole.stress).any():
        pictures.append(
            Picture(
                "stress_released",
                "Stress in the wires after the release",
                _left_in_wires(run),
                partial(draw_stress, whole=released.whole),
            )
        )
    if released.stability.mode is not None:
        pictures.append(
            Picture(
                "mode",
                "The way in which the grid would leave",
                "The lowest mode of the equilibrium that was found: with the least disturbance the grid goes this way "
                "or the opposite one. Colour is the vertical part, arrows the sideways one; the size means nothing.",
                draw_mode,
            )
        )
    return tuple(_in_section(picture, "released") for picture in pictures)


def loaded_pictures(run: Run) -> tuple[Picture, ...]:
    """How the load moves the grid; none without a load."""
    if run.loaded is None:
        return ()
    return (
        Picture(
            "deflection",
            "How the load moves the shape",
            "Plan view of the move along the normals of the released shape: red outwards, blue inwards. Large patches "
            "are where a rib or a support would help most.",
            draw_deflection,
            section="loaded",
        ),
    )


def _left_in_wires(run: Run) -> str:
    """How to read the stress after the release."""
    if run.formed.hardening is not None:
        return (
            "The largest stress in each wire piece, both families: what flowing has locked in, and in dark rings the "
            "bends that the holds keep."
        )
    return (
        "The largest stress in each wire piece, both families. Dark rings are bends that the holds keep; the "
        "mesh springs back further when those yield or are let go."
    )


def stage_words(run: Run) -> str:
    """Of which stage the accuracy is told."""
    return "formed" if run.released is None else "released"


def _in_section(picture: Picture, section: str) -> Picture:
    return Picture(picture.name, picture.title, picture.caption, picture.draw, picture.wide, section)


def _spread(run: Run, accuracy: Accuracy, aligned: Aligned) -> Figure:
    return draw_spread(accuracy, aligned)


def _lobes(run: Run, accuracy: Accuracy) -> Figure:
    return draw_lobes(accuracy)


def _colours(accuracy: Accuracy) -> str:
    signs = f"Colour is the {accuracy.judge.measure} deviation: red lies above the target, blue below."
    if accuracy.judge.tolerance is None:
        return signs
    return f"{signs} Green, within the line, is ±{size(accuracy.judge.tolerance, 'mm', 3)}."


def _other(accuracy: Accuracy) -> str:
    if accuracy.aligned is accuracy.as_held:
        return "What this map still shows cannot be mended by moving or refocusing the dish: it is an error of shape."
    return "What it shows beyond the judged map is a matter of where the dish is mounted and how deep it came out."
