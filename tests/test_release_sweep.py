"""Seventy-two releases of dishes, deep to shallow, soft to stiff, under every kind of hold: each ends in a minimum, or
in a saddle that is explained."""

from __future__ import annotations

import pytest

from punchform.case import (
    CircleBlank,
    CrossingSpring,
    HoldFrom,
    HoldNodes,
    HoldPoints,
    HoldRing,
    ParaboloidProfile,
    PressCase,
    PunchCase,
    ReleaseCase,
    read_case,
)
from punchform.grid import lay
from punchform.press import press
from punchform.punch import surface
from punchform.release import release
from punchform.wire import stiffness

RIM = 100.0
HOLDS = (
    "nothing",
    "rim",
    HoldFrom(from_radius=RIM),
    HoldRing(ring=RIM),
    HoldPoints(points=8, radius=RIM),
    HoldNodes(nodes=((13, 0), (-13, 0), (0, 13), (0, -13))),
)
MOST = 40
"""Factorisations that a release may take."""


@pytest.mark.parametrize("crossing", ["pinned", CrossingSpring(stiffness=50.0), "welded"], ids=str)
@pytest.mark.parametrize("ratio", [0.3, 0.4, 0.55, 0.8])
def test_every_release_ends_in_a_minimum_or_says_what_it_is(ratio: float, crossing: str | CrossingSpring) -> None:
    case = read_case("packaged:check")
    profile = ParaboloidProfile(focal_length=ratio * 2 * RIM)
    punch = surface(PunchCase(profile=profile, rim_radius=RIM, fillet=0.1 * RIM))
    laid = lay(case.grid.model_copy(update={"blank": CircleBlank(radius=1.15 * RIM)}), rim_radius=RIM)
    elements = stiffness(case.wire, case.grid.step)
    formed = press(laid, elements, punch, PressCase(), crossing=crossing)
    for hold in HOLDS:
        gone = release(formed, elements, ReleaseCase(hold=hold), PressCase(), crossing=crossing)
        assert gone.outcome.usable
        assert gone.energy <= formed.energy
        assert gone.factorisations <= MOST
        if gone.outcome.name == "SADDLE":
            assert gone.stability.mode is not None
            assert any("saddle" in note for note in gone.notes)
        else:
            assert gone.negative_eigenvalues == 0
        if gone.stability.negative:
            assert any("symmetr" in note for note in gone.notes)
