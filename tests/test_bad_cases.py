"""Every bad case ends with exit code 2 and one message that names the line, the key and what to do."""

from __future__ import annotations

from pathlib import Path

import pytest

from punchform.case import packaged_text
from punchform.cli import main

GOOD = """\
schema = 1
title = "dish"

[grid]
step = "7.5 mm"
blank = { shape = "circle", radius = "345 mm" }

[wire]
diameter = "0.75 mm"
youngs_modulus = "210 GPa"

[punch]
profile = { kind = "paraboloid", focal_length = "250 mm" }
rim_radius = "300 mm"
fillet = "30 mm"

[press]
rim = "draw"
"""

TITLE = 'title = "dish"'
STEP = 'step = "7.5 mm"'
BLANK = 'blank = { shape = "circle", radius = "345 mm" }'
DIAMETER = 'diameter = "0.75 mm"'
MODULUS = 'youngs_modulus = "210 GPa"'
FILLET = 'fillet = "30 mm"'
PROFILE = 'profile = { kind = "paraboloid", focal_length = "250 mm" }'
RIM = 'rim = "draw"'

SKEW = [[float(row == column) + 0.1 * (row == 0 and column == 1) for column in range(6)] for row in range(6)]


def corrected(kind: str, points: object) -> str:
    """The fillet with a correction of these points below it."""
    return f"{FILLET}\ncorrection = {{ kind = '{kind}', points = {points} }}"


AWAY = [[0, 0], [5, 0], [10, 0], [20, 0]]
"""Points of a correction of nothing."""
SQUARE = [[x, y, 0] for x in (0, 5, 10, 20) for y in (0, 5, 10, 20)]

# what is replaced, by what, the place and the beginning of the message, the hint ("" for any or none)
TABLE: list[tuple[str, str, str, str]] = [
    # missing
    ("schema = 1\n", "\n", "1: schema: is missing", "schema = 1"),
    (STEP, "", "4: grid.step: is missing", ""),
    (BLANK, "", "4: grid.blank: is missing", ""),
    ('shape = "circle", ', "", "6: grid.blank.shape: is missing: expected 'circle', 'rectangle'", ""),
    (', radius = "345 mm"', "", "6: grid.blank.radius: is missing", ""),
    (DIAMETER, "", "8: wire.diameter: is missing: expected a length such as '0.75 mm'", ""),
    (MODULUS, "", "8: wire.youngs_modulus: is missing", ""),
    (PROFILE, "", "12: punch.profile: is missing", ""),
    ('rim_radius = "300 mm"', "", "12: punch.rim_radius: is missing", ""),
    (', focal_length = "250 mm"', "", "13: punch.profile.focal_length: is missing", ""),
    (
        "[press]\n",
        "[target]\ntolerance = 1\naperture_radius = 270\n[press]\n",
        "17: target.profile: is missing",
        "",
    ),
    (RIM, 'pull = ["3 N"]', "18: press.pull: has too few entries", ""),
    # unknown
    (STEP, STEP + "\nwaeve = 1", "6: grid.waeve: no such setting", "did you mean `weave`?"),
    (
        MODULUS,
        'young_modulus = "210 GPa"',
        "10: wire.young_modulus: no such setting",
        "did you mean `youngs_modulus`?",
    ),
    (DIAMETER, DIAMETER + '\nfillet = "3 mm"', "10: wire.fillet: no such setting", "belongs in [punch]"),
    ("[press]", "[pres]", "17: pres: no such setting", "did you mean `press`?"),
    ("rim = ", "pull.force = 3\nrim = ", "18: press.pull: expected a list", ""),
    (
        'kind = "paraboloid"',
        'kind = "parabola"',
        "13: punch.profile.kind: expected 'paraboloid', ",
        "`paraboloid`?",
    ),
    (
        'shape = "circle"',
        'shape = "oval"',
        "6: grid.blank.shape: expected 'circle', 'rectangle', 'polygon' or 'wires', not 'oval'",
        "there are: ",
    ),
    (RIM, 'rim = "drawn"', "18: press.rim: expected 'draw' or 'clamp', not 'drawn'", "did you mean `draw`?"),
    (
        STEP,
        STEP + '\ncrossing = "pined"',
        "6: grid.crossing: expected 'pinned' or 'welded', or a table",
        "`pinned`?",
    ),
    (
        ", focal_length",
        ", radius = 3, focal_length",
        "13: punch.profile.radius: no such setting",
        "focal_length",
    ),
    ('radius = "345 mm"', 'diameter = "690 mm"', "6: grid.blank.diameter: no such", 'write radius = "345 mm": half'),
    ('radius = "345 mm"', "diameter = []", "6: grid.blank.diameter: no such setting", 'write radius = "..."'),
    (DIAMETER, "radius = 0.375", "9: wire.radius: no such setting", 'write diameter = "0.75 mm": twice the radius'),
    # wrong unit
    ("0.75 mm", "0.75 mmm", "9: wire.diameter: expected a length such as '0.75 mm', not '0.75 mmm'", "`mm`?"),
    (
        "7.5 mm",
        "7.5 MPa",
        "5: grid.step: expected a length such as '0.75 mm', not '7.5 MPa'",
        "unit of stress",
    ),
    ("210 GPa", "210 gpa", "10: wire.youngs_modulus: expected a stress or modulus", "did you mean `GPa`?"),
    (
        "0.75 mm",
        "0,75 mm",
        "9: wire.diameter: expected a length such as '0.75 mm', not '0,75 mm'",
        "decimal point",
    ),
    (
        "30 mm",
        "30 mm^2",
        "15: punch.fillet: expected a length such as '0.75 mm', not '30 mm^2'",
        "something else",
    ),
    (
        STEP,
        STEP + '\ncrossing = { stiffness = "20 N*mm" }',
        "6: grid.crossing.stiffness: expected a rotational",
        "",
    ),
    ("210 GPa", "210000 N/mm2", "10: wire.youngs_modulus: expected a stress", "write `N/mm^2` or `MPa`"),
    (STEP, STEP + '\ncrossing = { stiffness = "20 N mm1/rad" }', "6: grid.crossing.stiffness:", "`N mm^1/rad`"),
    # what the wire is made of and how it yields
    (
        MODULUS,
        'material = "304 anealed"',
        "10: wire.material: there is no material '304 anealed'",
        "did you mean `304 annealed`? `punchform materials` lists all",
    ),
    (MODULUS, 'material = "304"', "10: wire.material: there is no material '304'", "`304 annealed` or `304 quarter"),
    (MODULUS, 'material = "unobtainium"', "10: wire.material: there is no material", "`punchform materials` lists"),
    (MODULUS, MODULUS + "\nmaterial = 304", "11: wire.material: expected text in quotes, not 304", ""),
    (
        MODULUS,
        MODULUS + '\nhardening = "perfct"',
        "11: wire.hardening: expected 'none' or 'perfect', or a table such as { kind = 'linear'",
        "did you mean `perfect`?",
    ),
    (MODULUS, MODULUS + '\nhardening = "perfect"', "11: wire.hardening: nobody says at what stress", "`material`"),
    (MODULUS, MODULUS + "\nhardening = 3", "11: wire.hardening: expected 'none' or 'perfect'", ""),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'vocee', rate = 3 }",
        "11: wire.hardening.kind: expected 'linear', 'voce', 'power', 'table' or 'tensile', not 'vocee'",
        "did you mean `voce`?",
    ),
    (MODULUS, MODULUS + "\nhardening = { modulus = 3 }", "11: wire.hardening.kind: is missing: expected 'linear'", ""),
    (
        MODULUS,
        MODULUS + "\nyield_strength = 300\nhardening = { kind = 'linear', moduls = 3 }",
        "12: wire.hardening.moduls: no such setting",
        "did you mean `modulus`?",
    ),
    (
        MODULUS,
        MODULUS + "\nyield_strength = 300\nhardening = { kind = 'linear', modulus = '3 mm' }",
        "12: wire.hardening.modulus: expected a stress or modulus such as '210 GPa', not '3 mm'",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\nyield_strength = 300\nhardening = { kind = 'linear', modulus = '210 GPa' }",
        "12: wire.hardening.modulus: a tensile curve that rises by 210000 MPa before yield",
        "less than youngs_modulus",
    ),
    (
        MODULUS,
        MODULUS + "\nyield_strength = 300\nhardening = { kind = 'voce', saturation = '250 MPa', rate = 9 }",
        "12: wire.hardening.saturation: 250 MPa is less than the yield strength of 300 MPa",
        "not the rise",
    ),
    (
        MODULUS,
        MODULUS + "\nyield_strength = 300\nhardening = { kind = 'power', strength = 280, exponent = 0.2 }",
        "12: wire.hardening.strength: 280 MPa, the stress at a strain of 1, is not above the yield strength",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\nyield_strength = 300\nhardening = { kind = 'linear', modulus = 0, kinematic = 2 }",
        "12: wire.hardening.kinematic: must be at most 1, not 2",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'table', points = [[0, 300], [10, 400]] }",
        "11: wire.hardening.points: a strain of 10 is 10 times the length",
        "write 0.25 for 25 %",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'table', points = [[0, 300], [0.1, 290]] }",
        "11: wire.hardening.points: the stress falls from point to point: point 2",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'table', points = [[0, 300], [0.1, 400]] }\nyield_strength = 290",
        "12: wire.yield_strength: the flow curve of `hardening` begins at 300 MPa",
        "leave out",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'table' }",
        "11: wire.hardening.points: is missing",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'tensile', file = 'bad.csv' }",
        "11: wire.hardening.file: line 2 of bad.csv is not a row of numbers",
        "numbers",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'table', file = 'comma.csv' }",
        "11: wire.hardening.file: line 2 of comma.csv has semicolons and commas",
        "decimals with a point",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'tensile', points = [[0, 0], [1, 2], [2, 3]] }",
        "11: wire.hardening.points: a tensile test needs at least 5 rows",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\nhardening = { kind = 'tensile', points = [[0, 0], [1, 2], [2, 3]] }\nyield_strength = 300",
        "12: wire.yield_strength: the tensile test of `hardening` says where the wire yields",
        "leave out",
    ),
    (
        MODULUS,
        MODULUS + "\nyield_strength = '300 GPa'\nhardening = 'perfect'",
        "11: wire.yield_strength: no wire with a Young's modulus of 210000 MPa yields at 300000 MPa",
        "units",
    ),
    (
        MODULUS,
        MODULUS + "\nsection = 'fibers'",
        "11: wire.section: expected 'resultants' or 'fibres', or a table such as { rings = 3",
        "did you mean `fibres`?",
    ),
    (MODULUS, MODULUS + "\nsection = { rings = 0 }", "11: wire.section.rings: must be at least 1, not 0", ""),
    (MODULUS, MODULUS + "\nsection = { sectors = 3 }", "11: wire.section.sectors: must be at least 4, not 3", ""),
    (
        MODULUS,
        "stiffness = 'paper'\nhardening = 'perfect'",
        "11: wire.hardening: a wire whose stiffness is given as a matrix cannot yield",
        "centreline",
    ),
    (
        MODULUS,
        "stiffness = 'paper'\nmaterial = 'brass hard'",
        "11: wire.material: has no effect beside a given stiffness",
        "",
    ),
    # limits
    ("0.75 mm", "-0.75 mm", "9: wire.diameter: must be more than 0, not '-0.75 mm'", ""),
    ("345 mm", "0 mm", "6: grid.blank.radius: must be more than 0, not '0 mm'", ""),
    ("30 mm", "-30 mm", "15: punch.fillet: must be at least 0, not '-30 mm'", ""),
    (MODULUS, MODULUS + "\npoisson = 0.7", "11: wire.poisson: must be at most 0.5, not 0.7", ""),
    (
        'kind = "paraboloid", focal_length = "250 mm"',
        'kind = "cone", half_angle = "95 deg", nose_radius = "30 mm"',
        "13: punch.profile.half_angle: must be less than 90 deg, not '95 deg'",
        "",
    ),
    (
        'kind = "paraboloid", focal_length = "250 mm"',
        'kind = "cone", half_angle = "30", nose_radius = "30 mm"',
        "13: punch.profile.half_angle: must be less than 90 deg, not '30'",
        "a bare number is in rad: write '30 deg'",
    ),
    ("[press]", "[solver]\nmax_steps = 0\n[press]", "18: solver.max_steps: must be at least 1, not 0", ""),
    ("300 mm", "3e12 mm", "14: punch.rim_radius: must be at most 1e+09 mm, not '3e12 mm'", ""),
    ("7.5 mm", "1e-300 mm", "5: grid.step: must be at least 1e-06 mm, not '1e-300 mm'", ""),
    # not finite
    ("210 GPa", "nan GPa", "10: wire.youngs_modulus: expected a finite number, not 'nan GPa'", ""),
    ('"7.5 mm"', "nan", "5: grid.step: expected a finite number, not nan", ""),
    ('"300 mm"', "inf", "14: punch.rim_radius: expected a finite number, not inf", ""),
    ("300 mm", "1e400 mm", "14: punch.rim_radius: expected a finite number, not '1e400 mm'", ""),
    ("300 mm", "1e308 m", "14: punch.rim_radius: expected a finite number, not '1e308 m'", ""),
    # wrong types
    ('"0.75 mm"', "true", "9: wire.diameter: expected a length such as '0.75 mm', not true", ""),
    ('"300 mm"', '["300 mm"]', "14: punch.rim_radius: expected a length such as '0.75 mm', not a list", ""),
    ('step = "7.5 mm"', "step = [7, 7, 7]", "5: grid.step: has too many entries: at most 2", ""),
    ('"dish"', "3", "2: title: expected a short text in quotes, not 3", ""),
    (
        "schema = 1",
        "schema = 2",
        "1: schema: this program reads case files of schema 1, not 2",
        "newer punchform",
    ),
    ("schema = 1", 'schema = "1"', "1: schema: this program reads case files of schema 1, not '1'", ""),
    (PROFILE, 'profile = "sphere"', "13: punch.profile: expected a table with settings, not 'sphere'", ""),
    (
        RIM,
        "descent = { max_steps = 1.5 }",
        "18: press.descent.max_steps: expected a whole number, not 1.5",
        "",
    ),
    (RIM, 'pull = "2 N"', "18: press.pull: expected a list in square brackets, not '2 N'", 'write ["2 N", "2 N"]'),
    (BLANK, "blank = { shape = 'rectangle', size = 700 }", "6: grid.blank.size: expected a list", "write [700, 700]"),
    (PROFILE, "profile = { kind = 'table', points = 7 }", "13: punch.profile.points: expected a list", ""),
    (MODULUS, "stiffness = [[1, 2]]", "10: wire.stiffness: expected 6 rows of 6 numbers", ""),
    (
        DIAMETER,
        'stiffness = "paper"\n' + DIAMETER,
        "11: wire.youngs_modulus: has no effect beside a given stiffness",
        "leave out `youngs_modulus` or `stiffness`",
    ),
    # contradictions
    (
        MODULUS,
        'stiffness = "paper"\ncentreline = { kind = "straight" }',
        "11: wire.centreline: the stiffness is",
        "",
    ),
    (MODULUS, MODULUS + '\nheight = "1 mm"', "11: wire.height: 1 mm contradicts the centreline", "leave out"),
    ("0.75 mm", "8 mm", "9: wire.diameter: a wire of 8 mm is as thick as the step of 7.5 mm", ""),
    (
        MODULUS,
        MODULUS + '\ncentreline = { kind = "cosine", height = "9 mm" }',
        "11: wire.centreline: a crimp height of 9 mm is more than the step of 7.5 mm",
        "",
    ),
    (
        STEP,
        STEP + '\nweave = "stacked"',
        "9: wire.centreline: a stacked grid is made of straight wires",
        "straight",
    ),
    (
        "345 mm",
        "299 mm",
        "6: grid.blank.radius: the blank reaches 299 mm from the axis and so not to the rim",
        "",
    ),
    (
        BLANK,
        'blank = { shape = "rectangle", size = [700, 500] }',
        "6: grid.blank.size: the blank reaches 250 mm",
        "",
    ),
    (
        BLANK,
        "blank = { shape = 'polygon', points = [[-400, 0], [0, 0], [400, 0]] }",
        "6: grid.blank.points: the corners enclose no area",
        "",
    ),
    (
        RIM,
        'rim = "clamp"\nhold = { force_per_length = "5 N/mm", friction = 0.15 }',
        "19: press.hold: a clamped rim lets nothing slide",
        "draw",
    ),
    (
        RIM,
        'hold = { force_per_length = "5 N", friction = 0.15 }',
        "18: press.hold.force_per_length: expected a force per length such as '5 N/mm', not '5 N'",
        "a unit of force",
    ),
    (
        RIM,
        'hold = { force_per_length = "-5 N/mm", friction = 0.15 }',
        "18: press.hold.force_per_length: must be at least 0",
        "",
    ),
    (
        RIM,
        'hold = { force_per_length = "5 N/mm", friction = -0.1 }',
        "18: press.hold.friction: must be at least 0, not -0.1",
        "",
    ),
    (RIM, 'hold = { force_per_length = "5 N/mm" }', "18: press.hold.friction: is missing", ""),
    (
        RIM,
        "hold = { force_per_length = 5, friction = 0.15, from_radius = 300 }",
        "18: press.hold.from_radius: no such setting",
        "",
    ),
    (
        RIM,
        'kinematics = "differences"\nhold = { force_per_length = 5, friction = 0.15 }',
        "19: press.hold: a holder needs the free kinematics",
        'kinematics = "free"',
    ),
    (
        RIM,
        'method = "descent"\nhold = { force_per_length = 5, friction = 0.15 }',
        "19: press.hold: a holder needs Newton's method",
        'method = "newton"',
    ),
    (
        RIM,
        "pull = [1, 1]\nhold = { force_per_length = 5, friction = 0.15 }",
        "19: press.hold: the holder grips the flange",
        "leave out",
    ),
    (RIM, 'method = "descent"\nstrokes = 2', "19: press.strokes: the paper's descent goes to the full depth", "newton"),
    (RIM, "strokes = 0", "18: press.strokes: must be at least 1, not 0", ""),
    (RIM, "strokes = 2.5", "18: press.strokes: expected a whole number, not 2.5", ""),
    (RIM, 'hold = "rim"', "18: press.hold: ", ""),
    (RIM, 'rim = "clamp"\npull = [1, 1]', "19: press.pull: a clamped rim lets no wire end move", "draw"),
    (
        RIM,
        'method = "descent"\ndescent = { rule = "fixed" }',
        "19: press.descent.step_length: is missing: the rule 'fixed' needs a step length",
        "",
    ),
    (
        "[press]",
        "[release]\nhold = { from_radius = 400 }\n[press]",
        "18: release.hold.from_radius: no node lies",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = "rimm"\n[press]',
        "18: release.hold: expected 'nothing' or 'rim', or a table",
        "",
    ),
    (
        "[press]",
        "[release]\nhold = { point = 8, radius = 90 }\n[press]",
        "18: release.hold.point: no such setting",
        "",
    ),
    (
        "[press]",
        "[release]\nhold = { ring = 90, points = 3 }\n[press]",
        "18: release.hold.points: no such setting",
        "",
    ),
    (
        "[press]",
        "[release]\nhold = { radius = 90 }\n[press]",
        "18: release.hold.radius: no such setting",
        "",
    ),
    (
        "[press]",
        "[release]\nhold = {}\n[press]",
        "18: release.hold.from_radius: is missing",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = { points = "8", radius = 90 }\n[press]',
        "18: release.hold.points: expected a whole number, not '8'",
        "",
    ),
    (
        "[press]",
        "[release]\nhold = { nodes = [] }\n[press]",
        "18: release.hold.nodes: needs at least 1 entries",
        "",
    ),
    (
        "[press]",
        "[release]\nribs = [{ radius = 50, spokes = 3 }]\n[press]",
        "18: release.ribs[0]: a rib is either a hoop",
        "",
    ),
    (
        "[press]",
        "[release]\nribs = [{ spoke = 3 }]\n[press]",
        "18: release.ribs[0].spoke: no such setting",
        "",
    ),
    (
        "[press]",
        "[release]\nribs = { radius = 50 }\n[press]",
        "18: release.ribs: expected a list in square brackets",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = "rim"\n[load]\ngravity = "down"\n[press]',
        "20: load.gravity: expected a list",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = "rim"\n[load]\ngravity = [0, 0, -1]\n[press]',
        "20: load.gravity: the weight of the wire is not known",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = "rim"\n[load]\n[press]',
        "19: load: no load is given",
        "",
    ),
    (
        "[press]",
        '[release]\n[load]\npressure = "1 Pa"\n[press]',
        "18: load: nothing holds the grid",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = "rim"\n[load]\nwind = 3\n[press]',
        "20: load.wind: expected a table",
        "",
    ),
    (
        "[press]",
        '[release]\nhold = "rim"\n[load]\nforces = [{ node = [0], force = [0, 0, 1] }]\n[press]',
        "20: load.forces[0].node: has too few entries",
        "",
    ),
    (
        "[press]",
        "[target]\nprofile = { kind = 'sphere', radius = 500 }\naperture_radius = 301\ntolerance = 1\n[press]",
        "19: target.aperture_radius: an aperture of 301 mm reaches beyond the rim at 300 mm",
        "",
    ),
    (
        "345 mm",
        "345e5 mm",
        "5: grid.step: about 1.66e+13 crossings would have to be solved",
        "take a step of",
    ),
    ("7.5 mm", "310 mm", "5: grid.step: a step of 310 mm is more than the rim radius of 300 mm", ""),
    (
        RIM,
        RIM + "\n[grid.crossing]\nstiffness = 0",
        "20: grid.crossing.stiffness: must be more than 0, not 0",
        "",
    ),
    # stages
    (TITLE, TITLE + "\nstages = []", "3: stages: needs at least 1 entries, not 0", ""),
    (TITLE, TITLE + '\nstages = "press"', "3: stages: expected a list in square brackets, not 'press'", ""),
    (TITLE, TITLE + '\nstage = ["press"]', "3: stage: no such setting", "did you mean `stages`?"),
    (
        TITLE,
        TITLE + '\nstages = ["press",\n"relase"]',
        "4: stages[1]: expected 'press', 'release', 'trim'",
        "`release`?",
    ),
    (TITLE, TITLE + '\nstages = ["press", 3]', "3: stages[1]: expected 'press', 'release', 'trim' or 'load'", ""),
    (TITLE, TITLE + '\nstages = ["press", { trm = {} }]', "3: stages[1].trm: no such stage", "did you mean `trim`?"),
    (TITLE, TITLE + '\nstages = ["press", {}]', "3: stages[1]: each entry is one stage, but this table has 0 keys", ""),
    (
        TITLE,
        TITLE + '\nstages = ["press", { release = {}, trim = {} }]',
        "3: stages[1]: each entry is one stage, but this table has 2 keys",
        "one after the other",
    ),
    (TITLE, TITLE + '\nstages = ["trim"]', "3: stages[0]: the first stage is the press, not 'trim'", "formed first"),
    (
        TITLE,
        TITLE + '\nstages = [\n"press",\n"press"]',
        "5: stages[1]: 'press' cannot follow 'press'",
        "put a 'release' between",
    ),
    (TITLE, TITLE + '\nstages = ["press", "trim", "trim"]', "3: stages[2]: 'trim' cannot follow 'trim'", "'release'"),
    (
        TITLE,
        TITLE + '\nstages = ["press", { load = { pressure = 1 } }]',
        "3: stages[1]: 'load' cannot follow 'press': loads act on a grid that was just let go",
        "put a 'release' between",
    ),
    (
        TITLE,
        TITLE + '\nstages = ["press", "release", "release"]',
        "3: stages[2]: the stage before has let the grid go with the same hold",
        "leave it out",
    ),
    (
        TITLE,
        TITLE + '\nstages = ["press", { release = { hold = "rim" } }, "load"]',
        "3: stages[2]: 'load' needs a section [load]",
        "gravity",
    ),
    (
        TITLE,
        TITLE + '\nstages = ["press", "release", { load = { pressure = 1 } }]',
        "3: stages[2].load: nothing holds the grid",
        "",
    ),
    (
        TITLE,
        TITLE + '\nstages = ["press", { release = { hold = "rim" } },\n{ load = { gravity = [0, 0, 1] } }]',
        "4: stages[2].load.gravity: the weight of the wire is not known",
        "",
    ),
    (TITLE, TITLE + '\nstages = ["press", { trim = { radius = 0 } }]', "3: stages[1].trim.radius: must be more", ""),
    (
        TITLE,
        TITLE + '\nstages = ["press", { trim = { diameter = "600 mm" } }]',
        "3: stages[1].trim.diameter: no such setting",
        "half the diameter",
    ),
    (TITLE, TITLE + '\nstages = ["press", { trim = 3 }]', "3: stages[1].trim: expected a table with settings", ""),
    (
        TITLE,
        TITLE + "\nstages = ['press', { release = { hold = { from_radius = 400 } } }]",
        "3: stages[1].release.hold.from_radius: no node lies beyond 400 mm",
        "",
    ),
    (
        TITLE,
        TITLE + "\nstages = ['press', 'trim', { press = { pull = [1, 1], rim = 'clamp' } }]",
        "3: stages[2].press.pull: a clamped rim lets no wire end move",
        "",
    ),
    # files named in the case
    (
        PROFILE,
        "profile = { kind = 'table', file = 'none.csv' }",
        "13: punch.profile.file: cannot read ",
        "relative",
    ),
    (
        PROFILE,
        "profile = { kind = 'table', file = 'bad.csv' }",
        "13: punch.profile.file: line 2 of bad.csv",
        "numbers",
    ),
    (
        PROFILE,
        "profile = { kind = 'table', file = 'empty.csv' }",
        "13: punch.profile.file: empty.csv holds no",
        "",
    ),
    (
        PROFILE,
        "profile = { kind = 'table', file = 3 }",
        "13: punch.profile.file: expected the name of a file",
        "",
    ),
    (
        PROFILE,
        "profile = { kind = 'table', points = [[0, 9], [5, 8], [5, 7]] }",
        "13: punch.profile.points: rho must increase from point to point: point 3",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\ncentreline = { kind = 'points', points = [[0, 0], [7.5, 0, 1]] }",
        "11: wire.centreline.points: every point needs the same",
        "",
    ),
    # what only wire, punch and grid can tell
    (MODULUS, f"stiffness = {SKEW}", "10: wire.stiffness: not symmetric", ""),
    (
        PROFILE,
        "profile = { kind = 'points', points = [[0, 0], [7, 1]] }",
        "13: punch.profile.kind: expected 'paraboloid', ",
        "",
    ),
    (
        MODULUS,
        MODULUS + "\ncentreline = { kind = 'points', points = [[0, 0], [7, 1]] }",
        "11: wire.centreline",
        "",
    ),
    (PROFILE, "profile = { kind = 'sphere', radius = '200 mm' }", "13: punch.profile", ""),
    (PROFILE, "profile = { kind = 'expression', z = '__import__(1)' }", "13: punch.profile.z", ""),
    (PROFILE, "profile = { kind = 'expression', z = 'r**2' }", "13: punch.profile.z", ""),
    (
        PROFILE,
        "profile = { kind = 'flat', height = 40, edge_radius = 5 }",
        "13: punch.profile: the profile bends with a radius of 5 mm",
        "",
    ),
    (
        BLANK,
        "blank = { shape = 'polygon', points = [[-400, -100], [400, -100], [0, 400]] }",
        "6: grid.blank: the blank reaches only",
        "",
    ),
    # corrections of the punch
    (FILLET, FILLET + "\ncorrection = 3", "16: punch.correction: expected a table with settings, not 3", ""),
    (FILLET, FILLET + "\ncorrection = {}", "16: punch.correction.kind: is missing: expected 'field' or", ""),
    (FILLET, corrected("fields", SQUARE), "16: punch.correction.kind: expected 'field' or 'radial'", "`field`"),
    (
        FILLET,
        FILLET + "\ncorrection = { kind = 'field', file = 'none.csv' }",
        "16: punch.correction.file: cannot read ",
        "relative",
    ),
    (FILLET, corrected("field", SQUARE[:8]), "16: punch.correction.points: needs at least 16 entries, not 8", ""),
    (
        FILLET,
        corrected("field", [*SQUARE, [30, 30, 0]]),
        "16: punch.correction.points: 5 different x and 5 different y make a grid of 25 points, but 17 are given; "
        "the first that is missing is at x = 0 mm, y = 30 mm",
        "a height for every x and y",
    ),
    (
        FILLET,
        corrected("field", [*SQUARE, [5, 10, 0.1]]),
        "16: punch.correction.points: point 17 stands where point 7 does: x = 5 mm, y = 10 mm",
        "",
    ),
    (
        FILLET,
        corrected("field", [*SQUARE, [30, 30, "inf mm"]]),
        "16: punch.correction.points[16][2]: expected a finite number",
        "",
    ),
    (FILLET, corrected("field", [*SQUARE, [30, 30]]), "16: punch.correction.points[16]: has too few", ""),
    (
        FILLET,
        corrected("field", [*SQUARE[:-1], [20, 20, 0.3]]),
        "16: punch.correction.points: the correction is still 0.3 mm at its edge, at x = 20 mm, y = 20 mm",
        "die out",
    ),
    (FILLET, corrected("radial", AWAY[:3]), "16: punch.correction.points: needs at least 4 entries", ""),
    (
        FILLET,
        corrected("radial", [*AWAY, [15, 0]]),
        "16: punch.correction.points: rho must increase from point to point: point 5",
        "",
    ),
    (
        FILLET,
        corrected("radial", [*AWAY, [30, 1]]),
        "16: punch.correction.points: the correction is still 1 mm at its edge, at rho = 30 mm",
        "",
    ),
    (
        FILLET,
        corrected("radial", [*AWAY[1:], [30, 0]]),
        "16: punch.correction.points: the correction starts at rho = 5 mm",
        "",
    ),
    (
        FILLET,
        corrected("radial", [[0, 1], [5, -1], [8, 0], [80, 0]]),
        "16: punch.correction: the correction bends the punch with a radius of ",
        "smooth the correction",
    ),
    (
        FILLET,
        corrected("radial", [[0, -90], [100, -90], [200, -40], [280, 0]]),
        "16: punch.correction: the correction takes the punch ",
        "is a sign wrong?",
    ),
    # syntax
    ('"7.5 mm"', "7.5 mm", "5: not valid TOML: ", 'stands in quotes: "7.5 mm"'),
    ("[wire]", "[wire", "8: not valid TOML: ", ""),
    (RIM, RIM + '\nrim = "clamp"', "19: press.rim: stands twice, here and on line 18", "leave out one of them"),
    (RIM, RIM + "\n[wire]\n", "19: wire: stands twice, here and on line 8", ""),
    (RIM, RIM + "\n[grid.blank]\n", "19: grid.blank: stands twice, here and on line 6", ""),
    ('radius = "345 mm"', "radius = 3, radius = 4", "6: grid.blank.radius: stands twice, here and on line 6", ""),
    (RIM, "pull = [\n1,\n2]\npull = [3,\n4]\n", "21: press.pull: stands twice, here and on line 18", ""),
    (RIM, "descent.rule = 'fixed'\ndescent = 3", "19: not valid TOML: cannot overwrite a value", ""),
    ('"dish"', '"dish', "2: not valid TOML: ", ""),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "bad.csv").write_text("rho, z\n0, zero\n", encoding="utf-8")
    (tmp_path / "comma.csv").write_text("strain;stress\n0;300,5\n0,1;400\n", encoding="utf-8")
    (tmp_path / "empty.csv").write_text("# nothing\n", encoding="utf-8")
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> list[str]:
    """What stderr says about arguments that end with exit code 2 and print no result."""
    assert main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "Traceback" not in printed.err
    return printed.err.splitlines()


def test_the_case_before_it_is_spoilt_is_good(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "dish.toml").write_text(GOOD, encoding="utf-8")
    assert main(["check", str(folder / "dish.toml")]) == 0
    assert "usable" in capsys.readouterr().out


@pytest.mark.parametrize(("old", "new", "message", "hint"), TABLE, ids=[row[2] for row in TABLE])
def test_one_fault_one_message(
    old: str, new: str, message: str, hint: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert GOOD.count(old) == 1
    case = folder / "dish.toml"
    case.write_text(GOOD.replace(old, new), encoding="utf-8")
    lines = said(capsys, ["check", str(case)])
    assert lines[0].startswith(f"error: {case}:{message}"), lines
    assert sum(line.startswith("error: ") for line in lines) == 1, lines
    assert hint in "\n".join(lines[1:]), lines


def test_all_faults_at_once_in_the_order_of_their_lines(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = folder / "dish.toml"
    spoilt = GOOD.replace("7.5 mm", "7.5 kg").replace('"210 GPa"', "inf").replace('"draw"', '"drow"')
    case.write_text(spoilt.replace("300 mm", "350 mm").replace("schema = 1", "schema = 7"), encoding="utf-8")
    lines = said(capsys, ["check", str(case)])
    keys = [line.split(":")[3].strip() for line in lines if line.startswith("error: ")]
    assert keys == ["schema", "grid.step", "wire.youngs_modulus", "press.rim"]


def test_contradictions_are_told_beside_faults_of_other_sections(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = folder / "dish.toml"
    case.write_text(GOOD.replace("345 mm", "100 mm").replace('"draw"', '"drow"'), encoding="utf-8")
    lines = said(capsys, ["check", str(case)])
    assert [line.split(":")[3].strip() for line in lines if line.startswith("error: ")] == [
        "grid.blank.radius",
        "press.rim",
    ]


@pytest.mark.parametrize(
    ("press", "message", "hint"),
    [
        ('kinematics = "differences"', "18: press.kinematics: a wire that yields needs the free kinematics", "free"),
        ('frame = "O"', "18: press.frame: a wire that yields is stretched too far", 'frame = "chord"'),
        ('method = "descent"', "18: press.method: the paper's descent follows an energy", "newton"),
    ],
)
def test_a_wire_that_yields_needs_a_press_that_follows_it(
    press: str, message: str, hint: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = folder / "dish.toml"
    case.write_text(GOOD.replace(MODULUS, 'material = "304 annealed"').replace(RIM, press), encoding="utf-8")
    [error, told] = said(capsys, ["check", str(case)])
    assert error.startswith(f"error: {case}:{message}")
    assert hint in told
    assert 'wire.hardening = "none" for an elastic wire' in told
    case.write_text(GOOD.replace(RIM, press), encoding="utf-8")
    assert main(["check", str(case)]) == 0


def test_the_wires_of_a_gridshell_do_not_yield(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = folder / "shell.toml"
    text = packaged_text("gridshell")
    for line, key in (
        ('material = "304 annealed"', "material"),
        ('hardening = "perfect"\nyield_strength = "1 MPa"', "hardening"),
    ):
        case.write_text(text.replace("[wire]", f"[wire]\n{line}"), encoding="utf-8")
        [error, hint] = said(capsys, ["check", str(case)])
        assert f": wire.{key}: the wires of a gridshell do not yield yet" in error
        assert 'wire.hardening = "none"' in hint


def test_welded_crossings_contradict_differences(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = folder / "dish.toml"
    spoilt = GOOD.replace(STEP, STEP + '\ncrossing = "welded"').replace(RIM, 'kinematics = "differences"')
    case.write_text(spoilt, encoding="utf-8")
    [error, hint] = said(capsys, ["check", str(case)])
    assert error.startswith(f"error: {case}:19: press.kinematics: welded crossings need the free kinematics")
    assert "spring" in hint


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "schema: is missing"),
        (b'schema = 1\ntitle = "\xff"\n', "2: is not UTF-8 text"),
        (b"\x00\x01", "1: not valid TOML"),
        (b"x = " + 5000 * b"[", "not valid TOML|nested too deeply"),
        (b"\xff\xfe[\x00", "1: is not UTF-8 text"),
    ],
)
def test_files_that_are_no_case(content: bytes, message: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = folder / "dish.toml"
    case.write_bytes(content)
    lines = said(capsys, ["check", str(case)])
    assert any(words in lines[0] for words in message.split("|")), lines[0]


def test_places_that_hold_no_case(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "cannot be read: No such file" in said(capsys, ["check", str(folder / "no.toml")])[0]
    assert "is a folder, not a case file" in said(capsys, ["check", str(folder)])[0]
    assert "there is no packaged case 'dish'" in said(capsys, ["check", "packaged:dish"])[0]
    assert "cannot be read" in said(capsys, ["check", "a\0b"])[0]


def test_a_file_one_may_not_read(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(path: Path) -> bytes:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "read_bytes", refused)
    case = folder / "dish.toml"
    case.write_text(GOOD, encoding="utf-8")
    assert said(capsys, ["check", str(case)]) == [f"error: {case}: cannot be read: Permission denied"]


@pytest.mark.parametrize("command", [["element"], ["form", "-o", "results"]])
def test_every_command_refuses_a_bad_case(
    command: list[str], folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    Path("dish.toml").write_text(GOOD.replace("0.75 mm", "0.75 mmm"), encoding="utf-8")
    lines = said(capsys, [*command, "dish.toml"])
    assert lines[0] == ("error: dish.toml:9: wire.diameter: expected a length such as '0.75 mm', not '0.75 mmm'")
    assert not Path("results").exists()


def test_form_refuses_a_folder_in_use_before_it_solves(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = folder / "dish.toml"
    case.write_text(GOOD, encoding="utf-8")
    lines = said(capsys, ["form", str(case), "-o", str(folder)])
    assert "not a punchform run" in lines[0]
    assert "is a file" in said(capsys, ["form", str(case), "-o", str(case)])[0]
