"""The [wire] section: material, diameter and centreline of one wire, or its stiffness as it is."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, ModelWrapValidatorHandler, Tag, model_validator

from punchform.case.hardening import FibreSection, Hardening, SectionLaw, TableHardening, TensileHardening
from punchform.case.materials import library, likely, settings_of
from punchform.case.parts import (
    Count,
    Length,
    LengthFromZero,
    MisfitError,
    Number,
    Part,
    PositiveLength,
    PositiveStress,
    Quantity,
)
from punchform.case.tables import points_in_place_of_file
from punchform.units import LENGTH, NUMBER, UnitError, as_written, quantity

PAPER_DIAMETER = 0.75
"""Diameter and crimp height of the wire of the paper's Table 1 [mm]."""

Row = tuple[Number, Number, Number, Number, Number, Number]
Matrix = tuple[Row, Row, Row, Row, Row, Row]


class CosineLine(Part):
    """A woven wire: half a cosine from under one crossing wire to over the next."""

    kind: Literal["cosine"] = "cosine"
    height: LengthFromZero = Field(description="crimp height h [mm]; in a case file it is the diameter when left out")
    segments: Count = Field(default=64, description="straight pieces that stand for the curve")


class StraightLine(Part):
    """A straight wire: welded or stacked mesh."""

    kind: Literal["straight"] = "straight"
    height: LengthFromZero = Field(default=0.0, description="distance between the two families along the normal [mm]")


class PointsLine(Part):
    """A wire along given points, from one crossing to the next."""

    kind: Literal["points"] = "points"
    points: tuple[tuple[Length, ...], ...] = Field(
        description="points (x along the wire, z crimp) or (x, y, z) [mm]", min_length=2
    )
    file: str | None = Field(
        default=None,
        description="CSV file with the points [mm], relative to the case file; its points take its place",
    )

    _read_file = model_validator(mode="before")(points_in_place_of_file)

    @model_validator(mode="after")
    def _rows_alike(self) -> Self:
        widths = {len(point) for point in self.points}
        if widths not in ({2}, {3}):
            raise MisfitError("every point needs the same 2 numbers (x, z) or 3 numbers (x, y, z)", key=("points",))
        return self


Centreline = Annotated[CosineLine | StraightLine | PointsLine, Discriminator("kind")]


def _six_by_six(rows: Any) -> Any:
    if [len(row) if isinstance(row, list | tuple) else 0 for row in rows] != [6] * 6:
        raise MisfitError("expected 6 rows of 6 numbers", hint="rows and columns as in Eq. (2.1): P, then M")
    return rows


def _stiffness_kind(value: Any) -> str:
    return "<matrix>" if isinstance(value, list | tuple) else "<word>"


Stiffness = Annotated[
    Annotated[Literal["paper"], Tag("<word>")] | Annotated[Matrix, BeforeValidator(_six_by_six), Tag("<matrix>")],
    Discriminator(_stiffness_kind),
]


MATERIAL = ("material", "youngs_modulus", "poisson", "shear_factor", "hardening", "yield_strength", "section")
"""What a stiffness is computed from, and how its wire yields; beside one that is given it says nothing."""

CURVES = ("table", "tensile")
"""The kinds of hardening that say themselves where the wire yields."""


def _own_centreline(known: dict[str, Any]) -> CosineLine | None:
    return CosineLine(height=known["diameter"]) if known["stiffness"] is None else None


def rise(line: Centreline) -> float:
    """How much higher the wire ends than it starts: the crimp height h [mm]."""
    match line:
        case PointsLine(points=points):
            return points[-1][-1] - points[0][-1]
        case _:
            return line.height


def _own_height(known: dict[str, Any]) -> float:
    line = known["centreline"]
    return float(known["diameter"]) if line is None else rise(line)


def _length_or_nil(diameter: object) -> float:
    # A diameter that cannot be read is complained about once, where it stands, not for the height too.
    try:
        return quantity(diameter, LENGTH)
    except UnitError:
        return 0.0


def _of_one_diameter(values: dict[str, Any]) -> dict[str, Any]:
    """The centreline with the diameter for its height, where it is a cosine whose height was left out; else nothing."""
    line = values.get("centreline")
    given = line.model_dump(include=line.model_fields_set) if isinstance(line, CosineLine) else line
    if not isinstance(given, dict) or given.get("kind") != "cosine" or "height" in given:
        return {}
    return {"centreline": {**given, "height": _length_or_nil(values.get("diameter"))}}


def _own_yield(known: dict[str, Any]) -> float | None:
    return known["hardening"].points[0][1] if isinstance(known["hardening"], TableHardening) else None


def _of_material(values: dict[str, Any]) -> dict[str, Any]:
    """What the material of a wire says where the wire does not itself."""
    name = values.get("material")
    if not isinstance(name, str):
        return {}
    known = library()
    if name not in known:
        raise MisfitError(f"there is no material {as_written(name)}", key=("material",), hint=likely(name, known))
    law = values.get("hardening")
    kind = law.get("kind") if isinstance(law, dict) else getattr(law, "kind", None)
    said = {*values, "yield_strength"} if kind in CURVES else values
    return {key: value for key, value in settings_of(known[name]).items() if key not in said}


def _refuse_beside_stiffness(values: dict[str, Any]) -> None:
    if values.get("stiffness") is None:
        return
    for key in (key for key in MATERIAL if key in values):
        if key == "hardening":
            raise MisfitError(
                "a wire whose stiffness is given as a matrix cannot yield: nobody knows how it runs between crossings",
                key=(key,),
                hint="give the wire as a material, a diameter and a centreline, or leave out `hardening`",
            )
        raise MisfitError(
            "has no effect beside a given stiffness", key=(key,), hint=f"leave out `{key}` or `stiffness`"
        )


class WireCase(Part):
    """One wire between two crossings: its 6 x 6 stiffness follows from it, Eq. (2.4), or is given."""

    stiffness: Stiffness | None = Field(
        default=None,
        description="'paper' for the paper's Table 1, or 6 rows of 6 numbers in element axes "
        "[N/mm, N, N mm], Eq. (2.1); then no centreline is needed",
    )
    material: str | None = Field(
        default=None,
        description="name of a material, as `punchform materials` lists them: it gives modulus, Poisson's ratio, "
        "density, yield strength and hardening where they are left out",
    )
    diameter: PositiveLength = Field(
        default=PAPER_DIAMETER, description="wire diameter [mm]; needed unless stiffness = 'paper'"
    )
    youngs_modulus: PositiveStress = Field(
        default=210000.0, description="Young's modulus E [MPa]; needed unless material or stiffness are given"
    )
    poisson: Annotated[float, Quantity(NUMBER, above=-1.0, most=0.5)] = Field(
        default=0.3, description="Poisson's ratio nu [-]"
    )
    shear_factor: Annotated[float, Quantity(NUMBER, above=0.0, most=1.0)] = Field(
        default=0.9, description="shear factor kappa of the section [-]"
    )
    hardening: Hardening = Field(
        default="none",
        description="none: the wire stays elastic; perfect: it yields at the yield strength for ever; or a table with "
        "the kind linear, voce, power, table (a flow curve) or tensile (a test)",
    )
    yield_strength: PositiveStress | None = Field(
        default_factory=_own_yield,
        description="stress at which plastic strain begins [MPa]; gives the ratio of stress to it, and is needed for "
        "hardening that does not say it",
    )
    section: SectionLaw = Field(
        default="resultants",
        description="how the section of a wire that yields is followed: by its force and moments, or as fibres, "
        "{ rings = 3, sectors = 8 } unless said",
    )
    density: Annotated[float, Quantity(NUMBER, above=0.0, most=30_000.0)] | None = Field(
        default=None, description="density [kg/m^3]; needed for gravity, gives the mass of the wire"
    )
    centreline: Centreline | None = Field(
        default_factory=_own_centreline,
        description="how the wire runs between two crossings; a cosine of one diameter when left out",
    )
    height: Length = Field(
        default_factory=_own_height,
        description="crimp height h [mm]: the centreline's, or the diameter beside a given stiffness",
    )

    @model_validator(mode="wrap")
    @classmethod
    def _demand_and_complete(cls, values: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        if not isinstance(values, dict):
            return handler(values)
        _refuse_beside_stiffness(values)
        followed = _of_material(values)
        # None is refused by both fields: a wire is never given a size or a modulus silently.
        needed = {"diameter": None} if values.get("stiffness") != "paper" else {}
        needed |= {"youngs_modulus": None} if values.get("stiffness") is None else {}
        line = _of_one_diameter(values)
        wire = handler({**needed, **followed, **values, **line})
        # What was not given but followed from the material or the diameter follows again in a copy of this wire.
        for key in followed:
            wire.model_fields_set.discard(key)
        if line and wire.centreline is not None:
            wire.centreline.model_fields_set.discard("height")
        return wire

    @model_validator(mode="after")
    def _yields_somewhere(self) -> Self:
        if isinstance(self.hardening, TableHardening):
            begin = self.hardening.points[0][1]
            if self.yield_strength != begin:
                raise MisfitError(
                    f"the flow curve of `hardening` begins at {begin:g} MPa",
                    key=("yield_strength",),
                    hint="leave out `yield_strength`",
                )
        elif isinstance(self.hardening, TensileHardening):
            if self.yield_strength is not None:
                raise MisfitError(
                    "the tensile test of `hardening` says where the wire yields",
                    key=("yield_strength",),
                    hint="leave out `yield_strength`",
                )
        elif self.yields and self.yield_strength is None:
            raise MisfitError(
                "nobody says at what stress the wire yields",
                key=("hardening",),
                hint="give `yield_strength`, or a `material` that has one",
            )
        return self

    @property
    def yields(self) -> bool:
        """Whether the wire yields; else it is elastic whatever its stress."""
        return self.hardening != "none"

    @property
    def fibres(self) -> FibreSection | None:
        """The fibres of the section, None where it is followed by its resultants."""
        if isinstance(self.section, FibreSection):
            return self.section
        return FibreSection() if self.section == "fibres" else None
