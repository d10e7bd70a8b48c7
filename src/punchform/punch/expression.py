"""A profile written as a formula in rho: read by a strict grammar, never executed as code.

Only numbers, `rho`, `pi`, + - * / **, brackets and a short list of functions pass; every other token is
refused by name. Parts without rho are numbers at once; the rest becomes a tree of Taylor arithmetic, whose
derivatives are exact.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.punch import taylor
from punchform.punch.taylor import FUNCTIONS, Taylor

LENGTH_LIMIT = 1000
DEPTH_LIMIT = 100
EXPONENT_LIMIT = 64

Formula = Callable[[Taylor], Taylor]

_TOKEN = re.compile(
    r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<sign>\*\*|[-+*/()])|(?P<space> +)",
    re.ASCII,
)
_NOT_SMOOTH = ("abs", "min", "max", "floor", "ceil", "round", "sign")
_SUMS: dict[type[ast.operator], Callable[[Taylor, Taylor], Taylor]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_NUMBERS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


@dataclass(frozen=True)
class Expression:
    """A height function f(rho) from a formula; NaN where the formula is not defined."""

    text: str
    formula: Formula

    def __call__(self, rho: Floats) -> tuple[Floats, Floats, Floats]:
        with np.errstate(all="ignore"):
            result = self.formula(taylor.variable(rho))
        return result.value, result.first, result.second


def expression(text: str, *, where: str) -> Expression:
    """The formula of an expression profile, for example "-rho**2 / 1000" with rho and z in mm.

    Raises InputError that names the first thing that is not allowed.
    """
    reader = _Reader(where)
    text = " ".join(text.split())
    reader.check_tokens(text)
    try:
        tree = ast.parse(text, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise reader.refusal(f"`{_shown(text)}` is not a complete formula", "check brackets and operators") from None
    result = reader.read(tree.body, 0)
    if isinstance(result, float):
        raise reader.refusal(f"`{_shown(text)}` does not depend on rho")
    return Expression(text, result)


@dataclass(frozen=True)
class _Reader:
    where: str

    def refusal(self, message: str, hint: str = "") -> InputError:
        return InputError.of(message, where=self.where, hint=hint)

    def check_tokens(self, text: str) -> None:
        """Every token is a number, a known name or an arithmetic sign."""
        if len(text) > LENGTH_LIMIT:
            raise self.refusal(f"the expression is longer than {LENGTH_LIMIT} characters", "give a table of points")
        place, before = 0, ""
        while place < len(text):
            token = _TOKEN.match(text, place)
            if token is None:
                hint = "write powers as rho**2" if text[place] == "^" else "only numbers, rho, + - * / ** ( )"
                shown = text[place] if text[place].isprintable() else ascii(text[place])
                raise self.refusal(f"`{shown}` is not allowed in an expression", hint)
            if token.lastgroup == "name":
                self.check_name(token.group())
                if before == "number":
                    raise self.refusal(f"`{text[:place].split()[-1]}{token.group()}`: write the * of a product")
            place, before = token.end(), str(token.lastgroup)

    def check_name(self, name: str) -> None:
        if name in ("rho", "pi") or name in FUNCTIONS:
            return
        if name in _NOT_SMOOTH:
            raise self.refusal(
                f"`{name}` is not allowed: it makes the profile not smooth",
                "rho is never negative, so abs(rho) is rho" if name == "abs" else "",
            )
        raise self.refusal(f"`{name}` is not known in an expression", f"known: rho, pi, {', '.join(FUNCTIONS)}")

    def read(self, node: ast.expr, depth: int) -> Formula | float:
        """A number when the part does not contain rho, else its formula."""
        if depth > DEPTH_LIMIT:
            raise self.refusal("the expression is nested too deeply", "give a table of points")
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return self.number(lambda: float(value))
            case ast.Name(id="rho"):
                return lambda rho: rho
            case ast.Name(id="pi"):
                return math.pi
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.read(operand, depth + 1)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return _negative(self.read(operand, depth + 1))
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self.power(self.read(left, depth + 1), self.read(right, depth + 1))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _SUMS:
                return self.combine(type(op), self.read(left, depth + 1), self.read(right, depth + 1))
            case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in FUNCTIONS:
                return self.apply(name, self.read(argument, depth + 1))
            case ast.Call(func=ast.Name(id=name)) if name in FUNCTIONS:
                raise self.refusal(f"`{name}` takes one argument")
            case ast.Name(id=name):
                raise self.refusal(f"`{name}` is a function: write {name}(...)")
            case _:
                raise self.refusal("only sums, products, powers and known functions are allowed")

    def combine(self, op: type[ast.operator], left: Formula | float, right: Formula | float) -> Formula | float:
        if isinstance(left, float) and isinstance(right, float):
            return self.number(lambda: _NUMBERS[op](left, right))
        a, b, join = _formula(left), _formula(right), _SUMS[op]
        return lambda rho: join(a(rho), b(rho))

    def power(self, base: Formula | float, exponent: Formula | float) -> Formula | float:
        if not isinstance(exponent, float):
            raise self.refusal("an exponent must be a number", "write exp(...) for an exponential")
        if abs(exponent) > EXPONENT_LIMIT:
            raise self.refusal(f"the exponent {exponent:g} is too large; at most {EXPONENT_LIMIT} is allowed")
        if isinstance(base, float):
            return self.number(lambda: math.pow(base, exponent))
        return lambda rho: taylor.power(base(rho), exponent)

    def apply(self, name: str, argument: Formula | float) -> Formula | float:
        function = FUNCTIONS[name]
        if isinstance(argument, float):
            at = taylor.constant(argument, np.zeros(1))
            with np.errstate(all="ignore"):
                return self.number(lambda: float(function(at).value[0]))
        return lambda rho: function(argument(rho))

    def number(self, compute: Callable[[], float]) -> float:
        try:
            value = compute()
        except (ArithmeticError, ValueError):
            value = math.nan
        if not math.isfinite(value):
            raise self.refusal("a number in the expression is too large or not defined")
        return value


def _formula(part: Formula | float) -> Formula:
    if isinstance(part, float):
        return lambda rho: taylor.constant(part, rho.value)
    return part


def _negative(part: Formula | float) -> Formula | float:
    if isinstance(part, float):
        return -part
    return lambda rho: -part(rho)


def _shown(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
