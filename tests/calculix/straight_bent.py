"""A straight wire stretched, bent and let go, as elastic-plastic solids in CalculiX: how much of the bend stays.

The steel and the section are those of `crimped_pull`. Every section of the wire does the same, so one layer of bricks
between two plane faces is enough: O stays, A moves along x and turns about y. Either A is pulled and then turned where
it is, which unloads the inner side; or it is turned while free to follow and then pulled, which loads all of the
section; then it is let go.

`python straight_bent.py` (with `ccx` on the path) writes `straight_bent.csv` beside this file. Units: mm, N, MPa.
"""

from __future__ import annotations

import csv
import re
from itertools import product
from pathlib import Path
from time import perf_counter

import numpy as np
from ccx import answer_to
from crimped_pull import PATIENCE, HalfMesh, Ints, half_section, solids, swept
from crimped_wire_solids import Floats

ANSWERS = Path(__file__).with_name("straight_bent.csv")

LENGTH, CUTS = 0.5, 4
STRETCHES = (0.0, 0.001, 0.002, 0.01)
"""Elongation of the axis over its first length, before the bend."""
RADII = (600.0, 300.0, 100.0, 30.0)
"""Of the bend, about [mm]."""
COLUMNS = ("bent_first", "stretch", "curvature", "force", "moment", "stretch_kept", "curvature_kept")
"""Of the answers: whether it was bent before it was stretched; elongation of the axis over its first length and
curvature [1/mm] while bent; the force [N] and the moment [N mm] that do it; what is kept of both without them."""


def straight(cuts: int) -> HalfMesh:
    """One layer of bricks from O to A."""
    line = np.outer([0.0, 0.5, 1.0], [LENGTH, 0.0, 0.0])
    return swept(half_section(cuts), line, np.zeros(3))


def deck(mesh: HalfMesh, stretch: float, radius: float, *, bent_first: bool) -> str:
    """The CalculiX input: pull and turn, in either order, and let go; both are shifts of nodes apart."""
    pull, turn = len(mesh.nodes) + 1, len(mesh.nodes) + 2
    lines = solids(mesh)
    for node in mesh.faces[1]:
        z = mesh.nodes[node, 2]
        terms = [f"{node + 1}, 1, -1.", f"{pull}, 1, 1."]
        terms += [f"{turn}, 1, {-z:.12g}"] if abs(z) > 1e-12 else []
        lines += ["*EQUATION", str(len(terms)), *terms]
    # One node keeps the wire from floating up; nothing pushes there.
    stays = ["MIDDLE, 2, 2", "FACE_O, 1, 1", f"{mesh.faces[0][0] + 1}, 3, 3"]
    pulled = [f"{pull}, 1, 1, {stretch * LENGTH:.12g}"] if stretch else []
    turned = f"{turn}, 1, 1, {(1 + stretch) * LENGTH / radius:.12g}"
    first = [turned] if bent_first else [*pulled, f"{turn}, 1, 1, 0."]
    for moves in (first, [*pulled, turned], []):
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.05, 1., 1e-7, 0.05"]
        lines += ["*BOUNDARY, OP=NEW", *stays, *moves]
        lines += ["*NODE PRINT, NSET=FACE_A, FREQUENCY=1000", "U, RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def bend(stretch: float, radius: float, *, bent_first: bool, cuts: int = CUTS) -> Floats:
    """The answers for one wire, (7,) as COLUMNS says. Raises RuntimeError when ccx fails."""
    mesh = straight(cuts)
    face = mesh.faces[1]
    text = deck(mesh, stretch, radius, bent_first=bent_first)
    moves, forces = tables(answer_to(text, threads=1, timeout=PATIENCE), face)
    bent, freed = (mesh.nodes[face] + moved for moved in moves[-2:])
    rises, pulls = mesh.nodes[face, 2], forces[-2][:, 0]
    levers = bent[:, 2] - mesh.section.shares @ bent[:, 2]
    # Half the section carries half of both.
    efforts = 2 * pulls.sum(), -2 * pulls @ levers
    return np.array([bent_first, *shape(rises, bent), *efforts, *shape(rises, freed)])


def shape(rises: Floats, places: Floats) -> tuple[float, float]:
    """Elongation of the axis and its curvature, by the top and the bottom of the face at A."""
    low, high = places[np.argmin(rises)], places[np.argmax(rises)]
    along = 0.5 * (low[0] + high[0])
    return along / LENGTH - 1, float(np.arctan2(low[0] - high[0], high[2] - low[2])) / along


def tables(text: str, face: Ints) -> tuple[list[Floats], list[Floats]]:
    """The printed shifts and reactions of the nodes of the face, (n, 3) for each step. Raises RuntimeError."""
    found: dict[str, list[Floats]] = {"displacements": [], "forces": []}
    for block in re.split(r"^(?= *(?:displacements|forces) \()", text, flags=re.M)[1:]:
        rows = re.findall(r"^\s*(\d+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$", block, re.M)
        table = {int(number) - 1: [float(one) for one in row] for number, *row in rows}
        found[block.split(None, 1)[0]].append(np.array([table[node] for node in face]))
    if not len(found["displacements"]) == len(found["forces"]) == 3:
        raise RuntimeError(f"expected three steps from ccx, found {len(found['displacements'])}")
    return found["displacements"], found["forces"]


def main() -> None:
    """Bend all wires to all radii and keep the answers."""
    with ANSWERS.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for bent_first, stretch, radius in product((False, True), STRETCHES, RADII):
            # Without a pull there is no order.
            if stretch or bent_first:
                begin = perf_counter()
                writer.writerow([f"{one:.6g}" for one in bend(stretch, radius, bent_first=bent_first)])
                print(f"{bent_first}, stretch {stretch}, radius {radius}: {perf_counter() - begin:.1f} s")


if __name__ == "__main__":
    main()
