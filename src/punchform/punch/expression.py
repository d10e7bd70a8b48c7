"""A formula in a case, a profile in rho or a cost in figures: read by a strict grammar, never executed as code.

Only numbers, the names it is told of, `pi`, + - * / **, brackets and a short list of functions pass; every other
token is refused by name. Parts without names are numbers at once; the rest becomes a tree of Taylor arithmetic, whose
derivatives are exact.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.punch import taylor
from punchform.punch.taylor import FUNCTIONS, Taylor

LENGTH_LIMIT = 1000
DEPTH_LIMIT = 100
EXPONENT_LIMIT = 64
MOST_NAMED = 24

Point = Mapping[str, Taylor]
"""What stands for each name."""
Formula = Callable[[Point], Taylor]

_TOKEN = re.compile(
    r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*(?:\.[A-Za-z_]\w*|\[\d+\])*)"
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
            result = self.formula({"rho": taylor.variable(rho)})
        return result.value, result.first, result.second


@dataclass(frozen=True)
class Rule:
    """A number from other numbers by a formula; `names` are those that it needs."""

    text: str
    names: tuple[str, ...]
    formula: Formula

    def __call__(self, values: Mapping[str, float]) -> float:
        """The number for values of the names; NaN where the formula is not defined."""
        return float(self._at(values, None).value[0])

    def slope(self, values: Mapping[str, float], name: str) -> float:
        """Its derivative by one of the names, exact; 0 for a name that it does not have."""
        return float(self._at(values, name).first[0]) if name in self.names else 0.0

    def _at(self, values: Mapping[str, float], varied: str | None) -> Taylor:
        given = {name: np.array([values[name]]) for name in self.names}
        with np.errstate(all="ignore"):
            return self.formula(
                {
                    name: taylor.variable(value) if name == varied else taylor.constant(values[name], value)
                    for name, value in given.items()
                }
            )


def expression(text: str, *, where: str) -> Expression:
    """The formula of an expression profile, for example "-rho**2 / 1000" with rho and z in mm.

    Raises InputError that names the first thing that is not allowed.
    """
    reader = _Reader(where, ("rho",), "rho", "rho")
    text = " ".join(text.split())
    return Expression(text, reader.formula(text))


def rule(text: str, names: Collection[str], *, where: str) -> Rule:
    """The formula of a number from numbers that have names, such as "2.5 * wire_length / 1000 + 40 * mass".

    Raises InputError that names the first thing that is not allowed.
    """
    reader = _Reader(where, names, "any figure or setting", "mass")
    text = " ".join(text.split())
    formula = reader.formula(text)
    found = dict.fromkeys(token.group() for token in _TOKEN.finditer(text) if token.lastgroup == "name")
    return Rule(text, tuple(name for name in found if name in names), formula)


@dataclass(frozen=True)
class _Reader:
    """Reads a formula in some names; `on` says what it must depend on, `example` is a name for hints."""

    where: str
    names: Collection[str]
    on: str
    example: str

    def formula(self, text: str) -> Formula:
        """What the text says, for all names at once."""
        self.check_tokens(text)
        try:
            tree = ast.parse(text, mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise self.refusal(f"`{_shown(text)}` is not a complete formula", "check brackets and operators") from None
        result = self.read(tree.body, 0)
        if isinstance(result, float):
            raise self.refusal(f"`{_shown(text)}` does not depend on {self.on}")
        return result

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
                caret = text[place] == "^"
                hint = f"write powers as {self.example}**2" if caret else f"only numbers, {self.on}, + - * / ** ( )"
                shown = text[place] if text[place].isprintable() else ascii(text[place])
                raise self.refusal(f"`{shown}` is not allowed in an expression", hint)
            if token.lastgroup == "name":
                self.check_name(token.group())
                if before == "number":
                    raise self.refusal(f"`{text[:place].split()[-1]}{token.group()}`: write the * of a product")
            place, before = token.end(), str(token.lastgroup)

    def check_name(self, name: str) -> None:
        if name in self.names or name == "pi" or name in FUNCTIONS:
            return
        if name in _NOT_SMOOTH:
            raise self.refusal(
                f"`{name}` is not allowed: it makes the formula not smooth",
                "rho is never negative, so abs(rho) is rho" if name == "abs" and "rho" in self.names else "",
            )
        known = ", ".join((*list(self.names)[:MOST_NAMED], "pi", *FUNCTIONS))
        raise self.refusal(f"`{_shown(name)}` is not known in an expression", f"known: {known}")

    def read(self, node: ast.expr, depth: int) -> Formula | float:
        """A number when the part contains no name, else its formula."""
        if depth > DEPTH_LIMIT:
            raise self.refusal("the expression is nested too deeply", "give a table of points")
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return self.number(lambda: float(value))
            case ast.Name() | ast.Attribute() | ast.Subscript() if ast.unparse(node) in self.names:
                name = ast.unparse(node)
                return lambda at: at[name]
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
        return lambda at: join(a(at), b(at))

    def power(self, base: Formula | float, exponent: Formula | float) -> Formula | float:
        if not isinstance(exponent, float):
            raise self.refusal("an exponent must be a number", "write exp(...) for an exponential")
        if abs(exponent) > EXPONENT_LIMIT:
            raise self.refusal(f"the exponent {exponent:g} is too large; at most {EXPONENT_LIMIT} is allowed")
        if isinstance(base, float):
            return self.number(lambda: math.pow(base, exponent))
        return lambda at: taylor.power(base(at), exponent)

    def apply(self, name: str, argument: Formula | float) -> Formula | float:
        function = FUNCTIONS[name]
        if isinstance(argument, float):
            given = taylor.constant(argument, np.zeros(1))
            with np.errstate(all="ignore"):
                return self.number(lambda: float(function(given).value[0]))
        return lambda at: function(argument(at))

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
        return lambda at: taylor.constant(part, next(iter(at.values())).value)
    return part


def _negative(part: Formula | float) -> Formula | float:
    if isinstance(part, float):
        return -part
    return lambda at: -part(at)


def _shown(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
