"""Pulled wire ends as a user sees them, Eq. (5.2): a dish with rim and flange, a few newtons per wire.

The dish is one whose symmetric state is a minimum of the whole grid too: a flange half as wide as the dish's radius.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from exact_nets import square_grid

from punchform.arrays import Floats
from punchform.case import FlatProfile, GridCase, ParaboloidProfile, PressCase, PunchCase, WireCase
from punchform.grid import Grid, lay
from punchform.mechanics.footing import normals_of
from punchform.press import Formed, press
from punchform.punch import bare, surface
from punchform.whole import Whole
from punchform.wire import Section, along, stiffness, straight_line

RIM = 80.0
STEP = 5.0


def dish_grid(symmetry: str = "quarter") -> Grid:
    blank = {"shape": "circle", "radius": 120.0}
    return lay(GridCase.model_validate({"step": STEP, "blank": blank, "symmetry": symmetry}), rim_radius=RIM)


@cache
def dish(pull: float, symmetry: str = "quarter") -> Formed:
    """Steel wire of 0.5 mm over a dish of focal length 66.7 mm; pull [N]."""
    crimp = {"kind": "cosine", "height": 0.5}
    wire = {"diameter": 0.5, "youngs_modulus": 210e3, "poisson": 0.25, "centreline": crimp}
    punch = PunchCase(profile=ParaboloidProfile(focal_length=66.7), rim_radius=RIM, fillet=8.0)
    elements = stiffness(WireCase.model_validate(wire), (STEP, STEP))
    case = PressCase(pull=(pull, pull) if pull else None)
    return press(dish_grid(symmetry), elements, surface(punch), case)


PULLS = (0.0, 2.0, 5.0, 10.0)


def test_pull_lessens_the_draw_in() -> None:
    drawn = [dish(pull).draw_in for pull in PULLS]
    assert all(more > less for more, less in pairwise(drawn))
    # A small pull works against the grid's own stiffness: twice the pull, nearly twice the effect.
    assert (drawn[0] - drawn[2]) / (drawn[0] - drawn[1]) == pytest.approx(5.0 / 2.0, rel=0.05)


def end_forces(whole: Whole) -> Floats:
    """Forces of the elements on their nodes B in space, (M, 3) [N]; the opposite ones act on O."""
    family = whole.family - 1
    axis = whole.index[whole.end, family] - whole.index[whole.start, family]
    t = whole.tangents[whole.start, family] * axis[:, None]
    n = whole.normals[whole.start]
    push = whole.F[:, :1] * t + whole.F[:, 1:2] * np.cross(n, t) + (whole.sigma * whole.F[:, 2])[:, None] * n
    return np.asarray(-push)


def pulls(grid: Grid, formed: Formed, size: float) -> Floats:
    """Outward forces at the wire ends of the whole grid, along the wires and the surface, (N, 3) [N]."""
    outwards = grid.wire_ends[:, :, 1].astype(float) - grid.wire_ends[:, :, 0]
    normals = normals_of(formed.surface.gap(formed.whole.positions))
    along = formed.whole.tangents - np.einsum("nwc,nc,nd->nwd", formed.whole.tangents, normals, normals)
    along /= np.linalg.norm(along, axis=2)[:, :, None]
    return np.asarray(size * np.einsum("nw,nwc->nc", outwards, along))


@pytest.mark.parametrize("pull", PULLS)
def test_forces_balance_at_every_node(pull: float) -> None:
    """Wires, tool and pull on each node of the whole grid; hence also on any part of it."""
    formed = dish(pull)
    whole, forces = formed.whole, end_forces(formed.whole)
    total = whole.contact[:, None] * normals_of(formed.surface.gap(whole.positions))
    total += pulls(dish_grid("full"), formed, pull)
    np.add.at(total, whole.end, forces)
    np.subtract.at(total, whole.start, forces)
    assert np.abs(total).max() < 1e-6 * np.abs(forces).max()


def test_the_tool_is_loaded_by_itself_alone() -> None:
    """On the flat flange the pull is horizontal: what the punch lifts, rim and upper tool hold down."""
    formed = dish(5.0)
    upward = formed.whole.contact * normals_of(formed.surface.gap(formed.whole.positions))[:, 2]
    assert abs(upward.sum()) < 1e-9 * np.abs(upward).sum()
    assert pulls(dish_grid("full"), formed, 5.0)[:, 2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("pull", PULLS[1:])
def test_tension_at_the_wire_ends_is_the_pull(pull: float) -> None:
    """What an unpulled grid carries there, next to nothing, comes on top."""
    added = end_tension(pull) - end_tension(0.0)
    assert added.mean() == pytest.approx(pull, rel=0.01)
    np.testing.assert_allclose(added, pull, rtol=0.1)


def end_tension(pull: float) -> Floats:
    """Force along the wire of every last element [N]."""
    whole, ends = dish(pull).whole, dish_grid("full").wire_ends.any(axis=2)
    last = np.asarray(ends)[whole.end, whole.family - 1]
    return np.asarray(whole.F[last, 0])


def test_quarter_and_whole_grid_agree() -> None:
    quarter, whole = dish(5.0), dish(5.0, "full")
    assert whole.negative_eigenvalues == 0
    assert whole.energy == pytest.approx(quarter.energy, rel=1e-9)
    np.testing.assert_allclose(whole.whole.positions, quarter.whole.positions, atol=1e-6)


@pytest.mark.parametrize(("times", "stable"), [(3.5, True), (4.5, False)])
def test_a_wire_seems_unstable_beyond_4_ei_over_s_squared(
    times: float, stable: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What frames at O cost under tension, Eq. (3.5): a straight wire buckles when pulled, at F1 = 4 EI/s².

    Let the frames along a straight pulled wire turn by theta, alternating in sign, while the nodes stay. Then
    D2 = -s theta, D6 = -2 theta, and bending costs ½ (C22 s² + 4 C26 s + 4 C66) theta² = 2 EI theta²/s per node,
    while D1 = d·t - s shortens by s theta²/2, which frees F1 s theta²/2. No other pattern is cheaper: a true wire is
    stable at any tension, this element below 4 EI/s² (in a quarter, whose centre line cannot turn; Eq. (3.8)).
    """
    monkeypatch.setattr("punchform.press.largest_pull", lambda element: np.inf)
    count, bending = 12, 100.0
    element = along(straight_line(STEP), Section(0.5, 1e6, bending, bending / 1.25, np.inf))
    pull = times * bending / STEP**2
    flat = bare(FlatProfile(height=1.0, edge_radius=1.0), 1e3)
    formed = press(square_grid(STEP, count), (element, element), flat, PressCase(pull=(pull, pull)))
    np.testing.assert_allclose(formed.whole.F[:, 0], pull, rtol=1e-8)
    assert formed.negative_eigenvalues is not None
    assert (formed.negative_eigenvalues == 0) == stable
