"""The library of materials: every law reaches the strength it is given, and elements know how their wire yields."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from punchform.case import WireCase
from punchform.case.materials import FACTS, library
from punchform.errors import InputError
from punchform.wire import hardening_of, pieces, stiffness
from punchform.wire.hardening import perfect
from punchform.wire.materials import Material, material, materials

PAGE = Path(__file__).resolve().parents[2] / "docs" / "materials.md"
EACH = pytest.mark.parametrize("one", materials(), ids=lambda one: one.name)


def wire(**values: Any) -> WireCase:
    return WireCase.model_validate({"diameter": 0.75, **values})


@EACH
def test_the_law_reaches_the_tensile_strength_where_the_wire_necks(one: Material) -> None:
    p = np.linspace(0.0, 0.6, 60_001)
    stress = one.hardening.flow(p)
    load = stress * np.exp(-p - stress / one.youngs_modulus)
    top = int(load.argmax())
    assert one.hardening.breaks_at == pytest.approx(p[top] + stress[top] / one.youngs_modulus, rel=0.05)
    assert one.law_strength == pytest.approx(load[top], rel=1e-4)
    assert one.law_strength == pytest.approx(one.tensile_strength, rel=0.02)
    # Where a remark tells a uniform strain, the law has it.
    told = re.search(r"uniform strain (?:of )?([0-9.]+)", one.remark)
    if told:
        assert one.hardening.breaks_at == pytest.approx(float(told[1].rstrip(".")), rel=0.01)


@EACH
def test_numbers_are_those_of_a_metal(one: Material) -> None:
    assert 60e3 < one.youngs_modulus < 220e3
    assert 0.2 < one.poisson < 0.4
    assert 2500 < one.density < 9000
    assert 100 <= one.yield_strength < one.tensile_strength < 2500
    assert one.hardening.yield_strength == one.yield_strength
    assert one.hardening.flow(0.002) < 1.2 * one.yield_strength
    assert one.source
    assert one.remark


def test_first_yield_in_bending_is_where_the_literature_of_reflectors_has_it() -> None:
    """A wire of 0.75 mm yields first at a radius of E d / 2 sigma_y."""
    radii = {"304 annealed": 353.0, "304 quarter-hard": 140.5, "304 spring": 54.1, "low-carbon soft": 309.0}
    radii |= {"low-carbon hard drawn": 154.5, "Al 5056-O": 175.2, "Al 5056-H38": 77.2}
    for name, radius in radii.items():
        one = material(name)
        assert one.youngs_modulus * 0.375 / one.yield_strength == pytest.approx(radius, abs=0.06)


def test_the_library_holds_settings_of_a_wire_and_facts() -> None:
    for entry in library().values():
        assert set(FACTS) < set(entry)
        assert set(entry) - set(FACTS) == {"youngs_modulus", "poisson", "density", "yield_strength", "hardening"}


def test_an_unknown_material_is_told_what_is_near() -> None:
    with pytest.raises(InputError, match="did you mean `phosphor bronze annealed` or `phosphor bronze hard`"):
        material("Bronze")
    with pytest.raises(InputError, match="did you mean `brass hard`"):
        material("bras hard")


def test_the_page_shows_the_library() -> None:
    rows = re.findall(r"^\| ([^|]+) \|(.*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    shown = {name: [cell.strip() for cell in cells.split("|")] for name, cells in rows}
    for one in materials():
        assert shown[one.name] == [
            f"{one.youngs_modulus / 1000:g}",
            f"{one.poisson:g}",
            f"{one.density:g}",
            f"{one.yield_strength:g}",
            f"{one.tensile_strength:g}",
            f"{one.hardening.breaks_at:.3f}",
            one.law,
        ]
    assert len([name for name in shown if name in library()]) == len(library())


def test_every_law_that_the_page_shows_is_one() -> None:
    shown = re.findall(r"^\| `(\{ kind = .*\}|\".*\")` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(shown) == 7
    for text in shown:
        law = tomllib.loads(f"law = {text}")["law"]
        if "file" not in law:
            begin = {} if "table" in text else {"yield_strength": "205 MPa"}
            found = hardening_of(wire(youngs_modulus="193 GPa", hardening=law, **begin))
            assert (found is None) == (law == "none")


def test_elements_and_their_pieces_know_how_their_wire_yields() -> None:
    case = wire(material="304 annealed", section={"rings": 2, "sectors": 6})
    first, second = stiffness(case, (7.5, 6.0))
    assert first.hardening is not None
    assert first.hardening is second.hardening
    np.testing.assert_array_equal(first.hardening.curve, material("304 annealed").hardening.curve)
    cut = pieces((first, second), 3)
    assert len(cut) == 6
    assert all(piece.hardening is first.hardening and piece.fibres == (2, 6) for piece in cut)


def test_a_wire_without_hardening_stays_elastic() -> None:
    elastic, yielding = wire(material="304 annealed", hardening="none"), wire(material="304 annealed")
    (one, _), (other, _) = (stiffness(case, (7.5, 7.5)) for case in (elastic, yielding))
    assert one.hardening is None
    np.testing.assert_array_equal(one.C, other.C)
    assert hardening_of(wire(youngs_modulus=193e3, yield_strength=205.0)) is None


@pytest.mark.parametrize(
    ("law", "modulus_at_once"),
    [
        ("perfect", 1e-5 * 193e3),
        ({"kind": "linear", "modulus": 2500.0}, 2500 * 193e3 / (193e3 - 2500)),
        ({"kind": "voce", "saturation": 500.0, "rate": 10.0, "modulus": 100.0}, 10 * 295 + 100),
        ({"kind": "power", "strength": 1275.0, "exponent": 0.45}, 0.45 * 205 / (205 / 1275) ** (1 / 0.45)),
        ({"kind": "table", "points": [(0.0, 210.0), (0.1, 310.0)]}, 1000.0),
    ],
)
def test_each_law_of_a_case_hardens_as_it_says(law: Any, modulus_at_once: float) -> None:
    found = hardening_of(wire(material="304 annealed", hardening=law))
    assert found is not None
    (p, stress), (next_p, next_stress) = found.curve[:2]
    assert (next_stress - stress) / (next_p - p) == pytest.approx(modulus_at_once, rel=0.03)
    assert found.kinematic == 0.0


def test_the_kinematic_share_reaches_the_element() -> None:
    law = {"kind": "linear", "modulus": 2500.0, "kinematic": 0.3}
    (one, _) = stiffness(wire(material="304 annealed", hardening=law), (7.5, 7.5))
    assert one.hardening is not None
    assert one.hardening.kinematic == 0.3


def test_a_law_that_needs_a_yield_strength_says_so() -> None:
    case = wire(youngs_modulus=193e3, hardening={"kind": "table", "points": [(0.0, 210.0), (0.1, 310.0)]})
    bare = case.model_construct(**{**dict(case), "hardening": "perfect", "yield_strength": None})
    with pytest.raises(InputError, match="nobody says at what stress"):
        hardening_of(bare)
    found = hardening_of(case.model_copy(update={"hardening": "perfect", "yield_strength": 210.0}))
    assert found is not None
    np.testing.assert_array_equal(found.curve, perfect(210.0, 193e3).curve)
