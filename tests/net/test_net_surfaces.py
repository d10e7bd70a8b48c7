"""The net on every punch: across fillet and flange, on steep walls, from any origin, with and without tables."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
from nets import Hidden, edges, rectangle

from punchform.case import (
    CircleBlank,
    ConeProfile,
    EllipsoidProfile,
    ExpressionProfile,
    FlatProfile,
    GridCase,
    ParaboloidProfile,
    PolynomialProfile,
    Profile,
    PunchCase,
    SphereProfile,
    TableProfile,
)
from punchform.errors import InputError
from punchform.grid import Grid, lay
from punchform.net import lay_net, touching
from punchform.net.chain import chain
from punchform.net.ground import Untabled, ground
from punchform.net.pieces import pieces
from punchform.punch import Paraboloid, Revolution, Sphere, bare, uncorrected
from punchform.punch.curves import Graph

PROFILES: dict[str, Profile] = {
    "paraboloid": ParaboloidProfile(focal_length=250.0),
    "sphere": SphereProfile(radius=400.0),
    "hemisphere": SphereProfile(radius=270.0),
    "ellipsoid": EllipsoidProfile(radius=350.0, height=120.0),
    "cone": ConeProfile(half_angle=math.radians(50.0), nose_radius=100.0),
    "low cup": FlatProfile(height=40.0, edge_radius=30.0),
    "polynomial": PolynomialProfile(coefficients=(5.0, 0.0, -1e-3, 1e-6, -4e-9)),
    "dented": PolynomialProfile(coefficients=(0.0, 0.0, 1e-3, 0.0, -2e-8)),
    "table": TableProfile(points=tuple((25.0 * k, -((25.0 * k) ** 2) / 1000.0) for k in range(13))),
    "expression": ExpressionProfile(z="40 * cos(pi*rho/400) + 10*exp(-(rho/100)**2)"),
    "root": ExpressionProfile(z="sqrt(1000**2 - rho**2)"),
}


def punch(name: str, scale: float = 1.0) -> Revolution:
    """The punch with rim radius 300 mm and fillet 30 mm; scaled only where the profile is a paraboloid or sphere."""
    profile = PROFILES[name]
    match profile:
        case ParaboloidProfile():
            profile = ParaboloidProfile(focal_length=scale * profile.focal_length)
        case SphereProfile():
            profile = SphereProfile(radius=scale * profile.radius)
        case _:
            assert scale == 1.0
    return uncorrected(PunchCase(profile=profile, rim_radius=300.0 * scale, fillet=30.0 * scale))


def disc(step: float, *, radius: float = 345.0, scale: float = 1.0) -> Grid:
    blank = CircleBlank(radius=radius * scale)
    return lay(GridCase(step=(step * scale, step * scale), weave="same", blank=blank))


every_punch = pytest.mark.parametrize("name", PROFILES)


@every_punch
def test_edges_are_right_and_nodes_on_the_surface_across_fillet_and_flange(name: str) -> None:
    grid, made = disc(7.5, radius=460.0 if name == "hemisphere" else 345.0), punch(name)
    net = lay_net(grid, made)
    assert net.complete
    assert np.abs(edges(grid, net.positions)).max() < 1e-13
    assert np.abs(made.distance(net.positions)).max() < 1e-11 * 300.0
    # The blank reaches the flange, and lies flat there.
    outside = np.hypot(*net.positions[:, :2].T) > 301.0
    assert outside.any()
    assert np.abs(net.positions[outside, 2]).max() < 1e-12


@pytest.mark.parametrize("scale", [1e-3, 1e4])
@pytest.mark.parametrize("name", ["paraboloid", "sphere"])
def test_units_do_not_matter(name: str, scale: float) -> None:
    grid, small = disc(15.0), disc(15.0, scale=scale)
    net, scaled = lay_net(grid, punch(name)), lay_net(small, punch(name, scale))
    assert np.abs(scaled.positions / scale - net.positions).max() < 1e-11 * 300.0
    assert np.abs(edges(small, scaled.positions)).max() < 1e-13


@every_punch
def test_tables_and_signed_distance_give_the_same_net(name: str) -> None:
    grid, made = disc(15.0), punch(name)
    fast, slow = lay_net(grid, made), lay_net(grid, Hidden(made))
    assert chain(made) is not None
    assert chain(Hidden(made)) is None
    assert np.array_equal(fast.reached, slow.reached)
    assert np.abs(fast.positions - slow.positions).max() < 1e-11 * 300.0
    assert np.abs(fast.shear - slow.shear).max() < 1e-11


@every_punch
def test_normals_from_tables_are_those_of_the_surface(name: str) -> None:
    made = punch(name)
    x = lay_net(disc(15.0), made).positions
    assert np.abs(ground(made).normals(x) - made.gap(x).gradient).max() < 1e-11


def test_the_steep_walls_of_a_cup_are_covered() -> None:
    made = uncorrected(PunchCase(profile=FlatProfile(height=90.0, edge_radius=25.0), rim_radius=100.0, fillet=30.0))
    grid = rectangle((60, 2), (3.0, 3.0), symmetry="quarter")
    net = lay_net(grid, made)
    assert net.complete
    assert np.abs(edges(grid, net.positions)).max() < 1e-13
    on_wall = np.abs(net.positions[:, 2] - 47.0) < 15.0
    assert on_wall.any()
    assert np.abs(np.hypot(*net.positions[on_wall, :2].T) - 70.0).max() < 1e-12
    assert np.abs(made.distance(net.positions)).max() < 1e-10


def test_bends_sharper_than_the_step_are_met_by_the_nearest_point() -> None:
    made = uncorrected(PunchCase(profile=FlatProfile(height=9.0, edge_radius=2.0), rim_radius=40.0, fillet=2.0))
    grid = rectangle((14, 2), (4.0, 4.0), symmetry="quarter")
    fast, slow = lay_net(grid, made), lay_net(grid, Hidden(made))
    assert fast.complete
    assert np.abs(edges(grid, fast.positions)).max() < 1e-13
    assert np.abs(made.distance(fast.positions)).max() < 1e-11
    assert np.abs(fast.positions - slow.positions).max() < 1e-10
    # Along the axis every step goes outwards or down.
    wire = fast.positions[grid.index[:, 1] == 0]
    assert (np.diff(wire[:, 0]) > -1e-12).all()


@pytest.mark.parametrize("name", ["paraboloid", "sphere", "ellipsoid", "cone"])
def test_a_profile_without_rim_goes_on_straight_beyond_its_end(name: str) -> None:
    made = bare(PROFILES[name], 150.0)
    grid = rectangle((18, 18), (12.0, 12.0), symmetry="quarter")
    fast, slow = lay_net(grid, made), lay_net(grid, Hidden(made))
    assert fast.complete
    assert np.hypot(*fast.positions[:, :2].T).max() > 170.0
    assert np.abs(fast.positions - slow.positions).max() < 1e-9
    assert np.abs(made.distance(fast.positions)).max() < 1e-9


def test_pieces_agree_with_a_formula_to_rounding_and_refuse_what_is_not_smooth() -> None:
    graph = punch("expression").chain.segments[0]
    assert isinstance(graph, Graph)
    found = pieces(graph.function, graph.end)
    assert found is not None
    rho = np.linspace(0.0, graph.end, 5001)
    exact = graph.function(rho)[0]
    for piece in found:
        mine = (rho >= piece.low) & (rho <= piece.high)
        fitted = np.polyval(piece.coefficients, (rho[mine] - piece.origin) * piece.scale)
        assert np.abs(fitted - exact[mine]).max() < 1e-13 * graph.end
    assert pieces(lambda r: (np.abs(r - 1.0), np.sign(r - 1.0), 0 * r), 3.0) is None
    assert pieces(lambda r: (np.abs(r - 1.0), np.sign(r - 1.0), 0 * r), 3.0, (1.0,)) is not None


def test_from_an_origin_of_its_own_the_sphere_gives_the_same_net_turned() -> None:
    step = (0.1, 0.13)
    grid = rectangle((6, 5), step)
    straight = lay_net(grid, Sphere(1.0))
    x0, y0, direction = 0.3, -0.2, 0.7
    turned = lay_net(grid, Sphere(1.0), origin=(x0, y0), direction=direction)
    normal = np.array([x0, y0, math.sqrt(1 - x0**2 - y0**2)])
    ahead = np.array([math.cos(direction), math.sin(direction), 0.0])
    ahead -= (ahead @ normal) * normal
    ahead /= np.linalg.norm(ahead)
    rotation = np.column_stack((ahead, np.cross(normal, ahead), normal))
    assert np.abs(turned.positions - straight.positions @ rotation.T).max() < 1e-10
    assert np.abs(turned.shear - straight.shear).max() < 1e-9
    assert np.abs(edges(grid, turned.positions)).max() < 1e-13


def test_on_a_paraboloid_any_origin_gives_right_edges_on_geodesics() -> None:
    made = Paraboloid(0.5)
    for centre in ("node", "cell"):
        grid = rectangle((8, 8), (0.05, 0.04), centre=centre)
        net = lay_net(grid, made, origin=(0.2, 0.1), direction=math.radians(30.0))
        hidden = lay_net(grid, Hidden(made, mirror_planes=False), origin=(0.2, 0.1), direction=math.radians(30.0))
        assert net.complete
        assert np.abs(edges(grid, net.positions)).max() < 1e-13
        assert np.abs(made.distance(net.positions)).max() < 1e-15
        assert np.abs(net.positions - hidden.positions).max() < 1e-12
        # Clairaut: rho sin(angle to the meridian) is constant along a geodesic; for chords to the third order.
        wire = net.positions[grid.index[:, 1] == 0]
        middle, chord = (wire[1:] + wire[:-1]) / 2, np.diff(wire, axis=0)
        clairaut = (middle[:, 0] * chord[:, 1] - middle[:, 1] * chord[:, 0]) / 0.05
        assert np.ptp(clairaut) < 1e-3 * np.abs(clairaut).max()


@pytest.mark.parametrize("name", PROFILES)
def test_geodesics_of_a_punch_keep_their_moment_about_the_axis_and_lead_back(name: str) -> None:
    """Clairaut across fillet and flange, as if every step were exact; the way back is the way there."""
    made = punch(name)
    start = np.array([60.0, 30.0, float(made.height(np.array([[60.0, 30.0]]))[0])])
    on = ground(made)
    ahead = np.cross(on.normals(start[None])[0], (0.3, -0.8, 0.1))
    ahead /= np.linalg.norm(ahead)
    end, there = on.walk(start, ahead, 500.0)
    assert np.hypot(end[0], end[1]) > 310.0
    assert end[0] * there[1] - end[1] * there[0] == pytest.approx(start[0] * ahead[1] - start[1] * ahead[0], rel=1e-10)
    back, reverse = on.walk(end, -there, 500.0)
    assert np.abs(back - start).max() < 1e-7
    assert np.abs(reverse + ahead).max() < 1e-9


@pytest.mark.parametrize("name", ["paraboloid", "low cup", "expression"])
def test_geodesics_in_tables_are_those_of_the_distance(name: str) -> None:
    made, step = punch(name), 7.5
    start = np.array([60.0, 30.0, float(made.height(np.array([[60.0, 30.0]]))[0])])
    on, any_surface = ground(made), Untabled(made)
    ahead = np.cross(on.normals(start[None])[0], (-0.3, 0.8, 0.1))
    ahead /= np.linalg.norm(ahead)
    wire = on.geodesic(start, ahead, step, 46)
    assert np.abs(wire - any_surface.geodesic(start, ahead, step, 46)).max() < 1e-8
    assert np.abs(np.linalg.norm(np.diff(wire, axis=0), axis=1) / step - 1.0).max() < 1e-14
    assert np.abs(made.distance(wire)).max() < 1e-12


@pytest.mark.parametrize("scale", [1e-3, 1e4])
@pytest.mark.parametrize("centre", ["node", "cell"])
def test_a_net_from_an_origin_of_its_own_knows_no_unit(scale: float, centre: Literal["node", "cell"]) -> None:
    """Across the fillet, in metres as in micrometres."""
    plain, other = (
        lay_net(
            rectangle((40, 40), (7.5 * size, 9.0 * size), centre=centre),
            punch("paraboloid", size),
            origin=(50.0 * size, 20.0 * size),
            direction=0.4,
        )
        for size in (1.0, scale)
    )
    assert plain.complete
    assert np.abs(other.positions / scale - plain.positions).max() < 1e-8
    assert np.abs(other.shear - plain.shear).max() < 1e-9


def test_the_middle_of_a_cell_lies_on_the_origin() -> None:
    grid = rectangle((3, 3), (0.02, 0.02), centre="cell")
    net = lay_net(grid, Sphere(1.0), origin=(0.2, 0.1))
    inner = ((grid.index == 0) | (grid.index == -1)).all(axis=1)
    assert np.abs(net.positions[inner].mean(axis=0)[:2] - (0.2, 0.1)).max() < 1e-4


def test_without_mirror_planes_the_wires_through_the_axis_are_geodesics() -> None:
    grid = rectangle((6, 6), (0.1, 0.1))
    known = lay_net(grid, Sphere(1.0))
    found = lay_net(grid, Hidden(Sphere(1.0), mirror_planes=False))
    assert np.abs(found.positions - known.positions).max() < 1e-11


def test_a_blank_that_is_not_convex_is_reached_through_what_is_cut_away() -> None:
    corners = ((-0.6, -0.6), (0.6, -0.6), (0.6, 0.6), (0.2, 0.6), (0.2, 0.2), (-0.2, 0.2), (-0.2, 0.6), (-0.6, 0.6))
    from punchform.case import PolygonBlank

    grid = lay(GridCase(step=(0.1, 0.1), weave="same", blank=PolygonBlank(points=corners), symmetry="full"))
    square = rectangle((6, 6), (0.1, 0.1))
    whole = {tuple(i): x for i, x in zip(square.index.tolist(), lay_net(square, Sphere(1.0)).positions, strict=True)}
    net = lay_net(grid, Sphere(1.0))
    assert len(grid.index) < len(square.index)
    assert np.array_equal(net.positions, np.array([whole[tuple(i)] for i in grid.index.tolist()]))


def test_a_wire_locks_where_its_neighbours_touch() -> None:
    limit = touching(0.75, (7.5, 6.0))
    assert 6.0 * math.cos(limit) == pytest.approx(0.75)
    grid = rectangle((14, 14), (0.1, 0.1), symmetry="quarter")
    limit = math.radians(60.0)
    net = lay_net(grid, Sphere(1.0), shear_limit=limit)
    known = np.isfinite(net.shear)
    assert np.array_equal(net.locked[known], np.abs(net.shear[known]) > limit)
    assert 0 < net.locked.sum() < known.sum()
    assert net.max_shear > limit
    note = net.notes[0]
    assert note.startswith(f"the net locks: {net.locked.sum()} of {len(net.cells)} cells")
    assert "60 deg" in note
    with pytest.raises(InputError, match="do not fit side by side"):
        touching(8.0, (7.5, 9.0))


def test_an_origin_that_cannot_be_is_refused() -> None:
    grid = rectangle((4, 4), (0.1, 0.1), symmetry="quarter")
    with pytest.raises(InputError, match="no mirror planes"):
        lay_net(grid, Sphere(1.0), direction=0.3)
    with pytest.raises(InputError, match="does not reach there"):
        lay_net(rectangle((4, 4), (0.1, 0.1)), Sphere(1.0), origin=(1.5, 0.0))


def test_wires_that_meet_nothing_are_said_to_end() -> None:
    """A step longer than the sphere is wide."""
    net = lay_net(rectangle((2, 2), (2.5, 2.5)), Sphere(1.0))
    assert net.reached.sum() == 1
    assert "no point there at one step" in net.notes[0]
