"""A small grid that relaxes in time on a sphere, by PyElastica; `against_others.py` runs it in PyElastica's own Python.

Reads the problem as JSON from stdin: the nodes of the net along_x (wires, nodes, 3) [mm], step, sphere radius, wire
diameter [mm], youngs_modulus [MPa], poisson, pieces, and the seconds it may take. Writes what it reached as JSON to
stdout.

Every wire is one rod with the shape of the net and `pieces` elements between two crossings; crossings are PyElastica's
ball joints; a stiff spring along the normal holds every crossing on the sphere. Statics do not depend on inertia and
damping, so these are chosen for speed: the rotary inertia is raised until rotations allow the time step that
stretching does, and of three dampings the fastest counts.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from importlib.metadata import version
from time import perf_counter
from typing import Any

import elastica
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

DENSITY = 7.85e-9
"""Steel [t/mm³]."""
SAFETY = 0.5
"""Time step over the stability limit of the stiffest oscillator."""
DAMPINGS = (1e3, 4e3, 1.6e4)
"""Uniform damping rates that are tried [1/s]; the slowest bending oscillates at some 1e3 to 1e4 per second."""
REST = 1e-12
"""At rest when the kinetic energy is below this fraction of the elastic one."""
LOOK_EVERY = 200
MARKS = (1e-2, 1e-4, 1e-6)


class Grid(elastica.BaseSystemCollection, elastica.Connections, elastica.Forcing, elastica.Damping):
    """Rods with joints, forces and damping."""


class OnSphere(elastica.NoForces):
    """A spring along the normal of a sphere about the origin on every crossing."""

    def __init__(self, radius: float, stiffness: float, pieces: int) -> None:
        self.radius, self.stiffness, self.pieces = radius, stiffness, pieces

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add the forces of the springs."""
        x = system.position_collection[:, :: self.pieces]
        distance = np.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
        system.external_forces[:, :: self.pieces] += self.stiffness * (self.radius / distance - 1.0) * x


def finer(nodes: Floats, pieces: int, radius: float) -> Floats:
    """The nodes (n, 3) with others between them, all on the sphere."""
    places = np.linspace(0.0, len(nodes) - 1.0, (len(nodes) - 1) * pieces + 1)
    between = np.stack([np.interp(places, np.arange(len(nodes)), column) for column in nodes.T], axis=1)
    return between * (radius / np.linalg.norm(between, axis=1))[:, None]


def rod_along(nodes: Floats, asked: dict[str, Any]) -> Any:
    """A rod that is straight and unloaded at rest, laid along the nodes (n, 3)."""
    nodes = finer(nodes, asked["pieces"], asked["radius"])
    count, length = len(nodes) - 1, asked["step"] / asked["pieces"]
    modulus, poisson = asked["youngs_modulus"], asked["poisson"]
    edges = np.diff(nodes, axis=0)
    tangents = edges / np.linalg.norm(edges, axis=1)[:, None]
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    normals = middles - tangents * np.sum(middles * tangents, axis=1)[:, None]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    rod = elastica.CosseratRod.straight_rod(
        count,
        np.zeros(3),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 0.0, 1.0]),
        count * length,
        0.5 * asked["diameter"],
        DENSITY,
        youngs_modulus=modulus,
        shear_modulus=modulus / (2 * (1 + poisson)),
    )
    rod.position_collection[:] = nodes.T
    rod.director_collection[0] = normals.T
    rod.director_collection[1] = np.cross(tangents, normals).T
    rod.director_collection[2] = tangents.T
    slower = max((length / asked["diameter"]) ** 2, 1.0)
    rod.mass_second_moment_of_inertia *= slower
    rod.inv_mass_second_moment_of_inertia /= slower
    return rod


def elastic_energy(rods: Sequence[Any]) -> float:
    """What bends, twists, shears and stretches in all rods [mJ]."""
    total = 0.0
    for rod in rods:
        rod.compute_internal_forces_and_torques(0.0)
        strain, curvature = rod.sigma - rod.rest_sigma, rod.kappa - rod.rest_kappa
        total += 0.5 * np.einsum("ik,ijk,jk,k->", strain, rod.shear_matrix, strain, rod.rest_lengths)
        total += 0.5 * np.einsum("ik,ijk,jk,k->", curvature, rod.bend_matrix, curvature, rod.rest_voronoi_lengths)
    return float(total)


def ratio(rods: Sequence[Any]) -> tuple[float, float]:
    """The elastic energy [mJ], and the kinetic one over it."""
    energy = elastic_energy(rods)
    moving = sum(rod.compute_translational_energy() + rod.compute_rotational_energy() for rod in rods)
    return energy, float(moving) / energy


def relax(asked: dict[str, Any], damping: float, limit: float) -> Floats:
    """Steps, seconds, elastic energies and kinetic over elastic energies, until at rest or out of time."""
    along_x = np.array(asked["along_x"])
    area = 0.25 * np.pi * asked["diameter"] ** 2
    pieces, length = asked["pieces"], asked["step"] / asked["pieces"]
    axial = asked["youngs_modulus"] * area / length
    time_step = SAFETY * np.sqrt(DENSITY * area * length / axial) / np.sqrt(2)
    grid = Grid()
    wires = [*along_x, *along_x.transpose(1, 0, 2)]
    rods = [rod_along(nodes, asked) for nodes in wires]
    for rod in rods:
        grid.append(rod)
    for rod in rods:
        grid.add_forcing_to(rod).using(OnSphere, radius=asked["radius"], stiffness=axial, pieces=pieces)
        grid.dampen(rod).using(elastica.AnalyticalLinearDamper, uniform_damping_constant=damping, time_step=time_step)
    for j in range(along_x.shape[0]):
        for i in range(along_x.shape[1]):
            grid.connect(rods[j], rods[along_x.shape[0] + i], i * pieces, j * pieces).using(
                elastica.FreeJoint, k=axial, nu=0.0
            )
    grid.finalize()
    stepper = elastica.PositionVerlet()
    time, step = 0.0, 0
    # Compiled before the clock starts.
    stepper.step(grid, time, time_step)
    ratio(rods)
    begun = perf_counter()
    trace = []
    while True:
        for _ in range(LOOK_EVERY):
            time = stepper.step(grid, time, time_step)
        step += LOOK_EVERY
        energy, motion = ratio(rods)
        trace.append((step, perf_counter() - begun, energy, motion))
        if not trace[-1][3] > REST or trace[-1][1] > limit:
            return np.array(trace)


def main() -> None:
    """Relax with every damping, and tell when the fastest came near its last energy for good."""
    asked = json.load(sys.stdin)
    share = asked["seconds"] / len(DAMPINGS)
    traces = [relax(asked, damping, share) for damping in DAMPINGS]
    # What ended with the least motion is the nearest to rest; all are judged by its energy.
    last = min(traces, key=lambda trace: trace[-1, 3])[-1, 2]
    reached = []
    for within in MARKS:
        best = None
        for trace in traces:
            away = np.flatnonzero(~(np.abs(trace[:, 2] / last - 1) <= within))
            first = away[-1] + 1 if len(away) else 0
            if first < len(trace) and (best is None or trace[first, 1] < best["seconds"]):
                step, seconds, energy, motion = trace[first]
                best = {"within": within, "steps": int(step), "seconds": seconds, "energy": energy, "motion": motion}
        if best:
            reached.append(best)
    json.dump({"version": version("pyelastica"), "reached": reached}, sys.stdout)


if __name__ == "__main__":
    main()
