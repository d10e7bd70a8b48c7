"""The files of a comparison: comparison.json, points.csv, and the result.json that marks a folder of results."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from punchform import __version__
from punchform.arrays import Floats

if TYPE_CHECKING:
    from punchform.measured import Comparison, Deviation

COMPARISON, POINTS = "comparison.json", "points.csv"
COMPARISON_SCHEMA = 1
POINT_COLUMNS = (
    *("id", "xm", "ym", "zm", "x", "y", "z", "dx", "dy", "dz"),
    *("dev_target", "dev_prediction", "dev_shape", "outlier", "counted"),
)


def comparison_json(done: Comparison) -> str:
    """The text of comparison.json; what is not known or not determined is null."""
    return _text(comparison_result(done))


def mark_json(done: Comparison) -> str:
    """The text of result.json: by it `--overwrite` knows a folder that punchform wrote."""
    table = done.judged.table
    assert table is not None
    short = {"judged": _judged(done), "rms_mm": table.rms, "tolerance_mm": done.tolerance, "within": done.within}
    head = {"schema": COMPARISON_SCHEMA, "version": __version__, "case_title": done.case.title}
    return _text({**head, "comparison": short, "notes": list(done.notes)})


def comparison_result(done: Comparison) -> dict[str, object]:
    """The content of comparison.json: lengths in mm, angles in degrees, in the axes of the run."""
    cloud = done.cloud
    return {
        "schema": COMPARISON_SCHEMA,
        "version": __version__,
        "case_title": done.case.title,
        "predicted_stage": done.stage,
        "points": {
            "file": cloud.source,
            "read": len(cloud.points),
            "unit": cloud.unit,
            "unit_stated": cloud.stated,
            "skipped_rows": cloud.skipped,
            "outliers": int(done.outliers.sum()),
            "dropped": int((~done.counted).sum()),
        },
        "alignment": _alignment(done),
        "tolerance_mm": done.tolerance,
        "judged": _judged(done),
        "within": done.within,
        "target": None if done.target is None else _table(done.target),
        "prediction": {
            **_table(done.prediction),
            "facet_error_mm": dict(zip(("rms", "max"), done.sheet.facet_error, strict=True)),
            "surface_error_mm": dict(zip(("rms", "p95"), done.sheet.own_error, strict=True)),
        },
        "same_shape": {
            "n": done.shape.n,
            "measured_minus_predicted_rms_mm": done.shape.left,
            "predicted_minus_target_rms_mm": done.shape.expected,
            "measured_minus_target_rms_mm": done.shape.found,
            "correlation": done.shape.correlation,
            "verdict": done.shape.verdict,
        },
        "call_outs": [_call_out(done, int(row)) for row in done.labelled],
        "notes": list(done.notes),
    }


def points_csv(done: Comparison) -> str:
    """The text of points.csv, one row per measured point; empty cells where a point is off a surface.

    xm, ym, zm: as measured; x, y, z: aligned; dx, dy, dz: from the nearest point of the judged surface (the target,
    without one the prediction); dev_target, dev_prediction: signed distances, positive above; dev_shape: distance to
    the prediction in the best fit to it; all in mm. outlier, counted: 1 or 0.
    """
    empty = np.full(len(done.aligned), np.nan)
    numbers = np.column_stack(
        (
            done.cloud.points,
            done.aligned,
            done.judged.vector,
            empty if done.target is None else done.target.value,
            done.prediction.value,
            done.shape.deviation,
        )
    )
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(POINT_COLUMNS)
    flags = np.column_stack((done.outliers, done.counted)).astype(np.int64)
    for name, row, flag in zip(done.cloud.names, numbers.tolist(), flags.tolist(), strict=True):
        writer.writerow((name, *("" if math.isnan(cell) else f"{cell + 0.0:.12g}" for cell in row), *flag))
    return stream.getvalue()


def _judged(done: Comparison) -> str:
    return "prediction" if done.target is None else "target"


def _alignment(done: Comparison) -> dict[str, object]:
    alignment, fit = done.alignment, done.alignment.fit
    pose = fit.pose
    return {
        "kind": alignment.kind,
        "to": alignment.to or None,
        "points_used": int(fit.used.sum()),
        "shift_mm": pose.shift.tolist(),
        "shift_error_mm": fit.errors[:3].tolist(),
        "turn_deg": np.degrees(pose.rotation_vector).tolist(),
        "turn_error_deg": np.degrees(fit.errors[3:]).tolist(),
        "tilt_deg": math.degrees(pose.tilt),
        "upside_down": pose.tilt > 0.5 * math.pi,
        "rotation_matrix": pose.turn.tolist(),
        "scatter_mm": fit.scatter,
        "condition": fit.condition,
        "settled": fit.settled,
    }


def _table(deviation: Deviation) -> dict[str, object]:
    return {} if deviation.table is None else asdict(deviation.table)


def _call_out(done: Comparison, row: int) -> dict[str, object]:
    judged = done.judged
    return {
        "id": done.cloud.names[row],
        **_axes("", done.aligned[row]),
        **_axes("d", judged.vector[row]),
        "dev": float(judged.value[row]),
    }


def _axes(prefix: str, values: Floats) -> dict[str, float]:
    return {f"{prefix}{axis}": float(value) for axis, value in zip("xyz", values, strict=True)}


def _text(content: dict[str, object]) -> str:
    return json.dumps(_plain(content), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _plain(value: object) -> object:
    """Mappings and lists as they are, numbers that are not finite as None."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
