"""What acts on the released grid: forces on the nodes from gravity, pressure, wind and single forces (Eq. (7.3))."""

from __future__ import annotations

import numpy as np

from punchform.arrays import Floats
from punchform.case import LoadCase, WireCase
from punchform.errors import InputError
from punchform.grid import Grid
from punchform.mechanics.frames import State

EARTH = 9806.65
"""Standard gravity [mm/s²]."""
TONNE_PER_MM3 = 1e-12
"""1 kg/m³ in t/mm³, the unit of density beside N, mm and s."""


def wire_mass(grid: Grid, wire: WireCase, lengths: tuple[float, ...]) -> float | None:
    """Mass of all wire of the whole grid [kg], None without a density; lengths: of the wire in each piece [mm]."""
    if wire.density is None:
        return None
    return float(1e3 * grid.copies * (grid.weight * _piece_mass(wire, lengths)[grid.kind]).sum())


def _piece_mass(wire: WireCase, lengths: tuple[float, ...]) -> Floats:
    assert wire.density is not None
    return np.asarray(wire.density * TONNE_PER_MM3 * 0.25 * np.pi * wire.diameter**2 * np.asarray(lengths))


def forces(grid: Grid, state: State, case: LoadCase, wire: WireCase, lengths: tuple[float, ...]) -> Floats:
    """Dead forces on the solved nodes (N, 3) [N]; a node in a mirror plane has its share of the whole node's.

    Pressure and wind act along the normals of the given state. Raises InputError for a crossing that does not exist,
    and for a load that a quarter cannot bear because it is not symmetric about both axes.
    """
    total = np.zeros((grid.nodes, 3))
    area, covered = _areas(grid, wire)
    if case.gravity is not None:
        half = 0.5 * (grid.weight * _piece_mass(wire, lengths)[grid.kind])
        mass = np.bincount(grid.start, half, grid.nodes) + np.bincount(grid.end, half, grid.nodes)
        total += EARTH * mass[:, None] * np.asarray(case.gravity)
    if case.pressure is not None:
        total += case.pressure * area[:, None] * state.normals
    if case.wind is not None:
        total += case.wind.dynamic_pressure * case.wind.coefficient * covered[:, None] * state.normals
    for one in case.forces:
        total[_node(grid, one.node)] += np.asarray(one.force) * (0.25 if grid.quarter else 1.0)
    _demand_symmetric(grid, total, case)
    return total


def _areas(grid: Grid, wire: WireCase) -> tuple[Floats, Floats]:
    """Area of cloth per solved crossing, and the area that its wires cover, (N,) [mm²]; none between crossings."""
    along = _lengths(grid)
    covered = wire.diameter * (along[0] + along[1]) - wire.diameter**2 * grid.node_weight
    return cloth(grid), np.where(grid.crossings, covered, 0.0)


def cloth(grid: Grid) -> Floats:
    """Area of cloth that belongs to each solved node, (N,) [mm²]: none where only one wire passes."""
    first, second = _lengths(grid)
    return np.asarray(first * second / grid.node_weight)


def _lengths(grid: Grid) -> tuple[Floats, Floats]:
    """The length of wire of either family that belongs to each solved node, (N,) [mm]."""
    half = 0.5 * grid.weight * np.asarray(grid.step)[grid.family]
    along = [
        np.bincount(grid.start[own], half[own], grid.nodes) + np.bincount(grid.end[own], half[own], grid.nodes)
        for own in (grid.family == 0, grid.family == 1)
    ]
    return np.asarray(along[0], dtype=np.float64), np.asarray(along[1], dtype=np.float64)


def _node(grid: Grid, number: tuple[int, int]) -> int:
    wanted = np.abs(number) if grid.quarter else np.asarray(number)
    found = np.flatnonzero((grid.index == grid.subdivide * wanted).all(axis=1))
    if not found.size:
        raise InputError.of(f"the grid has no crossing {number}", where="load.forces")
    return int(found[0])


def _demand_symmetric(grid: Grid, total: Floats, case: LoadCase) -> None:
    """A quarter stands for four: gravity and forces may only act along the axis, a single one only on the axis."""
    if not grid.quarter:
        return
    sideways = case.gravity is not None and (case.gravity[0] or case.gravity[1])
    single = any(one.node != (0, 0) or one.force[0] or one.force[1] for one in case.forces)
    if sideways or single:
        raise InputError.of(
            "this load is not symmetric about both axes, and a quarter of the grid is solved",
            where="load.gravity" if sideways else "load.forces",
            hint='write release.symmetry = "full"',
        )
