"""What the sections of a case are made of: frozen tables, and quantities with their limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from punchform.units import (
    ANGLE,
    COMPLIANCE,
    FORCE,
    FORCE_PER_LENGTH,
    LENGTH,
    NUMBER,
    ROTARY_STIFFNESS,
    STRESS,
    Dimension,
    UnitError,
    as_written,
    quantity,
    show,
    without_unit,
)


class Part(BaseModel):
    """A table of the case file: it cannot be changed, and it refuses keys it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A table with some settings replaced, checked like a new one; what was left out follows them again.

        `deep` changes nothing: what a table holds is frozen. Raises what the constructor raises.
        """
        given = {name: getattr(self, name) for name in self.model_fields_set}
        return type(self).model_validate({**given, **(update or {})})


class MisfitError(ValueError):
    """A table whose entries do not belong together; `key` is where below the table, `hint` what to do."""

    def __init__(self, message: str, *, key: tuple[str | int, ...] = (), hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.key = key
        self.hint = hint


@dataclass(frozen=True)
class Quantity:
    """Marks a float as a quantity: read with its unit, limited, written with its unit again.

    Limits are in internal units: `above` and `below` are excluded, `least` and `most` included.
    """

    dimension: Dimension
    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf
    below: float = math.inf

    def read(self, value: object) -> float:
        """The value in internal units; raises UnitError outside the limits too."""
        number = quantity(value, self.dimension)
        broken = self._broken(number)
        if broken:
            raise UnitError(f"must be {broken}, not {as_written(value)}", self._hint(number, value))
        return number

    def write(self, value: float) -> str | float:
        """The value with its unit; a plain number stays a number."""
        return value if self.dimension == NUMBER else show(value, self.dimension)

    def _limit(self, limit: float) -> str:
        if self.dimension == ANGLE:
            return f"{math.degrees(limit):g} deg"
        return f"{limit:g} {self.dimension.unit}".rstrip() if limit else "0"

    def _broken(self, number: float) -> str:
        """The limit that a number does not keep, in words; empty when it keeps all."""
        broken = (
            (number <= self.above, "more than", self.above),
            (number < self.least, "at least", self.least),
            (number > self.most, "at most", self.most),
            (number >= self.below, "less than", self.below),
        )
        return next((f"{words} {self._limit(limit)}" for is_broken, words, limit in broken if is_broken), "")

    def _hint(self, number: float, value: object) -> str:
        degrees_meant = self.dimension == ANGLE and without_unit(value) and not self._broken(math.radians(number))
        return f"a bare number is in rad: write '{number:g} deg' if degrees are meant" if degrees_meant else ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(
            self.read,
            handler(source),
            serialization=core_schema.plain_serializer_function_ser_schema(self.write, when_used="json"),
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        text = {"type": "string", "examples": [self.dimension.example]}
        unit = f"; a bare number is in {self.dimension.unit}" if self.dimension.unit else ""
        return {"anyOf": [{"type": "number", **self._limits()}, text], "description": self.dimension.name + unit}

    def _limits(self) -> dict[str, float]:
        """The finite limits by the words of JSON schema."""
        limits = {"minimum": self.least, "exclusiveMinimum": self.above}
        limits |= {"maximum": self.most, "exclusiveMaximum": self.below}
        return {word: limit for word, limit in limits.items() if math.isfinite(limit)}


# A nanometre and a thousand kilometres: beyond them a unit is wrong, and products of lengths would overflow.
_SMALLEST, _LARGEST = 1e-6, 1e9

Length = Annotated[float, Quantity(LENGTH, least=-_LARGEST, most=_LARGEST)]
PositiveLength = Annotated[float, Quantity(LENGTH, above=0.0, least=_SMALLEST, most=_LARGEST)]
LengthFromZero = Annotated[float, Quantity(LENGTH, least=0.0, most=_LARGEST)]
Force = Annotated[float, Quantity(FORCE)]
ForcePerLengthFromZero = Annotated[float, Quantity(FORCE_PER_LENGTH, least=0.0)]
PositiveStress = Annotated[float, Quantity(STRESS, above=0.0, most=1e9)]
Angle = Annotated[float, Quantity(ANGLE)]
WallAngle = Annotated[float, Quantity(ANGLE, above=0.0, below=math.pi / 2)]
PositiveRotaryStiffness = Annotated[float, Quantity(ROTARY_STIFFNESS, above=0.0)]
PositiveCompliance = Annotated[float, Quantity(COMPLIANCE, above=0.0)]
Number = Annotated[float, Quantity(NUMBER)]
Count = Annotated[int, Field(strict=True, ge=1, le=1_000_000)]
