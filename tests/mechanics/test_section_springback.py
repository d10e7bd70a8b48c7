"""Wires bent, stretched and let go: the published tables, by fibres to 0.5 % and by resultants to 3 % of kappa."""

from __future__ import annotations

import numpy as np
import pytest

from punchform.arrays import Floats
from punchform.mechanics.fibres import round_points
from punchform.mechanics.section import SectionLaw

FREE = np.nan
POINTS = round_points(4, 16)
RADII = (300, 100, 30, 10)
LAWS = pytest.mark.parametrize(("points", "near"), [(None, 0.03), (POINTS, 0.005)], ids=["resultants", "fibres"])


def law(young: float, strength: float, slope: float, points: Floats | None) -> SectionLaw:
    """Wire of 0.75 mm with straight hardening of this slope of the flow curve, at least 1e-5 E [MPa]."""
    curve = np.array([[0.0, strength], [1.0, strength + max(slope, 1e-5 * young)]])
    return SectionLaw(np.array([young, young / 2.58, 0.75]), curve, points=points)


def kept(wire: SectionLaw, radius: float) -> float:
    """Part of the curvature that a wire bent to the radius keeps when it is let go."""
    bent = wire.at(np.array([FREE, 1 / radius, 0, 0]), wire.start())
    free = wire.under(np.zeros(4), bent.past)
    np.testing.assert_allclose(free.past.row, bent.past.row, rtol=0, atol=1e-12)
    return float(free.strain[1] * radius)


@LAWS
@pytest.mark.parametrize(
    ("young", "strength", "wanted"),
    [
        pytest.param(193e3, 205, (0.0155, 0.5382, 0.8563, 0.9519), id="304 annealed"),
        pytest.param(193e3, 515, (0, 0.0729, 0.6458, 0.8795), id="304 quarter-hard"),
        pytest.param(187.5e3, 1300, (0, 0, 0.1963, 0.6915), id="304 spring"),
        pytest.param(206e3, 250, (0.0003, 0.4789, 0.8360, 0.9451), id="low-carbon annealed"),
        pytest.param(206e3, 500, (0, 0.1161, 0.6765, 0.8903), id="low-carbon hard drawn"),
        pytest.param(71e3, 152, (0, 0.1807, 0.7135, 0.9032), id="Al 5056-O"),
        pytest.param(71e3, 345, (0, 0, 0.3888, 0.7819), id="Al 5056-H38"),
    ],
)
def test_bent_and_let_go(
    points: Floats | None, near: float, young: float, strength: float, wanted: tuple[float, ...]
) -> None:
    wire = law(young, strength, 0, points)
    np.testing.assert_allclose([kept(wire, radius) for radius in RADII], wanted, rtol=0, atol=near)


@LAWS
@pytest.mark.parametrize(
    ("tangent", "wanted"),
    [(0, (28.879, 68.128, 205.00, 1593.3)), (2100, (29.170, 68.816, 207.07, 1609.4))],
    ids=["perfect", "hardening"],
)
def test_radius_when_let_go(points: Floats | None, near: float, tangent: float, wanted: tuple[float, ...]) -> None:
    """E = 210 GPa, yield strength 250 MPa, bent to R = 25, 50, 100 and 200 mm; R = 400 mm is elastic."""
    wire = law(210e3, 250, 210e3 * tangent / (210e3 - tangent), points)
    radii = np.array([25, 50, 100, 200])
    np.testing.assert_allclose([kept(wire, R) for R in radii], radii / wanted, rtol=0, atol=near)
    assert kept(wire, 400) == pytest.approx(0, abs=1e-12)


def sprung(wire: SectionLaw, stretch: float, steps: int = 1) -> float:
    """Springback of the curvature 1/600 of a wire that was stretched and bent to it together."""
    past = wire.start()
    for part in np.arange(1, steps + 1) / steps:
        past = wire.at(part * np.array([stretch, 1 / 600, 0, 0]), past).past
    return float(1 - wire.under(np.zeros(4), past).strain[1] * 600)


@pytest.mark.parametrize(
    ("stretch", "tangent", "wanted"),
    [(0, 0, 1), (0.001, 0, 0.584), (0.00169, 0, 0), (0.01, 0, 0), (0.01, 2500, 0.01295), (0.04, 2500, 0.01295)],
)
@pytest.mark.parametrize("steps", [1, 5])
def test_stretched_and_bent_by_fibres(stretch: float, tangent: float, wanted: float, steps: int) -> None:
    """Stretched and bent together, to R = 600 mm: 304 annealed."""
    wire = law(193e3, 205, 193e3 * tangent / (193e3 - tangent), POINTS)
    assert sprung(wire, stretch, steps) == pytest.approx(wanted, abs=0.005)


@pytest.mark.parametrize(
    ("stretch", "tangent", "wanted", "near"),
    [
        (0, 0, 1, 1e-12),
        (0.001, 0, 0.584, 0.14),
        (0.00169, 0, 0, 0.04),
        (0.01, 0, 0, 0.03),
        (0.00169, 2500, 0.013, 0.14),
        (0.003, 2500, 0.01295, 0.065),
        (0.01, 2500, 0.01295, 0.02),
        (0.04, 2500, 0.01295, 0.01),
    ],
)
@pytest.mark.parametrize("steps", [1, 5])
def test_stretched_and_bent_by_resultants(
    stretch: float, tangent: float, wanted: float, near: float, steps: int
) -> None:
    """The same by resultants, which round off the corner where the last fibre begins to yield."""
    wire = law(193e3, 205, 193e3 * tangent / (193e3 - tangent), None)
    assert sprung(wire, stretch, steps) == pytest.approx(wanted, abs=near)
