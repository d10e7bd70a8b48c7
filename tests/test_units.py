"""Quantities: every unit against its definition, exact rounding, dimensions kept apart."""

from __future__ import annotations

import contextlib
import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from punchform.units import (
    ANGLE,
    COMPLIANCE,
    FORCE,
    LENGTH,
    NUMBER,
    ROTARY_STIFFNESS,
    STRESS,
    Dimension,
    UnitError,
    length_power,
    quantity,
    show,
)

DIMENSIONS = (LENGTH, FORCE, STRESS, ANGLE, ROTARY_STIFFNESS, COMPLIANCE, NUMBER, length_power(-2))
relaxed = settings(deadline=None)
FLOATS = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("7.5 mm", LENGTH, 7.5),
        ("0.75e-3 m", LENGTH, 0.75),
        ("0.3in", LENGTH, 7.62),
        ("1 ft", LENGTH, 304.8),
        ("1 mil", LENGTH, 0.0254),
        ("750 µm", LENGTH, 0.75),
        ("\N{MINUS SIGN}3 cm", LENGTH, -30.0),
        ("1 lbf", FORCE, 4.4482216152605),
        ("1 kgf", FORCE, 9.80665),
        ("2 kN", FORCE, 2000.0),
        ("210 GPa", STRESS, 210000.0),
        ("2.1e11 Pa", STRESS, 210000.0),
        ("1 N/mm^2", STRESS, 1.0),
        ("1 N/mm²", STRESS, 1.0),
        ("1e6 N / m**2", STRESS, 1.0),
        ("1 N/mm/mm", STRESS, 1.0),
        ("1 psi", STRESS, 0.006894757293168361),
        ("180 deg", ANGLE, math.pi),
        ("180°", ANGLE, math.pi),
        ("5 mrad", ANGLE, 0.005),
        ("20 N*mm/rad", ROTARY_STIFFNESS, 20.0),
        ("20 N mm/rad", ROTARY_STIFFNESS, 20.0),
        ("0.02 N·m/rad", ROTARY_STIFFNESS, 20.0),
        ("1 mm/kN", COMPLIANCE, 0.001),
        ("2 1/mm", length_power(-1), 2.0),
        ("-0.5 m^-1", length_power(-1), -0.0005),
        ("0.25", NUMBER, 0.25),
        ("7.5", LENGTH, 7.5),
        (7, LENGTH, 7.0),
    ],
)
def test_known_quantities(text: object, dimension: Dimension, value: float) -> None:
    assert quantity(text, dimension) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("0.75 mmm", "did you mean `mm`?"),
        ("5 MM", "did you mean `mm`?"),
        ("7,5 mm", "write a decimal point, not a comma"),
        ("3 N", "`N` is a unit of force"),
        ("3 mm^2", "`mm^2` measures something else"),
        ("3 mm*", "`mm*` is not a unit"),
        ("3 furlongs", "no unit is called `furlongs`"),
        ("mm", ""),
        ("", ""),
        ("3 mm 4", ""),
        ("1_000 mm", ""),
        ("0x10 mm", ""),
        ("٣ mm", ""),
        (None, ""),
        (True, ""),
        ([3], ""),
        ({"mm": 3}, ""),
    ],
)
def test_what_is_no_length(text: object, hint: str) -> None:
    with pytest.raises(UnitError, match=r"expected a length such as '0\.75 mm', not") as caught:
        quantity(text, LENGTH)
    assert hint in caught.value.hint


@pytest.mark.parametrize(
    "value",
    [
        math.nan,
        math.inf,
        -math.inf,
        10**400,
        "nan",
        "nan mm",
        "inf mm",
        "-Infinity",
        "1e400",
        "1e400 mm",
        "1e308 m",
    ],
)
def test_what_is_not_finite(value: object) -> None:
    with pytest.raises(UnitError, match="expected a finite number"):
        quantity(value, LENGTH)


def test_an_exponent_beyond_all_floats_costs_no_memory() -> None:
    assert quantity("1e-999999999 mm", LENGTH) == 0.0
    with pytest.raises(UnitError, match="finite"):
        quantity("1e999999999 mm", LENGTH)


def test_radians_are_not_dropped() -> None:
    with pytest.raises(UnitError, match="a rotational stiffness"):
        quantity("20 N*mm", ROTARY_STIFFNESS)


@relaxed
@given(FLOATS, st.sampled_from(DIMENSIONS))
def test_what_is_shown_reads_back_to_the_bit(value: float, dimension: Dimension) -> None:
    assert quantity(show(value, dimension), dimension).hex() == value.hex()


@relaxed
@given(st.decimals(-(10**9), 10**9, places=6))
def test_a_change_of_unit_rounds_once(number: object) -> None:
    exact = Fraction(str(number))
    assert quantity(f"{number} m", LENGTH) == float(exact * 1000)
    assert quantity(f"{number} in", LENGTH) == float(exact * Fraction("25.4"))
    assert quantity(f"{number}e6 Pa", STRESS) == quantity(f"{number} MPa", STRESS) == float(exact)


@relaxed
@given(FLOATS, st.sampled_from(["mm", "N/N*mm", "MPa*mm^2/N*mm", "mm*rad/rad", "mm^2/mm", "1/mm^-1"]))
def test_a_dimension_may_be_written_in_many_ways(number: float, unit: str) -> None:
    assert quantity(f"{number!r} {unit}", LENGTH) == number


@relaxed
@given(st.text(max_size=12))
def test_any_text_is_a_quantity_or_a_clear_error(text: str) -> None:
    with contextlib.suppress(UnitError):
        assert math.isfinite(quantity(text, LENGTH))
