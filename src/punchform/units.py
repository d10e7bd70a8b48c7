"""Quantities at the border: text with units in, floats in internal units (mm, N, MPa, rad) inside.

Numbers and unit factors are exact fractions, rounded once: "0.75e-3 m" and "0.75 mm" are the same float.
"""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache


@dataclass(frozen=True)
class Dimension:
    """What a quantity measures: exponents of length, force and angle, and the words for it.

    `unit` is the internal unit as it is written; `example` is a quantity for messages.
    """

    name: str
    length: int
    force: int
    angle: int
    unit: str
    example: str

    @property
    def exponents(self) -> tuple[int, int, int]:
        """Exponents of length, force and angle."""
        return self.length, self.force, self.angle


LENGTH = Dimension("a length", 1, 0, 0, "mm", "0.75 mm")
FORCE = Dimension("a force", 0, 1, 0, "N", "2.5 N")
STRESS = Dimension("a stress or modulus", -2, 1, 0, "MPa", "210 GPa")
ANGLE = Dimension("an angle", 0, 0, 1, "rad", "12 deg")
ROTARY_STIFFNESS = Dimension("a rotational stiffness", 1, 1, -1, "N*mm/rad", "20 N*mm/rad")
FORCE_PER_LENGTH = Dimension("a force per length", -1, 1, 0, "N/mm", "5 N/mm")
COMPLIANCE = Dimension("a compliance", 1, -1, 0, "mm/N", "0.001 mm/N")
NUMBER = Dimension("a plain number", 0, 0, 0, "", "0.25")

_NAMED = (LENGTH, FORCE, STRESS, ANGLE, ROTARY_STIFFNESS, FORCE_PER_LENGTH, COMPLIANCE, NUMBER)


def length_power(exponent: int) -> Dimension:
    """The dimension length^exponent, as for the coefficients of a polynomial profile.

    >>> length_power(-2).unit
    'mm^-2'
    """
    if exponent == 0:
        return NUMBER
    if exponent == 1:
        return LENGTH
    unit = f"mm^{exponent}"
    return Dimension(f"a quantity in {unit}", exponent, 0, 0, unit, f"0.002 {unit}")


def dimension_of(unit: str) -> Dimension:
    """The dimension whose internal unit is written like this.

    >>> dimension_of("MPa").name, dimension_of("mm^-1").name
    ('a stress or modulus', 'a quantity in mm^-1')
    """
    known = {dimension.unit: dimension for dimension in _NAMED}
    if unit in known:
        return known[unit]
    return length_power(int(unit.removeprefix("mm^")))


class UnitError(ValueError):
    """A quantity that cannot be read; `hint` says what may have been meant ("" when unknown)."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


_INCH = Fraction(254, 10)
_POUND_FORCE = Fraction("0.45359237") * Fraction("9.80665")
_DEGREE = Fraction(math.pi) / 180

# name -> (factor to the internal unit, exponents of length, force, angle)
_UNITS: dict[str, tuple[Fraction, tuple[int, int, int]]] = {
    **{
        name: (factor, (1, 0, 0))
        for name, factor in {
            "nm": Fraction(1, 10**6),
            "um": Fraction(1, 1000),
            "µm": Fraction(1, 1000),
            "μm": Fraction(1, 1000),
            "mm": Fraction(1),
            "cm": Fraction(10),
            "dm": Fraction(100),
            "m": Fraction(1000),
            "mil": _INCH / 1000,
            "thou": _INCH / 1000,
            "in": _INCH,
            "inch": _INCH,
            "ft": 12 * _INCH,
        }.items()
    },
    **{
        name: (factor, (0, 1, 0))
        for name, factor in {
            "mN": Fraction(1, 1000),
            "N": Fraction(1),
            "kN": Fraction(1000),
            "MN": Fraction(10**6),
            "gf": Fraction("0.00980665"),
            "kgf": Fraction("9.80665"),
            "lbf": _POUND_FORCE,
        }.items()
    },
    **{
        name: (factor, (-2, 1, 0))
        for name, factor in {
            "Pa": Fraction(1, 10**6),
            "kPa": Fraction(1, 1000),
            "MPa": Fraction(1),
            "GPa": Fraction(1000),
            "bar": Fraction(1, 10),
            "psi": _POUND_FORCE / _INCH**2,
            "ksi": 1000 * _POUND_FORCE / _INCH**2,
        }.items()
    },
    **{
        name: (factor, (0, 0, 1))
        for name, factor in {
            "rad": Fraction(1),
            "mrad": Fraction(1, 1000),
            "deg": _DEGREE,
            "°": _DEGREE,
        }.items()
    },
}

_QUANTITY = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)
_NOT_FINITE = re.compile(r"\s*[+-]?(?:nan|inf|infinity|∞)\b.*", re.IGNORECASE | re.DOTALL)
_DECIMAL_COMMA = re.compile(r"\s*[+-]?[0-9]+,[0-9]+(?![0-9,])")
_POWER = re.compile(r"([^\W\d_])([+-]?[0-9])")
_FACTOR = re.compile(r"([^\W\d_]+|°)(?:\^([+-]?[0-9]))?")


def without_unit(value: object) -> bool:
    """Whether a quantity of a case is a bare number, as text or not, and so in internal units.

    >>> without_unit("30"), without_unit(30), without_unit("30 deg")
    (True, True, False)
    """
    if not isinstance(value, str):
        return isinstance(value, int | float)
    matched = _QUANTITY.fullmatch(value)
    return matched is not None and not matched.group(2)


def as_written(value: object) -> str:
    """A value of a case file as a person would quote it in a sentence.

    >>> as_written("0.75 mmm"), as_written(True), as_written([1, 2])
    ("'0.75 mmm'", 'true', 'a list')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return repr(value if len(value) <= 60 else value[:57] + "...")
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return "a list"
    return str(value)


def quantity(value: object, dimension: Dimension) -> float:
    """The value in internal units of a quantity read from a case.

    Parameters: a text such as "7.5 mm" or "20 N*mm/rad", or a number, which is in internal units already.
    Returns a finite float in mm, N, MPa, rad (or their products).
    Raises UnitError when it is no number, not finite, of an unknown unit or of another dimension.

    >>> quantity("0.75e-3 m", LENGTH), quantity("210 GPa", STRESS), quantity(7.5, LENGTH)
    (0.75, 210000.0, 7.5)
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        return _finite(value, as_written(value), dimension)
    expected = f"expected {dimension.name} such as '{dimension.example}', not {as_written(value)}"
    if not isinstance(value, str):
        raise UnitError(expected)
    text = value.replace("\N{MINUS SIGN}", "-")
    if _NOT_FINITE.fullmatch(text):
        raise UnitError(f"expected a finite number, not {as_written(value)}")
    matched = _QUANTITY.fullmatch(text)
    if matched is None:
        raise UnitError(expected)
    number, unit = matched.groups()
    if not unit:
        return _finite(float(number), as_written(value), dimension)
    if _DECIMAL_COMMA.match(text):
        raise UnitError(expected, "write a decimal point, not a comma")
    factor, exponents, problem = _unit(unit)
    if problem is not None:
        raise UnitError(expected, problem)
    if exponents != dimension.exponents:
        raise UnitError(expected, _which(unit, exponents))
    return _scaled(number, factor, as_written(value), dimension)


def show(value: float, dimension: Dimension) -> str:
    """A value in internal units written with its unit; `quantity` reads back the same float.

    >>> show(0.75, LENGTH), show(210000.0, STRESS)
    ('0.75 mm', '210000 MPa')
    """
    return f"{value!r}".removesuffix(".0") + f" {dimension.unit}".rstrip()


def _finite(value: float, written: str, dimension: Dimension) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise UnitError(f"expected a finite number, not {written}", f"an example is '{dimension.example}'")
    return number


def _scaled(number: str, factor: Fraction, written: str, dimension: Dimension) -> float:
    rough = _finite(float(number), written, dimension)
    # Beyond the range of floats the exact fraction of "1e-999999999" would fill the memory.
    if rough == 0.0:
        return rough
    try:
        scaled = float(Fraction(number) * factor)
    except OverflowError:
        scaled = math.inf
    return _finite(scaled, written, dimension)


@cache
def _unit(text: str) -> tuple[Fraction, tuple[int, int, int], str | None]:
    """Factor and exponents of a unit such as "N*mm/rad", and what is wrong with it or None."""
    total, exponents = Fraction(1), (0, 0, 0)
    spelt = text.replace("**", "^").replace("·", "*").replace("²", "^2").replace("³", "^3")
    parts = re.split(r"\s*([*/])\s*|\s+", spelt)
    inverted = False
    for position, part in enumerate(parts):
        if position % 2:
            inverted = part == "/"
            continue
        if part == "1" and position == 0 and len(parts) > 1:
            continue
        matched = _FACTOR.fullmatch(part)
        if matched is None:
            return total, exponents, _with_carets(spelt) or f"`{text}` is not a unit"
        name, power_text = matched.groups()
        if name not in _UNITS:
            return total, exponents, _unknown(name)
        power = int(power_text or 1) * (-1 if inverted else 1)
        factor, own = _UNITS[name]
        total *= factor**power
        exponents = (
            exponents[0] + power * own[0],
            exponents[1] + power * own[1],
            exponents[2] + power * own[2],
        )
    return total, exponents, None


def _with_carets(text: str) -> str:
    """What to write instead of "N/mm2"; empty when carets alone make no unit of it."""
    proper = _POWER.sub(r"\1^\2", text)
    if proper == text:
        return ""
    _, exponents, problem = _unit(proper)
    if problem is not None:
        return ""
    return f"write `{proper}`" + (" or `MPa`" if exponents == STRESS.exponents else "")


def _unknown(name: str) -> str:
    same_letters = [unit for unit in _UNITS if unit.lower() == name.lower()]
    close = same_letters or difflib.get_close_matches(name, _UNITS, n=1, cutoff=0.5)
    if close:
        return f"no unit is called `{name}`: did you mean `{close[0]}`?"
    return f"no unit is called `{name}`; there are mm, m, in, N, kN, lbf, MPa, GPa, psi, rad, deg and products"


def _which(unit: str, exponents: tuple[int, int, int]) -> str:
    for dimension in _NAMED:
        if dimension.exponents == exponents:
            return f"`{unit}` is a unit of {dimension.name.split(' ', 1)[1]}"
    return f"`{unit}` measures something else"
