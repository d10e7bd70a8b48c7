"""The whole case: all sections of the file, checked against each other."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import ConfigDict, Field, ValidationInfo, field_validator, model_validator

from punchform.case.checks import findings
from punchform.case.grid import GridCase
from punchform.case.load import LoadCase
from punchform.case.optimise import OptimiseCase
from punchform.case.parts import Part
from punchform.case.press import PressCase, SolverCase
from punchform.case.punch import PunchCase
from punchform.case.release import ReleaseCase
from punchform.case.scatter import ScatterCase
from punchform.case.stages import Stage, Stages, Step, followed, steps
from punchform.case.target import TargetCase
from punchform.case.wire import WireCase
from punchform.errors import InputError, Problem

SCHEMA: Literal[1] = 1
"""The version of the case file that this program reads and writes."""


class Contradiction(InputError):
    """Sections that are right by themselves but not together."""


class Case(Part):
    """Everything a run needs to know, in internal units (mm, N, MPa, rad).

    Raises InputError when sections contradict each other, with all contradictions.
    """

    model_config = ConfigDict(title="punchform case", validate_by_name=True, validate_by_alias=True)

    schema_version: Literal[1] = Field(default=SCHEMA, alias="schema", description="version of the case file")
    title: str = Field(default="untitled", description="what the reports call this case", max_length=200)
    grid: GridCase = Field(description="the flat grid")
    wire: WireCase = Field(description="one wire between two crossings")
    punch: PunchCase | None = Field(default=None, description="the tool; absent where press.ends moves the wire ends")
    press: PressCase = Field(default=PressCase(), description="how the grid is pressed")
    solver: SolverCase = Field(default=SolverCase(), description="how the energy is minimised")
    release: ReleaseCase | None = Field(default=None, description="what stays held after the press")
    load: LoadCase | None = Field(default=None, description="what acts on the grid after its release")
    target: TargetCase | None = Field(default=None, description="the wanted shape")
    optimise: OptimiseCase | None = Field(default=None, description="what `punchform optimise` changes and improves")
    scatter: ScatterCase | None = Field(default=None, description="what varies from piece to piece")
    stages: Stages | None = Field(
        default=None,
        description="what is done, one after the other: press, release, trim, load, or tables with settings of their "
        "own such as { release = { hold = 'rim' } }; press, release and load as there are sections when absent",
    )

    @field_validator("stages")
    @classmethod
    def _follow_their_sections(cls, stages: tuple[Stage, ...] | None, info: ValidationInfo) -> tuple[Stage, ...] | None:
        return None if stages is None else followed(stages, {name: info.data.get(name) for name in STAGED})

    @model_validator(mode="after")
    def _belongs_together(self) -> Self:
        found = tuple(findings(**{name: getattr(self, name) for name in ("stages", *CHECKED)}))
        if found:
            raise Contradiction(Problem(one.message, ".".join(map(str, one.key)), one.hint) for one in found)
        if self.punch is None and self.press.ends is None:
            raise InputError.of(NO_PUNCH, where="punch", hint=NO_PUNCH_HINT)
        return self

    @property
    def tool(self) -> PunchCase:
        """The punch. Raises InputError for a gridshell, which is made without one."""
        if self.punch is None:
            raise InputError.of(
                "there is no punch: the wire ends of this case go to given points, which makes a gridshell",
                where="press.ends",
                hint="`punchform form` makes it; for everything else give a [punch] in place of press.ends",
            )
        return self.punch

    def framed(self, press: PressCase) -> PressCase:
        """The settings of a press with the frame that the wire asks for: one that yields is read from its chord."""
        if press.frame != "auto" or not self.wire.yields:
            return press
        return press.model_copy(update={"frame": "chord"})

    @property
    def steps(self) -> tuple[Step, ...]:
        """What is done to the grid, in order."""
        return tuple(steps(self.stages, {name: getattr(self, name) for name in STAGED}))

    @property
    def rim_radius(self) -> float | None:
        """Radius of the rim of the punch [mm], None without one."""
        return None if self.punch is None else self.punch.rim_radius


NO_PUNCH = "this section is missing"
NO_PUNCH_HINT = "add a table [punch], or say in press.ends where the wire ends go; `punchform new FILE` shows both"

CHECKED: tuple[str, ...] = ("grid", "wire", "punch", "press", "solver", "release", "load", "target", "optimise")
"""The tables of a case file that are checked against each other."""
SECTIONS: tuple[str, ...] = (*CHECKED, "scatter")
"""The tables of a case file in the order in which they are written."""
STAGED = ("press", "release", "load")
"""The sections that a stage may follow."""
