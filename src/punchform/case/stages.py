"""`stages = [...]`: what is done to the grid, one after the other, each by its section or by settings of its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from punchform.case.load import LoadCase
from punchform.case.parts import MisfitError, Part, PositiveLength
from punchform.case.places import dotted, undotted
from punchform.case.press import PressCase
from punchform.case.release import ReleaseCase
from punchform.case.wording import meant
from punchform.errors import InputError

Kind = Literal["press", "release", "trim", "load"]
KINDS: tuple[Kind, ...] = ("press", "release", "trim", "load")


class TrimCase(Part):
    """The outer part of the grid is cut off."""

    radius: PositiveLength | None = Field(
        default=None,
        description="crossings that lie beyond it in plan are cut off [mm]; the rim of the punch when absent",
    )


Settings = PressCase | ReleaseCase | TrimCase | LoadCase


class PressStage(Part):
    """A press with settings of its own."""

    press: PressCase = Field(description="what differs from [press]")


class ReleaseStage(Part):
    """A release with settings of its own."""

    release: ReleaseCase = Field(description="what differs from [release]")


class TrimStage(Part):
    """A trim with settings of its own."""

    trim: TrimCase = Field(description="where the grid is cut")


class LoadStage(Part):
    """A load with settings of its own."""

    load: LoadCase = Field(description="what differs from [load]")


_TABLES: dict[str, str] = {
    "press": "PressStage",
    "release": "ReleaseStage",
    "trim": "TrimStage",
    "load": "LoadStage",
}


def _of_one_kind(value: Any) -> Any:
    """A table names one stage."""
    if isinstance(value, dict) and len(value) != 1:
        raise MisfitError(
            f"each entry is one stage, but this table has {len(value)} keys",
            hint='write one after the other, such as ["press", { release = { hold = "rim" } }]',
        )
    if isinstance(value, dict) and (name := next(iter(value))) not in KINDS:
        raise MisfitError("no such stage", key=(name,), hint=meant(name, KINDS))
    return value


def _stage_kind(value: Any) -> str:
    if isinstance(value, Part):
        return f"<{type(value).__name__}>"
    return f"<{_TABLES[next(iter(value))]}>" if isinstance(value, dict) else "<word>"


Stage = Annotated[
    Annotated[Kind, Tag("<word>")]
    | Annotated[PressStage, Tag("<PressStage>")]
    | Annotated[ReleaseStage, Tag("<ReleaseStage>")]
    | Annotated[TrimStage, Tag("<TrimStage>")]
    | Annotated[LoadStage, Tag("<LoadStage>")],
    Discriminator(_stage_kind),
    BeforeValidator(_of_one_kind),
]
Stages = Annotated[tuple[Stage, ...], Field(min_length=1)]


class StagesCase(Part):
    """The stages alone, to be read before the rest of the case is known to be valid."""

    stages: Stages = Field(description="words or tables of one key")


@dataclass(frozen=True)
class Step:
    """One stage of a run: its settings, and where they stand in the case.

    number: its place in `stages`, None for a case without; own: keys that its own table gives; section: whether the
    case has a section of its kind.
    """

    kind: Kind
    settings: Settings
    number: int | None = None
    own: frozenset[str] = frozenset()
    section: bool = True

    def place(self, *key: str | int) -> tuple[str | int, ...]:
        """The path of one of its settings in the case: in its own table, in the section, else its entry."""
        if self.number is None or (self.section and not (key and key[0] in self.own)):
            return (self.kind, *key)
        return ("stages", self.number, self.kind, *key) if self.own else ("stages", self.number)

    def placed(self, error: InputError) -> InputError:
        """The same error, with keys of the section of this kind where this stage has them."""
        problems = []
        for problem in error.problems:
            path = undotted(problem.where)
            own = bool(path) and path[0] == self.kind
            problems.append(replace(problem, where=dotted(self.place(*path[1:]))) if own else problem)
        return InputError(problems)


def steps(stages: tuple[Stage, ...] | None, sections: Mapping[str, Part | None]) -> Iterator[Step]:
    """All stages with their settings; without `stages`: press, then release and load where there are such sections.

    sections: those of the case by their names. A word alone for a load that no section describes is passed over.
    """
    if stages is None:
        for kind in KINDS:
            section = PressCase() if kind == "press" and sections.get(kind) is None else sections.get(kind)
            if section is not None:
                yield Step(kind, _settings(section))
        return
    for number, stage in enumerate(stages):
        kind = kind_of(stage)
        own, section = _own(stage), sections.get(kind)
        given = _given(section) | _given(own)
        if kind == "load" and not given:
            continue
        settings = _MODELS[kind].model_validate(given)
        yield Step(kind, _settings(settings), number, frozenset(_given(own)), section is not None)


def kind_of(stage: Stage) -> Kind:
    """Which kind of stage it is."""
    return stage if isinstance(stage, str) else next(kind for kind in KINDS if hasattr(stage, kind))


def followed(stages: tuple[Stage, ...], sections: Mapping[str, Part | None]) -> tuple[Stage, ...]:
    """The stages, with what a table leaves out as in the section of its kind; the table still knows what it gives."""
    return tuple(_followed(stage, sections) for stage in stages)


def _followed(stage: Stage, sections: Mapping[str, Part | None]) -> Stage:
    own = _own(stage)
    if isinstance(stage, str) or own is None:
        return stage
    kind = kind_of(stage)
    whole = type(own).model_validate(_given(sections.get(kind)) | _given(own))
    values = {name: getattr(whole, name) for name in type(own).model_fields}
    settings = type(own).model_construct(_fields_set=set(own.model_fields_set), **values)
    table: dict[str, Any] = {kind: settings}
    return type(stage).model_construct(_fields_set={kind}, **table)


def _own(stage: Stage) -> Part | None:
    return None if isinstance(stage, str) else getattr(stage, kind_of(stage))


def _given(part: Part | None) -> dict[str, Any]:
    return {} if part is None else {name: getattr(part, name) for name in part.model_fields_set}


def _settings(part: Part) -> Settings:
    assert isinstance(part, PressCase | ReleaseCase | TrimCase | LoadCase)
    return part


_MODELS: dict[Kind, type[Part]] = {"press": PressCase, "release": ReleaseCase, "trim": TrimCase, "load": LoadCase}
