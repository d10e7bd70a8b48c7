"""The flat blank as a drawing: outline, every wire with its number, the lines of the rim, what is cut off, cut list."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Floats
from punchform.case import Blank, Case, CircleBlank, PolygonBlank, RectangleBlank, WiresBlank
from punchform.export.cut_list import COLUMNS, Cut
from punchform.export.drawings import drawing_bytes, empty_drawing, fixed_stamps
from punchform.export.told import told
from punchform.net import outline
from punchform.outline import reach

if TYPE_CHECKING:
    from ezdxf.layouts import Modelspace

    from punchform.run import Run

OUTLINE, WIRES, NUMBERS, RIM, LANDS, CUT_OFF, LIST, HEADING = (
    "OUTLINE",
    ("WIRES_1", "WIRES_2"),
    "NUMBERS",
    "RIM",
    "LANDS_ON_RIM",
    "CUT_OFF",
    "CUT_LIST",
    "HEADING",
)
COLOURS = {OUTLINE: 7, WIRES[0]: 5, WIRES[1]: 30, NUMBERS: 8, RIM: 8, LANDS: 6, CUT_OFF: 1, LIST: 7, HEADING: 7}
"""Layers and their colours: blue and orange for the families, which colour-blind readers tell apart."""
DIRECTIONS = 360
LETTERS, ROW, COLUMN, BESIDE = 0.25, 1.8, 12.0, 12.0
"""Height of letters in steps of the grid; of a row, width of a column and of the numbers in heights of letters."""


def blank_drawing(
    case: Case, cuts: Sequence[Cut], heading: Sequence[str], lands: Iterable[tuple[Floats, bool]] = ()
) -> bytes:
    """The DXF file of the flat blank in mm, with the axis of the punch at its origin; lands: see `rim_lines`.

    Layers: OUTLINE of the blank, WIRES_1 and WIRES_2 with a line from end to end of every wire, NUMBERS of the wires,
    RIM: where the rim of a punch is, LANDS_ON_RIM: which line of the flat grid lands on it, CUT_OFF: what trims have
    cut off, CUT_LIST and HEADING as text. Single wires have no OUTLINE.
    """
    letters = LETTERS * min(case.grid.step)
    with fixed_stamps():
        document = empty_drawing(COLOURS)
        space = document.modelspace()
        _add_outline(space, case.grid.blank)
        edge = _edge(case.grid.blank, cuts) + letters
        _add_wires(space, cuts, edge, letters)
        if case.rim_radius is not None:
            space.add_circle((0.0, 0.0), case.rim_radius, dxfattribs={"layer": RIM})
        for piece, closed in lands:
            space.add_lwpolyline(piece.tolist(), close=closed, dxfattribs={"layer": LANDS})
        _add_list(space, cuts, (float(edge[0]) + BESIDE * letters, float(edge[1])), letters)
        for number, line in enumerate(heading):
            place = (-float(edge[0]), -float(edge[1]) - (2 + number) * ROW * letters)
            _write(space, HEADING, line, place, letters)
        return drawing_bytes(document, heading)


def rim_lines(run: Run) -> Iterator[tuple[Floats, bool]]:
    """The line (n, 2) [mm] of the flat grid that lands on the rim, and whether it is closed; in pieces where the blank
    ends before the rim, none where it does all around."""
    whole = told(run).formed.whole
    known = slice(0, whole.crossings)
    level = np.hypot(whole.positions[known, 0], whole.positions[known, 1]) - run.case.tool.rim_radius
    directions: Floats = np.linspace(0.0, 2 * np.pi, DIRECTIONS, endpoint=False)
    line = outline(whole.index[known], whole.flat[known, :2], level, directions)
    there = np.isfinite(line[:, 0])
    if there.all():
        yield line, True
        return
    # Begun at a gap, so that no piece is cut in two where the directions begin.
    first = int(np.argmin(there))
    line, there = np.roll(line, -first, axis=0), np.roll(there, -first)
    for piece in np.split(np.arange(DIRECTIONS), 1 + np.flatnonzero(there[1:] != there[:-1])):
        if there[piece[0]] and len(piece) > 1:
            yield line[piece], False


def _edge(blank: Blank, cuts: Sequence[Cut]) -> Floats:
    """How far the blank reaches along x and along y, (2,) [mm]."""
    if isinstance(blank, WiresBlank):
        return np.asarray(np.abs([end for cut in cuts for end in (cut.start, cut.end)]).max(axis=0))
    return np.array(reach(blank)[:2])


def _add_outline(space: Modelspace, blank: Blank) -> None:
    layer = {"layer": OUTLINE}
    match blank:
        case CircleBlank(radius=radius):
            space.add_circle((0.0, 0.0), radius, dxfattribs=layer)
        case RectangleBlank(size=(width, height)):
            x, y = 0.5 * width, 0.5 * height
            space.add_lwpolyline([(-x, -y), (x, -y), (x, y), (-x, y)], close=True, dxfattribs=layer)
        case PolygonBlank(points=points):
            space.add_lwpolyline(list(points), close=True, dxfattribs=layer)


def _add_wires(space: Modelspace, cuts: Sequence[Cut], edge: Floats, letters: float) -> None:
    """Wires, what is cut off, and numbers: in a row beyond the outline, of further parts beside their own ends."""
    for cut in cuts:
        along = cut.strand.family - 1
        space.add_line(cut.start.tolist(), cut.end.tolist(), dxfattribs={"layer": WIRES[along]})
        for start, end in cut.off.tolist():
            space.add_line(start, end, dxfattribs={"layer": CUT_OFF})
        place = cut.end.copy()
        place[along] = edge[along] if cut.strand.part == 1 else cut.end[along] + letters
        place[1 - along] += 0.5 * letters * (1 if along else -1)
        _write(space, NUMBERS, cut.strand.name, (float(place[0]), float(place[1])), letters, turn=90.0 * along)


def _add_list(space: Modelspace, cuts: Sequence[Cut], corner: tuple[float, float], letters: float) -> None:
    rows = [COLUMNS, *(cut.cells for cut in cuts)]
    for number, row in enumerate(rows):
        for column, cell in enumerate(row):
            place = (corner[0] + COLUMN * letters * column, corner[1] - ROW * letters * number)
            _write(space, LIST, cell, place, letters)


def _write(
    space: Modelspace, layer: str, text: str, place: tuple[float, float], height: float, *, turn: float = 0.0
) -> None:
    # A caret alone would begin a control character.
    space.add_text(text.replace("^", "^ "), height=height, rotation=turn, dxfattribs={"layer": layer, "insert": place})
