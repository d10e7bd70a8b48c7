"""The smallest dish that presses, springs back and is judged: a run of a tenth of a second, for many runs."""

from __future__ import annotations

from punchform.case import Case
from punchform.case.reading import case_from_text

TEXT = """
schema = 1
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "70 mm" }
[wire]
diameter = "0.75 mm"
youngs_modulus = "210 GPa"
poisson = 0.3
[punch]
profile = { kind = "paraboloid", focal_length = "60 mm" }
rim_radius = "60 mm"
fillet = "20 mm"
[release]
hold = { from_radius = "60 mm" }
[target]
profile = { kind = "paraboloid", focal_length = "60 mm" }
aperture_radius = "40 mm"
tolerance = "0.5 mm"
"""


def case(more: str = "") -> Case:
    """The dish, with further lines of a case file."""
    return case_from_text(TEXT + more)
