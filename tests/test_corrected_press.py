"""The press on a punch with a correction: the same as on the equivalent punch, in every way of pressing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from small_grids import BLANK, assert_equal_grids, grid, wires
from stretched import DISH, KEPT

from punchform.arrays import Floats
from punchform.case import Case, ParaboloidProfile, PressCase, PunchCase, varied, write_case
from punchform.case.reading import case_from_text
from punchform.drape import drape
from punchform.net import start_state
from punchform.press import press
from punchform.punch import (
    Corrected,
    HeightField,
    Meridian,
    RadialCorrection,
    Revolution,
    corrected,
    surface,
    uncorrected,
)
from punchform.punch.curves import Graph
from punchform.run import Run, run

BASE = uncorrected(PunchCase(profile=ParaboloidProfile(focal_length=100.0), rim_radius=40.0, fillet=20.0))
"""The punch of the small grids: the fillet begins at 36 mm."""
EDGE = 35.0


def fading(rho: Floats) -> Floats:
    """1 on the axis, 0 from the edge on."""
    return np.asarray(np.clip(1.0 - (rho / EDGE) ** 2, 0.0, None) ** 4)


RHO = np.linspace(0.0, EDGE, 15)
ROUND = RadialCorrection(RHO, 0.8 * fading(RHO))


def with_lobes(count: int, *, whole: bool = False, lobes: float = 1.0) -> HeightField:
    """A correction with four lobes at points on a quarter or on the whole plan."""
    places = np.linspace(-EDGE if whole else 0.0, EDGE, 2 * count - 1 if whole else count)
    x, y = np.meshgrid(places, places, indexing="ij")
    rho, angle = np.hypot(x, y), np.arctan2(y, x)
    return HeightField(places, places, fading(rho) * (0.8 + lobes * (rho / EDGE) ** 4 * np.cos(4 * angle)))


def summed(rho: Floats) -> tuple[Floats, Floats, Floats]:
    """Height, slope and bend of the paraboloid with the correction of revolution."""
    rise = ROUND.rise(np.column_stack((rho, np.zeros_like(rho))))
    f = -(rho**2) / 400.0
    return f + rise.value, rise.gradient[:, 0] - rho / 200.0, rise.hessian[:, 0, 0] - 1.0 / 200.0


GRAPH = BASE.chain.segments[0]
assert isinstance(GRAPH, Graph)
SAME = Revolution(
    Meridian((Graph(summed, GRAPH.end, GRAPH.lift, knots=tuple(RHO.tolist())), *BASE.chain.segments[1:])), 40.0
)
"""The paraboloid with the correction of revolution, as another profile."""

WAYS: dict[str, dict[str, Any]] = {
    "drawn": {},
    "from the flat": {"start": "flat"},
    "clamped": {"rim": "clamp", "frame": "O"},
    "in strokes": {"strokes": 3},
    "pulled": {"pull": (3.0, 2.0)},
}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())
def test_the_press_is_that_on_the_same_punch_by_another_profile(way: dict[str, Any]) -> None:
    laid, case = grid(BLANK), PressCase(**way)
    elements = wires(laid.step)
    ours = press(laid, elements, Corrected(BASE, ROUND), case)
    theirs = press(laid, elements, SAME, case)
    assert ours.energy == pytest.approx(theirs.energy, rel=1e-10)
    assert_equal_grids(ours.whole, theirs.whole, 1e-6)


def test_a_field_of_the_same_heights_gives_nearly_the_same_grid() -> None:
    laid, elements = grid(BLANK), wires((10.0, 10.0))
    ours, theirs = (
        press(laid, elements, corrected(BASE, added), PressCase()) for added in (with_lobes(29, lobes=0.0), ROUND)
    )
    assert np.abs(ours.whole.positions - theirs.whole.positions).max() < 2e-3


def test_a_quarter_of_a_mirrored_field_is_the_whole_of_the_whole_field() -> None:
    case = PressCase()
    quarter, whole = (
        press(grid(BLANK, symmetry=symmetry), wires(), Corrected(BASE, with_lobes(15, whole=symmetry == "full")), case)
        for symmetry in ("quarter", "full")
    )
    assert_equal_grids(quarter.whole, whole.whole, 1e-6)
    assert np.abs(quarter.surface.distance(quarter.whole.positions)).max() < 1e-10


def test_the_net_lies_on_the_corrected_punch() -> None:
    laid = grid(BLANK)
    ours, theirs = (start_state(laid, tool) for tool in (Corrected(BASE, ROUND), SAME))
    assert ours.net.complete
    np.testing.assert_allclose(ours.positions, theirs.positions, atol=1e-6)
    np.testing.assert_allclose(ours.tangents, theirs.tangents, atol=1e-6)


def dish(**changes: Any) -> Case:
    text = DISH.replace("HOLD", KEPT).replace("RIM", 'rim = "clamp"').replace("CROSSING", "")
    return varied(case_from_text(text), {f"punch.{key}": value for key, value in changes.items()})


def lowest_and_highest(done: Run) -> tuple[float, float]:
    positions = done.formed.whole.positions
    middle = np.linalg.norm(positions[:, :2], axis=1) < 1.0
    return float(positions[middle, 2].max()), float(np.abs(done.formed.surface.distance(positions)).max())


def test_wires_that_yield_follow_a_correction_from_case_to_release() -> None:
    """The apex rises by what is added there, and the vertex at which a target would stand does not."""
    case = dish(correction=with_lobes(15).setting)
    plain, made = run(dish()), run(case)
    assert case_from_text(write_case(case)) == case
    apex, off = lowest_and_highest(made)
    assert apex == pytest.approx(lowest_and_highest(plain)[0] + 0.8, abs=1e-9)
    assert off < 1e-10
    assert surface(case.tool).height_at_axis == surface(dish().tool).height_at_axis
    assert made.released is not None
    assert plain.released is not None
    rise = made.released.whole.positions[:, 2].max() - plain.released.whole.positions[:, 2].max()
    assert 0.5 < rise < 1.0


def test_a_point_of_a_correction_is_a_setting_like_any_other() -> None:
    case = dish(correction=ROUND.setting)
    changed = varied(case, {"punch.correction.points[2][1]": "0.5 mm"})
    assert changed.tool.correction is not None
    assert changed.tool.correction.points[2][1] == 0.5
    again = varied(changed, {"punch.correction.points": ROUND.points.tolist()})
    assert again == case
    assert varied(case, {"punch.correction": None}) == dish()


def test_a_corrected_punch_is_draped_too() -> None:
    case = dish(correction=with_lobes(15).setting)
    draped = drape(case)
    positions = draped.formed.whole.positions
    assert np.isfinite(positions).all()
    assert np.abs(draped.formed.surface.distance(positions)).max() < 1e-6
