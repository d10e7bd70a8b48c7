"""The bundle of fibres: the section it makes, and closed forms of bending, stretch-bending, twist and limit loads."""

from __future__ import annotations

from itertools import pairwise
from math import asin, pi, sqrt

import numpy as np
import pytest

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.mechanics.fibres import past_size, round_points
from punchform.mechanics.section import SectionLaw

FREE = np.nan
FINE = round_points(12, 32)


def perfect(young: float, strength: float) -> Floats:
    """A flow curve whose slope is the least that there is."""
    return np.array([[0.0, strength], [1.0, strength + 1e-5 * young]])


def law(young: float, curve: Floats, *, shear: float | None = None, points: Floats = FINE) -> SectionLaw:
    """Wire of 0.75 mm."""
    return SectionLaw(np.array([young, shear or young / 2.58, 0.75]), curve, points=points)


def moment(young: float, strength: float, curvature: float) -> float:
    """Closed form of the moment of a perfectly plastic round wire of 0.75 mm: an elastic core of half-depth c."""
    r, c = 0.375, strength / (young * curvature)
    if c >= r:
        return young * pi / 4 * r**4 * curvature
    core = r**4 / 8 * asin(c / r) - c * (r**2 - 2 * c**2) * sqrt(r**2 - c**2) / 8
    return float(4 * (young * curvature * core + strength * (r**2 - c**2) ** 1.5 / 3))


@pytest.mark.parametrize(("rings", "sectors"), [(1, 4), (4, 16), (5, 10), (3, 24)])
def test_moments_of_the_section_are_exact(rings: int, sectors: int) -> None:
    y, z, share = round_points(rings, sectors).T
    sums = [share.sum(), share @ y, share @ z, share @ y**2, share @ z**2, share @ (y * z)]
    np.testing.assert_allclose(sums, [1, 0, 0, 1 / 16, 1 / 16, 0], rtol=0, atol=1e-15)
    # The ring sums are Gauss rules in rho², exact to the degree 2 rings - 1.
    fourth = share @ (y**2 + z**2) ** 2
    assert fourth == pytest.approx(1 / 48 if rings > 1 else 1 / 64, rel=1e-13)


@pytest.mark.parametrize(("rings", "sectors"), [(0, 8), (3, 3), (3, 9)])
def test_too_few_fibres_are_told(rings: int, sectors: int) -> None:
    with pytest.raises(InputError, match="no section that bends alike both ways"):
        round_points(rings, sectors)


def test_size_of_the_past() -> None:
    assert past_size(48) == law(193e3, perfect(193e3, 205), points=round_points(4, 12)).start().row.size


@pytest.mark.parametrize("curvature", [1 / 300, 1 / 100, 1 / 30, 1 / 10])
def test_bending_converges_to_the_closed_form(curvature: float) -> None:
    """The moment of ever finer bundles; far beyond yield its error is that of the sectors, 1 / sectors²."""
    exact = moment(193e3, 205, curvature)
    off = []
    for rings, sectors in ((2, 8), (4, 16), (10, 24)):
        found = law(193e3, perfect(193e3, 205), points=round_points(rings, sectors))
        bent = found.at(np.array([FREE, curvature, 0, 0]), found.start())
        off.append(abs(bent.load[1] / exact - 1))
        np.testing.assert_allclose(bent.load[[0, 2, 3]], 0, atol=1e-9)
    assert off[0] < 0.06
    assert off[1] < 0.011
    assert off[2] < 0.0045
    if curvature > 1 / 50:
        assert off[1] == pytest.approx(off[0] / 4, rel=0.4)
        assert off[2] == pytest.approx(off[0] / 9, rel=0.4)


def test_the_published_moment() -> None:
    """304 annealed bent to R = 100 mm: 13.84288 N mm."""
    assert moment(193e3, 205, 1 / 100) == pytest.approx(13.84288, abs=5e-6)
    found = law(193e3, perfect(193e3, 205))
    assert found.at(np.array([FREE, 1 / 100, 0, 0]), found.start()).load[1] == pytest.approx(13.84288, rel=1e-3)


@pytest.mark.parametrize("turn", [0.0, 0.13, 0.26, 0.8])
def test_bending_is_alike_in_all_directions(turn: float) -> None:
    found = law(193e3, perfect(193e3, 205), points=round_points(4, 16))
    way = np.array([np.cos(turn), np.sin(turn)])
    bent = found.at(np.array([FREE, *way / 50, 0]), found.start())
    assert bent.load[1:3] @ way == pytest.approx(moment(193e3, 205, 1 / 50), rel=0.011)
    assert abs(bent.load[1] * way[1] - bent.load[2] * way[0]) < 0.011 * moment(193e3, 205, 1 / 50)


@pytest.mark.parametrize("times", [1.5, 3.0, 10.0])
def test_twist(times: float) -> None:
    """T / T_p = 1 - (theta_y / theta)³ / 4 of a perfectly plastic round wire."""
    found = law(193e3, perfect(193e3, 205), shear=75e3)
    first_yield = 205 / sqrt(3) / 75e3 / 0.375
    twisted = found.at(np.array([FREE, 0, 0, times * first_yield]), found.start())
    plastic = 205 * pi * 0.75**3 / (12 * sqrt(3))
    assert twisted.load[3] == pytest.approx(plastic * (1 - times**-3 / 4), rel=0.003)


@pytest.mark.parametrize("angle", [0.3, 0.7, 1.1])
def test_limit_of_tension_and_bending(angle: float) -> None:
    """A neutral axis at d/2 sin(angle) leaves m = cos³, n = 2/pi (angle + sin cos) when all has yielded."""
    found = law(193e3, perfect(193e3, 205), points=round_points(12, 40))
    curvature = 2.0
    answer = found.at(np.array([0.375 * np.sin(angle) * curvature, curvature, 0, 0]), found.start())
    n = answer.load[0] / (205 * pi * 0.75**2 / 4)
    m = answer.load[1] / (205 * 0.75**3 / 6)
    assert n == pytest.approx(2 / pi * (angle + np.sin(angle) * np.cos(angle)), abs=0.02)
    assert m == pytest.approx(np.cos(angle) ** 3, abs=0.02)


def test_hardening_of_a_bent_wire() -> None:
    """Far beyond yield the moment grows by H' I per curvature, H' the slope of the tensile curve."""
    hardening = 2500.0
    slope = 193e3 * hardening / (193e3 + hardening)
    found = law(193e3, np.array([[0.0, 205.0], [1.0, 205 + hardening]]))
    one, two = (found.at(np.array([FREE, curvature, 0, 0]), found.start()).load[1] for curvature in (0.4, 0.5))
    assert (two - one) / 0.1 == pytest.approx(slope * pi * 0.75**4 / 64, rel=2e-3)


def test_half_the_bending_stiffness_after_a_stretch() -> None:
    """Stretched till it yields and then bent at that length, one half of the wire unloads: M = EI kappa / 2."""
    found = law(193e3, perfect(193e3, 205))
    stretched = found.at(np.array([0.01, 0, 0, 0]), found.start())
    bent = found.at(np.array([0.01, 1 / 600, 0, 0]), stretched.past)
    assert bent.load[1] * found.elastic[1] * 600 == pytest.approx(0.5, abs=1e-3)


def test_one_step_is_as_good_as_many_where_the_path_is_straight() -> None:
    """Stretched and bent together every fibre goes one way: the implicit step is exact."""
    found = law(193e3, np.array([[0.0, 205.0], [0.005, 260.0], [1.0, 2000.0]]), points=round_points(4, 16))
    goal = np.array([0.004, 1 / 200, 1 / 300, 0.0])
    past = found.start()
    for _, part in pairwise(np.linspace(0, 1, 21)):
        end = found.at(part * goal, past)
        past = end.past
    np.testing.assert_allclose(end.load, found.at(goal, found.start()).load, rtol=1e-9, atol=1e-9)
