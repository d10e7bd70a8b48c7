"""The files of a compensation: convergence.csv and result.json."""

from __future__ import annotations

import csv
import io
import json
import math
from typing import TYPE_CHECKING

from punchform import __version__

if TYPE_CHECKING:
    from punchform.optimise.compensated import Compensated
    from punchform.optimise.compensation import Compensation, Solve
    from punchform.optimise.reach import Reach

CONVERGENCE = "convergence.csv"
COMPENSATION_SCHEMA = 1
SOLVE_COLUMNS = ("surface", "solve", "rms", "p95", "max", "correction", "follows", "best", "failure")


def convergence_csv(done: Compensated) -> str:
    """The text of convergence.csv, one row per press and release.

    surface: of the punch; rms, p95, max: of the judged deviation [mm]; correction: the largest one at a crossing [mm];
    follows: which part of the last change of the punch the released shape has taken; best: 1 for the solve that counts;
    empty where a press failed, with the reason.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(SOLVE_COLUMNS)
    for kind, found in {done.kind: done.found, **done.others}.items():
        for one in found.solves:
            cells = [_cell(value) for value in (*_figures(one), one.correction, one.follows)]
            writer.writerow((kind, one.number, *cells, int(one is found.best), one.failure))
    return stream.getvalue()


def compensation_json(done: Compensated) -> str:
    """The text of result.json."""
    return json.dumps(compensation_result(done), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def compensation_result(done: Compensated) -> dict[str, object]:
    """The content of result.json: lengths in mm."""
    assert done.given.target is not None
    return {
        "schema": COMPENSATION_SCHEMA,
        "version": __version__,
        "case_title": done.given.title,
        "compensation": {
            "surface": done.kind,
            "measure": done.given.target.measure,
            "alignment": done.given.target.alignment,
            "tolerance_mm": done.tolerance,
            "within": done.within,
            "rms_before_mm": done.before.rms,
            **_found(done.found),
            "other_surfaces": {kind: _found(found) for kind, found in done.others.items()},
            "floors_if_followed_mm": dict(done.floors),
            "reach": None if done.reach is None else _reach(done.reach),
            "tried": [{"remedy": one.name, "rms_mm": one.rms} for one in done.remedies],
        },
        "notes": list(done.notes),
    }


def _found(found: Compensation) -> dict[str, object]:
    return {
        "rms_mm": found.best.misfit.rms if found.best.misfit is not None else None,
        "times_less": found.gain if math.isfinite(found.gain) else None,
        "largest_correction_mm": found.best.correction,
        "best_solve": found.best.number,
        "ending": found.ending.name.lower(),
        "floor_mm": found.floor,
        "terms": len(found.space.terms),
        "solves": [_solve(one) for one in found.solves],
    }


def _solve(one: Solve) -> dict[str, object]:
    rms, p95, largest = _figures(one)
    return {
        "solve": one.number,
        "rms_mm": rms,
        "p95_mm": p95,
        "max_mm": largest,
        "largest_correction_mm": one.correction,
        "follows": one.follows,
        "seconds": round(one.seconds, 3),
        "failure": one.failure or None,
    }


def _reach(reach: Reach) -> dict[str, object]:
    return {
        "singular_values": reach.values.tolist(),
        "shares_of_squared_error": reach.shares.tolist(),
        "share_not_moved": reach.beyond,
        "rms_not_moved_mm": reach.left,
        "lobes_not_moved_mm": {str(m): size for m, size in reach.lobes.items()},
        "solves": reach.solves,
    }


def _figures(one: Solve) -> tuple[float | None, float | None, float | None]:
    return (None, None, None) if one.misfit is None else (one.misfit.rms, one.misfit.p95, one.misfit.largest)


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.9g}"
