"""A CalculiX deck of beams: nodes, sections, hinges, what is held, the stresses that are there, and steps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.export.beam_stress import ACROSS, Square
from punchform.export.beams import Beams
from punchform.mechanics.frames import unit

STIFFER = 30.0
"""How much stiffer than the wires the arms of crossings are."""
STEEP = 0.8
"""Arms that lie nearer to x than this cosine have another axis of their section."""
NOTHING = 1e-9
"""Stresses below this are none [MPa]."""
AT_ONCE = 500
"""So many beams are written at a time."""
TURNED = 0.04
"""Wires whose direction differs by less, in each component, share a turned material."""
ARMS = ("ARMS", "ARMS_STEEP")
RESIDUAL = "1e-4, 1e-3"
"""Largest residual force over the average force, and largest correction over the largest move, at the end of a part."""


@dataclass(frozen=True)
class Step:
    """One step: what nodes of the grid are pushed with at its end, forces (N, 3) [N], and how far those that are held
    have moved by then, moves (N, 3) [mm]; parts: the first, least and largest part of it."""

    title: str
    forces: Floats
    moves: Floats
    parts: tuple[float, float, float] = (1.0, 1e-5, 1.0)


@dataclass(frozen=True)
class Support:
    """What is held: clamped (N,) nodes of the grid keep place and directions; fixed (N, 3): where the others stay."""

    clamped: Bools
    fixed: Bools

    @property
    def nodes(self) -> Ints:
        """The nodes that are held in any direction."""
        return np.flatnonzero(self.clamped | self.fixed.any(axis=1))


def deck(
    heading: Sequence[str],
    beams: Beams,
    section: Square,
    stress: Floats,
    *,
    support: Support,
    sets: dict[str, Ints],
    steps: Sequence[Step],
) -> str:
    """The text of a deck.

    stress (B, 50, 6) [MPa] as `stresses` gives it; sets: nodes of the grid by the name of their set, beside GRID for
    all of them and HELD for those that are held.
    """
    sets = {"GRID": np.arange(len(support.clamped)), "HELD": support.nodes, **sets}
    lines = [f"** {line}" for line in heading]
    lines += ["*NODE, NSET=ALL", *_numbered(beams.places)]
    lines += _sections(beams, section)
    for name, nodes in sets.items():
        if nodes.size:
            lines += [f"*NSET, NSET={name}", *_in_rows(nodes + 1)]
    for one, other in (beams.ties + 1).tolist():
        for axis in (1, 2, 3):
            lines += ["*EQUATION", "2", f"{other}, {axis}, 1., {one}, {axis}, -1."]
    lines += ["*INITIAL CONDITIONS, TYPE=STRESS", *_stresses(stress)]
    pushed = np.any([step.forces != 0 for step in steps], axis=0)
    for step in steps:
        lines += _step(step, beams, support, pushed)
    return "\n".join(lines) + "\n"


def _numbered(places: Floats) -> Iterable[str]:
    return (f"{k}, {x:.9f}, {y:.9f}, {z:.9f}" for k, (x, y, z) in enumerate((places + 0.0).tolist(), 1))


def _sections(beams: Beams, section: Square) -> list[str]:
    """Materials, elements and sections: wires of one family in one direction, for which the material is turned."""
    E, G = section.youngs_modulus, section.shear_modulus
    lines = ["*MATERIAL, NAME=WIRE", "*ELASTIC, TYPE=ENGINEERING CONSTANTS"]
    lines += [f"{E:.9g}, {E:.9g}, {E:.9g}, 0., 0., 0., {G:.9g}, {G:.9g},", f"{G:.9g}, 294."]
    lines += ["*MATERIAL, NAME=STIFF", "*ELASTIC", f"{STIFFER * E:.9g}, 0."]
    sides = f"{section.side:.9g}, {section.side:.9g}"
    for name, family in (("WIRES_X", 1), ("WIRES_Y", 2)):
        along, parts = _directions(beams, family)
        for k, (direction, own) in enumerate(zip(along, parts, strict=True), 1):
            part, turn, across = f"{name}_{k}", f"TURN_{name[-1]}_{k}", ACROSS[family - 1]
            lines += _group(part, beams.wires[own], own)
            lines += [f"*ORIENTATION, NAME={turn}, SYSTEM=RECTANGULAR", f"{_row(direction)}, {_row(across)}"]
            lines.append(f"*BEAM SECTION, ELSET={part}, MATERIAL=WIRE, ORIENTATION={turn}, SECTION=RECT")
            lines += [sides, _row(across)]
        lines += [f"*ELSET, ELSET={name}", *(f"{name}_{k}," for k in range(1, len(parts) + 1))]
    axes = unit(beams.places[beams.arms[:, 1]] - beams.places[beams.arms[:, 0]])
    steep = np.abs(axes[:, 0]) > STEEP
    for name, own, across in zip(ARMS, map(np.flatnonzero, (~steep, steep)), ACROSS[::-1], strict=True):
        if own.size:
            lines += _group(name, beams.arms[own], own + len(beams.wires))
            lines += [f"*BEAM SECTION, ELSET={name}, MATERIAL=STIFF, SECTION=RECT", sides, _row(across)]
    return lines


def _directions(beams: Beams, family: int) -> tuple[Floats, list[Ints]]:
    """Directions (n, 3) that are near enough for the material, and which beams of the family run along each."""
    own = np.flatnonzero(beams.family == family)
    t = unit(beams.places[beams.wires[own, 2]] - beams.places[beams.wires[own, 0]])
    t *= np.where(t[:, family - 1] < 0, -1.0, 1.0)[:, None]
    rough, which = np.unique(np.round(t / TURNED).astype(np.int64), axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    return unit(rough.astype(np.float64)), np.split(own[order], np.cumsum(np.bincount(which.ravel()))[:-1])


def _group(name: str, ends: Ints, numbers: Ints) -> list[str]:
    rows = np.column_stack((numbers, ends)) + 1
    kind = "B32R" if rows.shape[1] == 4 else "B31"
    return [f"*ELEMENT, TYPE={kind}, ELSET={name}", *(", ".join(map(str, row)) for row in rows.tolist())]


def _row(values: Floats) -> str:
    return ", ".join(f"{one:.9g}" for one in (values + 0.0).tolist())


def _boundary(beams: Beams, support: Support, moves: Floats) -> Iterable[str]:
    for node in support.nodes.tolist():
        if support.clamped[node]:
            yield from (f"{centre + 1}, 1, 6" for centre in beams.centres[node].tolist() if centre >= 0)
            continue
        for axis in np.flatnonzero(support.fixed[node]).tolist():
            moved = f", {moves[node, axis]:.9g}" if moves[node, axis] else ""
            yield f"{node + 1}, {axis + 1}, {axis + 1}{moved}"


def _stresses(stress: Floats) -> Iterable[str]:
    """Rows of beam, point and stress; one format for many rows is several times faster than one for each."""
    beams, points, _ = stress.shape
    shown = np.where(np.abs(stress) < NOTHING, 0.0, stress)
    for first in range(0, beams, AT_ONCE):
        block = shown[first : first + AT_ONCE]
        count = len(block)
        number = np.repeat(np.arange(first + 1, first + 1 + count), points)
        point = np.tile(np.arange(1, points + 1), count)
        cells = np.column_stack((number, point, block.reshape(-1, 6)))
        row = "%d,%d" + 6 * ",%.5g" + "\n"
        yield ((row * len(cells)) % tuple(cells.ravel().tolist()))[:-1]


def _step(step: Step, beams: Beams, support: Support, pushed: Bools) -> list[str]:
    first, least, most = step.parts
    lines = [f"** {step.title}", "*STEP, NLGEOM, INC=1000", "*STATIC", f"{first:g}, 1., {least:g}, {most:g}"]
    lines += ["*CONTROLS, PARAMETERS=FIELD", RESIDUAL]
    if support.nodes.size:
        lines += ["*BOUNDARY", *_boundary(beams, support, step.moves)]
    if pushed.any():
        rows = np.argwhere(pushed).tolist()
        lines += ["*CLOAD", *(f"{n + 1}, {axis + 1}, {step.forces[n, axis] + 0.0:.9g}" for n, axis in rows)]
    lines += ["*NODE PRINT, NSET=GRID, FREQUENCY=1000", "U"]
    if support.nodes.size:
        lines += ["*NODE PRINT, NSET=HELD, FREQUENCY=1000, TOTALS=YES", "RF"]
    return [*lines, "*NODE FILE, OUTPUT=2D, FREQUENCY=1000", "U, RF", "*END STEP"]


def _in_rows(numbers: Ints) -> Iterable[str]:
    return (", ".join(map(str, numbers[k : k + 12].tolist())) + "," for k in range(0, len(numbers), 12))
