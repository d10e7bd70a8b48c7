"""The cut list: every wire of the flat blank, how long it is and where it begins and ends; cut_list.csv."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.export.strands import Strand, strands
from punchform.export.told import laid
from punchform.whole import Whole, places_in
from punchform.wire import Element, pieces, stiffness

if TYPE_CHECKING:
    from punchform.run import Run

COLUMNS = ("wire", "family", "number", "length", "wire_length", "x_start", "y_start", "x_end", "y_end", "cut_off")
"""Names of the columns; lengths in mm."""


@dataclass(frozen=True)
class Cut:
    """One wire of the flat blank: length along the flat grid, wire_length of the wire itself with its crimp; start and
    end (x, y) in the flat; off: pairs of ends (c, 2, 2) of what trims have cut off it. All in mm."""

    strand: Strand
    length: float
    wire_length: float
    start: Floats
    end: Floats
    off: Floats

    @property
    def cut_off(self) -> float:
        """Length along the flat grid of what trims have cut off [mm]."""
        return float(np.linalg.norm(self.off[:, 1] - self.off[:, 0], axis=1).sum())

    @property
    def cells(self) -> tuple[str, ...]:
        """The row of a table, in the order of COLUMNS, to the thousandth of a millimetre."""
        sizes = (self.length, self.wire_length, *self.start, *self.end, self.cut_off)
        strand = self.strand
        return (strand.name, str(strand.family), str(strand.number), *(f"{size + 0.0:.3f}" for size in sizes))


def cut_list(run: Run) -> tuple[Cut, ...]:
    """All wires of the blank as it was laid. Wires end at their last crossings; what juts out is not known of."""
    case, whole = run.case, laid(run).whole
    elements = pieces(stiffness(case.wire, case.grid.step), case.grid.subdivide)
    stays = places_in(run.stages[-1].done.whole.flat, whole.flat) >= 0
    return cuts_of(whole, elements, ~(stays[whole.start] & stays[whole.end]))


def cuts_of(whole: Whole, elements: Sequence[Element], lost: Bools) -> tuple[Cut, ...]:
    """All wires of a whole grid, made of elements of such kinds, of which some (M,) are cut off."""
    each = np.array([element.wire_length for element in elements])[whole.kind]
    flat = whole.flat[:, :2]
    return tuple(
        Cut(
            strand,
            float(np.linalg.norm(flat[strand.nodes[-1]] - flat[strand.nodes[0]])),
            float(each[strand.elements].sum()),
            flat[strand.nodes[0]],
            flat[strand.nodes[-1]],
            _joined(flat[strand.nodes], lost[strand.elements]),
        )
        for strand in strands(whole)
    )


def cut_list_csv(cuts: Sequence[Cut], heading: Sequence[str]) -> str:
    """The text of cut_list.csv, under the lines of the heading as comments."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(cut.cells for cut in cuts)
    return "".join(f"# {line}\n" for line in heading) + stream.getvalue()


def _joined(places: Floats, lost: Bools) -> Floats:
    """Both ends (c, 2, 2) of each run of lost elements (n - 1,) between places (n, 2)."""
    edges = np.diff(np.concatenate(([False], lost, [False])).astype(np.int64))
    return np.stack((places[np.flatnonzero(edges == 1)], places[np.flatnonzero(edges == -1)]), axis=1)
