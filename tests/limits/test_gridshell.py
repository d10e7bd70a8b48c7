"""Elastic gridshells: arches that are elastica, and the published hemisphere of ten wires.

The hemisphere is a demonstration geometry of another program for networks of elastic rods; its figures, of first order
in the length of its elements, are given with 8, 16, 32 and 64 of them between two crossings.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from punchform.arch import arched
from punchform.case import (
    COLUMNS,
    CircleBlank,
    CrossingSpring,
    End,
    GridCase,
    StraightLine,
    WireCase,
    read_ends,
)
from punchform.errors import InputError
from punchform.grid import lay
from punchform.gridshell import Gridshell, gridshell, straight_elements
from punchform.mechanics.outcome import Outcome
from punchform.wire import Section, pieces, stiffness
from punchform.wires import FlatWire, LaidWires, lay_wires, wires_of

RADIUS, YOUNG, POISSON = 10.0, 100.0, 0.5
EI = YOUNG * np.pi * RADIUS**4 / 4
ROD = Section(2 * RADIUS, YOUNG * np.pi * RADIUS**2, EI, EI / (1 + POISSON), np.inf)
"""A round rod of 20 mm that does not shear, as those of the published program."""

OFFSET = 1000.0 / 3.0
HALF_LENGTH = (1000.0, 874.1667, 580.8333)
ENDS = ((0.0, 636.6667), (291.6667, 565.8333), (469.1667, 430.0))
"""Of the wires at 0, 1 and 2 offsets: half its length; where it ends, across and along itself [mm]."""

JOINTS = {
    (0, 1): (0.0, 320.674, 552.550),
    (1, 1): (314.506, 314.506, 457.968),
    (0, 2): (0.0, 554.254, 321.750),
    (1, 2): (297.691, 518.339, 201.670),
}
"""Crossings (i, j) with 64 elements [mm]."""
APEX = (630.984, 630.698, 630.575, 630.518)
ENERGY = (18968.0, 19055.0, 19094.0, 19112.5)
"""Height of the middle [mm] and energy [mJ] with 8, 16, 32 and 64 elements."""
WITHIN = 5e-4


def extrapolated(rows: tuple[float, ...]) -> float:
    """What a first-order sequence with halved steps tends to."""
    return 2 * rows[-1] - rows[-2]


def hemisphere_wires(subdivide: int) -> LaidWires:
    wires = [FlatWire(k * OFFSET, -HALF_LENGTH[abs(k)], HALF_LENGTH[abs(k)]) for k in range(-2, 3)]
    return lay_wires(wires, wires, subdivide=subdivide)


def hemisphere_ends() -> list[End]:
    ends = []
    for k in range(-2, 3):
        across, along = ENDS[abs(k)]
        for name, sign in (("low", -1), ("high", 1)):
            ends.append(End(1, k, name, (sign * along, np.sign(k) * across, 0.0)))  # type: ignore[arg-type]
            ends.append(End(2, k, name, (np.sign(k) * across, sign * along, 0.0)))  # type: ignore[arg-type]
    return ends


@cache
def hemisphere(subdivide: int, frame: str = "chord") -> Gridshell:
    laid = hemisphere_wires(subdivide)
    return gridshell(laid, straight_elements(laid, ROD), hemisphere_ends(), frame=frame)  # type: ignore[arg-type]


def at(shell: Gridshell, i: int, j: int) -> np.ndarray:
    whole = shell.whole
    found = (whole.index[: whole.crossings] == (i, j)).all(axis=1)
    return np.asarray(whole.positions[: whole.crossings][found][0])


# --- the hemisphere of ten wires ----------------------------------------------------------------------------


def test_the_hemisphere_is_the_published_one() -> None:
    shell = hemisphere(8)
    assert shell.outcome is Outcome.CONVERGED
    assert shell.negative_eigenvalues == 0
    assert shell.height == pytest.approx(extrapolated(APEX), rel=WITHIN)
    assert shell.energy == pytest.approx(extrapolated(ENERGY), rel=WITHIN)
    for joint, place in JOINTS.items():
        np.testing.assert_allclose(at(shell, *joint), place, rtol=0, atol=WITHIN * shell.height)
    bend = shell.energy_kinds["bend"] + shell.energy_kinds["in_plane"]
    for kind, published in (
        (bend, 19027.2),
        (shell.energy_kinds["stretch"], 64.5),
        (shell.energy_kinds["twist"], 20.8),
    ):
        assert kind == pytest.approx(published, abs=2e-3 * shell.energy)


def test_the_chord_frame_is_there_with_four_pieces_and_the_paper_s_frame_comes_at_order_2() -> None:
    final = hemisphere(16)
    for count, bound in ((1, 1e-2), (2, 1e-3), (4, 1e-4), (8, 1e-5)):
        assert hemisphere(count).height == pytest.approx(final.height, rel=bound)
        assert hemisphere(count).energy == pytest.approx(final.energy, rel=bound)
    errors = [hemisphere(count, "O").energy - final.energy for count in (2, 4, 8, 16)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


def test_the_hemisphere_is_symmetric_and_in_balance() -> None:
    shell = hemisphere(4)
    whole, n = shell.whole, shell.whole.crossings
    by_number = {
        tuple(index): place for index, place in zip(whole.index[:n].tolist(), whole.positions[:n], strict=True)
    }
    for (i, j), place in by_number.items():
        if max(abs(i), abs(j)) < 2:
            np.testing.assert_allclose(by_number[-i, j] * (-1, 1, 1), place, atol=1e-6)
            np.testing.assert_allclose(by_number[j, i][[1, 0, 2]], place, atol=1e-6)
    np.testing.assert_allclose(shell.reactions.sum(axis=0), 0, atol=1e-6 * np.abs(shell.reactions).max())
    moments = np.cross(whole.positions[shell.ends], shell.reactions).sum(axis=0)
    np.testing.assert_allclose(moments, 0, atol=1e-6 * np.abs(shell.reactions).max() * shell.height)


def test_upside_down_is_the_mirror_image() -> None:
    laid = hemisphere_wires(2)
    down = gridshell(laid, straight_elements(laid, ROD), hemisphere_ends(), up=-1)
    np.testing.assert_allclose(down.whole.positions * (1, 1, -1), hemisphere(2).whole.positions, atol=1e-6)


@pytest.mark.parametrize("crossing", ["welded", CrossingSpring(stiffness=1e6)])
def test_crossings_that_resist_shear_cost_energy(crossing: str | CrossingSpring) -> None:
    laid = hemisphere_wires(2)
    stiff = gridshell(laid, straight_elements(laid, ROD), hemisphere_ends(), crossing=crossing)
    assert stiff.energy > hemisphere(2).energy * 1.001


# --- two arches ---------------------------------------------------------------------------------------------


def elastica(way: float) -> tuple[float, float]:
    """Height and energy over EI of a pin-ended elastica of length 1 with its ends `way` apart."""
    m = brentq(lambda m: 2 * ellipe(m) / ellipk(m) - 1 - way, 1e-9, 0.9)
    return float(np.sqrt(m) / ellipk(m)), float(8 * ellipk(m) * (ellipe(m) - (1 - m) * ellipk(m)))


@pytest.mark.parametrize("way", [0.9, 0.5])
def test_two_arches_that_cross_are_elastica(way: float) -> None:
    """Both wires do the same, so the crossing passes nothing on."""
    length = 1000.0
    stiff = Section(1.0, 1e9 * EI / length**2, EI, EI, np.inf)
    height, energy = elastica(way)
    errors = []
    for count in (2, 4, 8):
        wire = [FlatWire(0.0, -0.5 * length, 0.5 * length)]
        laid = lay_wires(wire, wire, subdivide=count)
        reach = 0.5 * way * length
        ends = [End(1, 0, "low", (-reach, 0, 0)), End(1, 0, "high", (reach, 0, 0))]
        ends += [End(2, 0, "low", (0, -reach, 0)), End(2, 0, "high", (0, reach, 0))]
        shell = gridshell(laid, straight_elements(laid, stiff), ends)
        errors.append((shell.height / length / height - 1, shell.energy * length / EI / (2 * energy) - 1))
    assert np.abs(errors[-1]).max() < 2e-5
    assert (np.log2(np.abs(np.divide(errors[0], errors[2]))) / 2 > 3.5).all()


# --- wires --------------------------------------------------------------------------------------------------


def test_wires_cross_where_both_reach() -> None:
    laid = hemisphere_wires(3)
    grid = laid.grid
    assert grid.passes.all(axis=1).sum() == 21
    assert len(laid.lengths) == 3
    # A family has three wires of six pieces between crossings and ends, and two of four.
    assert grid.nodes == 21 + 20 + 2 * (3 * 6 + 2 * 4) * 2
    total = laid.lengths[grid.kind].sum()
    assert total == pytest.approx(15640.0, abs=0.01)
    np.testing.assert_allclose(
        np.linalg.norm(grid.flat[grid.end] - grid.flat[grid.start], axis=1), laid.lengths[grid.kind]
    )
    assert grid.wire_ends.sum() == 20


def test_a_wire_runs_on_past_one_that_is_short() -> None:
    across = [FlatWire(0.0, -1.0, 1.0), FlatWire(1.0, -1.0, -0.5), FlatWire(2.0, -1.0, 1.0)]
    laid = lay_wires([FlatWire(0.0, 0.0, 2.0), FlatWire(-0.75, -0.5, 2.5)], across, subdivide=2)
    upper, lower = laid.nodes[0][1], laid.nodes[0][0]
    np.testing.assert_allclose(laid.grid.flat[upper], np.column_stack((np.linspace(0, 2, 5), np.zeros(5))))
    np.testing.assert_allclose(laid.grid.flat[lower, 0], [-0.5, -0.25, 0, 0.5, 1, 1.5, 2, 2.25, 2.5])
    assert laid.grid.passes.all(axis=1).sum() == 5


@pytest.mark.parametrize(
    ("along_x", "along_y", "told"),
    [
        ([], [FlatWire(0, -1, 1)], "needs wires"),
        ([FlatWire(0, -1, 1)] * 2, [FlatWire(0, -1, 1)], "another offset"),
        ([FlatWire(0, 1, 1)], [FlatWire(0, -1, 1)], "no length"),
        ([FlatWire(0, -1, 1), FlatWire(5, -1, 1)], [FlatWire(0, -1, 1)], "crosses no other"),
    ],
)
def test_wires_that_make_no_grid_are_refused(along_x: list[FlatWire], along_y: list[FlatWire], told: str) -> None:
    with pytest.raises(InputError, match=told):
        lay_wires(along_x, along_y)


def test_a_grid_over_a_blank_becomes_a_gridshell() -> None:
    """The same arches by way of a blank: every wire end of a small grid moved in by a tenth."""
    case = GridCase(step=(10.0, 10.0), blank=CircleBlank(radius=32.0), symmetry="full", subdivide=2)
    wire = WireCase(diameter=1.0, youngs_modulus=210e3, centreline=StraightLine())
    laid = wires_of(lay(case))
    elements = pieces(stiffness(wire, case.step), 2)
    np.testing.assert_allclose(laid.lengths, 5.0)
    ends: list[End] = []
    for family, wires in enumerate(laid.nodes):
        for nodes in wires:
            number = int(laid.grid.index[nodes[0], 1 - family]) // 2
            for name, node in (("low", nodes[0]), ("high", nodes[-1])):
                if not any(np.allclose(end.point[:2], 0.9 * laid.grid.flat[node]) for end in ends):
                    ends.append(End(family + 1, number, name, (*(0.9 * laid.grid.flat[node]), 0.0)))  # type: ignore
    shell = gridshell(laid, elements, ends)
    assert shell.outcome is Outcome.CONVERGED
    assert shell.height > 5.0
    np.testing.assert_allclose(shell.reactions.sum(axis=0), 0, atol=1e-6 * np.abs(shell.reactions).max())
    with pytest.raises(InputError, match="quarter"):
        wires_of(lay(case.model_copy(update={"symmetry": "quarter"})))


# --- the start and the ends ---------------------------------------------------------------------------------


def test_arcs_are_as_long_as_their_wires() -> None:
    wire = [FlatWire(0.0, -1.0, 1.0)]
    laid = lay_wires(wire, wire, subdivide=200)
    held = np.concatenate([laid.nodes[w][0][[0, -1]] for w in range(2)])
    for reach in (0.9, 0.3, 1e-13):
        points = np.array([[-reach, 0.0, 0.2], [reach, 0.0, 0.2]])
        both = np.concatenate((points, points[:, [1, 0, 2]]))
        x = arched(laid.grid, laid.nodes, held, both, 1).positions[laid.nodes[0][0]]
        np.testing.assert_allclose(x[[0, -1]], points, atol=1e-12)
        assert np.linalg.norm(np.diff(x, axis=0), axis=1).sum() == pytest.approx(2.0, rel=1e-3)
        assert x[len(x) // 2, 2] > 0.1


def test_a_wire_that_is_not_held_lies_on_those_that_are() -> None:
    along_x = [FlatWire(500.0 * k, -1000.0, 1000.0) for k in (-1, 0, 1)]
    laid = lay_wires(along_x, [FlatWire(0.0, -750.0, 750.0)], subdivide=2)
    ends = []
    for k in (-1, 0, 1):
        ends += [End(1, k, "low", (-900.0, 500.0 * k, 0.0)), End(1, k, "high", (900.0, 500.0 * k, 0.0))]
    shell = gridshell(laid, straight_elements(laid, ROD), ends)
    assert shell.outcome is Outcome.CONVERGED
    free = shell.whole.positions[np.abs(shell.whole.flat[:, 1]) > 600]
    assert free[:, 2].min() > 250


@pytest.mark.parametrize(
    ("ends", "told"),
    [
        ([End(1, 7, "low", (0, 0, 0))], "no wire 7"),
        ([End(1, 0, "low", (0, 0, 0))] * 3, "given twice"),
        ([End(1, 0, "low", (0, 0, 0))], "do not hold"),
        ([End(1, 0, "low", (-900, 0, 0)), End(1, 1, "low", (-800, 0, 0)), End(1, 2, "low", (0, 0, 0))], "hangs loose"),
    ],
)
def test_ends_that_cannot_be_held_are_refused(ends: list[End], told: str) -> None:
    laid = hemisphere_wires(1)
    with pytest.raises(InputError, match=told):
        gridshell(laid, straight_elements(laid, ROD), ends)


def test_ends_are_read_from_a_table(tmp_path: Path) -> None:
    path = tmp_path / "ends.csv"
    rows = [
        f"{end.family},{end.wire},{end.end},{','.join(f'{x:.17g}' for x in end.point)}" for end in hemisphere_ends()
    ]
    path.write_text("\n".join([",".join(COLUMNS), *rows]) + "\n")
    assert list(read_ends(path)) == hemisphere_ends()
    path.write_text("family, wire, end, x, y, z\n1, -2, low, 0.5 m, 2 cm, -3\n")
    assert read_ends(path) == (End(1, -2, "low", (500.0, 20.0, -3.0)),)


def test_rows_that_are_no_ends_are_told_by_their_lines(tmp_path: Path) -> None:
    path = tmp_path / "ends.csv"
    lines = ["3,0,low,0,0,0", "1,a,low,0,0,0", "1,0,middle,0,0,0", "1,0,low,0,0,far", "1,0,low,0,0", "1,0,low,0,nan,0"]
    path.write_text("\n".join([",".join(COLUMNS), *lines]))
    with pytest.raises(InputError) as caught:
        read_ends(path)
    assert [problem.where for problem in caught.value.problems] == [f"ends.csv:{n}" for n in range(2, 8)]
    path.write_text("family,wire\n")
    with pytest.raises(InputError, match="no column end, x, y, z"):
        read_ends(path)
