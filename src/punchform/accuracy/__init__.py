"""The accuracy room: how near a shape comes to its target, Eqs. (9.1)-(9.18). Pure functions of arrays."""

from punchform.accuracy.crown import MIDDLE, WireSurface, wire_surface
from punchform.accuracy.deviation import MEASURES, Deviations, Measure, deviations, feet, offset, slopes
from punchform.accuracy.facets import Facets, facets, square_cell, triangle_sigma
from punchform.accuracy.fit import ALIGNMENTS, Fit, best_fit, implied_shift
from punchform.accuracy.gradient import Judged, judged_at, rms_gradient
from punchform.accuracy.harmonics import Harmonic, Harmonics, harmonics
from punchform.accuracy.hidden import hidden_error
from punchform.accuracy.measure import Accuracy, Aligned, Judge, measure, measure_case
from punchform.accuracy.plain import plain
from punchform.accuracy.statistics import Statistics, statistics
from punchform.accuracy.target import PARAMETERS, Pose, Target, place
from punchform.accuracy.weights import Aperture, tributary_areas

__all__ = [
    "ALIGNMENTS",
    "MEASURES",
    "MIDDLE",
    "PARAMETERS",
    "Accuracy",
    "Aligned",
    "Aperture",
    "Deviations",
    "Facets",
    "Fit",
    "Harmonic",
    "Harmonics",
    "Judge",
    "Judged",
    "Measure",
    "Pose",
    "Statistics",
    "Target",
    "WireSurface",
    "best_fit",
    "deviations",
    "facets",
    "feet",
    "harmonics",
    "hidden_error",
    "implied_shift",
    "judged_at",
    "measure",
    "measure_case",
    "offset",
    "place",
    "plain",
    "rms_gradient",
    "slopes",
    "square_cell",
    "statistics",
    "triangle_sigma",
    "tributary_areas",
    "wire_surface",
]
