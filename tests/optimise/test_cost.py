"""A formula of figures and settings: read by the grammar of the profiles, with exact slopes."""

from __future__ import annotations

import math

import pytest

from punchform.errors import InputError
from punchform.punch.expression import rule

NAMES = ("mass", "wire_length", "wire.diameter", "grid.step[0]")


def test_a_formula_gives_a_number_and_says_what_it_needs() -> None:
    cost = rule("2.5 * wire_length / 1000 + 40 * mass", NAMES, where="optimise.cost")
    assert cost.names == ("wire_length", "mass")
    assert cost({"wire_length": 8000.0, "mass": 0.05}) == pytest.approx(22.0)


def test_places_of_settings_are_names() -> None:
    cost = rule("wire.diameter ** 2 * pi / 4 + grid.step[0]", NAMES, where="optimise.cost")
    assert cost({"wire.diameter": 2.0, "grid.step[0]": 1.0}) == pytest.approx(math.pi + 1)


def test_slopes_agree_with_differences() -> None:
    cost = rule("exp(mass) * sqrt(wire_length) / wire.diameter ** 1.5 + log(mass)", NAMES, where="optimise.cost")
    at = {"mass": 0.7, "wire_length": 3.0, "wire.diameter": 0.8, "grid.step[0]": 1.0}
    for name in NAMES:
        ends = [cost({**at, name: at[name] + sign * 1e-5}) for sign in (-1, 1)]
        assert cost.slope(at, name) == pytest.approx((ends[1] - ends[0]) / 2e-5, rel=1e-8, abs=1e-12)


def test_what_is_not_defined_is_no_number() -> None:
    assert math.isnan(rule("log(mass)", NAMES, where="")({"mass": -1.0}))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("price * mass", "`price` is not known"),
        ("wire.diametr", "`wire.diametr` is not known"),
        ("mass.__class__", "is not known"),
        ("mass[0]", "is not known"),
        ("__import__('os')", "is not known"),
        ("40", "does not depend on any figure or setting"),
        ("mass +", "not a complete formula"),
        ("mass ^ 2", "write powers as mass"),
        ("2 mass", "not a complete formula"),
        ("min(mass)", "not smooth"),
        ("mass ** mass", "an exponent must be a number"),
        ("mass if mass else 1", "is not known"),
    ],
)
def test_everything_but_a_formula_is_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        rule(text, NAMES, where="optimise.cost")
