"""The unit-load stiffness of Eq. (2.4) against the same wire as solid elements in CalculiX."""

from __future__ import annotations

import json
import shutil
from typing import Any

import numpy as np
import pytest
from crimped_wire_solids import ANSWERS, DIAMETER, HEIGHT, POISSON, SMALL, STEP, YOUNGS_MODULUS
from crimped_wire_solids import flexibility_by_calculix as by_calculix

from punchform.arrays import Floats
from punchform.wire import cosine_line, flexibility, inverse, round_section

# Table 1's names of its twelve entries and where they sit in element axes, Eq. (2.2).
ENTRIES = {
    "C11": (2, 2),
    "C13": (2, 0),
    "C33": (0, 0),
    "C15": (2, 4),
    "C35": (0, 4),
    "C55": (4, 4),
    "C22": (1, 1),
    "C24": (1, 5),
    "C26": (1, 3),
    "C44": (5, 5),
    "C46": (5, 3),
    "C66": (3, 3),
}
RECORD: dict[str, Any] = json.loads(ANSWERS.read_text(encoding="utf-8"))


def closed_form() -> Floats:
    """Eq. (2.4) of the smooth wire (400 chords) with the shear factor of a round section,
    6 (1 + ν) / (7 + 6 ν), which is 0.882 here (Cowper 1966)."""
    shear_factor = 6 * (1 + POISSON) / (7 + 6 * POISSON)
    section = round_section(DIAMETER, youngs_modulus=YOUNGS_MODULUS, poisson=POISSON, shear_factor=shear_factor)
    return inverse(flexibility(cosine_line(HEIGHT, STEP, segments=400), section))


def deviations(solid: Floats) -> dict[str, float]:
    """Closed form over solids, less one, entry by entry [%]."""
    C, wanted = closed_form(), inverse(0.5 * (solid + solid.T))
    return {name: 100 * float(C[place] / wanted[place] - 1) for name, place in ENTRIES.items()}


def assert_agree(solid: Floats) -> None:
    """Within 1 %; C35, a small difference of large numbers, within 4 %."""
    off = {name: value for name, value in deviations(solid).items() if abs(value) > (4 if name == "C35" else 1)}
    assert not off, f"deviations in %: {off}"


@pytest.mark.parametrize("run", RECORD["runs"], ids=lambda run: f"{run['element']}-{run['equations']}")
def test_kept_answers_agree_with_the_closed_form(run: dict[str, Any]) -> None:
    solid = np.array(run["B"])
    scale = np.sqrt(np.outer(np.diag(solid), np.diag(solid)))
    assert np.abs((solid - solid.T) / scale).max() < 1e-6
    assert_agree(solid)


def test_kept_answers_hardly_depend_on_mesh_or_integration() -> None:
    first, *others = [deviations(np.array(run["B"])) for run in RECORD["runs"]]
    for other in others:
        assert max(abs(other[name] - first[name]) for name in ENTRIES) < 0.3


def test_kept_answers_repeat_the_independent_solid_model() -> None:
    """Another solid model of this wire (C3D20R, 25 683 equations), N/m, N, N m: to 0.1 %."""
    known = {
        "C11": 2.6005e5,
        "C13": 1.4096e6,
        "C33": 1.1780e7,
        "C15": -446.59,
        "C35": -868.33,
        "C55": 1.7825,
        "C22": 8.9950e4,
        "C24": 337.31,
        "C26": -33.731,
        "C44": 1.6973,
        "C46": -0.13501,
        "C66": 0.35943,
    }
    C = np.abs(inverse(np.array(RECORD["runs"][1]["B"])))
    metres = np.outer([1e3] * 3 + [1] * 3, [1.0] * 3 + [1e-3] * 3)
    for name, place in ENTRIES.items():
        assert abs((C * metres)[place] / abs(known[name]) - 1) < 1e-3, name


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not on the path")
def test_calculix_agrees_with_the_closed_form() -> None:
    layers, rings, kind = SMALL
    solid, _ = by_calculix(layers, rings, kind)
    assert_agree(solid)
    # The printed digits of ccx limit the repeat, not the solve.
    kept = np.array(RECORD["runs"][0]["B"])
    scale = np.sqrt(np.outer(np.diag(kept), np.diag(kept)))
    assert np.abs((solid - kept) / scale).max() < 1e-5
