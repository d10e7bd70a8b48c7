"""The flat grid: counts, weave, mirror planes, blanks of every shape, and what cannot be a grid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from punchform.case import CircleBlank, GridCase, PolygonBlank, RectangleBlank
from punchform.errors import InputError
from punchform.grid import Grid, lay
from punchform.outline import inside, reach


def grid_case(blank: object, *, step: tuple[float, float] = (10.0, 10.0), **settings: object) -> GridCase:
    return GridCase.model_validate({"step": step, "blank": blank} | settings)


def circle(radius: float = 52.0, **settings: object) -> GridCase:
    return grid_case(CircleBlank(radius=radius), **settings)  # type: ignore[arg-type]


def polygon(*points: tuple[float, float], **settings: object) -> GridCase:
    return grid_case(PolygonBlank(points=points), **settings)  # type: ignore[arg-type]


def nodes_of(grid: Grid) -> set[tuple[int, int]]:
    return {(int(i), int(j)) for i, j in grid.index}


# --- counts and places --------------------------------------------------------------------------------------


@pytest.mark.parametrize("radius", [20.0, 33.3, 50.0, 77.0, 100.0])
@pytest.mark.parametrize("centre", ["node", "cell"])
def test_the_nodes_are_all_crossings_inside_the_circle(radius: float, centre: str) -> None:
    grid = lay(circle(radius, centre=centre, symmetry="full"))
    shift = 0.0 if centre == "node" else 0.5
    lines = range(-12, 13)
    inside_it = {
        (i, j) for i in lines for j in lines if np.hypot((i + shift) * 10, (j + shift) * 10) <= radius * (1 + 1e-9)
    }
    assert nodes_of(grid) == inside_it
    np.testing.assert_allclose(grid.flat, (grid.index + shift) * 10.0)


def test_elements_join_neighbours_of_one_wire_once() -> None:
    for case in (circle(), circle(symmetry="full"), circle(centre="cell")):
        grid = lay(case)
        there = nodes_of(grid)
        expected = {((i, j), (i + 1, j)) for i, j in there if (i + 1, j) in there} | {
            ((i, j), (i, j + 1)) for i, j in there if (i, j + 1) in there
        }
        joined = [
            sorted((tuple(grid.index[a]), tuple(grid.index[b]))) for a, b in zip(grid.start, grid.end, strict=True)
        ]
        assert len(joined) == grid.elements == len(expected)
        assert {(a, b) for a, b in joined} == expected
        along = np.abs(grid.index[grid.end] - grid.index[grid.start])
        np.testing.assert_array_equal(along, np.eye(2, dtype=int)[grid.family])


@pytest.mark.parametrize("centre", ["node", "cell"])
def test_every_element_points_away_from_the_centre_line(centre: str) -> None:
    # Eq. (2.1); the element that crosses the centre line of a cell grid points to the positive side.
    grid = lay(circle(centre=centre, symmetry="full"))
    along = np.arange(grid.elements), grid.family
    near, far = grid.flat[grid.start][along], grid.flat[grid.end][along]
    assert ((np.abs(far) > np.abs(near)) | ((far == -near) & (far > 0))).all()
    np.testing.assert_allclose(far - near, grid.direction * 10.0)


def test_neighbours_are_those_before_and_after_along_each_wire() -> None:
    grid = lay(circle(symmetry="full"))
    number = {node: k for k, node in enumerate(map(tuple, grid.index.tolist()))}
    for (i, j), k in number.items():
        expected = [
            [number.get((i - 1, j), -1), number.get((i + 1, j), -1)],
            [number.get((i, j - 1), -1), number.get((i, j + 1), -1)],
        ]
        np.testing.assert_array_equal(grid.neighbours[k], expected)


def test_wire_ends_are_the_outline_and_never_a_mirror_plane() -> None:
    whole, quarter = lay(circle(symmetry="full")), lay(circle())
    # Each wire has two ends.
    for family in range(2):
        wires = len({int(row[1 - family]) for row in whole.index[whole.passes[:, family]]})
        assert whole.wire_ends[:, family].sum() == 2 * wires
    ends = {tuple(row) for row in whole.index[whole.wire_ends.any(axis=(1, 2))]}
    assert {tuple(row) for row in quarter.index[quarter.wire_ends.any(axis=(1, 2))]} == {
        (i, j) for i, j in ends if i >= 0 and j >= 0
    }
    assert not quarter.wire_ends[:, :, 0].any()


def test_unequal_steps_stretch_the_grid() -> None:
    grid = lay(circle(60.0, step=(10.0, 4.0), symmetry="full"))
    np.testing.assert_allclose(grid.flat, grid.index * (10.0, 4.0))
    assert grid.index.max(axis=0).tolist() == [6, 15]
    length = np.linalg.norm(grid.flat[grid.end] - grid.flat[grid.start], axis=1)
    np.testing.assert_allclose(length, np.array([10.0, 4.0])[grid.family])


def test_a_node_on_the_outline_belongs_to_the_blank() -> None:
    # (27, 36) lies on the circle of 45 steps; rounding must not cost it.
    step = 7.5
    blank = CircleBlank(radius=45 * step)
    for scale, belongs in ((1 - 1e-12, True), (1 + 1e-12, True), (1 + 1e-8, False)):
        assert bool(inside(blank, scale * step * np.array([[27.0, 36.0]]))[0]) == belongs


# --- mirror planes ------------------------------------------------------------------------------------------


def test_a_quarter_stands_for_the_whole_grid() -> None:
    whole, quarter = lay(circle(symmetry="full")), lay(circle())
    assert quarter.quarter
    assert quarter.copies == 4
    assert (quarter.copies * quarter.node_weight).sum() == whole.nodes
    assert (quarter.copies * quarter.weight).sum() == whole.elements
    assert nodes_of(quarter) == {(i, j) for i, j in nodes_of(whole) if i >= 0 and j >= 0}
    assert (whole.weight == 1).all()
    assert (whole.node_weight == 1).all()
    assert whole.copies == 1
    assert not whole.on_mirror.any()


@pytest.mark.parametrize("weave", ["plain", "same", "stacked"])
def test_the_signs_of_a_quarter_are_those_of_the_whole(weave: str) -> None:
    whole, quarter = lay(circle(weave=weave, symmetry="full")), lay(circle(weave=weave))

    def signs(grid: Grid) -> dict[tuple[int, ...], int]:
        keys = np.column_stack((grid.family, grid.index[grid.start], grid.index[grid.end]))
        return dict(zip(map(tuple, keys.tolist()), grid.sigma.tolist(), strict=True))

    of_whole = signs(whole)
    assert all(of_whole[key] == sign for key, sign in signs(quarter).items())
    # And a mirrored element has the sign of its image: else the planes would not be mirror planes.
    for (family, *ends), sign in of_whole.items():
        assert of_whole[(family, *map(abs, ends))] == sign


def heights(grid: Grid) -> np.ndarray:
    """Whether each wire lies low (-1) or high (+1) at each node, (N, 2), as its elements say; 0 where none does."""
    height = np.zeros((grid.nodes, 2), dtype=int)
    for ends, side in ((grid.start, -grid.sigma), (grid.end, grid.sigma)):
        for node, family, value in zip(ends, grid.family, side, strict=True):
            assert height[node, family] in (0, value), "two elements of one wire disagree on its height at a node"
            height[node, family] = value
    return height


@pytest.mark.parametrize("centre", ["node", "cell"])
@pytest.mark.parametrize("symmetry", ["quarter", "full"])
def test_in_a_plain_weave_wires_go_over_and_under_in_turn(centre: str, symmetry: str) -> None:
    grid = lay(circle(centre=centre, symmetry=symmetry))
    height = heights(grid)
    crossed = grid.passes.all(axis=1)
    np.testing.assert_array_equal(height[crossed, 0], -height[crossed, 1])
    np.testing.assert_array_equal(height[grid.start, grid.family], -height[grid.end, grid.family])
    # The next wire of the same family does the opposite: not a twill.
    parity = 1 - 2 * (grid.index.sum(axis=1) % 2)
    assert len(set((parity * height[:, 0])[height[:, 0] != 0].tolist())) == 1


def test_in_the_papers_weave_every_wire_rises_outwards() -> None:
    assert (lay(circle(weave="same")).sigma == 1).all()


def test_in_a_stacked_grid_each_family_has_its_own_side() -> None:
    grid = lay(circle(weave="stacked", symmetry="full"))
    for family in range(2):
        assert len(set(grid.sigma[grid.family == family].tolist())) == 1
    assert grid.sigma[grid.family == 0][0] == -grid.sigma[grid.family == 1][0] == -1


@pytest.mark.parametrize(
    ("case", "planes", "why"),
    [
        (circle(centre="cell"), True, "a plain weave with a cell on the axis has no mirror planes"),
        (circle(centre="cell", weave="same"), True, "the mirror planes cut elements"),
        (circle(), False, "the punch has none"),
        (polygon((-50, -50), (60, -50), (50, 50), (-50, 50)), True, "the blank is not symmetric"),
        (polygon((0, 40), (60, 0), (0, -40), (-41, 0)), True, "the blank is not symmetric"),
    ],
)
def test_without_mirror_planes_the_whole_grid_is_solved_and_says_why(case: GridCase, planes: bool, why: str) -> None:
    grid = lay(case, mirror_planes=planes)
    assert not grid.quarter
    assert len(grid.notes) == 1
    assert why in grid.notes[0]
    # Who asks for the whole grid is told nothing.
    assert lay(case.model_copy(update={"symmetry": "full"}), mirror_planes=planes).notes == ()


@pytest.mark.parametrize(
    "case",
    [
        circle(),
        grid_case(RectangleBlank(size=(80.0, 60.0))),
        polygon((50, 0), (0, 30), (-50, 0), (0, -30)),
        circle(weave="same"),
        circle(weave="stacked"),
    ],
)
def test_with_mirror_planes_a_quarter_is_solved_in_silence(case: GridCase) -> None:
    grid = lay(case)
    assert grid.quarter
    assert grid.notes == ()
    assert grid.index.min() == 0


# --- blanks -------------------------------------------------------------------------------------------------


def test_a_rectangle_is_given_by_its_full_lengths() -> None:
    grid = lay(grid_case(RectangleBlank(size=(80.0, 60.0)), symmetry="full"))
    assert nodes_of(grid) == {(i, j) for i in range(-4, 5) for j in range(-3, 4)}
    assert grid.elements == 8 * 7 + 9 * 6


def test_the_corners_of_a_polygon_may_run_either_way_round() -> None:
    corners = ((45.0, 5.0), (10.0, 42.0), (-38.0, 20.0), (-30.0, -35.0), (20.0, -44.0))
    one, other = lay(polygon(*corners)), lay(polygon(*reversed(corners)))
    np.testing.assert_array_equal(one.index, other.index)


@settings(max_examples=100, deadline=None)
@given(
    corners=st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=3, max_size=3, unique=True),
    at=st.tuples(st.floats(-9, 9), st.floats(-9, 9)),
)
def test_a_triangle_holds_what_lies_on_the_inner_side_of_all_its_sides(
    corners: list[tuple[int, int]], at: tuple[float, float]
) -> None:
    a, b, c = (np.array(corner, dtype=float) for corner in corners)
    p = np.array(at)

    def turns(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> float:
        return float((v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0]))

    sides = np.array([turns(a, b, p), turns(b, c, p), turns(c, a, p)]) * np.sign(turns(a, b, c))
    if turns(a, b, c) == 0 or np.abs(sides).min() < 1e-6:
        return
    blank = PolygonBlank(points=tuple((float(x), float(y)) for x, y in (a, b, c)))
    assert bool(inside(blank, p[None])[0]) == bool((sides > 0).all())


def test_a_polygon_holds_its_own_sides_and_corners() -> None:
    corners = np.array([(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (20.0, 10.0), (0.0, 30.0)])
    blank = PolygonBlank(points=tuple(map(tuple, corners.tolist())))
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    assert inside(blank, np.concatenate((corners, middles))).all()
    # The notch is outside.
    assert not inside(blank, np.array([[20.0, 20.0]]))[0]


@pytest.mark.parametrize(
    ("blank", "far"),
    [
        (CircleBlank(radius=7.0), (7.0, 7.0, 7.0)),
        (RectangleBlank(size=(8.0, 6.0)), (4.0, 3.0, 3.0)),
        (PolygonBlank(points=((4.0, 0.0), (0.0, 3.0), (-4.0, 0.0), (0.0, -3.0))), (4.0, 3.0, 2.4)),
        (PolygonBlank(points=((1.0, 0.0), (5.0, 0.0), (5.0, 2.0))), (5.0, 2.0, 0.0)),
    ],
)
def test_the_reach_of_a_blank_is_its_extent_and_its_nearest_side(blank: object, far: tuple[float, ...]) -> None:
    assert reach(blank) == pytest.approx(far)  # type: ignore[arg-type]


# --- what cannot be a grid ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("case", "rim_radius", "message"),
    [
        (circle(52.0), 60.0, "reaches only 52 mm from the axis, the rim lies at 60 mm"),
        (grid_case(RectangleBlank(size=(200.0, 100.0))), 60.0, "reaches only 50 mm"),
        (polygon((4, -90), (90, -90), (90, 90), (4, 90)), 10.0, "reaches only 0 mm"),
        (circle(9.9), 0.0, "holds only 0 crossings"),
        (circle(10.0), 0.0, "holds only 5 crossings"),
        (
            polygon(
                *((-60, -20), (-24, -20), (-24, 2), (24, 2), (24, -20), (60, -20)),
                *((60, 20), (24, 20), (24, 8), (-24, 8), (-24, 20), (-60, 20)),
            ),
            0.0,
            "falls into 2 separate pieces",
        ),
    ],
)
def test_a_blank_that_makes_no_grid_is_refused(case: GridCase, rim_radius: float, message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        lay(case, rim_radius=rim_radius)
    assert error.value.problems[0].where == "grid.blank"
    assert error.value.problems[0].hint


def test_a_blank_that_just_reaches_the_rim_is_accepted() -> None:
    assert lay(circle(52.0), rim_radius=52.0).nodes > 9


def test_a_single_crossing_that_no_element_reaches_is_left_out() -> None:
    # The thin tip of this blank holds the crossing (5, 0), but not (4, 0).
    tip = ((32.0, 2.0), (51.0, -0.5), (51.0, 0.5), (32.0, 4.0))
    case = polygon((-32, -32), (32, -32), *tip, (32, 32), (-32, 32), symmetry="full")
    assert inside(case.blank, np.array([[50.0, 0.0], [40.0, 0.0]])).tolist() == [True, False]
    assert nodes_of(lay(case)) == {(i, j) for i in range(-3, 4) for j in range(-3, 4)}


@settings(max_examples=60, deadline=None)
@given(
    radius=st.floats(1.0, 90.0),
    step=st.tuples(st.floats(3.0, 30.0), st.floats(3.0, 30.0)),
    centre=st.sampled_from(("node", "cell")),
    weave=st.sampled_from(("plain", "same", "stacked")),
    symmetry=st.sampled_from(("quarter", "full")),
)
def test_any_circle_is_a_sound_grid_or_an_input_error(
    radius: float, step: tuple[float, float], centre: str, weave: str, symmetry: str
) -> None:
    try:
        grid = lay(circle(radius, step=step, centre=centre, weave=weave, symmetry=symmetry))
    except InputError:
        # A circle holds one piece of grid, or hardly any.
        assert radius < 2.9 * max(step)
        return
    assert grid.nodes * grid.copies >= 9
    assert grid.passes.any(axis=1).all()
    assert set(np.unique(grid.sigma)) <= {-1, 1}
    assert (grid.start != grid.end).all()
    assert ((grid.start >= 0) & (grid.end < grid.nodes)).all()
    assert np.hypot(*grid.flat.T).max() <= radius * (1 + 1e-9)
