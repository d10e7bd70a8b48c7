"""The case: what a file means, what may be left out, and that a written case reads back the same."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from punchform.case import (
    TEMPLATE,
    Case,
    CircleBlank,
    ConeProfile,
    CosineLine,
    CrossingSpring,
    DescentCase,
    EllipsoidProfile,
    ExpressionProfile,
    FibreSection,
    FieldPoints,
    FlatProfile,
    GridCase,
    HoldFrom,
    LinearHardening,
    ParaboloidProfile,
    PointsLine,
    PolygonBlank,
    PolynomialProfile,
    PowerHardening,
    PressCase,
    PunchCase,
    RadialPoints,
    RectangleBlank,
    ReleaseCase,
    SolverCase,
    SphereProfile,
    StraightLine,
    TableHardening,
    TableProfile,
    TargetCase,
    TensileHardening,
    VoceHardening,
    WireCase,
    case_from_text,
    json_schema,
    packaged_cases,
    packaged_text,
    read_case,
    write_case,
)
from punchform.case.places import key_lines
from punchform.case.wire import MATERIAL
from punchform.errors import InputError

SHORT = """
schema = 1
[grid]
step = 7.5
blank = { shape = "circle", radius = 345 }
[wire]
diameter = 0.75
youngs_modulus = "210 GPa"
[punch]
profile = { kind = "sphere", radius = 400 }
rim_radius = 300
"""


def problem_of(text: str, **where: Any) -> str:
    with pytest.raises(InputError) as caught:
        case_from_text(text, "dish.toml", **where)
    return str(caught.value)


def test_the_check_case_is_in_internal_units() -> None:
    case = read_case("packaged:check")
    assert case.grid.step == (7.5, 7.5)
    assert case.grid.blank == CircleBlank(radius=345.0)
    assert case.wire.youngs_modulus == 210000.0
    assert case.wire.centreline == CosineLine(height=0.75, segments=64)
    assert case.tool == PunchCase(profile=ParaboloidProfile(focal_length=250), rim_radius=300, fillet=30)
    assert case.release == ReleaseCase(hold=HoldFrom(from_radius=300))
    assert case.target is not None
    assert case.target.tolerance == 1.0


def test_what_may_be_left_out() -> None:
    case = case_from_text(SHORT)
    assert (case.grid.weave, case.grid.centre, case.grid.symmetry, case.grid.crossing) == (
        "plain",
        "node",
        "quarter",
        "pinned",
    )
    assert (case.wire.poisson, case.wire.shear_factor, case.wire.yield_strength) == (0.3, 0.9, None)
    assert case.wire.centreline == CosineLine(height=0.75, segments=64)
    assert case.wire.height == 0.75
    assert case.tool.fillet == 30.0
    assert case.press == PressCase()
    assert case.solver == SolverCase(linear="auto", max_steps=200, tolerance=1e-12)
    assert case.release is None
    assert case.target is None


def test_the_paper_preset_needs_no_material() -> None:
    wire = read_case("packaged:paper").wire
    assert (wire.stiffness, wire.centreline, wire.height) == ("paper", None, 0.75)


def test_a_cosine_without_height_has_one_diameter() -> None:
    text = SHORT.replace("diameter = 0.75", 'diameter = 0.5\ncentreline = { kind = "cosine", segments = 8 }')
    assert case_from_text(text).wire.centreline == CosineLine(height=0.5, segments=8)


def test_a_material_gives_what_is_left_out() -> None:
    material = SHORT.replace('youngs_modulus = "210 GPa"', 'material = "304 annealed"')
    wire = case_from_text(material).wire
    assert (wire.youngs_modulus, wire.poisson, wire.density, wire.yield_strength) == (193e3, 0.29, 8000, 205)
    assert wire.hardening == PowerHardening(strength=1275, exponent=0.45)
    assert wire.model_fields_set == {"diameter", "material"}
    own = material.replace("[wire]", '[wire]\nyoungs_modulus = "190 GPa"\nhardening = "none"')
    wire = case_from_text(own).wire
    assert (wire.youngs_modulus, wire.hardening, wire.yield_strength, wire.yields) == (190e3, "none", 205, False)
    flow = material.replace("[wire]", "[wire]\nhardening = { kind = 'table', points = [[0, 240], [0.2, 600]] }")
    assert case_from_text(flow).wire.yield_strength == 240
    resolved = case_from_text(write_case(case_from_text(material)))
    assert resolved == case_from_text(material)
    assert resolved.wire.model_copy(update={"material": "brass hard"}).youngs_modulus == 193e3


def test_a_tensile_test_is_written_into_the_resolved_case(tmp_path: Path) -> None:
    (tmp_path / "test.csv").write_text("strain, stress\n0, 0\n0.001, 205\n0.01,250\n0.1,440\n0.3,540\n", "utf-8")
    text = SHORT.replace("[wire]", "[wire]\nhardening = { kind = 'tensile', file = 'test.csv', kinematic = 0.5 }")
    case = case_from_text(text, folder=tmp_path)
    rows = ((0, 0), (0.001, 205), (0.01, 250), (0.1, 440), (0.3, 540))
    assert case.wire.hardening == TensileHardening(points=rows, kinematic=0.5)
    assert case.wire.yield_strength is None
    assert case_from_text(write_case(case)) == case


def test_fibres_have_a_usual_number() -> None:
    wire = case_from_text(SHORT).wire
    assert wire.fibres is None
    assert wire.model_copy(update={"section": "fibres"}).fibres == FibreSection(rings=3, sectors=8)
    assert wire.model_copy(update={"section": {"rings": 6}}).fibres == FibreSection(rings=6, sectors=8)


def test_a_wire_that_yields_is_read_from_its_chord() -> None:
    elastic = case_from_text(SHORT)
    wire = elastic.wire.model_copy(update={"hardening": "perfect", "yield_strength": 300})
    case = elastic.model_copy(update={"wire": wire})
    assert (elastic.framed(elastic.press).chord, case.framed(case.press).chord, case.press.frame) == (
        False,
        True,
        "auto",
    )
    assert elastic.framed(elastic.press) is elastic.press


def test_a_case_cannot_be_changed() -> None:
    case = read_case("packaged:check")
    with pytest.raises(ValidationError, match="frozen"):
        case.grid.weave = "same"  # type: ignore[misc]


def test_contradictions_are_found_in_cases_built_in_python_too() -> None:
    case = read_case("packaged:check")
    with pytest.raises(InputError, match="pull contradicts"):
        Case(grid=case.grid, wire=case.wire, punch=case.tool, press=PressCase(pull=(1.0, 1.0), rim="clamp"))


def test_the_kinematics_of_the_paper_reads_back_the_same() -> None:
    case = read_case("packaged:check")
    case = case.model_copy(update={"press": PressCase(kinematics="differences", offset="lower")})
    assert case_from_text(write_case(case)) == case


@pytest.mark.parametrize("name", packaged_cases())
def test_packaged_cases_read_back_the_same(name: str) -> None:
    case = read_case(f"packaged:{name}")
    assert case_from_text(write_case(case)) == case


def test_the_packaged_check_case_is_the_first_to_be_used() -> None:
    assert {"check", "paper", TEMPLATE} <= set(packaged_cases())


def with_choice(number: int) -> str:
    """The template with one commented line in place of the active one of the same key, its section opened."""
    lines = packaged_text(TEMPLATE).splitlines()
    key = lines[number].split()[1]
    first = max(row for row in range(number) if re.match(r"(# )?\[", lines[row]))
    later = (row for row in range(number, len(lines)) if re.match(r"(# )?\[", lines[row]))
    commented = lines[first].startswith("# ")
    # A stiffness stands in the place of the whole wire.
    replaced = (key, "diameter", *MATERIAL) if key == "stiffness" else (key,)
    for row in range(first, next(later, len(lines))):
        if lines[row].split(" = ")[0] in replaced:
            lines[row] = ""
        if row == number or (commented and re.match(r"# (\[|\w+ = )", lines[row])):
            lines[row] = lines[row].removeprefix("# ")
    # A wire yields at a stress; a flow curve says it itself.
    if key == "hardening" and '"table"' not in lines[number]:
        lines[first] += '\nyield_strength = "300 MPa"'
    # Loads act on a released grid.
    released = "\n[release]\nhold = 'rim'\n" if lines[first].startswith("[load]") else ""
    return "\n".join(lines) + released


def test_every_choice_that_the_template_shows_is_valid() -> None:
    lines = packaged_text(TEMPLATE).splitlines()
    shown = [row for row, line in enumerate(lines) if re.match(r"# \w+ = ", line) and ".csv" not in line]
    assert len(shown) > 20
    plain = case_from_text(packaged_text(TEMPLATE))
    changed = [case_from_text(with_choice(row), lines[row]) != plain for row in shown]
    assert sum(changed) > 10


def test_points_come_from_a_file_beside_the_case(tmp_path: Path) -> None:
    (tmp_path / "crimp.csv").write_text("\N{BOM}x, z\r\n0, 0\r\n3.75; 0.3  # middle\r\n\r\n7.5 0.75\r\n", "utf-8")
    (tmp_path / "bowl.csv").write_text("0,90\n100,80\n300,0\n", "utf-8")
    (tmp_path / "flow.csv").write_text("strain, stress\n0, 300\n0.1, 410.5\n", "utf-8")
    text = SHORT.replace('"210 GPa"', '"210 GPa"\ncentreline = { kind = "points", file = "crimp.csv" }')
    text = text.replace("[wire]", '[wire]\nhardening = { kind = "table", file = "flow.csv" }')
    text = text.replace('kind = "sphere", radius = 400', 'kind = "table", file = "bowl.csv"')
    (tmp_path / "dish.toml").write_text(text, "utf-8")
    case = read_case(tmp_path / "dish.toml")
    assert case.wire.centreline == PointsLine(points=((0, 0), (3.75, 0.3), (7.5, 0.75)))
    assert case.wire.height == 0.75
    assert case.wire.hardening == TableHardening(points=((0, 300), (0.1, 410.5)))
    assert case.wire.yield_strength == 300
    assert case.tool.profile == TableProfile(points=((0, 90), (100, 80), (300, 0)))
    assert case_from_text(write_case(case)) == case


def test_points_of_a_correction_come_from_a_file_with_comments(tmp_path: Path) -> None:
    rows = [f"{x},{y},{0.1 * (x + y == 0)}" for y in (9, 0, 3, 6) for x in (0, 6, 3, 9)]
    (tmp_path / "correction.csv").write_text("# heights\n# in mm\nx,y,dz\n" + "\n".join(rows), "utf-8")
    text = SHORT.replace("[punch]", '[punch]\ncorrection = { kind = "field", file = "correction.csv" }')
    (tmp_path / "dish.toml").write_text(text, "utf-8")
    case = read_case(tmp_path / "dish.toml")
    added = case.tool.correction
    assert isinstance(added, FieldPoints)
    x, y, dz = added.grid
    assert x == y == [0, 3, 6, 9]
    assert dz == [[0.1, 0, 0, 0], [0] * 4, [0] * 4, [0] * 4]
    assert case_from_text(write_case(case)) == case


def test_a_file_saved_by_a_windows_editor_reads_the_same(tmp_path: Path) -> None:
    (tmp_path / "dish.toml").write_bytes(b"\xef\xbb\xbf" + SHORT.replace("\n", "\r\n").encode())
    assert read_case(tmp_path / "dish.toml") == case_from_text(SHORT)


def test_a_misspelt_key_is_not_missing_too() -> None:
    told = problem_of(SHORT.replace("youngs_modulus", "young_modulus"))
    assert "did you mean `youngs_modulus`?" in told
    assert "is missing" not in told


def test_memory_counts_what_will_be_solved() -> None:
    from punchform.case.memory import solved_nodes

    grid = read_case("packaged:check").grid
    quarter = solved_nodes(grid)
    assert quarter == pytest.approx(1703, rel=0.05)
    assert solved_nodes(grid.model_copy(update={"symmetry": "full"})) == 4 * quarter
    diamond = PolygonBlank(points=((400, 0), (0, 400), (-400, 0), (0, -400)))
    skewed = PolygonBlank(points=((400, 0), (0, 400), (-400, 0), (100, -400)))
    for blank, share in ((diamond, 4), (skewed, 1)):
        own = grid.model_copy(update={"blank": blank})
        assert solved_nodes(own) == pytest.approx(320000 / 56.25 / share)


@pytest.mark.parametrize(
    ("text", "path", "line"),
    [
        ("a = 1\nb = 2", ("b",), 2),
        ("[a]\n\n# [b]\nc.d = 1\nc.e = 2", ("a", "c", "e"), 5),
        ("[a]\nc.d = 1\nc.e = 2", ("a", "c"), 2),
        ("[\"a b\".c]\n'd.e' = 1", ("a b", "c", "d.e"), 2),
        ("a = [\n 1, # one ]\n [2,\n3], ]\nb = 1", ("a", 1, 1), 4),
        ("a = [\n 1, # one ]\n [2,\n3], ]\nb = 1", ("b",), 5),
        ('a = """\n[b]\nc = 1"""\nd = 1', ("d",), 4),
        ('a = """x\\"""" # """\nd = 1', ("d",), 2),
        ("a = '''\n''''' \nd = 1", ("d",), 3),
        ('a = { b = "}", c = { d = [\n1] } }\ne = 2026-01-01 00:00:00 # x', ("a", "c", "d", 0), 2),
        ('a = { b = "}", c = { d = [\n1] } }\ne = 2026-01-01 00:00:00 # x', ("e",), 3),
        ("[[a]]\nb = 1\n[[a]]\nb = 2\n[a.c]\nd = 3", ("a", 1, "b"), 4),
        ("[[a]]\nb = 1\n[[a]]\nb = 2\n[a.c]\nd = 3", ("a", 1, "c", "d"), 6),
    ],
)
def test_lines_of_keys(text: str, path: tuple[str | int, ...], line: int) -> None:
    assert key_lines(text)[path] == line


def test_the_schema_tells_units_and_what_is_needed() -> None:
    schema = json_schema()
    parts = schema["$defs"]
    assert schema["required"] == ["schema", "grid", "wire"]
    assert schema["oneOf"][0] == {"required": ["punch"]}
    assert schema["additionalProperties"] is False
    assert "[mm]" in parts["PunchCase"]["properties"]["rim_radius"]["description"]
    assert parts["SphereProfile"]["required"] == ["kind", "radius"]
    assert parts["LinearHardening"]["required"] == ["kind", "modulus"]
    assert {"required": ["diameter", "material"]} in parts["WireCase"]["anyOf"]
    assert "304 annealed" in parts["WireCase"]["properties"]["material"]["anyOf"][0]["enum"]
    assert json.loads(json.dumps(schema)) == schema
    for name, part in parts.items():
        for key, entry in part["properties"].items():
            named = "description" in entry or key in ("kind", "shape")
            assert named, f"{name}.{key} has no description"


positive = st.floats(1e-3, 1e3)
lengths = st.floats(-1e3, 1e3)


def increasing(least: int) -> st.SearchStrategy[tuple[tuple[float, float], ...]]:
    columns = st.lists(st.tuples(lengths, lengths), min_size=least, max_size=30, unique_by=lambda row: row[0])
    return columns.map(lambda rows: tuple(sorted(rows)))


@st.composite
def corrections(draw: st.DrawFn) -> FieldPoints | RadialPoints:
    heights = st.floats(-1, 1)
    if draw(st.booleans()):
        return RadialPoints(points=draw(increasing(4)))
    places = draw(st.lists(st.integers(-900, 900), min_size=4, max_size=6, unique=True))
    return FieldPoints(points=tuple((x / 7, y / 3, draw(heights)) for x in places for y in places))


profiles = st.one_of(
    st.builds(ParaboloidProfile, focal_length=positive),
    st.builds(SphereProfile, radius=positive),
    st.builds(EllipsoidProfile, radius=positive, height=positive),
    st.builds(ConeProfile, half_angle=st.floats(0.01, 1.57), nose_radius=positive),
    st.builds(FlatProfile, height=positive, edge_radius=positive),
    st.builds(PolynomialProfile, coefficients=st.lists(lengths, min_size=2, max_size=8).map(tuple)),
    st.builds(TableProfile, points=increasing(3)),
    st.builds(ExpressionProfile, z=st.text(max_size=40)),
)
blanks = st.one_of(
    st.builds(CircleBlank, radius=st.floats(500, 1000)),
    st.builds(RectangleBlank, size=st.tuples(st.floats(1000, 2000), st.floats(1000, 2000))),
    st.just(PolygonBlank(points=((-900, -900), (900, -900), (0.1, 900)))),
)
grids = st.builds(
    GridCase,
    step=st.tuples(st.floats(5, 50), st.floats(5, 50)),
    weave=st.sampled_from(["plain", "same"]),
    blank=blanks,
    centre=st.sampled_from(["node", "cell"]),
    symmetry=st.sampled_from(["quarter", "full"]),
    crossing=st.one_of(st.sampled_from(["pinned", "welded"]), st.builds(CrossingSpring, stiffness=positive)),
)
lines = st.one_of(
    st.builds(CosineLine, height=st.floats(0, 4), segments=st.integers(1, 200)),
    st.builds(StraightLine, height=st.floats(0, 4)),
    st.just(PointsLine(points=((0.0, 0.0, 0.0), (4.0, 0.1, 0.2), (5.0, 0.0, 1 / 3)))),
)
shares = st.floats(0, 1)
laws = st.one_of(
    st.sampled_from(["none", "perfect"]),
    st.builds(LinearHardening, modulus=positive, kinematic=shares),
    st.builds(VoceHardening, saturation=positive, rate=positive, modulus=positive, kinematic=shares),
    st.builds(PowerHardening, strength=positive, exponent=st.floats(0.01, 0.9), kinematic=shares),
)
sections = st.one_of(
    st.sampled_from(["resultants", "fibres"]),
    st.builds(FibreSection, rings=st.integers(1, 64), sectors=st.integers(4, 256)),
)
curves = st.one_of(
    st.builds(TableHardening, points=st.just(((0.0, 300.0), (0.1, 1000 / 3))), kinematic=shares),
    st.builds(TensileHardening, points=st.just(((-0.1, -1.0), (0.1, 1 / 3)))),
)
matrices = st.lists(st.lists(lengths, min_size=6, max_size=6).map(tuple), min_size=6, max_size=6).map(tuple)
wires = st.one_of(
    st.builds(
        WireCase,
        diameter=st.floats(0.01, 4),
        youngs_modulus=positive,
        poisson=st.floats(-0.9, 0.5),
        yield_strength=st.none() | positive,
        centreline=lines,
    ),
    st.builds(
        WireCase,
        diameter=st.floats(0.01, 4),
        youngs_modulus=positive,
        yield_strength=positive,
        hardening=laws,
        section=sections,
    ),
    st.builds(WireCase, diameter=st.floats(0.01, 4), youngs_modulus=positive, hardening=curves),
    st.builds(
        WireCase,
        diameter=st.floats(0.01, 4),
        material=st.sampled_from(["304 annealed", "Al 5056-H38"]),
        hardening=st.just("none") | curves,
    ),
    st.builds(WireCase, diameter=st.floats(0.01, 4), material=st.just("brass hard"), density=positive),
    st.builds(WireCase, stiffness=st.just("paper"), height=st.floats(0, 4)),
    st.builds(WireCase, stiffness=matrices, diameter=st.floats(0.01, 4)),
)
presses = st.builds(
    PressCase,
    kinematics=st.just("free"),
    offset=st.sampled_from(["centred", "lower"]),
    method=st.sampled_from(["newton", "descent"]),
    pull=st.none() | st.tuples(st.floats(0, 100), st.floats(0, 100)),
    descent=st.builds(DescentCase, rule=st.sampled_from(["exact", "fixed"]), step_length=positive),
)


def case_of(*, wire: WireCase, press: PressCase, **others: Any) -> Case:
    """A case whose press can follow its wire."""
    followed = press.model_copy(update={"method": "newton"}) if wire.yields else press
    return Case(wire=wire, press=followed, **others)


cases = st.builds(
    case_of,
    title=st.text(max_size=30),
    grid=grids,
    wire=wires,
    punch=st.builds(
        PunchCase,
        profile=profiles,
        rim_radius=st.floats(100, 500),
        fillet=st.floats(0, 100),
        correction=st.none() | corrections(),
    ),
    press=presses,
    solver=st.builds(SolverCase, tolerance=st.floats(1e-15, 1e-3), max_steps=st.integers(1, 999)),
    release=st.none()
    | st.builds(ReleaseCase, hold=st.just("nothing") | st.builds(HoldFrom, from_radius=st.floats(0, 400))),
    target=st.none() | st.builds(TargetCase, profile=profiles, aperture_radius=st.floats(1, 100), tolerance=positive),
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(cases)
def test_what_is_written_reads_back_equal(case: Case) -> None:
    text = write_case(case)
    assert case_from_text(text) == case
    assert write_case(case_from_text(text)) == text
