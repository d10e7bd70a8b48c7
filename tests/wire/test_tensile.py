"""A tensile test made of a known law gives the law back, however the test was spoilt; nonsense is refused."""

from __future__ import annotations

import numpy as np
import pytest

from punchform.arrays import Floats
from punchform.errors import InputError
from punchform.wire.hardening import Hardening, power
from punchform.wire.tensile import OFFSET, from_tensile

E = 193e3
LAW = power(205.0, E, strength=1275.0, exponent=0.45)
BREAKS_AT = 0.4373
LOOKED_AT = np.geomspace(1e-3, 0.4, 50)


def pulled(law: Hardening = LAW, until: float = 0.45, rows: int = 4000) -> Floats:
    """Rows of engineering strain and stress of a test of a law, with an elastic part, to a plastic strain."""
    elastic = np.linspace(0.0, law.yield_strength, 60)[:-1]
    p = until * np.linspace(0.0, 1.0, rows) ** 2
    stress = np.concatenate((elastic, law.flow(p)))
    strain = np.concatenate((elastic / E, p + law.flow(p) / E))
    return np.column_stack((np.expm1(strain), stress * np.exp(-strain)))


def read(test: Floats, youngs_modulus: float = E) -> Hardening:
    return from_tensile([(strain, stress) for strain, stress in test.tolist()], youngs_modulus)


def assert_is_the_law(found: Hardening, within: float, breaks_within: float = 0.02) -> None:
    np.testing.assert_allclose(found.flow(LOOKED_AT), LAW.flow(LOOKED_AT), rtol=within)
    assert found.breaks_at == pytest.approx(BREAKS_AT, abs=breaks_within)


def test_a_clean_test_gives_its_law_back() -> None:
    found = read(pulled())
    assert_is_the_law(found, 0.004)
    assert found.yield_strength == pytest.approx(float(LAW.flow(OFFSET)), rel=1e-3)
    assert len(found.curve) < 60


def test_what_comes_after_the_largest_load_changes_nothing() -> None:
    test = pulled()
    top = int(test[:, 1].argmax())
    assert top < len(test) - 1
    necked = np.column_stack((test[top, 0] + np.linspace(0.001, 0.1, 50), test[top, 1] * np.linspace(0.999, 0.6, 50)))
    np.testing.assert_array_equal(read(np.vstack((test[: top + 1], necked))).curve, read(test).curve)


def test_foot_and_soft_machine_do_not_count() -> None:
    test = pulled()
    # The crosshead also moves by the machine's own compliance, and the grips first take up some slack.
    test[:, 0] += 2.0 * test[:, 1] / E + 0.03
    foot = np.column_stack((np.linspace(0.0, test[0, 0], 20)[:-1], np.zeros(19)))
    assert_is_the_law(read(np.vstack((foot, test))), 0.01)


@pytest.mark.parametrize("seed", range(3))
def test_small_wiggles_are_averaged(seed: int) -> None:
    rng = np.random.default_rng(seed)
    test = pulled()
    test += rng.normal(size=test.shape) * (1e-5, 1.0)
    found = read(test)
    assert_is_the_law(found, 0.015, breaks_within=0.06)
    assert (np.diff(found.curve[:, 1]) > 0).all()


def test_a_wire_let_go_for_a_moment_gives_the_same_curve() -> None:
    test = pulled()
    at = 2000
    down = np.linspace(1.0, 0.1, 30)[:, None]
    loop = test[at] - (1 - np.vstack((down, down[::-1]))) * (test[at, 1] / E, test[at, 1])
    looped = np.vstack((test[: at + 1], loop, test[at + 1 :]))
    np.testing.assert_allclose(read(looped).flow(LOOKED_AT), read(test).flow(LOOKED_AT), rtol=1e-3)


def test_an_upper_yield_point_becomes_its_plateau() -> None:
    elastic = np.linspace(0.0, 320.0, 40)
    plateau, hard = np.linspace(0.002, 0.02, 200), np.linspace(0.021, 0.2, 500)
    strain = np.concatenate((elastic / 206e3, plateau, hard))
    stress = np.concatenate((elastic, np.full(200, 280.0), 280 + 600 * (hard - 0.02)))
    found = read(np.column_stack((strain, stress)), 206e3)
    assert found.flow(0.01) == pytest.approx(280 * 1.01, rel=0.01)
    assert found.yield_strength == pytest.approx(283, rel=0.02)


def test_a_few_rows_typed_by_hand_will_do() -> None:
    rows = [(0.0, 0.0), (0.00106, 205.0), (0.012, 250.0), (0.1, 440.0), (0.3, 545.0), (0.5, 575.0)]
    found = from_tensile(rows, E, kinematic=0.2)
    assert found.yield_strength == pytest.approx(205.0, rel=0.01)
    assert found.kinematic == 0.2
    assert found.breaks_at == pytest.approx(np.log(1.5), abs=1e-12)
    for strain, stress in rows[2:]:
        true = stress * (1 + strain)
        assert found.flow(np.log1p(strain) - true / E) == pytest.approx(true, rel=1e-9)


@pytest.mark.parametrize(
    ("test", "told"),
    [
        (pulled()[:4], "at least 5 rows of strain and stress, not 4"),
        (pulled() * (100, 1), "a strain of .* times the length"),
        (pulled() * (1, 1e-3), "begins with a slope of 193 MPa, but youngs_modulus is 193000 MPa"),
        (pulled() * (1, 1e3), "begins with a slope of 1.93e.08 MPa"),
        (pulled()[:, ::-1], "a strain of 57[45].* is"),
        (pulled()[::-1], "comes after only"),
        (pulled()[:55], "does not yield in this test"),
        (np.column_stack((np.linspace(0, 0.1, 50), np.full(50, -3.0))), "comes after only 1 rows"),
    ],
)
def test_what_is_no_tensile_test_is_refused(test: Floats, told: str) -> None:
    with pytest.raises(InputError, match=told) as caught:
        read(test)
    assert [problem.where for problem in caught.value.problems] == ["wire.hardening.points"]
