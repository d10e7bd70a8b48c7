"""One crimped wire pulled until it is straight, as elastic-plastic solids in CalculiX: mesh, deck, run, answers.

Half a wave of an endless wire, the one of `crimped_wire_solids`; the plane y = 0 halves the section. The faces at O and
A are symmetry planes of the wave: they stay plane and across x. A moves along x and its pull is asked for, once
with A free to sink (the wires that cross give way) and once with A held at its height (they do not). The rises of the
faces are means over their area, so that what holds the height spreads over a face and dents nothing.

`python crimped_pull.py` (with `ccx` on the path) pulls a small and a fine mesh both ways and writes `crimped_pull.csv`
beside this file. Units: mm, N, MPa.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from ccx import answer_to
from crimped_wire_solids import DIAMETER, HEIGHT, STEP, Floats, section_mesh
from numpy.typing import NDArray

Ints = NDArray[np.int64]

ANSWERS = Path(__file__).with_name("crimped_pull.csv")

YOUNGS_MODULUS, POISSON, YIELD, TANGENT = 193e3, 0.29, 205.0, 2.5e3
"""AISI 304, annealed: true stress over logarithmic strain, linear and isotropic."""
HARDENING = YOUNGS_MODULUS * TANGENT / (YOUNGS_MODULUS - TANGENT)
"""Stress per plastic strain [MPa]."""
LARGEST_PLASTIC_STRAIN = 0.2
"""Where the table of the hardening ends; beyond it the stress would stay."""

PERCENT = np.concatenate(
    [
        [0.005, 0.02],
        np.linspace(0.05, 1.0, 20),
        np.linspace(1.1, 1.5, 5),
        np.linspace(1.75, 3.0, 6),
        np.linspace(3.5, 10.0, 14),
    ]
)
"""Pulls that are kept, as parts of the step [%]."""

SMALL, FINE = (16, 2), (20, 3)
"""Layers of bricks along the wire, and into how many by how many each of the six quads of half the section is cut: the
border between what yields and what does not crosses the section, and needs more bricks than elastic wires do."""
PATIENCE = 1200.0
"""Seconds after which a run of ccx is given up."""
CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0))
"""Where the eight nodes of a quad sit in its own coordinates."""
WAYS = ("free", "held")
COLUMNS = ("u", *(f"{way}_{what}" for way in WAYS for what in ("force", "force_small")), "free_height", "held_across")
"""Of the answers: pull of A [mm], forces along x by the fine and by the small mesh [N], the height that is left where A
is free [mm], and the force across, along z, on A where it is held [N]."""


@dataclass(frozen=True)
class HalfSection:
    """The half y ≥ 0 of the unit disc in quads of eight nodes: points (k, 2), corners first, their number, the share of
    each point in the mean over the area (k,), and the quads (m, 8)."""

    points: Floats
    corners: int
    shares: Floats
    quads: Ints


@dataclass(frozen=True)
class HalfMesh:
    """Half the wire in bricks of twenty nodes, 0-based. The nodes of the faces at O and A are as in the section."""

    nodes: Floats
    bricks: Ints
    faces: tuple[Ints, Ints]
    section: HalfSection

    @property
    def middle(self) -> Ints:
        """The nodes of the plane y = 0."""
        return np.flatnonzero(np.abs(self.nodes[:, 1]) < 1e-9)


def half_section(cuts: int) -> HalfSection:
    """Quads of the coarsest `section_mesh`, each cut into cuts × cuts."""
    disc, _, whole = section_mesh(1)
    i, j = np.divmod(np.arange(cuts**2), cuts)
    middles = (2 * np.column_stack([i, j]) + 1) / cuts - 1
    within = (middles[:, None] + np.array(CORNERS) / cuts).reshape(-1, 2)
    shapes = np.array([eight_nodes(r, q)[0] for r, q in within])
    places = np.vstack([shapes @ disc[list(quad)] for quad in whole if disc[list(quad), 0].min() > -1e-9])
    # The sides of a quad are parabolas, and the disc is round.
    reach = np.linalg.norm(places, axis=1, keepdims=True)
    places /= np.where(reach > 0.99, reach, 1.0)
    _, first, names = np.unique(places.round(9), axis=0, return_index=True, return_inverse=True)
    names = names.reshape(-1, 8)
    corners = np.unique(names[:, :4])
    order = np.concatenate([corners, np.setdiff1d(names, corners)])
    points, quads = places[first[order]], np.argsort(order)[names]
    return HalfSection(points, len(corners), shares(points, quads), quads)


def shares(points: Floats, quads: Ints) -> Floats:
    """The share of every point in the mean over the area: ∫ N dA / A by 3 × 3 Gauss points."""
    places, weights = np.polynomial.legendre.leggauss(3)
    total = np.zeros(len(points))
    for quad in quads:
        for r, one in zip(places, weights, strict=True):
            for q, other in zip(places, weights, strict=True):
                N, slopes = eight_nodes(r, q)
                total[quad] += one * other * abs(np.linalg.det(slopes @ points[quad])) * N
    return np.asarray(total / total.sum())


def eight_nodes(r: float, q: float) -> tuple[Floats, Floats]:
    """Shape functions (8,) of a quad of eight nodes, corners first, and their slopes (2, 8) in r and q."""
    R, Q = np.array(CORNERS, dtype=np.float64).T
    corner, along_r = np.arange(8) < 4, R == 0
    a, b = 1 + R * r, 1 + Q * q
    N = np.where(corner, a * b * (R * r + Q * q - 1) / 4, np.where(along_r, (1 - r * r) * b / 2, a * (1 - q * q) / 2))
    by_r = np.where(corner, R * b * (2 * R * r + Q * q) / 4, np.where(along_r, -r * b, R * (1 - q * q) / 2))
    by_q = np.where(corner, Q * a * (R * r + 2 * Q * q) / 4, np.where(along_r, Q * (1 - r * r) / 2, -q * a))
    return N, np.stack([by_r, by_q])


def swept(section: HalfSection, line: Floats, slopes: Floats) -> HalfMesh:
    """Bricks along a line of points (2 n + 1, 3) with sections across the slopes (2 n + 1,); odd points are middles."""
    planes, start = [], [0]
    for place, (centre, slope) in enumerate(zip(line, slopes, strict=True)):
        across = 0.5 * DIAMETER * (section.points if place % 2 == 0 else section.points[: section.corners])
        up = np.array([-np.sin(slope), 0.0, np.cos(slope)])
        planes.append(centre + across[:, :1] * np.array([0.0, 1.0, 0.0]) + across[:, 1:] * up)
        start.append(start[-1] + len(across))
    ends, middles = section.quads[:, :4], section.quads[:, 4:]
    bricks = [
        np.column_stack([low + ends, high + ends, low + middles, high + middles, between + ends])
        for low, between, high in zip(start[:-3:2], start[1:-2:2], start[2:-1:2], strict=True)
    ]
    face = np.arange(len(section.points))
    return HalfMesh(np.vstack(planes), np.vstack(bricks), (face, start[-2] + face), section)


def half_wave(layers: int, cuts: int) -> HalfMesh:
    """The wire of Eq. (2.3), in layers of equal t."""
    t = np.linspace(0.0, 1.0, 2 * layers + 1)
    line = np.column_stack([STEP * t, np.zeros_like(t), HEIGHT * np.sin(0.5 * np.pi * t) ** 2])
    return swept(half_section(cuts), line, np.arctan2(0.5 * np.pi * HEIGHT * np.sin(np.pi * t), STEP))


def deck(mesh: HalfMesh, *, held: bool) -> str:
    """The CalculiX input: one nonlinear step; held: whether the height of A is held."""
    rises = (len(mesh.nodes) + 1, len(mesh.nodes) + 2)
    lines = solids(mesh)
    lines += ["*NSET, NSET=RISE_A", f"{rises[1]},"]
    for face, rise in zip(mesh.faces, rises, strict=True):
        lines += _mean_rise(face, mesh.section.shares, rise)
    lines += ["*TIME POINTS, NAME=KEPT", *(f"{percent / PERCENT[-1]:.12g}," for percent in PERCENT)]
    lines += ["*STEP, NLGEOM, INC=2000", "*STATIC", f"{PERCENT[0] / PERCENT[-1]:.12g}, 1., 1e-7, 0.025"]
    lines += ["*BOUNDARY", "MIDDLE, 2, 2", "FACE_O, 1, 1", f"{rises[0]}, 3, 3"]
    lines += [f"FACE_A, 1, 1, {STEP * PERCENT[-1] / 100:.12g}"]
    lines += [f"{rises[1]}, 3, 3"] if held else []
    lines += ["*NODE PRINT, NSET=RISE_A, TIME POINTS=KEPT", "U"]
    lines += ["*NODE PRINT, NSET=FACE_A, TIME POINTS=KEPT, TOTALS=ONLY", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def solids(mesh: HalfMesh) -> list[str]:
    """Nodes, two of them apart from the bricks, then bricks, sets of nodes and the steel."""
    places = [*mesh.nodes, *(mesh.nodes[face].mean(axis=0) for face in mesh.faces)]
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{number}, {x:.12g}, {y:.12g}, {z:.12g}" for number, (x, y, z) in enumerate(places, 1)]
    lines += ["*ELEMENT, TYPE=C3D20R, ELSET=WIRE"]
    for number, brick in enumerate(mesh.bricks, 1):
        names = [str(node + 1) for node in brick]
        lines += [f"{number}, " + ", ".join(names[:10]) + ",", ", ".join(names[10:])]
    for name, numbers in zip(("FACE_O", "FACE_A", "MIDDLE"), (*mesh.faces, mesh.middle), strict=True):
        lines += [f"*NSET, NSET={name}", *(f"{number + 1}," for number in numbers)]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNGS_MODULUS}, {POISSON}", "*PLASTIC", f"{YIELD}, 0."]
    lines += [f"{YIELD + HARDENING * LARGEST_PLASTIC_STRAIN:.12g}, {LARGEST_PLASTIC_STRAIN}"]
    return [*lines, "*SOLID SECTION, ELSET=WIRE, MATERIAL=STEEL"]


def _mean_rise(face: Ints, parts: Floats, rise: int) -> list[str]:
    """The mean of u_z over a face is u_z of the node `rise`."""
    order = np.argsort(-np.abs(parts))
    # The first term is the one that ccx eliminates.
    terms = [f"{face[k] + 1}, 3, {parts[k]:.12g}" for k in order] + [f"{rise}, 3, -1."]
    return ["*EQUATION", str(len(terms)), *terms]


def pull(layers: int, cuts: int, *, held: bool) -> Floats:
    """The answers, a row per pull: force along x [N], force along z on A [N], height that is left [mm].

    Raises RuntimeError when ccx fails.
    """
    return parse(answer_to(deck(half_wave(layers, cuts), held=held), threads=1, timeout=PATIENCE))


def parse(text: str) -> Floats:
    """Rows as `pull` gives them. Raises RuntimeError when a pull is missing."""
    number = r"(\S+)\s+(\S+)\s+(\S+)\s*$"
    moves = re.findall(rf"^ displacements .*\n\s*\n\s*\d+\s+{number}", text, re.M)
    forces = re.findall(rf"^ total force .*\n\s*\n\s*{number}", text, re.M)
    if not len(moves) == len(forces) == len(PERCENT):
        raise RuntimeError(f"expected {len(PERCENT)} pulls from ccx, found {len(moves)} and {len(forces)}")
    force, move = np.array(forces, dtype=np.float64), np.array(moves, dtype=np.float64)
    # Half the section carries half the force.
    return np.column_stack([2 * force[:, 0], 2 * force[:, 2], HEIGHT + move[:, 2]])


def main() -> None:
    """Pull both meshes both ways and keep the answers."""
    found = {}
    for way in WAYS:
        for layers, cuts in (SMALL, FINE):
            begin = perf_counter()
            found[way, layers] = pull(layers, cuts, held=way == "held")
            print(f"{way}, {layers} layers: {perf_counter() - begin:.1f} s")
    fine, small = FINE[0], SMALL[0]
    columns = [STEP * PERCENT / 100]
    columns += [found[way, layers][:, 0] for way in WAYS for layers in (fine, small)]
    columns += [found["free", fine][:, 2], found["held", fine][:, 1]]
    with ANSWERS.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows([f"{one:.6g}" for one in row] for row in np.column_stack(columns))


if __name__ == "__main__":
    main()
