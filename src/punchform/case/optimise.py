"""The [optimise] section: what a design search may change, what it improves, and what must hold."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, field_validator, model_serializer, model_validator

from punchform.case.findings import Finding
from punchform.case.load import LoadCase
from punchform.case.parts import Count, MisfitError, Number, Part, Quantity
from punchform.case.places import quoted
from punchform.case.target import TargetCase
from punchform.units import NUMBER

MOST_OBJECTIVES = 4
Method = Literal["auto", "gradient", "global"]
Setting = float | str | dict[str, Any]
"""What a case file may hold at a place: a number, a quantity with its unit, a word, a table."""


class VariableCase(Part):
    """What one setting may be: anything from one number to another, or one of a list."""

    model_config = ConfigDict(validate_by_name=True, validate_by_alias=True)

    least: int | float | str | None = Field(
        default=None, alias="from", description="the smallest value, as at its place"
    )
    most: int | float | str | None = Field(default=None, alias="to", description="the largest value, as at its place")
    among: tuple[bool | int | Setting, ...] | None = Field(
        default=None, description="the values to choose from, as at its place", min_length=2
    )

    @model_validator(mode="after")
    def _range_or_list(self) -> Self:
        if (self.among is None) == (self.least is None and self.most is None):
            raise MisfitError(
                "needs a range or a list",
                hint="write { from = ..., to = ... } or { among = [...] }, with the values that its place may have",
            )
        for name, end in (("from", self.least), ("to", self.most)):
            if self.among is None and end is None:
                raise MisfitError("is missing: a range has two ends", key=(name,))
        return self

    @model_serializer
    def _as_given(self) -> dict[str, Any]:
        if self.among is not None:
            return {"among": list(self.among)}
        return {"from": self.least, "to": self.most}


class LimitCase(Part):
    """What a figure must keep, in the unit of the figure."""

    least: Number | None = Field(default=None, description="the smallest value that is allowed")
    most: Number | None = Field(default=None, description="the largest value that is allowed")

    @model_validator(mode="after")
    def _limits(self) -> Self:
        if self.least is None and self.most is None:
            raise MisfitError("sets no limit", hint="write { least = ... }, { most = ... } or both")
        if self.least is not None and self.most is not None and self.least > self.most:
            raise MisfitError(f"nothing is at least {self.least:g} and at most {self.most:g}", key=("most",))
        return self


class ObjectiveCase(Part):
    """A figure to be made small, or large."""

    minimise: str | None = Field(default=None, description="the figure to be made small")
    maximise: str | None = Field(default=None, description="the figure to be made large")

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.minimise is None) == (self.maximise is None):
            raise MisfitError(
                "names no figure, or two", hint='write "rms", which is made small, or { maximise = "..." }'
            )
        return self

    @property
    def figure(self) -> str:
        """The name of the figure."""
        return self.minimise or self.maximise or ""


OF_ACCURACY = re.compile("gain_loss|rms(_(normal|axial|half_path)(_fitted)?)?")
"""Figures that are told of a case with a target only."""


class OptimiseCase(Part):
    """How a design is searched for."""

    variables: dict[str, VariableCase] = Field(
        description='what may change: places of settings in quotes, as in "wire.diameter", each with its range or list',
        min_length=1,
    )
    objectives: tuple[ObjectiveCase, ...] = Field(
        default=(ObjectiveCase(minimise="rms"),),
        description="figures to be made small, or { maximise = '...' }; of several the search finds the front: designs "
        "that no other beats in all of them",
    )
    constraints: dict[str, LimitCase] = Field(
        default={}, description="what figures must keep: { least = ... }, { most = ... }, in the unit of the figure"
    )
    frequency: Annotated[float, Quantity(NUMBER, above=0.0, most=1e4)] | None = Field(
        default=None, description="at which `gain_loss` is told [GHz]"
    )
    cost: str | None = Field(
        default=None, description="the figure `cost`: a formula of figures and settings", max_length=1000
    )
    method: Method = Field(
        default="auto",
        description="gradient: downhill from the case, one objective, continuous variables; global: by a model of all "
        "that was tried; auto: gradient where all is smooth",
    )
    evaluations: Count = Field(default=100, description="how many designs may be tried")
    seed: int = Field(default=1, ge=0, le=2**32 - 1, strict=True, description="of the random numbers")

    @field_validator("variables", mode="before")
    @classmethod
    def _places_in_quotes(cls, given: object) -> object:
        if isinstance(given, Mapping):
            for section, inside in given.items():
                if "." not in section and isinstance(inside, Mapping) and not {"from", "to", "among"} & set(inside):
                    key = next(iter(inside), "key")
                    raise MisfitError(
                        "is a section, not a setting", key=(section,), hint=f"write {quoted(f'{section}.{key}')} = ..."
                    )
        return given

    @field_validator("objectives", mode="before")
    @classmethod
    def _small_as_a_rule(cls, given: object) -> object:
        if isinstance(given, str):
            given = [given]
        if not isinstance(given, list | tuple):
            return given
        if not 1 <= len(given) <= MOST_OBJECTIVES:
            raise MisfitError(f"between 1 and {MOST_OBJECTIVES} figures can be improved, not {len(given)}")
        return tuple({"minimise": one} if isinstance(one, str) else one for one in given)

    @model_validator(mode="after")
    def _belongs_together(self) -> Self:
        asked = [one.figure for one in self.objectives]
        for number, name in enumerate(asked):
            if name in asked[:number]:
                raise MisfitError(f"`{name}` stands twice", key=("objectives", number))
        for name, key, example in (("cost", "cost", '"40 * mass"'), ("gain_loss", "frequency", "10.0")):
            if getattr(self, key) is None and name in (*asked, *self.constraints):
                raise MisfitError(f"is missing: `{name}` needs it", key=(key,), hint=f"write {key} = {example}, say")
        if self.method == "gradient" and len(asked) > 1:
            raise MisfitError(
                "one objective has a way downhill, several have not", key=("method",), hint='write method = "global"'
            )
        for place, variable in self.variables.items():
            if self.method == "gradient" and variable.among is not None:
                raise MisfitError(
                    f"`{place}` is chosen from a list, which has no gradient",
                    key=("method",),
                    hint='write method = "global"',
                )
        return self


def design_findings(optimise: OptimiseCase, target: TargetCase | None, load: LoadCase | None) -> Iterator[Finding]:
    """Figures that the case cannot tell: of accuracy without a target, of rigidity without a load."""
    named: list[tuple[tuple[str | int, ...], str]] = [
        *((("optimise", "objectives", k), one.figure) for k, one in enumerate(optimise.objectives)),
        *((("optimise", "constraints", name), name) for name in optimise.constraints),
    ]
    for key, name in named:
        if target is None and OF_ACCURACY.fullmatch(name):
            yield Finding(key, f"`{name}` is not known without a [target]", "say which shape is wanted")
        if load is None and name in ("compliance", "rms_deflection"):
            yield Finding(key, f"`{name}` is not known without a [load]", "say what acts on the grid")
