"""The [press] and [solver] sections: how the grid is pressed, and how the energy is minimised."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from punchform.case.ends import EndCase, ends_in_place_of_file
from punchform.case.parts import Count, Force, ForcePerLengthFromZero, Part, PositiveCompliance, Quantity
from punchform.units import NUMBER


class DescentCase(Part):
    """The paper's descent P(18)-P(20): how its step length lambda is found, and when it stops."""

    rule: Literal["exact", "fixed", "reuse-direction"] = Field(
        default="exact",
        description="exact: lambda from second derivatives; fixed: one lambda throughout; "
        "reuse-direction: one direction until the energy grows",
    )
    step_length: PositiveCompliance | None = Field(
        default=None, description="lambda of P(19) [mm/N]; needed by the rules fixed and reuse-direction"
    )
    max_steps: Count = Field(default=20_000, description="steps after which the descent stops")


class HolderCase(Part):
    """A blank holder: the flange slides between two faces, which the wires overcome, Eq. (12.23)."""

    force_per_length: ForcePerLengthFromZero = Field(
        description="force that presses the faces together, per length of the rim [N/mm]"
    )
    friction: Annotated[float, Quantity(NUMBER, least=0.0)] = Field(
        description="coefficient of friction between wire and either face [-]"
    )


Ends = Annotated[tuple[EndCase, ...], BeforeValidator(ends_in_place_of_file)]


class PressCase(Part):
    """How the grid is pressed onto the punch, and by which formulation; or where its wire ends go without one."""

    kinematics: Literal["free", "differences"] = Field(
        default="free",
        description="free: node frames are unknowns; differences: the paper's P(12), P(17)",
    )
    offset: Literal["centred", "lower"] = Field(
        default="centred", description="centred: e = h/2; lower: e = h, the paper's P(14); see Eq. (3.1)"
    )
    frame: Literal["auto", "O", "chord"] = Field(
        default="auto",
        description="where an element's deformation is read: O: in the paper's frame at its end O, Eq. (3.2); chord: "
        "from the line between its ends, Eq. (3.12), which stays right at large bends and pulls; auto: chord where the "
        "rim is clamped or held, wire ends are given or the wire yields, else O",
    )
    rim: Literal["draw", "clamp"] = Field(
        default="draw", description="draw: the flange slides in freely; clamp: held from the rim outwards"
    )
    hold: HolderCase | None = Field(
        default=None,
        description="a blank holder with rim = 'draw': { force_per_length, friction }; the flange slides in against it",
    )
    strokes: Count | None = Field(
        default=None,
        description="in how many equal strokes the punch goes down, each from where the one before it ended; when "
        "absent 1, or 12 where what happens on the way matters: with a holder",
    )
    start: Literal["net", "flat"] = Field(
        default="net",
        description="of a press in one stroke: net: from the inextensible net, where it reaches all crossings; "
        "flat: the paper's P(18)",
    )
    method: Literal["newton", "descent"] = Field(
        default="newton", description="newton: exact Hessian; descent: the paper's method, for comparison"
    )
    pull: tuple[Force, Force] | None = Field(
        default=None, description="outward force on every wire end of the two families [N]"
    )
    descent: DescentCase = Field(default=DescentCase(), description="only used with method = 'descent'")

    ends: Ends | None = Field(
        default=None,
        description="without a punch: where the wire ends go, as a CSV file with the columns family, wire, end, x, y, "
        "z [mm], relative to the case file, or as a list of { family, wire, end, point }",
    )

    @property
    def chord(self) -> bool:
        """Whether deformations are read from the chord, as far as the press says; `Case.framed` asks the wire too."""
        far = self.rim == "clamp" or self.ends is not None or self.hold is not None
        return self.frame == "chord" or (self.frame == "auto" and far)


class SolverCase(Part):
    """The Newton method and the linear solver under it."""

    linear: Literal["auto", "rslab", "pardiso", "scipy"] = Field(
        default="auto", description="library for the sparse factorisation"
    )
    max_steps: Count = Field(default=200, description="Newton steps after which the solve gives up")
    tolerance: Annotated[float, Quantity(NUMBER, above=0.0, most=1e-2)] = Field(
        default=1e-12, description="Newton decrement relative to the energy at which the solve is done [-]"
    )
