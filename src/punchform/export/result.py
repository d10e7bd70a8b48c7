"""result.json: the figures of a run that a person or a script asks for first. Strictly valid JSON, no NaN."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

import numpy as np

from punchform import __version__
from punchform.accuracy import plain as accuracy_json
from punchform.arrays import Floats
from punchform.export.told import laid, told

if TYPE_CHECKING:
    from punchform.holder import Grip
    from punchform.load import Loaded
    from punchform.press import Formed
    from punchform.release import Released
    from punchform.run import Run, Stage
    from punchform.solved import Shaped, Solved
    from punchform.springback import Springback
    from punchform.trim import Trimmed

RESULT_SCHEMA = 1


def result_json(run: Run) -> str:
    """The text of result.json; what is not known or not finite is null."""
    return json.dumps(result(run), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def result(run: Run) -> dict[str, object]:
    """The content of result.json as plain Python values; energies [mJ] are of the whole grid."""
    shown, first = told(run), laid(run)
    content: dict[str, object] = {
        "schema": RESULT_SCHEMA,
        "version": __version__,
        "case_title": run.case.title,
        "grid": {
            "nodes": first.whole.crossings,
            "elements": len(first.whole.family),
            "solved_nodes": first.solved_nodes,
        },
        "formed": _formed(run.formed),
        "released": None if shown.released is None else _released(shown.released),
        "loaded": None if shown.loaded is None else _loaded(shown.loaded),
        "accuracy": None if run.accuracy is None else accuracy_json(run.accuracy),
        "notes": list(all_notes(run)),
    }
    if run.case.stages is not None:
        content["stages"] = [_stage(stage) for stage in run.stages]
    filled = plain(content)
    assert isinstance(filled, dict)
    return filled


def all_notes(run: Run) -> tuple[str, ...]:
    """The notes of the run and of its stages, each once, in order."""
    staged = run.case.stages is not None
    done = [stage.done for stage in run.stages] if staged else [run.formed, run.released, run.loaded]
    stages = [stage.notes for stage in done if stage is not None]
    warned = () if run.accuracy is None else run.accuracy.warnings
    return tuple(dict.fromkeys(note for notes in (run.notes, *stages, warned) for note in notes))


def largest(values: Floats) -> float | None:
    """The largest known value, None when all are NaN (or there is none)."""
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else None


def _stage(stage: Stage) -> dict[str, object]:
    """What result.json tells of one stage of many: all but the history of its solve."""
    done = stage.done
    size = {"crossings": done.whole.crossings, "elements": len(done.whole.family)}
    match stage.kind:
        case "press":
            found = _formed(cast("Formed", done))
        case "release":
            found = _released(cast("Released", done))
        case "load":
            found = _loaded(cast("Loaded", done))
        case "trim":
            found = _trimmed(cast("Trimmed", done))
    found.pop("history", None)
    return {"name": stage.name, "kind": stage.kind, **size, **found, "notes": list(done.notes)}


def _trimmed(trimmed: Trimmed) -> dict[str, object]:
    return shape_result(trimmed) | {
        "radius_mm": trimmed.radius,
        "crossings_cut": trimmed.crossings_cut,
        "elements_cut": trimmed.pieces_cut,
        "wires_cut": trimmed.wires_cut,
        "mass_cut_kg": trimmed.mass_cut,
        "blank_left_mm": trimmed.blank,
    }


def _formed(formed: Formed) -> dict[str, object]:
    contact = formed.whole.contact
    return stage_result(formed) | {
        "draw_in_mm": formed.draw_in,
        "contact": {"min_N": contact.min(), "max_N": contact.max(), "push_N": formed.push},
        "strokes": [
            {
                "share": stroke.share,
                "steps": stroke.steps,
                "factorisations": stroke.factorisations,
                "energy_mJ": stroke.energy,
                "friction_work_mJ": stroke.friction_work,
            }
            for stroke in formed.strokes
        ],
        "holder": None if formed.grip is None else _holder(formed.grip),
    }


def _holder(grip: Grip) -> dict[str, object]:
    return {
        "friction_work_mJ": grip.work,
        "largest_slip_mm": grip.largest_slip,
        "slipped_share": grip.slipped,
    }


def _released(released: Released) -> dict[str, object]:
    return stage_result(released) | {
        "apex_mm": released.apex,
        "max_sag_mm": released.max_sag,
        "max_sag_node": released.whole.index[released.lowest].tolist(),
        "held_nodes": released.hold.count,
        "largest_reaction_N": released.largest_reaction,
        "negative_eigenvalues_of_whole": released.stability.negative,
        **({} if released.split is None else {"springback": _springback(released.split)}),
    }


def _springback(split: Springback) -> dict[str, object]:
    """The parts of Eqs. (12.50) and (12.51)."""
    return {
        name: {"rms_mm": share.rms, "apex_mm": share.apex, "largest_mm": share.largest}
        for name, share in vars(split).items()
    }


def _loaded(loaded: Loaded) -> dict[str, object]:
    return stage_result(loaded) | {
        "load_N": loaded.load,
        "rms_deflection_mm": loaded.rms_deflection,
        "largest_deflection_mm": loaded.largest_deflection,
        "compliance_mm_per_N": loaded.compliance,
        "largest_reaction_N": np.linalg.norm(loaded.reactions, axis=1).max(),
        "mass_kg": loaded.mass,
    }


def shape_result(stage: Shaped) -> dict[str, object]:
    """What result.json tells of the shape of every stage."""
    return {
        "energy_mJ": stage.energy,
        "max_shear_deg": math.degrees(stage.max_shear),
        "max_axial_strain": stage.max_axial_strain,
        "energy_kinds_mJ": stage.energy_kinds,
        "axial_force": {"min_N": stage.whole.F[:, 0].min(), "max_N": stage.whole.F[:, 0].max()},
        "max_stress_MPa": largest(stage.whole.stress),
        "max_stress_ratio": largest(stage.whole.stress_ratio),
        **_plastic(stage),
    }


def _plastic(stage: Shaped) -> dict[str, object]:
    """What flowing has left in wires that yield; nothing of elastic ones."""
    if stage.hardening is None:
        return {}
    return {
        "plastic": {
            "max_plastic_strain": stage.max_plastic_strain,
            "max_elongation": stage.max_axial_strain,
            "max_thinning": stage.max_thinning,
            "yielded_share": stage.yielded,
            "strain_to_break": stage.strain_to_break,
            "flow_work_mJ": stage.flow_work,
        }
    }


def stage_result(stage: Solved) -> dict[str, object]:
    """What result.json tells of every stage that was solved."""
    return {
        "energy_mJ": stage.energy,
        "outcome": stage.outcome.name.lower(),
        "advice": stage.outcome.value,
        "steps": stage.steps,
        "factorisations": stage.factorisations,
        "negative_eigenvalues": stage.negative_eigenvalues,
        **shape_result(stage),
        "seconds": stage.seconds,
        "linear_solver": stage.linear_solver,
        "history": [
            {
                "number": step.number,
                "energy_mJ": step.energy,
                "gradient": step.gradient,
                "decrement": step.decrement,
                "length": step.length,
                "hessian": step.hessian,
            }
            for step in stage.history
        ],
    }


def plain(value: object) -> object:
    """Numpy numbers as Python's, mappings and sequences as dict and list, non-finite numbers as None."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
