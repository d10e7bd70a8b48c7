"""Resultants against fibres where several loads act: how far apart they are, in parts of what is bent or twisted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from punchform.arrays import Floats
from punchform.mechanics.fibres import round_points
from punchform.mechanics.section import SectionLaw

FREE = np.nan
WIRE = np.array([193e3, 193e3 / 2.58, 0.75])
POINTS = round_points(5, 16)
STRAINS = np.concatenate([[0.0], np.geomspace(2e-4, 0.3, 40)])
CURVES = {
    "perfect": np.array([[0.0, 205.0], [1.0, 206.93]]),
    "linear": np.array([[0.0, 205.0], [1.0, 205 + 2500 / (1 - 2500 / 193e3)]]),
    "saturating": np.column_stack([STRAINS, 205 + 300 * (1 - np.exp(-30 * STRAINS)) + 500 * STRAINS]),
    "power": np.column_stack([STRAINS, 1275 * (STRAINS + 0.01723) ** 0.45]),
    "steep": np.column_stack([STRAINS, 205 + 200 * (1 - np.exp(-200 * STRAINS)) + 1000 * STRAINS]),
}
curves = pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)
kinematics = pytest.mark.parametrize("kinematic", [0.0, 1.0])


def sprung(law: SectionLaw, corners: Sequence[Sequence[float]], steps: int = 5) -> Floats:
    """Springback (4,) of elongation, curvatures and twist after a path of strains through its corners."""
    past, here = law.start(), np.zeros(4)
    for corner in np.asarray(corners, dtype=np.float64):
        for part in np.arange(1, steps + 1) / steps:
            answer = law.at(np.where(np.isnan(corner), FREE, here + part * (corner - here)), past)
            past = answer.past
        here = np.where(np.isnan(corner), 0.0, corner)
    return np.asarray(law.elastic * answer.load)


def apart(curve: Floats, kinematic: float, corners: Sequence[Sequence[float]]) -> Floats:
    """How far the two laws are apart in springback, signed."""
    law = SectionLaw(WIRE, curve, kinematic)
    return sprung(law, corners) - sprung(SectionLaw(WIRE, curve, kinematic, POINTS), corners)


@curves
@pytest.mark.parametrize("radius", [200, 100, 30, 10])
def test_bending_alone(curve: Floats, radius: float) -> None:
    assert abs(apart(curve, 0.0, [(FREE, 1 / radius, 0, 0)])[1]) * radius < 0.02


@curves
@pytest.mark.parametrize("twist", [0.01, 0.02, 0.05, 0.2])
def test_twist_alone(curve: Floats, twist: float) -> None:
    assert abs(apart(curve, 0.0, [(FREE, 0, 0, twist)])[3]) / twist < 0.012


@curves
@kinematics
@pytest.mark.parametrize(("radius", "twist"), [(200, 0.01), (100, 0.01), (100, 0.03), (30, 0.05), (10, 0.05)])
def test_bending_and_twist(curve: Floats, kinematic: float, radius: float, twist: float) -> None:
    both = (FREE, 1 / radius, 0, twist)
    for path in ([both], [(FREE, 1 / radius, 0, 0), both], [(FREE, 0, 0, twist), both]):
        off = np.abs(apart(curve, kinematic, path))
        assert off[1] * radius < 0.07
        assert off[3] / twist < 0.08


@curves
@kinematics
@pytest.mark.parametrize(
    ("stretch", "near"), [(0.0005, 0.005), (0.001, 0.15), (0.0015, 0.24), (0.003, 0.07), (0.01, 0.04), (0.04, 0.04)]
)
def test_stretch_and_bending(curve: Floats, kinematic: float, stretch: float, near: float) -> None:
    """To R = 600 mm. By resultants a wire of which not every fibre flows yet, or just so, springs back more."""
    both = (stretch, 1 / 600, 0, 0)
    for path in ([both], [(0, 1 / 600, 0, 0), both]):
        assert abs(apart(curve, kinematic, path)[1]) * 600 < near
    assert abs(apart(curve, kinematic, [(stretch, 0, 0, 0), both])[1]) * 600 < 0.17


@curves
@kinematics
@pytest.mark.parametrize("stretch", [0.001, 0.002, 0.005, 0.02])
def test_stretch_and_twist(curve: Floats, kinematic: float, stretch: float) -> None:
    both = (stretch, 0, 0, 0.01)
    for path in ([both], [(stretch, 0, 0, 0), both]):
        assert abs(apart(curve, kinematic, path)[3]) / 0.01 < 0.15
