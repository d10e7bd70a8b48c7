"""A small dish of wires that yield, stretched over its punch and let go: a real run of less than a second."""

from __future__ import annotations

from functools import cache

from punchform.case.reading import case_from_text
from punchform.run import Run, run

DISH = """
schema = 1
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "70 mm" }
CROSSING
[wire]
material = "304 annealed"
diameter = "0.75 mm"
[punch]
profile = { kind = "paraboloid", focal_length = "60 mm" }
rim_radius = "60 mm"
fillet = "20 mm"
[press]
RIM
strokes = 4
[release]
hold = HOLD
"""
KEPT = '{ from_radius = "60 mm" }'


@cache
def dish(hold: str = KEPT, rim: str = 'rim = "clamp"', crossing: str = "") -> Run:
    """A small dish of wires that yield, formed and let go; settings as in a case file."""
    text = DISH.replace("HOLD", hold).replace("RIM", rim).replace("CROSSING", crossing)
    return run(case_from_text(text))
