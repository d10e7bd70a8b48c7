"""The crimped wire as solid elements in CalculiX: mesh, deck, run, answer.

The round section is swept along the centreline of Eq. (2.3) with its planes across the tangent. The face
at O is held; the face at A moves as a rigid body with a reference point at its centre, which carries the
six unit loads one at a time. Its motions are the columns of B.

`python crimped_wire_solids.py` (with `ccx` on the path) runs a small and a fine mesh and writes
`answers.json` beside this file. Units: mm, N, MPa.
"""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from ccx import answer_to
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ANSWERS = Path(__file__).with_name("answers.json")

STEP, HEIGHT, DIAMETER = 7.5, 0.75, 0.75
YOUNGS_MODULUS, POISSON = 210e3, 0.25

EIGHTHS = np.arange(8) * np.pi / 4
SQUARE = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))

SMALL = (16, 1, "C3D20R")
"""Layers, rings and element of the smallest mesh that meets the tolerances with room to spare."""

FIRST_FREE_NUMBER = 900_001
"""Numbers of the reference point (displacement) and of the node that carries its rotation."""


@dataclass(frozen=True)
class Mesh:
    """Twenty-node bricks: nodes (n, 3) [mm], bricks (m, 20) 0-based, nodes on the faces at O and A."""

    nodes: Floats
    bricks: NDArray[np.int64]
    held: NDArray[np.int64]
    loaded: NDArray[np.int64]


def section_quads(rings: int) -> tuple[Floats, list[tuple[int, int, int, int]]]:
    """Corners (k, 2) in the unit disc and quads: four in a square core, then `rings` rings of eight."""
    core = 0.5
    points = [(0.0, 0.0)] + [(core * x * (1 if y == 0 else 0.9), core * y * (1 if x == 0 else 0.9)) for x, y in SQUARE]
    inner = np.array(points[1:])
    outer = np.column_stack([np.cos(EIGHTHS), np.sin(EIGHTHS)])
    corners = [np.array(points)]
    corners += [inner + (outer - inner) * ring / rings for ring in range(1, rings + 1)]
    quads = [(0, 1 + 2 * k, 2 + 2 * k, 1 + (2 * k + 2) % 8) for k in range(4)]
    for ring in range(rings):
        a, b = 1 + 8 * ring, 9 + 8 * ring
        quads += [(a + k, b + k, b + (k + 1) % 8, a + (k + 1) % 8) for k in range(8)]
    return np.vstack(corners), quads


def section_mesh(rings: int) -> tuple[Floats, int, list[tuple[int, ...]]]:
    """Eight-node quads of the unit disc: points (corners first), number of corners, quads of 8 numbers.

    The middle of an edge whose two ends lie on the circle lies on the circle too.
    """
    corners, quads = section_quads(rings)
    points = [*corners]
    middles: dict[tuple[int, int], int] = {}

    def middle(a: int, b: int) -> int:
        edge = (min(a, b), max(a, b))
        if edge not in middles:
            point = 0.5 * (corners[a] + corners[b])
            if np.allclose(np.linalg.norm(corners[[a, b]], axis=1), 1.0):
                point = point / np.linalg.norm(point)
            middles[edge] = len(points)
            points.append(point)
        return middles[edge]

    full = [(*quad, *(middle(quad[k], quad[(k + 1) % 4]) for k in range(4))) for quad in quads]
    return np.array(points), len(corners), full


def sweep(layers: int, rings: int) -> Mesh:
    """The wire in `layers` layers of bricks of equal t; planes across the tangent of the centreline."""
    flat, corners, quads = section_mesh(rings)
    planes = []
    start = [0]
    for half in range(2 * layers + 1):
        t = half / (2 * layers)
        across = flat if half % 2 == 0 else flat[:corners]
        slope = np.arctan2(0.5 * np.pi * HEIGHT * np.sin(np.pi * t), STEP)
        centre = np.array([STEP * t, 0.0, HEIGHT * np.sin(0.5 * np.pi * t) ** 2])
        up = np.array([-np.sin(slope), 0.0, np.cos(slope)])
        side = np.array([0.0, 1.0, 0.0])
        planes.append(centre + 0.5 * DIAMETER * (across[:, :1] * side + across[:, 1:] * up))
        start.append(start[-1] + len(across))
    bricks = []
    for layer in range(layers):
        low, between, high = start[2 * layer], start[2 * layer + 1], start[2 * layer + 2]
        for quad in quads:
            ends, middles = np.array(quad[:4]), np.array(quad[4:])
            bricks.append(np.concatenate([low + ends, high + ends, low + middles, high + middles, between + ends]))
    nodes = np.vstack(planes)
    face = np.arange(len(flat))
    return Mesh(nodes, np.array(bricks), face, start[-2] + face)


def deck(mesh: Mesh, kind: str) -> str:
    """The CalculiX input: six linear static steps of one unit load each."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.12g}, {y:.12g}, {z:.12g}" for k, (x, y, z) in enumerate(mesh.nodes, 1)]
    reference, rotation = FIRST_FREE_NUMBER, FIRST_FREE_NUMBER + 1
    x, y, z = mesh.nodes[mesh.loaded].mean(axis=0)
    lines += [f"{number}, {x:.12g}, {y:.12g}, {z:.12g}" for number in (reference, rotation)]
    lines += ["*NSET, NSET=TIP", f"{reference}, {rotation}", f"*ELEMENT, TYPE={kind}, ELSET=WIRE"]
    for number, brick in enumerate(mesh.bricks, 1):
        names = [str(node + 1) for node in brick]
        lines += [f"{number}, " + ", ".join(names[:10]) + ",", ", ".join(names[10:])]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNGS_MODULUS}, {POISSON}"]
    lines += ["*SOLID SECTION, ELSET=WIRE, MATERIAL=STEEL", "*NSET, NSET=HELD"]
    lines += [f"{node + 1}," for node in mesh.held]
    lines += ["*BOUNDARY", "HELD, 1, 3"]
    lines += _rigid_face(mesh, reference, rotation)
    for load in range(6):
        node, direction = (reference, load + 1) if load < 3 else (rotation, load - 2)
        lines += ["*STEP", "*STATIC", "*CLOAD, OP=NEW", f"{node}, {direction}, 1."]
        lines += ["*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def _rigid_face(mesh: Mesh, reference: int, rotation: int) -> list[str]:
    """u = U + φ × ρ for every node of the face at A, as linear equations."""
    lines = []
    centre = mesh.nodes[mesh.loaded].mean(axis=0)
    for node in mesh.loaded:
        rho = mesh.nodes[node] - centre
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            terms = [(node + 1, i + 1, -1.0), (reference, i + 1, 1.0)]
            terms += [(rotation, j + 1, rho[k]), (rotation, k + 1, -rho[j])]
            terms = [term for term in terms if abs(term[2]) > 1e-14]
            lines += ["*EQUATION", str(len(terms))]
            lines += [f"{number}, {direction}, {factor:.12g}" for number, direction, factor in terms]
    return lines


def flexibility_by_calculix(layers: int, rings: int, kind: str) -> tuple[Floats, dict[str, object]]:
    """B (6, 6) [mm/N, 1/N, 1/(N mm)] and what made it. Raises RuntimeError when ccx fails."""
    mesh = sweep(layers, rings)
    begin = perf_counter()
    B = parse(answer_to(deck(mesh, kind)))
    facts: dict[str, object] = {
        "element": kind,
        "layers": layers,
        "rings": rings,
        "nodes": len(mesh.nodes),
        "bricks": len(mesh.bricks),
        "equations": 3 * (len(mesh.nodes) - len(mesh.held) - len(mesh.loaded) + 2),
        "seconds": round(perf_counter() - begin, 1),
    }
    return B, facts


def parse(text: str) -> Floats:
    """B from the printed displacements of the two tip nodes after each of the six steps."""
    rows = re.findall(rf"^\s*({FIRST_FREE_NUMBER}|{FIRST_FREE_NUMBER + 1})\s+(\S+)\s+(\S+)\s+(\S+)\s*$", text, re.M)
    if len(rows) != 12:
        raise RuntimeError(f"expected 12 rows of displacements from ccx, found {len(rows)}")
    # ccx prints the nodes of a set in rising order: the reference point, then the rotation.
    motions = np.array([[float(value) for value in row[1:]] for row in rows])
    return motions.reshape(6, 6).T


def version() -> str:
    """What `ccx -v` says."""
    done = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False)
    found = re.search(r"[Vv]ersion\s+(\S+)", done.stdout)
    return found.group(1) if found else "unknown"


def main() -> None:
    """Run the small and the fine mesh, with reduced and with full integration, and keep the answers."""
    runs = []
    for layers, rings, kind in ((*SMALL,), (48, 2, "C3D20R"), (48, 2, "C3D20")):
        B, facts = flexibility_by_calculix(layers, rings, kind)
        runs.append({**facts, "B": B.tolist()})
        print(facts)
    wire = {
        "step": STEP,
        "height": HEIGHT,
        "diameter": DIAMETER,
        "youngs_modulus": YOUNGS_MODULUS,
        "poisson": POISSON,
    }
    record = {"ccx": version(), "units": "mm, N, MPa; element axes, Eq. (2.1)", "wire": wire, "runs": runs}
    text = json.dumps(record, indent=1)
    # One line per row of a matrix.
    text = re.sub(r"\[\s+([^\[\]]*?)\s+\]", lambda row: "[" + " ".join(row[1].split()) + "]", text)
    ANSWERS.write_text(text + "\n")


if __name__ == "__main__":
    main()
