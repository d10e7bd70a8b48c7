"""The [scatter] section: by how much numbers of the case vary from piece to piece."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from punchform.case.parts import MisfitError, Part
from punchform.units import UnitError, as_written

EXAMPLE = "a share such as '3 %' or a quantity such as '0.1 mm'"
PERCENT = re.compile(r"\s*\+?([0-9]+\.?[0-9]*|\.[0-9]+)\s*%\s*")


def _amount(value: Any) -> str | float:
    """A share in per cent or a quantity of any dimension, which only its setting knows."""
    if isinstance(value, str) and ("%" not in value or PERCENT.fullmatch(value)) and re.search(r"[0-9]", value):
        return value.strip()
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise UnitError(f"expected {EXAMPLE}, not {as_written(value)}")


Amount = Annotated[str | float, BeforeValidator(_amount)]


class Spread(Part):
    """How one number varies: normally about its nominal value, or evenly between two limits."""

    normal: Amount | None = Field(
        default=None, description="standard deviation: in per cent of the number, or its unit"
    )
    uniform: Amount | None = Field(
        default=None, description="how far to both sides, all alike: in per cent of the number, or its unit"
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.normal is None) == (self.uniform is None):
            raise MisfitError("expected either `normal` or `uniform`", hint="such as { normal = '5 %' }")
        return self

    @property
    def amount(self) -> str | float:
        """The standard deviation, or half the distance of the limits, as the file says it."""
        return self.uniform if self.normal is None else self.normal  # type: ignore[return-value]


def _normal_if_plain(value: Any) -> Any:
    if isinstance(value, Mapping) and not value.keys() <= Spread.model_fields.keys():
        raise MisfitError(
            f"expected {EXAMPLE}, or a table such as {{ uniform = '0.1 mm' }}",
            hint='a place stands in quotes with its dots: "wire.diameter" = "1 %"',
        )
    return value if isinstance(value, Mapping | Spread) else {"normal": _amount(value)}


class ScatterCase(Part):
    """How much each of some numbers varies from piece to piece: the place of the number in quotes, and the standard
    deviation of what it is, or a table { uniform = ... } with how far it goes to both sides."""

    model_config = ConfigDict(extra="allow")

    __pydantic_extra__: dict[str, Annotated[Spread, BeforeValidator(_normal_if_plain)]]

    @property
    def spreads(self) -> Mapping[str, Spread]:
        """The spreads by the places of their numbers."""
        return self.__pydantic_extra__
