"""The punch: surfaces of revolution, P(1), on which a grid can be pressed."""

from __future__ import annotations

import numpy as np

from punchform.case import FieldPoints, PunchCase, RadialPoints
from punchform.errors import InputError
from punchform.punch.bare import Paraboloid, Sphere, bare, profile_curve
from punchform.punch.corrected import Corrected, Tool, corrected
from punchform.punch.correction import Correction, HeightField, RadialCorrection, Rise
from punchform.punch.domes import dome
from punchform.punch.fillet import rim_arc
from punchform.punch.gentle import check_correction
from punchform.punch.lowered import lowered
from punchform.punch.meridian import Meridian
from punchform.punch.project import laid_onto, project
from punchform.punch.protocol import Gap, Surface
from punchform.punch.revolution import Revolution
from punchform.punch.section import is_turned, points_needed, section, section_angles
from punchform.punch.segments import Line
from punchform.punch.sharpness import check_sharpness

__all__ = [
    "Corrected",
    "Correction",
    "Gap",
    "HeightField",
    "Meridian",
    "Paraboloid",
    "RadialCorrection",
    "Revolution",
    "Rise",
    "Sphere",
    "Surface",
    "Tool",
    "bare",
    "check_correction",
    "check_sharpness",
    "corrected",
    "correction_of",
    "is_turned",
    "laid_onto",
    "lowered",
    "points_needed",
    "profile_curve",
    "project",
    "section",
    "section_angles",
    "surface",
    "uncorrected",
]


def surface(case: PunchCase) -> Tool:
    """The surface of a punch: profile, rim fillet, the flange z = 0 from the rim outwards, and its correction.

    Raises InputError when the fillet does not fit, or the profile is not defined, not smooth, or not a dome, or the
    correction does not die out.
    """
    return corrected(uncorrected(case), correction_of(case))


def correction_of(case: PunchCase) -> Correction | None:
    """The correction of a punch, None without one. Raises InputError when it does not die out."""
    match case.correction:
        case FieldPoints(grid=(x, y, dz)):
            return HeightField(np.array(x), np.array(y), np.array(dz))
        case RadialPoints(points=points):
            rho, heights = np.array(points).T
            return RadialCorrection(rho, heights)
    return None


def uncorrected(case: PunchCase) -> Revolution:
    """The surface of revolution of a punch: profile, rim fillet, and the flange z = 0 from the rim outwards.

    Raises InputError when the fillet does not fit, or the profile is not defined, not smooth, or not a dome.
    """
    if case.fillet <= 0:
        raise InputError.of(
            "a fillet of 0 makes a sharp edge at the rim, around which no wire can be bent",
            where="punch.fillet",
            hint="give the radius of the die's edge, at least two grid steps",
        )
    inside = dome(case.profile, case.rim_radius, case.fillet)
    fillet = rim_arc(case.rim_radius, case.fillet, inside.angle)
    flange = Line((case.rim_radius, 0.0), (1.0, 0.0), float("inf"))
    return Revolution(Meridian((*inside.segments, fillet, flange)), case.rim_radius)
