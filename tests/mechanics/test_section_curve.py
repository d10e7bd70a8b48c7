"""The flow curve, Eq. (12.1), and the return of one fibre to it, Eq. (12.3), against the same things written out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from punchform.mechanics import flow_curve

CURVE = np.array([[0.0, 205.0], [0.002, 240.0], [0.01, 290.0], [0.05, 330.0], [0.06, 390.0]])
E, G = 193e3, 75e3
strains = st.floats(0, 0.12)
stresses = st.floats(-900, 900)


def stress(alpha: float) -> float:
    """The straight pieces by NumPy, the last one going on."""
    if alpha > CURVE[-1, 0]:
        return float(CURVE[-1, 1] + 6000 * (alpha - CURVE[-1, 0]))
    return float(np.interp(alpha, *CURVE.T))


@settings(deadline=None)
@given(strains)
def test_flow_stress(alpha: float) -> None:
    assert flow_curve.flow_stress(CURVE, alpha) == pytest.approx(stress(alpha), rel=1e-13)
    assert flow_curve.radius(CURVE, 0.25, alpha) == pytest.approx(205 + 0.75 * (stress(alpha) - 205), rel=1e-13)


@settings(deadline=None)
@given(strains, strains)
def test_rise_and_its_integral(alpha: float, added: float) -> None:
    height, slope, work = flow_curve.rise(CURVE, alpha, added)
    assert height == pytest.approx(stress(alpha + added) - stress(alpha), abs=1e-11)
    assert np.isclose(slope, np.diff(CURVE[:, 1]) / np.diff(CURVE[:, 0]), rtol=1e-12).any()
    corners = [x - alpha for x in CURVE[:, 0] if alpha < x < alpha + added]
    exact = quad(lambda x: stress(alpha + x) - stress(alpha), 0, added, points=corners or None)[0]
    assert work == pytest.approx(exact, rel=1e-9, abs=1e-10)


@settings(deadline=None)
@given(strains, strains, st.sampled_from([0.0, E, 3 * G]))
def test_strain_for_is_the_inverse_of_the_rise(alpha: float, added: float, modulus: float) -> None:
    excess = flow_curve.rise(CURVE, alpha, added)[0] + modulus * added
    assert flow_curve.strain_for(CURVE, alpha, modulus, excess) == pytest.approx(added, rel=1e-11, abs=1e-15)


@settings(deadline=None)
@given(stresses, stresses, strains, st.sampled_from([0.0, 0.4, 1.0]))
def test_return_of_a_fibre(sigma: float, tau: float, alpha: float, kinematic: float) -> None:
    added, q, risen = flow_curve.flow_under(sigma, tau, alpha, CURVE, kinematic, E, G)
    size = 205 + (1 - kinematic) * (stress(alpha) - 205)

    def excess(x: float) -> float:
        wide = size + stress(alpha + x) - stress(alpha)
        return float(np.hypot(sigma / (wide + E * x), np.sqrt(3) * tau / (wide + 3 * G * x)) - 1)

    if np.hypot(sigma, np.sqrt(3) * tau) <= size:
        assert added == 0
        return
    assert added == pytest.approx(brentq(excess, 0, 1, xtol=1e-16), rel=1e-9, abs=1e-15)
    assert risen == flow_curve.rise(CURVE, alpha, added)
    left, around = flow_curve.left_of(sigma, tau, added, q, E, G)
    assert np.hypot(left, np.sqrt(3) * around) == pytest.approx(q, rel=1e-12)
