"""The accuracy as plain Python values, for result.json."""

from __future__ import annotations

import math

from punchform.accuracy.facets import Facets
from punchform.accuracy.harmonics import Harmonics
from punchform.accuracy.measure import Accuracy, Aligned
from punchform.accuracy.statistics import Statistics
from punchform.accuracy.target import Pose

_NAMES = {
    "u": "u_mm",
    "v": "v_mm",
    "w": "w_mm",
    "alpha": "alpha_deg",
    "beta": "beta_deg",
    "f": "focal_length_mm",
}


def plain(accuracy: Accuracy) -> dict[str, object]:
    """All figures of an accuracy, in mm, deg and as shares, not rounded; what is not known or not finite is None."""
    judge, aperture = accuracy.judge, accuracy.aperture
    return {
        "judged_on": {
            "measure": judge.measure,
            "alignment": judge.alignment,
            "rms_mm": accuracy.judged.rms,
            "tolerance_mm": judge.tolerance,
            "within": accuracy.within,
        },
        "nodes": accuracy.nodes,
        "aperture": {
            "radius_mm": aperture.radius,
            "inner_radius_mm": aperture.inner_radius,
            "taper_dB": aperture.taper,
            "weighted_area_mm2": _finite(float(accuracy.weights.sum())),
        },
        "weighting": accuracy.weighting,
        "fit_minimises": accuracy.fit_measure,
        "best_fit": accuracy.best_fit,
        "surface": {"name": accuracy.surface.name, "above_nodes_mm": accuracy.surface.offset},
        "apex_height_mm": accuracy.target.apex_height,
        "focal_length_mm": accuracy.target.focal_length,
        "positive": "upwards: outside the dome, away from the focus",
        "alignments": {aligned.name: _aligned(aligned) for aligned in accuracy.alignments},
        "facets": None if accuracy.facets is None else _facets(accuracy.facets),
        "warnings": list(accuracy.warnings),
    }


def _aligned(aligned: Aligned) -> dict[str, object]:
    fit, pose = aligned.fit, aligned.fit.pose
    return {
        "deviations": {measure: _statistics(found) for measure, found in aligned.statistics.items()},
        "parameters": {shown: _parameter(pose, name) for name, shown in _NAMES.items()},
        "standard_errors": {_NAMES[name]: _finite(_shown(name, sigma)) for name, sigma in fit.sigmas.items()},
        "condition": _finite(fit.condition),
        "converged": fit.converged,
        "focus_shift_mm" if pose.f is not None else "vertex_shift_mm": aligned.implied_shift.tolist(),
        "boresight_tilt_deg": math.degrees(aligned.boresight_tilt),
        "harmonics": None if aligned.harmonics is None else _harmonics(aligned.harmonics),
    }


def _parameter(pose: Pose, name: str) -> float | None:
    return None if name == "f" and pose.f is None else _shown(name, getattr(pose, name))


def _shown(name: str, value: float) -> float:
    return math.degrees(value) if name in ("alpha", "beta") else value


def _statistics(found: Statistics) -> dict[str, float]:
    return {
        "rms_mm": found.rms,
        "mean_mm": found.mean,
        "sigma_mm": found.sigma,
        "min_mm": found.lowest,
        "max_mm": found.highest,
        "peak_to_valley_mm": found.peak_to_valley,
        "p95_mm": found.p95,
    }


def _harmonics(found: Harmonics) -> dict[str, object]:
    return {
        "mean_mm": found.mean,
        "sigma_mm": found.sigma,
        "radial_orders": found.orders,
        "residual_share": found.residual,
        "parts": [
            {
                "m": part.m,
                "share": part.share,
                "rms_mm": part.rms,
                "edge_cos_mm": part.cosine,
                "edge_sin_mm": part.sine,
            }
            for part in found.parts
        ],
    }


def _facets(found: Facets) -> dict[str, float]:
    return {"mean_mm": found.mean, "sigma_mm": found.sigma, "largest_mm": found.largest}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
