"""How the wires yield, and what makes the grid spring back: the tables of both. No HTML here."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from punchform.export.result import largest
from punchform.report.section import Matrix, Rows, Section
from punchform.report.words import energy, percent, place, size

if TYPE_CHECKING:
    from punchform.release import Released
    from punchform.run import Run
    from punchform.solved import Solved

CAUSES = {
    "membrane": "pull in the wires",
    "bending": "bending and twist",
    "rim": "rim let go",
    "remainder": "not told apart",
    "total": "all together",
}
NOTE = (
    "The punch goes first: the pull shortens the wires, their bending straightens them. Then the rim goes, if it does. "
    "Each is what a small springback would do; what that misses is the line before the last, and where it is large the "
    "others say little. Moves add up, their rms does not, since parts may work against each other."
)
STRETCHED = (
    " What bending does gets less the further the wires are stretched; what the pull does stays, and another profile "
    "of the punch can answer it."
)
"""What to do about it, with wires that yield."""


def yielding_sections(run: Run) -> tuple[Section, ...]:
    """The section on what has flowed in the wires; none for elastic ones."""
    if run.formed.hardening is None:
        return ()
    named = (("in the tool", run.formed), ("released", run.released), ("loaded", run.loaded))
    stages = [(name, stage) for name, stage in named if stage is not None]
    columns = [_column(run, stage) for _, stage in stages]
    rows = tuple((name, *(column[k][1] for column in columns)) for k, (name, _) in enumerate(columns[0]))
    table = Matrix("What the wires have gone through", ("", *(name for name, _ in stages)), rows)
    tables = (("Where", _places(run)), ("How near to breaking", _limits(run)))
    return (Section("yielding", "How the wires yield", matrices=(table,), tables=tables),)


def springback_tables(released: Released) -> tuple[Matrix, ...]:
    """The springback in its parts, Eqs. (12.50) and (12.51); none where it was not split."""
    if released.split is None:
        return ()
    shares = vars(released.split)
    rows = [
        (cause, size(shares[name].rms, "mm", 3), _signed(shares[name].apex), size(shares[name].largest, "mm", 3))
        for name, cause in CAUSES.items()
        if name != "rim" or shares[name].largest
    ]
    head = ("what moves the grid", "rms along the normals", "middle", "longest move")
    note = NOTE if released.hardening is None else NOTE + STRETCHED
    return (Matrix("What makes it spring back", head, tuple(rows), (len(rows) - 1,), note),)


def _column(run: Run, stage: Solved) -> Rows:
    """What one stage says of its wires, in the same order for all."""
    whole = stage.whole
    stress, ratio = largest(whole.stress), largest(whole.stress_ratio)
    thinnest = run.case.wire.diameter * (1 - stage.max_thinning)
    return (
        ("Largest plastic strain in a section", percent(stage.max_plastic_strain)),
        ("Largest elongation of a wire piece", percent(stage.max_axial_strain)),
        ("Mean elongation inside the rim", percent(_mean_elongation(run, stage))),
        ("Wire pieces that have yielded", percent(stage.yielded)),
        ("Diameter of the wire where it is thinnest", size(thinnest, "mm")),
        ("Largest stress", "not known" if stress is None else size(stress, "MPa")),
        ("Largest stress / that of first yield", "not known" if ratio is None else size(ratio, "", 3)),
        ("Work that flow has taken up to here", energy(stage.flow_work)),
        ("Elastic energy in the wires", energy(stage.energy)),
    )


def _mean_elongation(run: Run, stage: Solved) -> float:
    """Of the pieces with both ends inside the rim; NaN without any."""
    whole = stage.whole
    inside = np.hypot(whole.positions[:, 0], whole.positions[:, 1]) < run.case.tool.rim_radius
    both = inside[whole.start] & inside[whole.end]
    return float(whole.axial_strain[both].mean()) if both.any() else math.nan


def _places(run: Run) -> Rows:
    whole = run.formed.whole
    return (
        ("Largest plastic strain", _place(run, int(whole.plastic_strain.argmax()))),
        ("Largest elongation", _place(run, int(whole.axial_strain.argmax()))),
        ("Largest stress", _place(run, int(whole.stress.argmax()))),
    )


def _limits(run: Run) -> Rows:
    formed, hardening = run.formed, run.formed.hardening
    assert hardening is not None
    share = formed.strain_to_break
    most = float(np.log1p(formed.max_axial_strain))
    breaking: Rows = (("True strain at which the wire necks", "its flow curve does not say"),)
    if hardening.breaks_at is not None and share is not None:
        breaking = (
            ("True strain at which the wire necks", percent(hardening.breaks_at)),
            ("Share of it that is used up", percent(share)),
        )
    return (
        ("Largest true strain along a wire", percent(most)),
        *breaking,
    )


def _place(run: Run, piece: int) -> str:
    whole = run.formed.whole
    x, y, _ = 0.5 * (whole.positions[whole.start[piece]] + whole.positions[whole.end[piece]])
    return f"x = {place(x)}, y = {place(y)}"


def _signed(value: float) -> str:
    return ("+" if value > 0 else "") + size(value, "mm", 3)
