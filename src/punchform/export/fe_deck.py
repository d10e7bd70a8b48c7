"""FE decks of a run: the grid as beams with the forces that are in its wires, for CalculiX (and, with changes, Abaqus).

A deck starts in a bent shape, not in the flat one, so it needs no press: each wire carries from the beginning what it
carries here, as initial stresses of its beams. The wires are elastic from there on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats, Ints
from punchform.case import CrossingSpring
from punchform.errors import InputError
from punchform.export.beam_stress import square, stresses
from punchform.export.beams import beams
from punchform.export.calculix import Step, Support, deck
from punchform.export.heading import heading
from punchform.export.tables import rows_csv
from punchform.mechanics.bars import Bars
from punchform.mechanics.end_loads import end_loads
from punchform.prepare import prepare
from punchform.release import Released
from punchform.run import formed_with
from punchform.solved import Shaped, bars_of
from punchform.whole import Whole, spread_over, unfold_loads, unfold_vectors
from punchform.wire import Element

if TYPE_CHECKING:
    from punchform.run import Run

FORMED, SPRINGBACK, RELEASED = "formed.inp", "springback.inp", "released.inp"
NODES, NODE_COLUMNS = "deck_nodes.csv", ("node", "i", "j", "between", "x0", "y0")
BEAMS = 2
"""Beams of three nodes for a wire between two crossings: two half waves of a crimp; its pieces have one each."""
LETTING_GO = (0.5, 1e-5, 0.5)
"""The first, the least and the largest part in which the forces of the tool leave."""


@dataclass(frozen=True)
class _Wires:
    """What beams need to know of the wires, and the lines that every deck begins with."""

    elements: tuple[Element, ...]
    bars: Bars
    welded: bool
    count: int


def write_decks(run: Run, folder: Path) -> tuple[Path, ...]:
    """Write springback.inp and released.inp of the last release of a run, or formed.inp of one that ends in its tool,
    and deck_nodes.csv, which tells which crossing each node is.

    springback.inp starts where the stage before the release left the grid, pushed by the forces of the tool, and lets
    them go; released.inp starts in the released shape and puts the loads on. Raises InputError for wires that are only
    known by a matrix, and for crossings with springs; OSError.
    """
    _refuse(run)
    last = _last_release(run)
    elements = prepare(run.case).elements
    subdivide = run.case.grid.subdivide
    wires = _Wires(
        elements,
        bars_of(elements, run.case.framed(formed_with(run.stages[:last]))),
        run.case.grid.crossing == "welded",
        BEAMS if subdivide == 1 else 1,
    )
    texts = {FORMED: _formed(run, wires)} if last is None else _released(run, last, wires)
    texts[NODES] = nodes_table((run.final if last is None else run.stages[last].done).whole)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    return tuple(folder / name for name in texts)


def nodes_table(whole: Whole) -> str:
    """The text of the table that tells which crossing (i, j) a node of the decks is, and its place in the flat [mm]."""
    numbers = np.arange(1, len(whole.index) + 1)
    return rows_csv(NODE_COLUMNS, np.column_stack((numbers, whole.index, whole.between)), whole.flat[:, :2])


def _last_release(run: Run) -> int | None:
    """The number of the stage of the last release; None without one, or when a later press has undone it."""
    kinds = [stage.kind for stage in run.stages if stage.kind in ("press", "release")]
    if kinds[-1] == "press":
        return None
    return max(k for k, stage in enumerate(run.stages) if stage.kind == "release")


def _released(run: Run, last: int, wires: _Wires) -> dict[str, str]:
    """Both decks of the release that is stage number `last`."""
    released, before = run.stages[last].done, run.stages[last - 1].done
    assert isinstance(released, Released)
    hold, grid = released.hold, released.grid
    support = _standing(Support(spread_over(grid, hold.held), spread_over(grid, hold.fixed)), released.whole)
    moves = np.where(support.fixed, unfold_vectors(grid, hold.positions) - before.whole.positions, 0.0)
    loads = _loads(before, wires)
    tool = np.where(support.clamped[:, None] | support.fixed, 0.0, _on_nodes(before.whole, loads))
    still = np.zeros_like(tool)
    back = (
        Step("step 1: the forces of the tool hold the grid in the shape in which it was pressed", tool, still),
        Step("step 2: they leave, and the grid springs back", still, moves, LETTING_GO),
    )
    steps = [Step("step 1: nothing happens; what moves is the error of the model", still, still)]
    if run.loaded is not None and last + 1 < len(run.stages) and run.stages[last + 1].done is run.loaded:
        steps.append(Step("step 2: the loads of the case", run.loaded.applied, still))
    return {
        SPRINGBACK: _text(run, "the grid in its tool, and its springback", before.whole, loads, wires, support, back),
        RELEASED: _text(
            run, "the released grid", released.whole, _loads(released, wires), wires, support, tuple(steps)
        ),
    }


def _formed(run: Run, wires: _Wires) -> str:
    """The deck of a grid that is never let go: every node stays where it is."""
    whole = run.final.whole
    still = np.zeros_like(whole.positions)
    support = Support(np.zeros(len(still), dtype=bool), np.ones_like(still, dtype=bool))
    steps = (Step("step 1: nothing moves; the wires carry what they carry in the tool", still, still),)
    return _text(run, "the grid in its tool", whole, _loads(run.final, wires), wires, support, steps)


def _text(
    run: Run, what: str, whole: Whole, loads: Floats, wires: _Wires, support: Support, steps: tuple[Step, ...]
) -> str:
    section = wires.elements[0].section
    assert section is not None, "wires without a section are refused"
    model = beams(whole, wires.elements, wires.bars, count=wires.count, welded=wires.welded, clamped=support.clamped)
    same = square(section)
    sets = {"CROSSINGS": np.flatnonzero(whole.between == 0), "RIM": _wire_ends(whole)}
    lines = (*heading(run, f"FE deck, {what}").lines, *_told(run, section.diameter, chord=wires.bars.chord))
    stress = stresses(model, whole, loads, same.side)
    return deck(lines, model, same, stress, support=support, sets=sets, steps=steps)


def _told(run: Run, diameter: float, *, chord: bool) -> Iterator[str]:
    """What to know of a deck."""
    wire = run.case.wire
    yield f"written for CalculiX (ccx); {NODES} tells which crossing node n is; more nodes follow"
    yield "wires: beams along their bent centrelines; as a brick a square section resists pull, bending and twist"
    yield f"  as the round wire of {diameter:g} mm does with E = {wire.youngs_modulus:g} MPa and nu = {wire.poisson:g}"
    yield "crossings: stiff arms along the normal (ARMS); *EQUATION ties centres and tips, wires turn about it"
    yield "*INITIAL CONDITIONS: the forces and moments in the wires; without them the grid is another, free of stress"
    if wire.yields:
        yield "the wires have flowed: they are elastic about this state, crimped as when new, and do not yield further"
    if not chord:
        yield "the run read its wires from their ends O: where they bend much between crossings its springback is"
        yield '  another than that of these beams, which agree with press.frame = "chord"'
    yield "sets: GRID, CROSSINGS, RIM (wire ends), HELD (nodes); WIRES_X, WIRES_Y, ARMS (elements)"
    yield "Abaqus: see docs/exports.md; elements are B32, the section CIRC, and initial stresses are written otherwise"


def _loads(stage: Shaped, wires: _Wires) -> Floats:
    """What acts on the ends of the elements of the whole grid, (M, 2, 6)."""
    solved = slice(stage.grid.elements)
    return unfold_loads(
        stage.grid, end_loads(stage.grid, stage.state, wires.bars, stage.whole.D[solved], stage.whole.F[solved])
    )


def _on_nodes(whole: Whole, loads: Floats) -> Floats:
    """The forces (N, 3) [N] that keep the nodes of a whole grid where they are."""
    forces = np.zeros_like(whole.positions)
    for end, nodes in enumerate((whole.start, whole.end)):
        np.add.at(forces, nodes, loads[:, end, :3])
    return forces


def _wire_ends(whole: Whole) -> Ints:
    """Nodes at which a wire ends."""
    count = np.zeros((len(whole.positions), 2), dtype=np.int64)
    for nodes in (whole.start, whole.end):
        np.add.at(count, (nodes, whole.family - 1), 1)
    return np.flatnonzero((count == 1).any(axis=1))


def _standing(support: Support, whole: Whole) -> Support:
    """The support with as many more directions of three nodes as keep the whole grid from floating away.

    They carry nothing where the loads balance each other. The nodes: the one nearest to the axis, and those farthest
    from it along x and along y.
    """
    if support.clamped.any():
        return support
    places, fixed = whole.positions, support.fixed.copy()
    far = np.abs(places[:, :2] - places[np.linalg.norm(places[:, :2], axis=1).argmin(), :2])
    middle = int(np.linalg.norm(places[:, :2], axis=1).argmin())
    wanted = [(node, axis) for node in (middle, *far.argmax(axis=0).tolist()) for axis in (0, 1, 2)]
    rows = [_rigid(places[node], axis) for node, axis in np.argwhere(fixed).tolist()]
    for node, axis in wanted:
        more = [*rows, _rigid(places[node], axis)]
        if np.linalg.matrix_rank(np.array(more), tol=1e-6) > (
            np.linalg.matrix_rank(np.array(rows), tol=1e-6) if rows else 0
        ):
            rows, fixed[node, axis] = more, True
    return Support(support.clamped, fixed)


def _rigid(place: Floats, axis: int) -> Floats:
    """How far a node moves along an axis when the grid moves, and when it turns by lengths of 1, (6,)."""
    unit = np.eye(3)[axis]
    return np.concatenate((unit, np.cross(place, unit) / (1.0 + np.abs(place).max())))


def _refuse(run: Run) -> None:
    if run.case.wire.stiffness is not None:
        raise InputError.of(
            "a wire whose stiffness is given as a matrix has no section: it cannot become beams",
            where="wire.stiffness",
            hint="give the wire as diameter, youngs_modulus and a centreline",
        )
    if isinstance(run.case.grid.crossing, CrossingSpring):
        raise InputError.of(
            "an FE deck has no springs at crossings",
            where="grid.crossing",
            hint="export a run with pinned or welded ones",
        )
