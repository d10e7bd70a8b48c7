"""Wires cut in pieces between their crossings: grid, wire, start, equilibrium and tables, Eqs. (7.5), (7.6)."""

from __future__ import annotations

import numpy as np
import pytest
from small_grids import PUNCH, STEP, assert_equal_grids, grid, grid_case, wire_case

from punchform.arrays import Floats
from punchform.between import between
from punchform.case import (
    CosineLine,
    HoldNodes,
    ParaboloidProfile,
    PointsLine,
    PressCase,
    PunchCase,
    ReleaseCase,
    StraightLine,
    WireCase,
    case_from_text,
    read_case,
)
from punchform.drape import drape
from punchform.errors import InputError
from punchform.export.tables import nodes_csv, wires_csv
from punchform.grid import Grid, lay, undivided
from punchform.mechanics.assembly import Energy
from punchform.mechanics.frames import State, turn
from punchform.mechanics.kinematics import FreeFrames
from punchform.mechanics.newton import minimise
from punchform.net import start_state
from punchform.prepare import prepare
from punchform.press import Formed, press
from punchform.punch import surface
from punchform.release import release
from punchform.run import run
from punchform.solved import bars_of
from punchform.wire import (
    Element,
    along,
    cosine_line,
    line_through,
    pieces,
    round_section,
    stiffness,
    straight_line,
    stress,
    together,
)

SECTION = round_section(1.0, youngs_modulus=210e3, poisson=0.25, shear_factor=0.9)
BENT = line_through([(0.0, 0.2, 0.1), (2.5, 0.0, 0.4), (6.1, -0.3, 0.9), (10.0, 0.2, 1.1)], STEP)
"""A wire that leaves its plane and has no symmetry."""


# --- the grid -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("settings", [{}, {"symmetry": "full"}, {"centre": "cell"}, {"weave": "stacked"}])
@pytest.mark.parametrize("count", [2, 3])
def test_without_its_nodes_between_a_grid_is_the_uncut_one(count: int, settings: dict[str, object]) -> None:
    uncut, cut = grid(**settings), grid(subdivide=count, **settings)  # type: ignore[arg-type]
    again = undivided(cut)
    for name in ("index", "flat", "neighbours", "on_mirror"):
        np.testing.assert_array_equal(getattr(again, name), getattr(uncut, name), err_msg=name)
    there = {tuple(row): row[-2:] for row in _elements(uncut)}
    assert {tuple(row) for row in _elements(again)} == set(there)
    assert undivided(uncut) is uncut


def _elements(laid: Grid) -> list[list[float]]:
    columns = (laid.family, laid.start, laid.end, laid.direction, laid.sigma, laid.weight)
    return [list(row) for row in np.column_stack(columns).tolist()]


@pytest.mark.parametrize("centre", ["node", "cell"])
def test_pieces_of_a_wire_follow_each_other_outwards(centre: str) -> None:
    count = 3
    cut = grid(subdivide=count, symmetry="full", centre=centre)
    uncut = undivided(cut)
    assert cut.elements == count * uncut.elements
    assert cut.nodes == uncut.nodes + (count - 1) * uncut.elements
    np.testing.assert_array_equal(np.bincount(cut.kind), np.repeat(np.bincount(uncut.family), count))
    lengths = np.linalg.norm(cut.flat[cut.end] - cut.flat[cut.start], axis=1)
    np.testing.assert_allclose(lengths, STEP / count)
    assert not cut.passes[~cut.crossings].all(axis=1).any()
    assert not cut.wire_ends[~cut.crossings].any()
    # The next piece of the wire begins where one ends, with the same sign.
    inner = cut.kind % count < count - 1
    begins = {int(node): m for m, node in enumerate(cut.start) if cut.kind[m] % count}
    following = np.array([begins[int(node)] for node in cut.end[inner]])
    np.testing.assert_array_equal(cut.kind[following], cut.kind[inner] + 1)
    for name in ("sigma", "direction", "family"):
        np.testing.assert_array_equal(getattr(cut, name)[following], getattr(cut, name)[inner])


# --- the wire -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [2, 3, 7])
@pytest.mark.parametrize("line", [straight_line(STEP), cosine_line(1.0, STEP, segments=32), BENT])
def test_flexibilities_of_pieces_add_up_to_that_of_the_wire(line: object, count: int) -> None:
    whole = along(line, SECTION)  # type: ignore[arg-type]
    scale = np.sqrt(np.outer(np.diag(whole.C), np.diag(whole.C)))
    np.testing.assert_allclose(together(pieces((whole,), count)) / scale, whole.C / scale, rtol=0, atol=1e-12)


def test_pieces_carry_the_stress_of_the_wire() -> None:
    whole = along(cosine_line(1.0, STEP, segments=32), SECTION)
    cut = pieces((whole,), 4)
    F = np.array([[30.0, 2.0, -3.0, 5.0, 40.0, -7.0]])
    reach, largest = np.zeros(3), []
    for part in reversed(cut):
        at_end = F.copy()
        at_end[:, 3:] += np.cross(reach, F[:, :3])
        largest.append(stress(part, at_end)[0])
        assert part.centreline is not None
        reach += (part.length, 0.0, part.centreline.rise)
    # The uncut wire is looked at in fewer places.
    assert max(largest) >= stress(whole, F)[0] * (1 - 1e-12)
    assert max(largest) == pytest.approx(stress(whole, F)[0], rel=0.02)


@pytest.mark.parametrize(
    ("wire", "told"),
    [
        (WireCase(stiffness="paper"), "matrix"),
        (
            WireCase(
                diameter=1.0,
                youngs_modulus=2e5,
                centreline=PointsLine(points=((0.0, 0.0), (5.0, 0.5), (4.0, 0.8), (7.5, 1.0))),
            ),
            "turns back",
        ),
    ],
)
def test_a_wire_that_cannot_be_cut_says_why(wire: WireCase, told: str) -> None:
    with pytest.raises(InputError, match=told) as caught:
        pieces(stiffness(wire, (7.5, 7.5)), 2)
    assert caught.value.problems[0].where == "grid.subdivide"


# --- pieces between crossings are the wire ------------------------------------------------------------------


@pytest.mark.parametrize("chord", [False, True])
@pytest.mark.parametrize("offset", ["centred", "lower"])
@pytest.mark.parametrize("weave", ["plain", "stacked"])
def test_small_motions_of_crossings_cost_what_they_cost_the_uncut_wire(weave: str, offset: str, chord: bool) -> None:
    """The nodes between find their places: offsets, rises and signs of the pieces are those of one wire."""
    line = StraightLine(height=1.0) if weave == "stacked" else CosineLine(height=1.0, segments=32)
    wire = WireCase(diameter=1.0, youngs_modulus=210e3, poisson=0.25, centreline=line)
    case = PressCase(offset=offset, frame="chord" if chord else "O")
    elements = stiffness(wire, (STEP, STEP))
    cut = grid(1.5 * STEP, symmetry="full", weave=weave, subdivide=3)
    uncut = undivided(cut)
    moved = _shaken(uncut, 1e-5)
    expected = Energy(uncut, bars_of(elements, case), _held(uncut, np.ones(uncut.nodes, dtype=bool))).at(moved)
    state = _level(cut)
    for name in ("positions", "normals", "tangents"):
        getattr(state, name)[cut.crossings] = getattr(moved, name)
    energy = Energy(cut, bars_of(pieces(elements, 3), case), _held(cut, cut.crossings))
    assert energy.at(_level(cut)) < 1e-12 * expected
    assert energy.at(minimise(energy, state, scale=expected).state) == pytest.approx(expected, rel=1e-3)


def _held(laid: Grid, held: object) -> FreeFrames:
    return FreeFrames(laid, None, held)  # type: ignore[arg-type]


def _level(laid: Grid) -> State:
    up = np.tile((0.0, 0.0, 1.0), (laid.nodes, 1))
    return State(np.column_stack((laid.flat, 0 * laid.flat[:, 0])), up, np.tile(np.eye(3)[:2], (laid.nodes, 1, 1)))


def _shaken(laid: Grid, amount: float) -> State:
    rng = np.random.default_rng(3)
    level = _level(laid)
    tilt = amount * rng.uniform(-1, 1, (laid.nodes, 3)) * (1.0, 1.0, 0.0)
    shift = amount * STEP * rng.uniform(-1, 1, (laid.nodes, 3))
    return turn(level, level.positions + shift, tilt, amount * rng.uniform(-1, 1, (laid.nodes, 2)))


# --- the start ----------------------------------------------------------------------------------------------


def test_the_start_lies_on_the_surface_with_frames_along_it() -> None:
    cut = lay(grid_case(5.2 * STEP, subdivide=4))
    net = start_state(undivided(cut), PUNCH)
    start = between(cut, State(net.positions, net.normals, net.tangents), PUNCH)
    gap = PUNCH.gap(start.positions)
    assert np.abs(gap.value).max() < 1e-9
    np.testing.assert_allclose(np.sum(start.tangents * start.normals[:, None], axis=2), 0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(start.tangents, axis=2), 1)
    assert np.abs(start.positions[cut.on_mirror[:, 0], 0]).max() < 1e-12
    # No piece is much longer or shorter than it was.
    edges = np.linalg.norm(start.positions[cut.end] - start.positions[cut.start], axis=1)
    np.testing.assert_allclose(edges, STEP / 4, rtol=0.05)


# --- the press ----------------------------------------------------------------------------------------------

SHARP = surface(PunchCase(profile=ParaboloidProfile(focal_length=100.0), rim_radius=40.0, fillet=10.0))


def formed(count: int, *, frame: str = "chord", **settings: object) -> Formed:
    """The grid of 5 steps over a dish whose fillet is as sharp as a step."""
    laid = lay(grid_case(5.2 * STEP, subdivide=count, **settings))  # type: ignore[arg-type]
    return press(laid, _wires(count), SHARP, PressCase(frame=frame))


def _wires(count: int) -> tuple[Element, ...]:
    return pieces(stiffness(wire_case(), (STEP, STEP)), count)


@pytest.mark.parametrize("frame", ["O", "chord"])
def test_the_energy_converges_where_one_element_cannot_follow_the_fillet(frame: str) -> None:
    """Order 2: a wire's curvature jumps where the fillet begins."""
    energies = [formed(count, frame=frame).energy for count in (4, 8, 16)]
    ratio = (energies[1] - energies[0]) / (energies[2] - energies[1])
    assert 3.0 < ratio < 6.0
    assert formed(1, frame=frame).energy < 0.3 * energies[-1]


def test_both_frames_agree_once_the_pieces_are_short() -> None:
    apart = [abs(formed(n).energy / formed(n, frame="O").energy - 1) for n in (2, 16)]
    assert apart[1] < 3e-4 < apart[0]


def test_quarter_and_whole_grid_agree() -> None:
    one, other = formed(3), formed(3, symmetry="full")
    assert_equal_grids(one.whole, other.whole, 1e-6)
    np.testing.assert_array_equal(one.whole.between, other.whole.between)


@pytest.mark.parametrize("settings", [{"kinematics": "differences"}, {"rim": "clamp"}, {"pull": (5.0, 5.0)}])
def test_every_way_of_pressing_takes_pieces(settings: dict[str, object]) -> None:
    laid = lay(grid_case(5.2 * STEP, subdivide=2))
    done = press(laid, _wires(2), PUNCH, PressCase.model_validate(settings))
    assert done.outcome.usable
    assert np.abs(PUNCH.gap(done.whole.positions).value).max() < 1e-8


def test_a_welded_grid_is_pressed_in_pieces() -> None:
    laid = lay(grid_case(5.2 * STEP, subdivide=2))
    done = press(laid, _wires(2), PUNCH, PressCase(), crossing="welded")
    crossed = laid.passes.all(axis=1)
    tangents = done.state.tangents[crossed]
    np.testing.assert_allclose(np.sum(tangents[:, 0] * tangents[:, 1], axis=1), 0, atol=1e-12)


def test_released_on_the_whole_grid_it_is_what_the_quarter_is() -> None:
    one = formed(2)
    case = ReleaseCase(hold=HoldNodes(nodes=((3, 0), (-3, 0), (0, 3), (0, -3))))
    quarter = release(one, _wires(2), case, PressCase(frame="chord"))
    assert quarter.hold.count == 2
    full = lay(grid_case(5.2 * STEP, subdivide=2, symmetry="full"))
    whole = release(one, _wires(2), case, PressCase(frame="chord"), full_grid=full)
    if quarter.stability.negative == 0:
        assert whole.energy == pytest.approx(quarter.energy, rel=1e-6)
    assert whole.energy <= quarter.energy * (1 + 1e-6)


# --- what a user sees ---------------------------------------------------------------------------------------


def test_tables_have_crossings_and_pieces() -> None:
    count = 3
    cut, uncut = formed(count), formed(1)
    whole = cut.whole
    assert whole.crossings == len(uncut.whole.index)
    np.testing.assert_array_equal(whole.index[: whole.crossings], uncut.whole.index)
    np.testing.assert_array_equal(whole.cells, uncut.whole.cells)
    nodes, wires = (_table(text) for text in (nodes_csv(cut), wires_csv(cut)))
    np.testing.assert_array_equal(nodes[:, :4], _table(nodes_csv(uncut))[:, :4])
    np.testing.assert_array_equal(wires[::count, :3], _table(wires_csv(uncut))[:, :3])
    # Pieces of one wire one after the other: the moment at the end of one goes on in the next.
    np.testing.assert_array_equal(wires[0::count, :3], wires[2::count, :3])


def _table(text: str) -> Floats:
    return np.array([[float(cell or "nan") for cell in line.split(",")] for line in text.splitlines()[1:]])


def test_a_sharper_punch_is_let_through_when_the_wires_are_cut() -> None:
    case = read_case("packaged:check")
    coarse = case.model_copy(update={"grid": case.grid.model_copy(update={"step": (35.0, 35.0)})})
    with pytest.raises(InputError, match="sharper"):
        prepare(coarse)
    cut = coarse.model_copy(update={"grid": coarse.grid.model_copy(update={"subdivide": 4})})
    assert len(prepare(cut).elements) == 8
    # The net has straight edges between crossings, however the wires are cut.
    smooth = cut.model_copy(update={"punch": cut.tool.model_copy(update={"fillet": 71.0})})
    assert drape(smooth).grid.subdivide == 1


def test_crimped_wires_that_yield_straighten_alike_whole_and_in_pieces() -> None:
    """Levers that shrink within one element, Eq. (12.15), do what the nodes of a cut wire do by moving."""
    text = """
        schema = 1
        [grid]
        step = "10 mm"
        blank = { shape = "circle", radius = "72 mm" }
        [wire]
        material = "304 annealed"
        diameter = "0.8 mm"
        [punch]
        profile = { kind = "paraboloid", focal_length = "60 mm" }
        rim_radius = "60 mm"
        fillet = "15 mm"
        [press]
        rim = "clamp"
        strokes = 8
        [release]
        hold = { from_radius = "60 mm" }
    """
    whole, cut = (run(case_from_text(text.replace("[wire]", f"subdivide = {n}\n[wire]"))) for n in (1, 2))
    assert whole.formed.max_plastic_strain > 0.02
    assert cut.formed.energy == pytest.approx(whole.formed.energy, rel=0.03)
    assert whole.released is not None
    assert cut.released is not None
    assert cut.released.max_sag == pytest.approx(whole.released.max_sag, rel=0.1)
    assert cut.formed.whole.stretch.max() == pytest.approx(whole.formed.whole.stretch.max(), rel=0.01)
