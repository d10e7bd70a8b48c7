"""A small elastic dish with a release, a load and a target, solved in a tenth of a second; and its relatives."""

from __future__ import annotations

from punchform.case import Case, case_from_text, varied

TEXT = """
schema = 1
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "66 mm" }
[wire]
diameter = "0.8 mm"
youngs_modulus = "200 GPa"
density = 7850
[punch]
profile = { kind = "paraboloid", focal_length = "70 mm" }
rim_radius = "52 mm"
fillet = "17 mm"
[release]
hold = { from_radius = "51 mm" }
[load]
gravity = [0.0, 0.0, -1.0]
[target]
profile = { kind = "paraboloid", focal_length = "70 mm" }
aperture_radius = "46.3 mm"
tolerance = "0.5 mm"
[solver]
tolerance = 1e-14
"""
DISH = case_from_text(TEXT)
HOOP = {"release.hold": {"ring": "50 mm"}}
CHANGES: dict[str, dict[str, object]] = {
    "drawn in": {},
    "clamped": {"press.rim": "clamp"},
    "welded": {"grid.crossing": "welded"},
    "crossing springs, best fit": {"grid.crossing": {"stiffness": 200.0}, "target.alignment": "best fit"},
    "kinematics of the paper": {"press.kinematics": "differences"},
    "lifted hoop": {**HOOP, "release.ribs": [{"radius": "30 mm", "lift": "0.4 mm"}]},
    "hoop at a height": {**HOOP, "release.ribs": [{"radius": "30 mm", "height": "12 mm"}]},
    "polynomial, axial": {
        "punch.profile": {"kind": "polynomial", "coefficients": [0.0, 0.0, -0.0035, 0.0, 1e-8]},
        "target.measure": "axial",
    },
    "cut wires": {"grid.subdivide": 2},
    "whole grid, chord, welded": {
        "press.frame": "chord",
        "grid.symmetry": "full",
        "grid.crossing": "welded",
        "grid.step": "12.5 mm",
    },
    "two steps, half-path": {"grid.step": ("10 mm", "8 mm"), "target.measure": "half-path", "target.taper": 10.0},
}
"""What makes a relative of the dish."""


def dish(name: str = "drawn in") -> Case:
    """The dish, or one of its relatives."""
    return varied(DISH, CHANGES[name])
