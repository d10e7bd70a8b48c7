"""Flow curves: each law against its formula, its end against Considère, and what no wire does refused."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.wire.hardening import FAR, LEAST_SLOPE, Hardening, linear, perfect, power, table, voce

E = 193e3
BEGIN = 205.0
DENSE = np.linspace(0.0, FAR, 20_001)


def slopes(law: Hardening) -> Floats:
    return np.asarray(np.diff(law.curve[:, 1]) / np.diff(law.curve[:, 0]))


def load(stress: Callable[[float], float], p: float) -> float:
    """Engineering stress of a wire pulled to a plastic strain: its load over its first section."""
    return stress(p) * float(np.exp(-p - stress(p) / E))


def strongest(stress: Callable[[float], float]) -> tuple[float, float]:
    """Plastic strain and engineering stress at the largest load of a law, by a search."""
    found = minimize_scalar(lambda p: -load(stress, p), bounds=(0.0, FAR), method="bounded", options={"xatol": 1e-10})
    return found.x, -found.fun


def test_perfect_plasticity_rises_by_the_least_slope_for_ever() -> None:
    law = perfect(BEGIN, E)
    assert (law.yield_strength, law.kinematic, law.breaks_at) == (BEGIN, 0.0, None)
    np.testing.assert_allclose(law.flow(np.array([0.0, 0.5, 30.0])), BEGIN + LEAST_SLOPE * E * np.array([0, 0.5, 30]))
    with pytest.raises(ValueError, match="read-only"):
        law.curve[0, 1] = 1.0


@given(st.floats(0.01, 0.9), st.floats(0.0, 0.5))
def test_a_linear_law_gives_the_tensile_curve_its_slope(part: float, p: float) -> None:
    law = linear(BEGIN, E, modulus=part * E, kinematic=0.3)
    stress = float(law.flow(p))
    strain = p + stress / E
    assert stress == pytest.approx(BEGIN + part * E * (strain - BEGIN / E), rel=1e-9)
    assert (law.kinematic, law.breaks_at) == (0.3, None)


def test_a_linear_law_without_slope_is_perfect() -> None:
    np.testing.assert_array_equal(linear(BEGIN, E, modulus=0.0).curve, perfect(BEGIN, E).curve)


@pytest.mark.parametrize(
    ("saturation", "rate", "modulus"), [(700.0, 12.0, 0.0), (206.0, 900.0, 300.0), (9000.0, 40.0, 50.0)]
)
def test_voce_keeps_to_its_formula(saturation: float, rate: float, modulus: float) -> None:
    law = voce(BEGIN, E, saturation=saturation, rate=rate, modulus=modulus)
    p = np.concatenate((DENSE, DENSE / rate, 50 * DENSE))
    exact = saturation - (saturation - BEGIN) * np.exp(-rate * p) + max(modulus, LEAST_SLOPE * E) * p
    assert law.yield_strength == BEGIN
    np.testing.assert_allclose(law.flow(p), exact, rtol=1e-4)
    assert len(law.curve) < 1000


def test_voce_that_saturates_at_once_is_perfect() -> None:
    law = voce(BEGIN, E, saturation=BEGIN, rate=10.0)
    np.testing.assert_allclose(law.flow(DENSE), perfect(BEGIN, E).flow(DENSE), rtol=1e-12)


@pytest.mark.parametrize(("strength", "exponent"), [(1275.0, 0.45), (300.0, 0.05), (5000.0, 0.9)])
def test_a_power_law_keeps_to_its_formula(strength: float, exponent: float) -> None:
    law = power(BEGIN, E, strength=strength, exponent=exponent)
    p = np.concatenate((DENSE, 1e-2 * DENSE, 1e-4 * DENSE))
    shift = (BEGIN / strength) ** (1 / exponent)
    assert law.yield_strength == BEGIN
    np.testing.assert_allclose(law.flow(p), strength * (shift + p) ** exponent, rtol=1e-4)
    assert len(law.curve) < 400


@pytest.mark.parametrize(
    ("law", "stress"),
    [
        (power(BEGIN, E, strength=1275.0, exponent=0.45), lambda p: 1275 * ((BEGIN / 1275) ** (1 / 0.45) + p) ** 0.45),
        (voce(BEGIN, E, saturation=600.0, rate=9.0), lambda p: 600 - 395 * np.exp(-9 * p) + LEAST_SLOPE * E * p),
    ],
)
def test_a_wire_necks_where_considere_says(law: Hardening, stress: Callable[[float], float]) -> None:
    p, strength = strongest(stress)
    assert law.breaks_at == pytest.approx(p + stress(p) / E, rel=1e-5)
    assert strongest(lambda p: float(law.flow(p)))[1] == pytest.approx(strength, rel=1e-4)
    slope = (stress(p + 1e-6) - stress(p - 1e-6)) / 2e-6
    assert slope * (1 - stress(p) / E) == pytest.approx(stress(p), rel=1e-4)


def test_a_power_law_without_elasticity_necks_at_its_exponent() -> None:
    law = power(100.0, 1e9, strength=1000.0, exponent=0.25)
    assert law.breaks_at == pytest.approx(0.25 - 1e-4, rel=1e-5)


def test_a_law_whose_load_falls_from_the_start_does_not_say_when_it_necks() -> None:
    assert voce(BEGIN, E, saturation=300.0, rate=1.0).breaks_at is None


@given(st.floats(1.0, 100.0), st.floats(0.1, 1000.0), st.floats(0.0, 100.0))
def test_every_other_law_necks_before_a_strain_of_one(rise: float, rate: float, slope: float) -> None:
    law = voce(BEGIN, E, saturation=BEGIN * rise, rate=rate, modulus=BEGIN * slope)
    if law.breaks_at is not None:
        p = np.interp(law.breaks_at, law.curve[:, 0] + law.curve[:, 1] / E, law.curve[:, 0])
        assert 0.0 < p < FAR


@pytest.mark.parametrize(
    ("points", "breaks_at"),
    [
        # On the second piece H = 500 MPa: the load is largest where the stress is H / (1 + H/E).
        ([(0.0, 200.0), (0.1, 400.0), (1.1, 900.0)], 0.1 + (500 / (1 + 500 / E) - 400) / 500 + 500 / (1 + 500 / E) / E),
        # A corner: the load rises up to it and falls beyond.
        ([(0.0, 200.0), (0.1, 400.0), (1.1, 500.0)], 0.1 + 400 / E),
        # The load still rises at the end, or falls from the start: the table does not say.
        ([(0.0, 200.0), (0.1, 400.0)], None),
        ([(0.0, 200.0), (0.1, 201.0)], None),
    ],
)
def test_a_table_necks_where_its_load_is_largest(points: list[tuple[float, float]], breaks_at: float | None) -> None:
    law = table(points, E, kinematic=1.0)
    assert law.breaks_at == (None if breaks_at is None else pytest.approx(breaks_at, rel=1e-12))
    np.testing.assert_array_equal(law.curve, points)
    p, stress = points[-1]
    assert law.flow(p + 2.0) == pytest.approx(stress + 2 * float(slopes(law)[-1]))


def test_a_plateau_rises_by_the_least_slope() -> None:
    law = table([(0.0, 250.0), (0.02, 250.0), (0.03, 260.0), (0.2, 260.0)], 206e3)
    np.testing.assert_allclose(
        slopes(law),
        [
            2.06,
            (260 - 250.0412) / 0.01,
            2.06,
        ][:3],
        rtol=1e-9,
    )
    assert (slopes(law) >= LEAST_SLOPE * 206e3 * (1 - 1e-9)).all()


@given(
    st.lists(st.tuples(st.floats(1e-4, 0.2), st.floats(0.0, 300.0)), min_size=1, max_size=12),
    st.floats(50.0, 2000.0),
)
def test_every_curve_rises(steps: list[tuple[float, float]], begin: float) -> None:
    points = np.cumsum(np.array([(0.0, begin), *steps]), axis=0)
    law = table([(p, stress) for p, stress in points], E)
    assert (slopes(law) >= LEAST_SLOPE * E * (1 - 1e-6)).all()
    np.testing.assert_allclose(law.flow(law.curve[:, 0]), law.curve[:, 1])


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (partial(perfect, 0.0, E), "yield_strength: no wire"),
        (partial(perfect, 0.2 * E, E), "yield_strength: no wire with a Young's modulus of 193000 MPa yields at 38600"),
        (partial(linear, BEGIN, E, modulus=E), "hardening.modulus: a tensile curve"),
        (partial(linear, BEGIN, E, modulus=-1.0), "hardening.modulus"),
        (partial(linear, BEGIN, E, modulus=2.5e3, kinematic=1.1), "hardening.kinematic: must be between 0 and 1"),
        (partial(voce, BEGIN, E, saturation=200.0, rate=9.0), "hardening.saturation: 200 MPa is less than the yield"),
        (partial(voce, BEGIN, E, saturation=300.0, rate=0.0), "hardening.rate: must be more than 0"),
        (partial(power, BEGIN, E, strength=205.0, exponent=0.2), "hardening.strength: 205 MPa"),
        (partial(power, BEGIN, E, strength=1275.0, exponent=0.05), "hardening.exponent: a wire that yields at 205 MPa"),
        (partial(power, BEGIN, E, strength=1275.0, exponent=1.0), "hardening.exponent: must be between"),
        (partial(table, [(0.0, 200.0)], E), "hardening.points: a flow curve has at least two points"),
        (partial(table, [(0.01, 200.0), (0.1, 300.0)], E), "hardening.points: the first point is at a plastic strain"),
        (partial(table, [(0.0, 200.0), (0.1, 300.0), (0.1, 310.0)], E), "the strain must rise .* point 3 has 0.1, 310"),
        (partial(table, [(0.0, 200.0), (0.1, 300.0), (0.2, 290.0)], E), "the stress falls .* point 3 has 0.2, 290"),
        (partial(table, [(0.0, 200.0), (25.0, 300.0)], E), "a strain of 25 is 25 times the length"),
        (partial(table, [(0.0, 200.0), (0.1, float("nan"))], E), "must be finite"),
    ],
)
def test_what_no_wire_does_is_refused(make: Callable[[], Hardening], told: str) -> None:
    with pytest.raises(InputError, match=told) as caught:
        make()
    assert len(caught.value.problems) == 1
