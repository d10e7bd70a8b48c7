"""Copies of a case with some settings replaced: checked like a new one, and what was left out follows."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from punchform.case import Case, CosineLine, case_from_text, read_case, write_case
from punchform.errors import InputError

SHORT = """\
schema = 1
[grid]
step = "7.5 mm"
blank = { shape = "circle", radius = "345 mm" }
[wire]
diameter = "0.75 mm"
youngs_modulus = "210 GPa"
[punch]
profile = { kind = "sphere", radius = "400 mm" }
rim_radius = "300 mm"
"""
COSINE = SHORT.replace("[punch]", 'centreline = { kind = "cosine", segments = 8 }\n[punch]')
OWN = SHORT.replace("[punch]", 'centreline = { kind = "cosine", height = "0.6 mm" }\n[punch]')


def with_wire(case: Case, **settings: Any) -> Case:
    return case.model_copy(update={"wire": case.wire.model_copy(update=settings)})


@pytest.mark.parametrize("text", [SHORT, COSINE])
def test_a_crimp_that_was_left_out_follows_the_diameter(text: str) -> None:
    case = case_from_text(text)
    thicker = with_wire(with_wire(case, diameter=1.0), diameter="1.25 mm")
    assert thicker == case_from_text(text.replace("0.75 mm", "1.25 mm"))
    assert isinstance(thicker.wire.centreline, CosineLine)
    assert (thicker.wire.centreline.height, thicker.wire.height) == (1.25, 1.25)
    assert case.wire.height == 0.75


def test_what_a_material_gave_follows_the_material() -> None:
    case = case_from_text(SHORT.replace('youngs_modulus = "210 GPa"', 'material = "304 annealed"\npoisson = 0.3'))
    bronze = with_wire(with_wire(case, diameter=1.0), material="phosphor bronze hard").wire
    assert (bronze.youngs_modulus, bronze.poisson, bronze.yield_strength) == (110e3, 0.3, 750)
    assert case.wire.youngs_modulus == 193e3


def test_a_crimp_that_was_given_stays() -> None:
    wire = with_wire(case_from_text(OWN), diameter=1.0).wire
    assert (wire.diameter, wire.height, wire.centreline) == (1.0, 0.6, CosineLine(height=0.6))
    # The resolved case gives everything.
    resolved = case_from_text(write_case(case_from_text(SHORT)))
    assert with_wire(resolved, diameter=1.0).wire.height == 0.75


def test_a_height_that_contradicts_the_centreline_is_refused() -> None:
    with pytest.raises(InputError, match="1 mm contradicts the centreline"):
        with_wire(case_from_text(SHORT), height=1.0)
    assert with_wire(case_from_text(SHORT), centreline=CosineLine(height=1.0)).wire.height == 1.0


def test_a_fillet_that_was_left_out_follows_the_rim() -> None:
    punch = case_from_text(SHORT).tool
    assert punch.model_copy(update={"rim_radius": 200.0}).fillet == 20.0
    assert punch.model_copy(update={"fillet": 5.0}).model_copy(update={"rim_radius": 200.0}).fillet == 5.0


def test_copies_are_checked() -> None:
    case = read_case("packaged:check")
    assert case.grid.model_copy(update={"step": "6 mm"}).step == (6.0, 6.0)
    with pytest.raises(ValidationError, match="setp"):
        case.grid.model_copy(update={"setp": 6.0})
    with pytest.raises(InputError, match="not to the rim"):
        case.model_copy(update={"punch": case.tool.model_copy(update={"rim_radius": 400.0})})


@pytest.mark.parametrize("name", ["check", "paper"])
def test_a_copy_without_changes_is_equal(name: str) -> None:
    case = read_case(f"packaged:{name}")
    copy = case.model_copy(deep=True)
    assert copy == case
    assert copy.model_fields_set == case.model_fields_set
