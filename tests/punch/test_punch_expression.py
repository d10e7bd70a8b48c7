"""Formulas in rho: what is refused, and that derivatives are exact."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from punchform.errors import InputError
from punchform.punch.expression import DEPTH_LIMIT, expression
from punchform.punch.taylor import FUNCTIONS


def refusal(text: str) -> str:
    with pytest.raises(InputError) as caught:
        expression(text, where="punch.profile.z")
    (problem,) = caught.value.problems
    assert problem.where == "punch.profile.z"
    return problem.message


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "rho.__class__",
        "().__class__.__bases__",
        "(lambda: 1)()",
        "lambda rho: rho",
        "[rho for rho in (1, 2)]",
        "{rho: 1}",
        "(x := 3) + rho",
        "'rho'",
        '"rho"',
        "f'{rho}'",
        "eval(rho)",
        "exec(rho)",
        "open(rho)",
        "getattr(rho, sin)",
        "__builtins__",
        "rho if rho else 1",
        "rho and 1",
        "not rho",
        "rho < 3",
        "rho[0]",
        "rho @ rho",
        "rho // 2",
        "rho % 2",
        "rho ^ 2",
        "rho | 1",
        "~rho",
        "rho, rho",
        "*rho",
        "sin(*rho)",
        "sin(**rho)",
        "sin(rho, rho)",
        "sin(rho=1)",
        "sin()",
        "sin",
        "sin + rho",
        "rho(2)",
        "2(rho)",
        "pi(rho)",
        "sin(cos)(rho)",
        "2 rho",
        "2rho",
        "0x10*rho",
        "1_000*rho",
        "1j*rho",
        "1or rho",
        "08*rho",
        "1..real*rho",
        "True*rho",
        "None",
        "...",
        "rho;rho",
        "rho = 2",
        "rho\\n",
        "rho # comment",
        "rho\x00",
        "ｒｈｏ",
        "ρ",
        "٣*rho",
        "",
        "   ",
        "(rho",
        "rho)",
        "rho +",
        "rho ** ",
        "10**10**10*rho",
        "9**9**9**9 + rho",
        "rho**1000000",
        "rho**-65",
        "rho**rho",
        "2**rho",
        "((1e300*1e300))*rho",
        "1/0 + rho",
        "sqrt(-1)*rho",
        "(-8)**0.5*rho",
        "log(0) + rho",
        "1e999*rho",
        "9" * 400 + "*rho",
        "5",
        "pi**2",
        "-" * 400 + "rho",
        "(" * 450 + "rho" + ")" * 450,
        "sin(" * 150 + "rho" + ")" * 150,
        "rho+" * 120 + "rho",
        "rho + 1" + " + 1" * 300,
        "foo(rho)",
        "tau*rho",
        "sec(rho)",
    ],
)
def test_everything_but_a_formula_is_refused(text: str) -> None:
    message = refusal(text)
    assert message
    assert len(message) < 200


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("abs(rho)", "not smooth"),
        ("min(rho)", "not smooth"),
        ("x**2", "`x` is not known"),
        ("rho^2", "`^` is not allowed"),
        ("2rho", "`2rho`: write the *"),
        ("rho**2 +", "not a complete formula"),
        ("rho**100", "exponent 100 is too large"),
        ("3", "does not depend on rho"),
        ("sin(rho, 2)", "`,` is not allowed"),
    ],
)
def test_refusals_say_what_is_wrong(text: str, words: str) -> None:
    assert words in refusal(text)


@given(st.text(alphabet="rho0123456789.+-*/() sincexplgtaqd_,[]'\"=:", max_size=40))
@settings(max_examples=300, deadline=None)
def test_no_text_does_anything_but_parse_or_refuse(text: str) -> None:
    try:
        function = expression(text, where="")
    except InputError:
        return
    for part in function(np.linspace(0.0, 1.0, 3)):
        assert part.shape == (3,)


FORMULAS = [
    "-rho**2/1000",
    "+3.5 - (rho/7)**3 * .5e-1",
    "rho**0 + rho**1 + rho**2 + rho**3 - rho**-2",
    "1/(1 + rho**2) - (rho + 1)/(rho**3 + 2)",
    "(2 + rho)**2.5 - (1 + rho)**-0.5",
    "sqrt(4 - rho**2) * exp(-rho/3) + log(2 + rho)",
    "sin(2*rho)*cos(rho)**3 - tan(rho/4)",
    "asin(rho/5) + acos(rho/7) - atan(3*rho)",
    "sinh(rho)/cosh(rho) - tanh(rho) + tanh(rho**2)*pi",
    "-(-rho)**3 + 2**3**2*rho",
    "sqrt(2)*rho - sin(1)*rho**2",
]


@pytest.mark.parametrize("text", FORMULAS)
def test_derivatives_agree_with_symbolic_ones(text: str) -> None:
    rho = sympy.Symbol("rho")
    symbolic = sympy.sympify(text, locals={"rho": rho})
    at = np.array([0.3, 0.75, 1.25])
    got = expression(text, where="")(at)
    for order, part in enumerate(got):
        derivative = sympy.diff(symbolic, rho, order)
        exact = [float(derivative.subs(rho, sympy.Float(float(r), 30)).evalf(20)) for r in at]
        assert part == pytest.approx(exact, rel=2e-13, abs=1e-13)


@pytest.mark.parametrize("name", list(FUNCTIONS))
def test_every_function_has_its_second_derivative(name: str) -> None:
    rho = sympy.Symbol("rho")
    formula = getattr(sympy, name)(0.2 + rho**2 / 2)
    got = expression(f"{name}(0.2 + rho**2/2)", where="")(np.array([0.9]))
    for order, part in enumerate(got):
        assert part[0] == pytest.approx(float(sympy.diff(formula, rho, order).subs(rho, 0.9)), rel=1e-13)


def test_the_axis_is_exact_for_even_formulas() -> None:
    for text in ("-rho**2/1000", "cos(rho/100)", "sqrt(rho**2 + 25)", "exp(-rho**2)", "rho**4 - rho**3"):
        _, slope, bend = expression(text, where="")(np.zeros(1))
        assert slope[0] == 0.0
        assert np.isfinite(bend[0])


def test_line_breaks_are_spaces_and_long_sums_pass() -> None:
    function = expression("-rho**2\n / 1000", where="")
    assert function(np.array([10.0]))[0] == pytest.approx(-0.1)
    assert expression(" + ".join(["rho"] * (DEPTH_LIMIT // 2)), where="")(np.ones(1))[0] == DEPTH_LIMIT // 2
