"""The press on small grids: equilibrium, scaling, symmetry, limits of the crossing, the pull, tools of one's own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_grids import (
    BLANK,
    PUNCH,
    SHALLOW,
    STEP,
    Cylinder,
    Plane,
    assert_equal_grids,
    grid,
    grid_case,
    wire_case,
    wires,
)

from punchform.arrays import Floats
from punchform.case import (
    Case,
    CrossingSpring,
    DescentCase,
    ParaboloidProfile,
    PressCase,
    PunchCase,
    SolverCase,
    SphereProfile,
)
from punchform.errors import InputError, NoEquilibrium, PunchformError
from punchform.grid import Grid
from punchform.mechanics.outcome import Outcome
from punchform.press import Formed, energy_of, press
from punchform.punch import Surface, surface
from punchform.run import run
from punchform.start import flat_start
from punchform.testing import assert_equilibrium
from punchform.whole import Whole


def pressed(
    laid: Grid | None = None,
    tool: Surface | None = None,
    *,
    crossing: str | CrossingSpring = "pinned",
    wire: dict[str, Any] | None = None,
    **settings_: Any,
) -> Formed:
    """A grid of 5 steps on the small punch, unless told otherwise; settings are those of `PressCase`."""
    laid = grid(BLANK) if laid is None else laid
    tool = tool or (SHALLOW if settings_.get("rim") == "clamp" else PUNCH)
    elements = wires(laid.step, **(wire or {}))
    return press(laid, elements, tool, PressCase(**settings_), crossing=crossing)


SETTINGS: dict[str, dict[str, Any]] = {
    "pinned": {},
    "welded": {"crossing": "welded"},
    "spring": {"crossing": CrossingSpring(stiffness=300.0)},
    "lower": {"offset": "lower"},
    "pulled": {"pull": (3.0, 2.0)},
    "pulled, welded": {"pull": (3.0, 2.0), "crossing": "welded"},
    "clamped": {"rim": "clamp", "frame": "O"},
    "differences": {"kinematics": "differences"},
    "differences, spring": {"kinematics": "differences", "crossing": CrossingSpring(stiffness=300.0)},
    "differences, pulled": {"kinematics": "differences", "pull": (3.0, 2.0)},
}
GRIDS: dict[str, dict[str, Any]] = {
    "plain": {},
    "same": {"weave": "same"},
    "unequal steps": {"step": (STEP, 8.0)},
    "rectangle": {"size": (110.0, 90.0)},
}


# --- equilibrium, from the forces of the elements alone -----------------------------------------------------


def elastic_forces(whole: Whole) -> Floats:
    """What the elements pull at the nodes with, (N, 3): F1 t + F2 j + sigma F3 n on O, the opposite on B."""
    along = whole.family - 1
    sign = np.sign((whole.index[whole.end] - whole.index[whole.start])[np.arange(len(along)), along])
    t = sign[:, None] * whole.tangents[whole.start, along]
    n = whole.normals[whole.start]
    F = whole.F
    force = F[:, :1] * t + F[:, 1:2] * np.cross(n, t) + (whole.sigma * F[:, 2])[:, None] * n
    total = np.zeros_like(whole.positions)
    np.add.at(total, whole.start, force)
    np.add.at(total, whole.end, -force)
    return total


def pulls(formed: Formed, force: tuple[float, float] | None) -> Floats:
    """The pull on the nodes, (N, 3): outwards along the wire and the surface at each wire end, Eq. (5.2)."""
    whole, normals = formed.whole, surface_normals(formed)
    total = np.zeros_like(whole.positions)
    there = {tuple(node) for node in whole.index.tolist()}
    for node, (i, j) in enumerate(whole.index.tolist()):
        for family, (di, dj) in enumerate(((1, 0), (0, 1))):
            before, after = (i - di, j - dj) in there, (i + di, j + dj) in there
            if force is not None and before != after:
                t, n = whole.tangents[node, family], normals[node]
                along = t - (t @ n) * n
                total[node] += (1 if before else -1) * force[family] * along / np.linalg.norm(along)
    return total


def surface_normals(formed: Formed) -> Floats:
    return formed.surface.gap(formed.whole.positions).gradient


# Where frames follow from the surface, the tool turns them too, and its normal forces are not all that it does.
FREE = [name for name, setting in SETTINGS.items() if "kinematics" not in setting]


@pytest.mark.parametrize("laid", GRIDS)
@pytest.mark.parametrize("name", FREE)
def test_elements_tool_and_pull_are_in_balance_at_every_node(name: str, laid: str) -> None:
    setting = SETTINGS[name]
    formed = pressed(grid(BLANK, **GRIDS[laid]), **setting)
    whole, normals = formed.whole, surface_normals(formed)
    assert formed.outcome is Outcome.CONVERGED
    left = elastic_forces(whole) + pulls(formed, setting.get("pull")) + whole.contact[:, None] * normals
    size = np.abs(whole.F[:, :3]).max()
    held = np.linalg.norm(whole.flat, axis=1) >= formed.surface.rim_radius * (1 - 1e-9)
    free = ~held if setting.get("rim") == "clamp" else np.ones(len(held), dtype=bool)
    assert np.abs(left[free]).max() < 1e-6 * size
    assert np.abs(np.sum(left * normals, axis=1)).max() < 1e-6 * size


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
@pytest.mark.parametrize("name", [name for name in FREE if "rim" not in SETTINGS[name]])
def test_the_tool_and_the_pull_balance_each_other_on_the_whole(name: str, symmetry: str) -> None:
    # A grid on which only they act: their forces and their moments add up to nothing.
    setting = SETTINGS[name]
    formed = pressed(grid(BLANK, symmetry=symmetry), **setting)
    whole = formed.whole
    by_tool = whole.contact[:, None] * surface_normals(formed)
    outside = by_tool + pulls(formed, setting.get("pull"))
    size = np.abs(by_tool).sum()
    assert np.abs(outside.sum(axis=0)).max() < 1e-8 * size
    assert np.abs(np.cross(whole.positions, outside).sum(axis=0)).max() < 1e-8 * size * BLANK
    assert whole.contact.min() < 0 < whole.contact.max()


def test_contact_is_positive_where_the_punch_pushes() -> None:
    # Wires that are pulled over a dome press on it everywhere, all the more the harder they are pulled.
    whole, harder = (pressed(pull=(force, force)).whole for force in (50.0, 100.0))
    dome = np.linalg.norm(whole.flat, axis=1) < 2.5 * STEP
    assert whole.contact[dome].min() > 0
    assert (harder.contact[dome] > whole.contact[dome]).all()


@pytest.mark.parametrize("name", [name for name, setting in SETTINGS.items() if "pull" not in setting])
def test_the_formed_state_is_an_equilibrium_of_the_energy(name: str) -> None:
    setting = dict(SETTINGS[name])
    formed = pressed(**setting)
    crossing = setting.pop("crossing", "pinned")
    energy = energy_of(
        formed.grid, wires(), formed.surface, PressCase(**setting), crossing=crossing, start=formed.state
    )
    assert_equilibrium(energy, formed.state)
    assert formed.grid.copies * energy.at(formed.state) == pytest.approx(formed.energy, rel=1e-12)


# --- what is reported ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetry", ["quarter", "full"])
@pytest.mark.parametrize("name", SETTINGS)
def test_energies_add_up(name: str, symmetry: str) -> None:
    formed = pressed(grid(BLANK, symmetry=symmetry), **SETTINGS[name])
    whole = formed.whole
    assert set(formed.energy_kinds) == {"stretch", "bend", "in_plane", "twist", "crossing"}
    assert formed.energy == pytest.approx(sum(formed.energy_kinds.values()), rel=1e-12)
    elements = formed.energy - formed.energy_kinds["crossing"]
    assert whole.energy.sum() == pytest.approx(elements, rel=1e-12)
    np.testing.assert_allclose(whole.energy, 0.5 * np.sum(whole.D * whole.F, axis=1), rtol=0, atol=1e-12 * elements)
    np.testing.assert_allclose(whole.F, whole.D @ wires()[0].C, rtol=0, atol=1e-9 * np.abs(whole.F).max())
    if "spring" not in name:
        assert formed.energy_kinds["crossing"] == 0


def test_the_crossing_spring_holds_what_its_angles_say() -> None:
    stiffness = 300.0
    formed = pressed(crossing=CrossingSpring(stiffness=stiffness))
    tangents = formed.whole.tangents
    links = np.bincount(np.concatenate((formed.whole.start, formed.whole.end)))
    assert links.min() >= 1
    there = {tuple(node) for node in formed.whole.index.tolist()}
    crossed = np.array(
        [
            ((i - 1, j) in there or (i + 1, j) in there) and ((i, j - 1) in there or (i, j + 1) in there)
            for i, j in formed.whole.index.tolist()
        ]
    )
    turned = np.arcsin(np.sum(tangents[:, 0] * tangents[:, 1], axis=1))
    assert formed.energy_kinds["crossing"] == pytest.approx(0.5 * stiffness * np.sum(turned[crossed] ** 2), rel=1e-10)


def test_strain_shear_and_draw_in_are_those_of_the_positions() -> None:
    formed = pressed()
    whole = formed.whole
    # The pull alone, ends not turning: what is left of D1 when the couple F5 that undoes its turn is taken away.
    B = wires(formed.grid.step)[0].B
    unturned = B[0, 0] - B[0, 4] * B[4, 0] / B[4, 4]
    assert formed.max_axial_strain == pytest.approx(unturned * whole.F[:, 0].max() / STEP, rel=1e-12)
    p, q, r, s = (whole.positions[whole.cells[:, k]] for k in range(4))
    a, b = q + r - p - s, r + s - p - q
    cosine = np.sum(a * b, axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
    np.testing.assert_allclose(whole.cell_shear, np.pi / 2 - np.arccos(cosine), atol=1e-12)
    assert formed.max_shear == pytest.approx(np.abs(whole.cell_shear).max())
    # Opposite quarters shear alike, neighbouring ones the other way.
    assert whole.cell_shear.sum() == pytest.approx(0.0, abs=1e-12)
    links = np.bincount(np.concatenate((whole.start, whole.end)), minlength=len(whole.index))
    inward = np.linalg.norm(whole.flat, axis=1) - np.linalg.norm(whole.positions[:, :2], axis=1)
    assert formed.draw_in == pytest.approx(inward[links < 4].max(), rel=1e-12)
    # The flat corners of the cells run counter-clockwise.
    p, q, r, s = (whole.flat[whole.cells[:, k]] for k in range(4))
    np.testing.assert_allclose(np.cross(q - p, s - p)[:, 2], STEP**2)


def test_a_clamp_holds_the_rim_and_says_what_that_means() -> None:
    formed = pressed(rim="clamp")
    whole = formed.whole
    beyond = np.linalg.norm(whole.flat, axis=1) >= formed.surface.rim_radius
    assert beyond.any()
    np.testing.assert_array_equal(whole.positions[beyond], whole.flat[beyond])
    assert formed.draw_in == 0
    assert any("clamped" in note and "yields" in note for note in formed.notes)
    drawn = pressed(tool=SHALLOW)
    assert not any("clamped" in note for note in drawn.notes)
    assert formed.energy > drawn.energy
    assert whole.axial_strain.mean() > 2 * drawn.whole.axial_strain.mean()


def test_the_notes_of_the_grid_are_passed_on() -> None:
    laid = grid(BLANK, centre="cell")
    assert laid.notes
    assert set(laid.notes) <= set(pressed(laid).notes)


def test_a_descent_reports_all_its_steps_and_how_it_ended() -> None:
    formed = pressed(method="descent", descent=DescentCase(rule="exact", max_steps=150))
    assert formed.outcome is Outcome.STEP_LIMIT
    assert formed.steps == 150
    assert formed.energy > pressed().energy


def test_stress_over_yield_is_only_known_with_a_yield_strength() -> None:
    laid = grid(BLANK)
    known = press(laid, wires(), PUNCH, PressCase(), yield_strength=200.0)
    assert np.isnan(pressed(laid).whole.stress_ratio).all()
    np.testing.assert_allclose(known.whole.stress_ratio, known.whole.stress / 200.0)
    assert known.whole.stress.min() > 0


# --- symmetry, scale, limits --------------------------------------------------------------------------------


@pytest.mark.parametrize("weave", ["plain", "same", "stacked"])
@pytest.mark.parametrize("name", SETTINGS)
def test_quarter_and_whole_grid_agree(name: str, weave: str) -> None:
    straight = {"straight": True} if weave == "stacked" else {}
    quarter, whole = (
        pressed(grid(BLANK, weave=weave, symmetry=symmetry), wire=straight, **SETTINGS[name])
        for symmetry in ("quarter", "full")
    )
    assert whole.energy == pytest.approx(quarter.energy, rel=1e-9)
    assert whole.draw_in == pytest.approx(quarter.draw_in, rel=1e-7, abs=1e-9)
    # The pull is followed until the wire ends turn by less than 1e-9.
    assert_equal_grids(whole.whole, quarter.whole, 1e-7 if "pulled" in name else 1e-8)


@pytest.mark.parametrize("name", ["pinned", "welded", "lower", "differences"])
def test_the_papers_weave_has_the_symmetry_of_the_square(name: str) -> None:
    # C4v when every sigma is +1: the mirror of the diagonal swaps the families.
    whole = pressed(grid(BLANK, weave="same"), **SETTINGS[name]).whole
    number = {tuple(node): k for k, node in enumerate(whole.index.tolist())}
    swapped = np.array([number[j, i] for i, j in whole.index.tolist()])
    np.testing.assert_allclose(whole.positions[swapped][:, [1, 0, 2]], whole.positions, rtol=0, atol=1e-8)
    np.testing.assert_allclose(whole.contact[swapped], whole.contact, rtol=0, atol=1e-6 * np.abs(whole.contact).max())


def test_a_cell_on_the_axis_keeps_the_half_turn_of_the_plain_weave() -> None:
    # On a shallow dome; a steep one would be cheaper to lie on off the axis, without friction. And only nearly: the
    # elements across the centre line point to one side, and the energy of (3.2) changes on reversal, Eq. (3.5).
    whole = pressed(grid(BLANK, centre="cell"), SHALLOW).whole
    number = {tuple(node): k for k, node in enumerate(whole.index.tolist())}
    turned = np.array([number[-1 - i, -1 - j] for i, j in whole.index.tolist()])
    np.testing.assert_allclose(whole.positions[turned] * (-1, -1, 1), whole.positions, rtol=0, atol=1e-4)


@pytest.mark.parametrize("kinematics", ["free", "differences"])
@pytest.mark.parametrize("crossing", ["pinned", "spring"])
def test_energy_goes_with_the_third_power_of_the_size(kinematics: str, crossing: str) -> None:
    # All lengths times k with the same moduli; a crossing spring then scales as a moment, with k³.
    k = 2.5
    found = []
    for scale in (1.0, k):
        tool = surface(
            PunchCase(profile=ParaboloidProfile(focal_length=100 * scale), rim_radius=40 * scale, fillet=20 * scale)
        )
        laid = grid(BLANK * scale, step=(STEP * scale, STEP * scale))
        spring = CrossingSpring(stiffness=300 * scale**3) if crossing == "spring" else "pinned"
        found.append(pressed(laid, tool, crossing=spring, wire={"diameter": scale}, kinematics=kinematics))
    small, large = found
    assert large.energy == pytest.approx(k**3 * small.energy, rel=1e-9)
    np.testing.assert_allclose(large.whole.positions, k * small.whole.positions, rtol=0, atol=1e-7)
    np.testing.assert_allclose(
        large.whole.contact, k**2 * small.whole.contact, rtol=0, atol=1e-7 * np.abs(large.whole.contact).max()
    )
    np.testing.assert_allclose(large.whole.stress, small.whole.stress, rtol=1e-6)


def test_energy_is_proportional_to_youngs_modulus_and_the_shape_independent_of_it() -> None:
    laid = grid(BLANK)
    stiff = wires()
    formed = [press(laid, elements, PUNCH, PressCase()) for elements in (stiff, softened(stiff, 0.2))]
    assert formed[1].energy == pytest.approx(0.2 * formed[0].energy, rel=1e-9)
    np.testing.assert_allclose(formed[1].whole.positions, formed[0].whole.positions, rtol=0, atol=1e-8)


def softened(elements: tuple[Any, Any], factor: float) -> tuple[Any, Any]:
    first, second = (replace(element, C=factor * element.C) for element in elements)
    return first, second


def test_a_crossing_spring_leads_from_pinned_to_welded() -> None:
    pinned, welded = pressed(), pressed(crossing="welded")
    energies = [
        pressed(crossing=CrossingSpring(stiffness=stiffness)).energy for stiffness in (1e-2, 1.0, 1e2, 1e4, 1e6, 1e7)
    ]
    energies = [pinned.energy, *energies, welded.energy]
    assert (np.diff(energies) > 0).all()
    # Both limits are approached in proportion to the stiffness and to its inverse.
    assert energies[1] - pinned.energy == pytest.approx(0.01 * (energies[2] - pinned.energy), rel=0.01)
    assert welded.energy - energies[-2] == pytest.approx(0.1 * (welded.energy - energies[-3]), rel=0.01)
    angles = np.sum(welded.whole.tangents[:, 0] * welded.whole.tangents[:, 1], axis=1)
    assert np.abs(angles).max() < 1e-12


def test_the_papers_kinematics_are_an_upper_bound() -> None:
    some: list[dict[str, Any]] = [{}, {"offset": "lower"}, {"rim": "clamp"}]
    for setting in (*some, {"crossing": CrossingSpring(stiffness=300.0)}):
        assert pressed(**setting).energy < pressed(kinematics="differences", **setting).energy


def test_holding_more_costs_more() -> None:
    drawn, welded = pressed(tool=SHALLOW), pressed(tool=SHALLOW, crossing="welded")
    assert drawn.energy < welded.energy < pressed(crossing="welded", rim="clamp").energy


def test_a_pull_outwards_lowers_the_draw_in_and_stretches_the_wires() -> None:
    found = [pressed(pull=(force, force)) for force in (0.5, 2.0, 8.0)]
    found = [pressed(), *found]
    assert (np.diff([formed.draw_in for formed in found]) < 0).all()
    assert (np.diff([formed.max_axial_strain for formed in found]) > 0).all()
    nothing = pressed(pull=(0.0, 0.0))
    assert nothing.energy == pytest.approx(found[0].energy, rel=1e-9)


def test_the_pull_follows_the_wires_and_ends_at_their_force() -> None:
    # On a plane wires stay straight: each carries just the force of its family, from end to end.
    formed = pressed(grid(BLANK), Plane(), wire={"straight": True, "height": 0.0}, pull=(3.0, 2.0))
    whole = formed.whole
    np.testing.assert_allclose(whole.F[:, 0], np.array([3.0, 2.0])[whole.family - 1], rtol=1e-9)
    np.testing.assert_allclose(whole.F[:, 1:], 0.0, atol=1e-9)
    np.testing.assert_allclose(whole.contact, 0.0, atol=1e-12)
    section = wires(straight=True)[0].section
    assert section is not None
    np.testing.assert_allclose(whole.axial_strain, whole.F[:, 0] / section.EA, rtol=1e-7)


# --- the start and the solver -------------------------------------------------------------------------------


def test_the_start_of_the_paper_lies_on_the_punch_above_the_flat_grid() -> None:
    laid = grid(BLANK)
    state = flat_start(laid, PUNCH)
    np.testing.assert_array_equal(state.positions[:, :2], laid.flat)
    assert np.abs(PUNCH.gap(state.positions).value).max() < 1e-12
    np.testing.assert_allclose(state.normals, PUNCH.gap(state.positions).gradient, atol=1e-12)
    for family in range(2):
        t = state.tangents[:, family]
        np.testing.assert_allclose(np.sum(t * state.normals, axis=1), 0.0, atol=1e-14)
        assert (t[:, family] > 0).all()


def test_another_start_leads_to_the_same_answer() -> None:
    laid, elements = grid(BLANK), wires()
    expected = press(laid, elements, PUNCH, PressCase())
    nearby = press(laid, elements, PUNCH, PressCase(rim="clamp")).state
    found = press(laid, elements, PUNCH, PressCase(), start=nearby)
    assert found.energy == pytest.approx(expected.energy, rel=1e-9)
    np.testing.assert_allclose(found.whole.positions, expected.whole.positions, rtol=0, atol=1e-7)


def test_a_solve_that_ends_nowhere_is_no_result() -> None:
    with pytest.raises(NoEquilibrium, match="step limit was reached"):
        press(grid(BLANK), wires(), PUNCH, PressCase(), solver=SolverCase(max_steps=2))


def test_welded_differences_are_refused() -> None:
    with pytest.raises(InputError, match="welded crossings need the free kinematics"):
        pressed(kinematics="differences", crossing="welded")


# --- tools of one's own -------------------------------------------------------------------------------------


def test_on_a_plane_nothing_happens() -> None:
    for weave in ("plain", "same", "stacked"):
        formed = pressed(grid(BLANK, weave=weave), Plane(), crossing=CrossingSpring(stiffness=1.0))
        assert formed.energy < 1e-18
        np.testing.assert_allclose(formed.whole.positions, formed.whole.flat, atol=1e-10)


def test_on_a_cylinder_one_family_is_bent_and_the_other_is_not() -> None:
    # A cylinder is developable: straight wires along it stay straight, those around it are bent as a beam to a circle,
    # EI kappa² s / 2 per element, up to the false strain of Eq. (3.5) and the ends, which bend less. (The mirror planes
    # keep it straight: a whole grid would turn to where both families are bent by half.)
    radius = 400.0
    laid = grid(size=(202.0, 62.0))
    straight = {"straight": True, "height": 0.0, "diameter": 0.5}
    formed = pressed(laid, Cylinder(radius), wire=straight, crossing=CrossingSpring(stiffness=10.0))
    whole = formed.whole
    assert formed.outcome is Outcome.CONVERGED
    around, along = whole.family == 1, whole.family == 2
    np.testing.assert_allclose(whole.D[along], 0.0, atol=1e-7)
    section = wires(diameter=0.5, straight=True)[0].section
    assert section is not None
    expected = 0.5 * section.EI * STEP / radius**2
    # What the free end does dies out by 2 - sqrt(3) per step, as in a beam over many supports.
    inside = around & (np.abs(whole.index[whole.start, 0]) < 5)
    np.testing.assert_allclose(whole.energy[inside], expected, rtol=2e-3)
    # Arc lengths are kept: the grid rolls up on the cylinder.
    angle = np.arctan2(whole.positions[:, 0], whole.positions[:, 2] + radius)
    np.testing.assert_allclose(radius * angle, whole.flat[:, 0], atol=2e-3 * STEP)
    np.testing.assert_allclose(whole.positions[:, 1], whole.flat[:, 1], atol=1e-6)


def test_a_cylinder_bends_with_the_square_of_its_curvature() -> None:
    laid = grid(size=(202.0, 62.0))
    found = [
        pressed(laid, Cylinder(radius), wire={"straight": True, "height": 0.0}, crossing=CrossingSpring(stiffness=10.0))
        for radius in (2000.0, 4000.0)
    ]
    assert found[0].energy / found[1].energy == pytest.approx(4.0, rel=1e-3)


# --- whatever may come --------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(
    step=st.tuples(st.floats(6.0, 14.0), st.floats(6.0, 14.0)),
    weave=st.sampled_from(("plain", "same", "stacked")),
    centre=st.sampled_from(("node", "cell")),
    crossing=st.sampled_from(("pinned", "welded", CrossingSpring(stiffness=100.0))),
    diameter=st.floats(0.2, 2.0),
    radius=st.floats(30.0, 60.0),
    rim_radius=st.floats(20.0, 50.0),
    sphere=st.floats(45.0, 300.0),
    kinematics=st.sampled_from(("free", "differences")),
    offset=st.sampled_from(("centred", "lower")),
    rim=st.sampled_from(("draw", "clamp")),
    pull=st.sampled_from((None, (1.0, 1.0), (0.0, 5.0))),
    method=st.sampled_from(("newton", "newton", "descent")),
)
def test_a_case_is_formed_or_refused_with_a_message(
    step: tuple[float, float],
    weave: str,
    centre: str,
    crossing: str | CrossingSpring,
    diameter: float,
    radius: float,
    rim_radius: float,
    sphere: float,
    kinematics: str,
    offset: str,
    rim: str,
    pull: tuple[float, float] | None,
    method: str,
) -> None:
    try:
        case = Case(
            grid=grid_case(radius, step=step, weave=weave, centre=centre, crossing=crossing),
            wire=wire_case(diameter, straight=weave == "stacked"),
            punch=PunchCase(profile=SphereProfile(radius=sphere), rim_radius=rim_radius, fillet=20.0),
            press=PressCase.model_validate(
                {
                    "kinematics": kinematics,
                    "offset": offset,
                    "rim": rim,
                    "pull": pull,
                    "method": method,
                    "descent": {"max_steps": 20},
                }
            ),
            solver=SolverCase(max_steps=30),
        )
        formed = run(case).formed
    except PunchformError:
        return
    assert np.isfinite(formed.energy)
    assert np.isfinite(formed.whole.positions).all()
    assert formed.energy >= 0
