"""result.json: the figures of a run that a person or a script asks for first. Strictly valid JSON, no NaN."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from punchform import __version__
from punchform.arrays import Floats

if TYPE_CHECKING:
    from punchform.press import Formed
    from punchform.run import Run

RESULT_SCHEMA = 1


def result_json(run: Run) -> str:
    """The text of result.json; what is not known or not finite is null."""
    return json.dumps(result(run), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def result(run: Run) -> dict[str, object]:
    """The content of result.json as plain Python values; energies [mJ] are of the whole grid."""
    whole = run.formed.whole
    content: dict[str, object] = {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "case_title": run.case.title,
        "grid": {
            "nodes": len(whole.positions),
            "elements": len(whole.family),
            "solved_nodes": run.formed.solved_nodes,
        },
        "formed": _formed(run.formed),
        "notes": list(all_notes(run)),
    }
    plain = _plain(content)
    assert isinstance(plain, dict)
    return plain


def all_notes(run: Run) -> tuple[str, ...]:
    """The notes of the run and of its stages, each once, in order."""
    return tuple(dict.fromkeys((*run.notes, *run.formed.notes)))


def largest(values: Floats) -> float | None:
    """The largest known value, None when all are NaN (or there is none)."""
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else None


def _formed(formed: Formed) -> dict[str, object]:
    contact = formed.whole.contact
    return {
        "energy_mJ": formed.energy,
        "outcome": formed.outcome.name.lower(),
        "advice": formed.outcome.value,
        "steps": formed.steps,
        "factorisations": formed.factorisations,
        "negative_eigenvalues": formed.negative_eigenvalues,
        "max_shear_deg": math.degrees(formed.max_shear),
        "max_axial_strain": formed.max_axial_strain,
        "draw_in_mm": formed.draw_in,
        "seconds": formed.seconds,
        "energy_kinds_mJ": formed.energy_kinds,
        "contact": {"min_N": contact.min(), "max_N": contact.max(), "push_N": formed.push},
        "linear_solver": formed.linear_solver,
        "max_stress_MPa": largest(formed.whole.stress),
        "max_stress_ratio": largest(formed.whole.stress_ratio),
        "history": [
            {
                "number": step.number,
                "energy_mJ": step.energy,
                "gradient": step.gradient,
                "decrement": step.decrement,
                "length": step.length,
                "hessian": step.hessian,
            }
            for step in formed.history
        ],
    }


def _plain(value: object) -> object:
    """Numpy numbers as Python's, mappings and sequences as dict and list, non-finite numbers as None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
