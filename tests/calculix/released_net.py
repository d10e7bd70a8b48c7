"""A pressed net of 9 × 9 crossings, released on eight supports and loaded, as nonlinear beams in CalculiX.

The wires are elastic, so the released net does not remember the press: CalculiX starts from the flat, stress-free net,
moves the supports to where our press left them, and lets all else find its place (a small lift, taken away again,
chooses the side). Then single forces act. Welded wires share the node of a crossing. Pinned wires have a node each
with a stiff arm upright on it; the nodes and the tips of the arms are tied in their shifts, which makes an exact hinge
about the common normal.

The beams of CalculiX (B32R) are turned into bricks: a square section with Poisson's ratio 0 keeps them from
swelling where crossings are rigid, and one brick in the section resists twist with G b⁴/6, not with 0.141 G b⁴. Our
net is given just these rigidities. `python released_net.py` (with `ccx` on the path) writes `released_net_*.csv` beside
this file. Units: mm, N, MPa.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from ccx import answer_to
from numpy.typing import NDArray

from punchform.case import (
    GridCase,
    HoldPoints,
    LoadCase,
    PointForce,
    PressCase,
    RectangleBlank,
    ReleaseCase,
    StraightLine,
    WireCase,
)
from punchform.grid import lay
from punchform.load import Loaded, load
from punchform.press import press
from punchform.punch import Paraboloid
from punchform.release import Released, release
from punchform.wire import Section, along, straight_line

Floats = NDArray[np.float64]
Node = tuple[int, int]

CROSSINGS = ("pinned", "welded")
STEP, REACH = 10.0, 4
"""Step of the net [mm] and the largest number of a wire, counted from the middle."""
SIDE, YOUNGS_MODULUS = 1.0, 210e3
"""Side of the square section [mm] and Young's modulus [MPa]; Poisson's ratio is 0."""
FOCAL_LENGTH = 100.0
SUPPORTS = HoldPoints(points=8, radius=40.0)
FORCES = (PointForce(node=(2, 1), force=(0.0, 0.0, -60.0)), PointForce(node=(-2, -2), force=(30.0, 0.0, 0.0)))
ARM, STIFFER = 3.0, 30.0
"""Length of a hinge's arms [mm], and how much stiffer than the wire they are."""
LIFT = 0.5
"""Force on every crossing while the supports move [N]."""
RESIDUAL = "1e-4, 1e-3"
"""Largest residual force over the average force, and largest correction over the largest move, at the end of a part."""
SHARES = (0.1, 0.5, 0.5)
"""The parts in which the supports move, the lift leaves and the forces come."""
COLUMNS = ("i", "j", "held", *(f"{stage}_{axis}" for stage in ("x", "rx", "y", "ry") for axis in "123"))
"""Of the answers: x, rx position and reaction after the release [mm, N]; y, ry the same under the load."""


def rigidities(twist: float = SIDE**4 / 6) -> Section:
    """The section as the beams of CalculiX see it; twist: its torsion constant [mm⁴]."""
    E, G = YOUNGS_MODULUS, YOUNGS_MODULUS / 2
    return Section(SIDE, EA=E * SIDE**2, EI=E * SIDE**4 / 12, GJ=G * twist, kappa_GA=G * SIDE**2)


def our_net(crossing: str, section: Section | None = None) -> tuple[Released, Loaded]:
    """The same net by this package: pressed as a quarter, released and loaded as a whole."""
    case = GridCase(
        step=(STEP, STEP),
        blank=RectangleBlank(size=(2.01 * REACH * STEP, 2.01 * REACH * STEP)),
        weave="stacked",
    )
    elements = (along(straight_line(STEP), section or rigidities()),) * 2
    how = PressCase(frame="chord")
    formed = press(lay(case), elements, Paraboloid(FOCAL_LENGTH), how, crossing=crossing)
    whole = lay(case.model_copy(update={"symmetry": "full"}))
    released = release(formed, elements, ReleaseCase(hold=SUPPORTS), how, crossing=crossing, full_grid=whole)
    wire = WireCase(diameter=SIDE, youngs_modulus=YOUNGS_MODULUS, poisson=0.0, centreline=StraightLine(height=0.0))
    return released, load(released, elements, LoadCase(forces=FORCES), wire, how, crossing=crossing)


def crossings() -> list[Node]:
    """All crossings, by i, then j."""
    numbers = range(-REACH, REACH + 1)
    return [(i, j) for i in numbers for j in numbers]


@dataclass(frozen=True)
class Mesh:
    """Beams of three nodes: places (n, 3) [mm]; wires: the beams of both families; first, second: node of either wire
    at each crossing (the same when welded); arms: the beams upright on pinned crossings. Numbers count from 1."""

    places: list[tuple[float, float, float]]
    wires: tuple[list[list[int]], list[list[int]]]
    first: dict[Node, int]
    second: dict[Node, int]
    arms: list[list[int]]


def mesh(welded: bool, pieces: int) -> Mesh:
    """The flat net with `pieces` beams between two crossings."""
    places: list[tuple[float, float, float]] = []
    ends: tuple[dict[Node, int], dict[Node, int]] = ({}, {})
    wires: tuple[list[list[int]], list[list[int]]] = ([], [])

    def add(x: float, y: float, z: float = 0.0) -> int:
        places.append((x, y, z))
        return len(places)

    for family in range(2):
        for line in range(-REACH, REACH + 1):
            nodes = []
            for k in range(-2 * pieces * REACH, 2 * pieces * REACH + 1):
                along_, across = k * STEP / (2 * pieces), line * STEP
                place = (along_, across) if family == 0 else (across, along_)
                number, between = divmod(k, 2 * pieces)
                crossing = (number, line) if family == 0 else (line, number)
                if not between and welded and family == 1:
                    nodes.append(ends[0][crossing])
                else:
                    nodes.append(add(*place))
                if not between:
                    ends[family][crossing] = nodes[-1]
            wires[family].extend(nodes[at : at + 3] for at in range(0, len(nodes) - 1, 2))
    arms = []
    if not welded:
        for i, j in crossings():
            for family in range(2):
                upwards = [add(i * STEP, j * STEP, height) for height in (ARM / 2, ARM)]
                arms.append([ends[family][i, j], *upwards])
    return Mesh(places, wires, *ends, arms)


def deck(welded: bool, supports: dict[Node, Floats], forces: dict[Node, Floats], *, pieces: int) -> str:
    """The CalculiX input: the supports move, the lift leaves, the forces come."""
    net = mesh(welded, pieces)
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{number}, {x:.10g}, {y:.10g}, {z:.10g}" for number, (x, y, z) in enumerate(net.places, 1)]
    lines += _beams(net)
    if not welded:
        lines += _hinges(net, supports)
    both = sorted({net.first[node] for node in supports} | {net.second[node] for node in supports})
    lines += ["*NSET, NSET=CROSSINGS", *(f"{number}," for number in sorted(net.first.values()))]
    lines += ["*NSET, NSET=SUPPORTS", *(f"{number}," for number in both)]
    moves = []
    for (i, j), place in supports.items():
        for axis, shift in enumerate(place - (i * STEP, j * STEP, 0.0), 1):
            moves += [f"{number}, {axis}, {axis}, {shift:.10g}" for number in {net.first[i, j], net.second[i, j]}]
    free = [net.first[node] for node in crossings() if node not in supports]
    pushed = [
        f"{net.first[node]}, {axis}, {one:.10g}" for node, force in forces.items() for axis, one in enumerate(force, 1)
    ]
    lifts = [[f"{number}, 3, {force}" for number in free] for force in (LIFT, 0.0)]
    for forces_now, share in zip((*lifts, pushed), SHARES, strict=True):
        lines += ["*STEP, NLGEOM, INC=500", "*STATIC", f"{share}, 1., 1e-6, {share}"]
        lines += ["*CONTROLS, PARAMETERS=FIELD", RESIDUAL]
        lines += ["*BOUNDARY", *moves, "*CLOAD", *forces_now]
        lines += ["*NODE PRINT, NSET=CROSSINGS, FREQUENCY=500", "U"]
        lines += ["*NODE PRINT, NSET=SUPPORTS, FREQUENCY=500", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def _beams(net: Mesh) -> list[str]:
    lines, number = [], 0
    sets = {"ALONG_X": (net.wires[0], 1.0, "0, 0, 1"), "ALONG_Y": (net.wires[1], 1.0, "0, 0, 1")}
    if net.arms:
        sets["ARMS"] = (net.arms, STIFFER, "1, 0, 0")
    for name, (beams, stiffer, across) in sets.items():
        lines += [f"*ELEMENT, TYPE=B32R, ELSET={name}"]
        for beam in beams:
            number += 1
            lines.append(f"{number}, " + ", ".join(map(str, beam)))
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{stiffer * YOUNGS_MODULUS}, 0."]
        lines += [f"*BEAM SECTION, ELSET={name}, MATERIAL={name}, SECTION=RECT", f"{SIDE}, {SIDE}", across]
    return lines


def _hinges(net: Mesh, supports: dict[Node, Floats]) -> list[str]:
    """The two nodes and the two tips of the arms of a crossing move alike."""
    tips = [arm[-1] for arm in net.arms]
    ties = [(net.second[node], net.first[node]) for node in crossings() if node not in supports]
    ties += list(zip(tips[1::2], tips[0::2], strict=True))
    return [
        line
        for one, other in ties
        for axis in (1, 2, 3)
        for line in ("*EQUATION", "2", f"{one}, {axis}, 1., {other}, {axis}, -1.")
    ]


def by_calculix(crossing: str, *, pieces: int = 1) -> tuple[Floats, float]:
    """The answers, a row per crossing as COLUMNS says, and their seconds. Raises RuntimeError when ccx fails."""
    released, under = our_net(crossing)
    welded, begin = crossing == "welded", perf_counter()
    index = [(int(i), int(j)) for i, j in released.whole.index]
    held = {index[k]: released.whole.positions[k] for k in np.flatnonzero(released.hold.fixed.all(axis=1))}
    forces = {index[k]: under.applied[k] for k in np.flatnonzero(under.applied.any(axis=1))}
    shifts, reactions = tables(answer_to(deck(welded, held, forces, pieces=pieces)))
    net = mesh(welded, pieces)
    rows = []
    for i, j in crossings():
        row = [float(i), float(j), float((i, j) in held)]
        for shift, reaction in zip(shifts[1:], reactions[1:], strict=True):
            row += list(shift[net.first[i, j]] + (i * STEP, j * STEP, 0.0))
            # A pinned support holds both its wires.
            held_here = {net.first[i, j], net.second[i, j]}
            row += list(np.sum([reaction.get(number, np.zeros(3)) for number in held_here], axis=0))
        rows.append(row)
    return np.array(rows), perf_counter() - begin


def tables(text: str) -> tuple[list[dict[int, Floats]], list[dict[int, Floats]]]:
    """The printed shifts and reactions, a table per step. Raises RuntimeError when a step is missing."""
    found: dict[str, list[dict[int, Floats]]] = {"displacements": [], "forces": []}
    for block in re.split(r"^(?= *(?:displacements|forces) \()", text, flags=re.M)[1:]:
        kind = block.split(None, 1)[0]
        rows = re.findall(r"^\s*(\d+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$", block, re.M)
        found[kind].append({int(number): np.array([float(one) for one in row]) for number, *row in rows})
    if not len(found["displacements"]) == len(found["forces"]) == 3:
        raise RuntimeError(f"expected three steps from ccx, found {len(found['displacements'])}")
    return found["displacements"], found["forces"]


def answers(crossing: str) -> Path:
    """Where the answers are kept."""
    return Path(__file__).with_name(f"released_net_{crossing}.csv")


def main() -> None:
    """Run both nets and keep the answers."""
    for crossing in CROSSINGS:
        rows, seconds = by_calculix(crossing)
        print(f"{crossing}: {seconds:.1f} s")
        with answers(crossing).open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(COLUMNS)
            writer.writerows([*(int(one) for one in row[:3]), *(f"{one:.6f}" for one in row[3:])] for row in rows)


if __name__ == "__main__":
    main()
