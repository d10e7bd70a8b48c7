"""The law of the resultants: where it yields, the curves it follows, and the tip of its lenses."""

from __future__ import annotations

from math import asin, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from punchform.arrays import Floats
from punchform.mechanics import resultants
from punchform.mechanics.section import SectionLaw

FREE = np.nan
E, G = 193e3, 75e3
WIRE = np.array([E, G, 0.75])
PERFECT = np.array([[0.0, 205.0], [1.0, 205 + 1e-5 * E]])
LINEAR = np.array([[0.0, 205.0], [1.0, 205 + 2500.0]])
PLASTIC = 205 * np.array([pi * 0.75**2 / 4, 0.75**3 / 6, 0.75**3 / 6, pi * 0.75**3 / (12 * sqrt(3))])
LAW = SectionLaw(WIRE, PERFECT)
FIRST_YIELD = 205 / (E * 0.375)
"""Curvature at which the edge of a bent wire yields [1/mm]."""


def flow(law: SectionLaw, load: Floats, row: Floats | None = None) -> tuple[float, Floats, Floats]:
    """w, dp and f of the kernel, for a wire that has never yielded if no row is given."""
    dp, f = np.empty(4), np.empty((4, 4))
    row = np.zeros(resultants.PAST) if row is None else row
    return resultants.flow(load, row, law.curve, law.kinematic, law.wire, law.stretch, dp, f), dp, f


def bending_curve(times: float) -> float:
    """M / M_p at so many times the curvature of first yield, closed form."""
    c = 1 / times
    core = asin(c) / 8 - c * (1 - 2 * c**2) * sqrt(1 - c**2) / 8
    return float(3 * (times * core + (1 - c**2) ** 1.5 / 3))


@pytest.mark.parametrize("times", np.geomspace(1.001, 60, 40))
def test_bending_follows_the_perfectly_plastic_section(times: float) -> None:
    """Eq. (12.6): the springback of the curvature is off by at most 0.65 % of the curvature."""
    curvature = times * FIRST_YIELD
    bent = LAW.at(np.array([FREE, curvature, 0, 0]), LAW.start())
    exact = bending_curve(times) * PLASTIC[1]
    assert (bent.load[1] - exact) * LAW.elastic[1] == pytest.approx(0, abs=0.0065 * curvature)


@pytest.mark.parametrize("times", np.geomspace(1.001, 60, 40))
@pytest.mark.parametrize("shear", [70e3, 75e3, 80e3])
def test_twist_follows_the_perfectly_plastic_section(times: float, shear: float) -> None:
    law = SectionLaw(np.array([E, shear, 0.75]), PERFECT)
    twist = times * 205 / sqrt(3) / shear / 0.375
    twisted = law.at(np.array([FREE, 0, 0, twist]), law.start())
    exact = (1 - times**-3 / 4) * PLASTIC[3]
    assert (twisted.load[3] - exact) * law.elastic[3] == pytest.approx(0, abs=0.006 * twist)


@given(st.floats(-1, 1))
@settings(deadline=None)
def test_nothing_flows_in_tension_before_the_whole_section_yields(part: float) -> None:
    assert flow(LAW, np.array([part * PLASTIC[0] * (1 - 1e-12), 0, 0, 0]))[0] == 0


def test_first_yield() -> None:
    for component, first in ((1, resultants.BENDING[0]), (2, resultants.BENDING[0]), (3, resultants.TWISTING[0])):
        load = np.eye(4)[component] * first * PLASTIC
        assert flow(LAW, load * (1 - 1e-9))[0] == 0
        assert flow(LAW, load * (1 + 1e-9))[0] > 0
    # The first lens with a tension, n² + mu = 1.
    load = np.array([0.6, 0.64 * resultants.BENDING[0], 0, 0]) * PLASTIC
    assert flow(LAW, load * (1 - 1e-9))[0] == 0
    assert flow(LAW, load * (1 + 1e-9))[0] > 0


@pytest.mark.parametrize("way", [[1, 0.4, 0, 0], [0.5, 0.4, 0.3, 0.6], [0, 1, 2, 1], [-1, 1, -1, 0.2]])
def test_the_sphere_bounds_the_load(way: list[float]) -> None:
    """Without hardening no strain whatever needs more than n² + m² + t² = 1."""
    strain = np.array(way) * [0.2, 0.5, 0.5, 0.5]
    answer = LAW.at(strain, LAW.start())
    assert np.linalg.norm(answer.load / PLASTIC) == pytest.approx(1, abs=3e-3)


def test_bending_is_soft_at_the_tip() -> None:
    """A wire that flows under tension bends by 1 + a_1 + … + a_4 times its elastic compliance, whichever way."""
    law = SectionLaw(WIRE, LINEAR)
    _, _, f = flow(law, np.array([1.2 * PLASTIC[0], 0, 0, 0]))
    soft = sum(resultants.SOFTNESS)
    sphere = f[1, 1] / law.elastic[1] - soft
    assert sphere > 0
    np.testing.assert_allclose(f[2, 2], f[1, 1], rtol=1e-13)
    # The sphere's own part: its plastic strain over its load, as bending sees them.
    turn = (1 - 4 * resultants.PART) * (41 / 2500) / 246
    assert sphere * law.elastic[1] == pytest.approx(turn * 9 * pi / 0.75**4, rel=1e-9)


def test_the_tip_is_passed_smoothly() -> None:
    """From a moment of nothing to one that leaves the tip: dp goes on without a jump, from 0 on."""
    law = SectionLaw(WIRE, LINEAR)
    parts = np.linspace(0, 0.3, 601)
    dp = np.array([flow(law, np.array([1.05, part, 0, 0]) * PLASTIC)[1] for part in parts])
    assert dp[0, 1] == 0
    assert dp[0, 0] == pytest.approx(0.05 * 205 / 2500, rel=1e-12)
    assert np.isfinite(dp).all()
    assert (np.diff(dp[:, 1]) > 0).all()
    assert np.diff(dp[:, 1]).max() < 1.5 * np.diff(dp[:, 1])[0]
    tiny = flow(law, np.array([1.05, 1e-160, 0, 1e-170]) * PLASTIC)
    assert np.isfinite(tiny[2]).all()
    assert tiny[1][0] == pytest.approx(dp[0, 0], rel=1e-12)


def test_pull_and_push_are_mirror_images() -> None:
    load = np.array([0.8, 0.5, -0.3, 0.4]) * PLASTIC
    (w, dp, f), (w_back, dp_back, f_back) = flow(LAW, load), flow(LAW, -load)
    assert w_back == w > 0
    np.testing.assert_array_equal(dp_back, -dp)
    np.testing.assert_array_equal(f_back, f)


def test_strain_at_the_edge() -> None:
    """Eq. (12.8) of a wire bent and twisted far is that of its outermost fibre."""
    law = SectionLaw(WIRE, LINEAR)
    bent = law.at(np.array([FREE, 0.3, 0.4, 0]), law.start())
    edge = 0.375 * np.hypot(*bent.past.plastic[1:3])
    assert law.largest_plastic_strain(bent.past) == pytest.approx(edge, rel=1e-12)
    assert edge == pytest.approx(0.375 * 0.5, rel=0.03)
    twisted = law.at(np.array([FREE, 0, 0, 0.5]), law.start())
    assert law.largest_plastic_strain(twisted.past) == pytest.approx(
        0.375 * twisted.past.plastic[3] / sqrt(3), rel=1e-12
    )


def test_hardening_of_a_bent_wire() -> None:
    """Far beyond yield the moment grows by 0.88 of E_t I per curvature, Eq. (12.7)."""
    law = SectionLaw(WIRE, LINEAR)
    one, two = (law.at(np.array([FREE, curvature, 0, 0]), law.start()).load[1] for curvature in (0.4, 0.5))
    slope = E * 2500 / (E + 2500)
    assert (two - one) / 0.1 == pytest.approx(0.88 * slope * pi * 0.75**4 / 64, rel=2e-3)
