"""The punch: surfaces of revolution, P(1), on which a grid can be pressed."""

from __future__ import annotations

from punchform.case import PunchCase
from punchform.errors import InputError
from punchform.punch.bare import Paraboloid, Sphere, bare, profile_curve
from punchform.punch.domes import dome
from punchform.punch.fillet import rim_arc
from punchform.punch.lowered import lowered
from punchform.punch.meridian import Meridian
from punchform.punch.project import laid_onto, project
from punchform.punch.protocol import Gap, Surface
from punchform.punch.revolution import Revolution
from punchform.punch.segments import Line
from punchform.punch.sharpness import check_sharpness

__all__ = [
    "Gap",
    "Meridian",
    "Paraboloid",
    "Revolution",
    "Sphere",
    "Surface",
    "bare",
    "check_sharpness",
    "laid_onto",
    "lowered",
    "profile_curve",
    "project",
    "surface",
]


def surface(case: PunchCase) -> Revolution:
    """The surface of a punch: profile, rim fillet, and the flange z = 0 from the rim outwards.

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
