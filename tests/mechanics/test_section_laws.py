"""What every section law promises, by resultants and by fibres: potentials, derivatives, scaling, second law, loops."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from punchform.arrays import Floats
from punchform.errors import InputError, NoEquilibrium
from punchform.mechanics import fibres, resultants
from punchform.mechanics.section import Past, SectionLaw
from punchform.testing import slope_and_curvature

WIRE = np.array([193e3, 75e3, 0.75])
PERFECT = np.array([[0.0, 205.0], [1.0, 205 + 1.93]])
LINEAR = np.array([[0.0, 205.0], [1.0, 205 + 2500.0]])
BENT_CURVE = np.array([[0.0, 205.0], [0.002, 240.0], [0.01, 290.0], [0.05, 330.0], [0.06, 390.0]])
AREA = pi * 0.75**2 / 4
SIZE = 205 * np.array([AREA, 0.75**3 / 6, 0.75**3 / 6, pi * 0.75**3 / (12 * sqrt(3))])
"""N, M, M and T at which a section of the first yield strength has yielded throughout."""

RESULTANTS = SectionLaw(WIRE, LINEAR)
FIBRES = replace(RESULTANTS, points=fibres.round_points(3, 8))
both = pytest.mark.parametrize("law", [RESULTANTS, FIBRES], ids=["resultants", "fibres"])
parts = arrays(np.float64, 4, elements=st.floats(-0.9, 0.9))
shares = st.sampled_from([0.0, 0.4, 1.0])
curves = st.sampled_from([PERFECT, LINEAR, BENT_CURVE])


def flow(law: SectionLaw, load: Floats, past: Past) -> tuple[float, Floats, Floats]:
    """w, dp and f of the kernel."""
    dp, f = np.empty(4), np.empty((4, 4))
    made_of = (law.curve, law.kinematic, law.wire, law.stretch)
    if law.points is None:
        return resultants.flow(load, past.row, *made_of, dp, f), dp, f
    nowhere = np.full(fibres.MEMORY, np.nan)
    return fibres.flow(load, past.row, *made_of, law.points, nowhere, dp, f), dp, f


def some_past(law: SectionLaw, seed: int, steps: int = 3) -> tuple[Past, Floats]:
    """A section after some random yielding, and one more load that makes it yield."""
    rng = np.random.default_rng(seed)
    loads = rng.standard_normal((steps + 1, 4))
    # What hardens next to nothing is not loaded far beyond what it can carry.
    sizes = rng.uniform(0.9, 1.25, steps + 1) if law.curve is not PERFECT else rng.uniform(0.6, 0.85, steps + 1)
    loads *= (sizes / np.linalg.norm(loads, axis=1))[:, None]
    past = law.start()
    for load in loads[:-1]:
        past = law.under(load * SIZE, past).past
    return past, loads[-1] * SIZE


def slope_along(law: SectionLaw, load: Floats, past: Past, way: Floats, which: int) -> Floats:
    """How w (which = 0) or dp (which = 1) changes along a direction, by differences."""
    return slope_and_curvature(lambda h: flow(law, load + h * way, past)[which], 1e-5)[0]


@both
@pytest.mark.parametrize("kinematic", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("curve", [PERFECT, LINEAR, BENT_CURVE], ids=["perfect", "linear", "bent"])
def test_derivatives(law: SectionLaw, kinematic: float, curve: Floats) -> None:
    law = replace(law, kinematic=kinematic, curve=curve)
    for seed in range(6):
        past, load = some_past(law, seed)
        w, dp, f = flow(law, load, past)
        if w == 0:
            continue
        scaled = f * SIZE * SIZE[:, None]
        np.testing.assert_allclose(scaled, scaled.T, rtol=0, atol=1e-15 * np.abs(scaled).max())
        assert np.linalg.eigvalsh(scaled).min() >= -1e-12 * np.abs(scaled).max()
        for way in np.random.default_rng(seed).standard_normal((3, 4)) * SIZE:
            slope = slope_along(law, load, past, way, 0)
            bend = slope_along(law, load, past, way, 1) * SIZE
            assert float(slope) == pytest.approx(dp @ way, abs=2e-7 * float(np.linalg.norm(dp * SIZE)))
            np.testing.assert_allclose(bend, f @ way * SIZE, rtol=0, atol=1e-6 * np.abs(scaled).max() * 2)


@both
@settings(deadline=None, max_examples=60)
@given(parts, parts, st.integers(0, 20), curves, shares)
def test_the_potential_is_convex_and_never_negative(
    law: SectionLaw, one: Floats, two: Floats, seed: int, curve: Floats, kinematic: float
) -> None:
    law = replace(law, curve=curve, kinematic=kinematic)
    past, _ = some_past(law, seed, 2)
    one, two = one * SIZE, two * SIZE
    (w_1, dp_1, _), (w_2, dp_2, _) = flow(law, one, past), flow(law, two, past)
    between = flow(law, 0.5 * (one + two), past)[0]
    rounding = 1e-10 * (w_1 + w_2)
    assert min(w_1, w_2, between) >= 0
    assert between <= 0.5 * (w_1 + w_2) + rounding
    assert (dp_1 - dp_2) @ (one - two) >= -rounding
    # Convex and tangent: the other value lies above the tangent plane.
    assert w_2 >= w_1 + dp_1 @ (two - one) - rounding - 1e-12 * np.abs(dp_1 * SIZE).sum()


@both
@settings(deadline=None, max_examples=60)
@given(st.lists(parts, min_size=1, max_size=8), curves, shares)
def test_dissipation_is_never_negative(law: SectionLaw, path: list[Floats], curve: Floats, kinematic: float) -> None:
    law = replace(law, curve=curve, kinematic=kinematic)
    past, work = law.start(), 0.0
    for part in path:
        answer = law.under(part * SIZE, past)
        work += float(answer.load @ (answer.past.plastic - past.plastic))
        heat, before = law.dissipated(answer.past), law.dissipated(past)
        assert heat >= before
        assert law.largest_plastic_strain(answer.past) >= law.largest_plastic_strain(past)
        # What plastic work has not become heat is stored in back and residual stresses.
        assert work >= heat * (1 - 1e-9) - 1e-15
        past = answer.past


@both
@given(load=arrays(np.float64, 4, elements=st.floats(-0.25, 0.25)))
@settings(deadline=None, max_examples=30)
def test_nothing_flows_within_first_yield(law: SectionLaw, load: Floats) -> None:
    w, dp, f = flow(law, load * SIZE, law.start())
    assert w == 0
    assert not dp.any()
    assert not f.any()
    np.testing.assert_allclose(
        law.under(load * SIZE, law.start()).strain, law.elastic * load * SIZE, rtol=1e-15, atol=1e-300
    )


@both
@pytest.mark.parametrize("kinematic", [0.0, 0.4, 1.0])
def test_unload_and_reload_closes(law: SectionLaw, kinematic: float) -> None:
    law = replace(law, kinematic=kinematic, curve=BENT_CURVE)
    for seed in range(8):
        load = np.random.default_rng(seed).standard_normal(4)
        load *= 0.95 * SIZE / np.linalg.norm(load)
        there = law.under(load, law.start())
        assert law.dissipated(there.past) > 0
        back = law.under(0.3 * load, there.past)
        again = law.under(load, back.past)
        np.testing.assert_allclose(again.strain, there.strain, rtol=1e-12, atol=1e-16)
        np.testing.assert_allclose(again.past.row, there.past.row, rtol=1e-12, atol=1e-12)


@both
@pytest.mark.parametrize("component", [1, 3])
def test_loops_close(law: SectionLaw, component: int) -> None:
    """Without isotropic hardening a cycle of bending or twist comes back to where it began (Masing)."""
    law = replace(law, kinematic=1.0)
    load = 0.9 * SIZE * np.eye(4)[component]
    first = law.under(load, law.start())
    back = law.under(-load, first.past)
    again = law.under(load, back.past)
    np.testing.assert_allclose(again.strain, first.strain, rtol=1e-9, atol=1e-16)
    np.testing.assert_allclose(back.strain, -first.strain, rtol=1e-9, atol=1e-16)


@both
@pytest.mark.parametrize("curve", [LINEAR, BENT_CURVE], ids=["linear", "bent"])
@pytest.mark.parametrize("steps", [1, 7])
def test_a_pulled_wire_follows_the_flow_curve(law: SectionLaw, curve: Floats, steps: int) -> None:
    law = replace(law, curve=curve)
    past = law.start()
    for force in np.linspace(0, 320, steps + 1)[1:] * AREA:
        answer = law.under(np.array([force, 0, 0, 0]), past)
        past = answer.past
    plastic = 115 / 2500 if curve is LINEAR else 0.04
    wanted = [320 / WIRE[0] + plastic, 0, 0, 0]
    np.testing.assert_allclose(answer.strain, wanted, rtol=1e-11, atol=1e-14)
    assert law.largest_plastic_strain(past) == pytest.approx(plastic, rel=1e-11)
    end = law.at(np.array([wanted[0], np.nan, np.nan, np.nan]), law.start())
    np.testing.assert_allclose(end.load, [320 * AREA, 0, 0, 0], rtol=1e-10, atol=1e-12)


@both
@pytest.mark.parametrize(("kinematic", "reverse"), [(0.0, -240.0), (1.0, 240.0 - 2 * 205), (0.5, 35 / 2 - 222.5)])
def test_bauschinger(law: SectionLaw, kinematic: float, reverse: float) -> None:
    """Pulled to 240 MPa, a wire yields again at minus that, at 240 - 2 · 205, or midway."""
    law = replace(law, kinematic=kinematic)
    past = law.under(np.array([240 * AREA, 0, 0, 0]), law.start()).past
    assert flow(law, np.array([reverse * AREA * (1 - 1e-9), 0, 0, 0]), past)[0] == 0
    assert flow(law, np.array([reverse * AREA - 0.01, 0, 0, 0]), past)[0] > 0


@both
@settings(deadline=None, max_examples=25)
@given(parts, st.floats(0.5, 3), st.floats(1, 1.5))
def test_scaling(law: SectionLaw, part: Floats, factor: float, stretch: float) -> None:
    """A thicker wire under the same stresses flows alike; a stretched wire is a thinner one."""
    load = 1.3 * part * SIZE
    thick = replace(law, wire=WIRE * [1, 1, factor])
    by = np.array([1, 1 / factor, 1 / factor, 1 / factor])
    w, dp, f = flow(law, load, law.start())
    w_thick, dp_thick, f_thick = flow(thick, load * factor**2 / by, law.start())
    assert w_thick == pytest.approx(w * factor**2, rel=1e-8, abs=1e-12)
    np.testing.assert_allclose(dp_thick, dp * by, rtol=1e-7, atol=1e-13)
    np.testing.assert_allclose(f_thick, f * by * by[:, None] / factor**2, rtol=1e-5, atol=1e-12)
    stretched, thin = replace(law, stretch=stretch), replace(law, wire=WIRE * [1, 1, 1 / sqrt(stretch)])
    assert flow(stretched, load, law.start())[0] == pytest.approx(flow(thin, load, law.start())[0], rel=1e-8, abs=1e-12)
    np.testing.assert_allclose(stretched.elastic, thin.elastic, rtol=1e-13)


@both
def test_a_quarter_turn_of_the_section(law: SectionLaw) -> None:
    turn = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    past = turned = law.start()
    rng = np.random.default_rng(8)
    for _ in range(4):
        load = rng.uniform(-0.6, 0.6, 4) * SIZE
        answer, other = law.under(load, past), law.under(turn @ load, turned)
        np.testing.assert_allclose(other.strain, turn @ answer.strain, rtol=1e-9, atol=1e-14)
        np.testing.assert_allclose(other.compliance, turn @ answer.compliance @ turn.T, rtol=1e-6, atol=1e-12)
        past, turned = answer.past, other.past


@both
def test_strain_and_load_are_inverse(law: SectionLaw) -> None:
    for seed in range(10):
        past, load = some_past(law, seed)
        answer = law.under(load, past)
        found = law.at(answer.strain, past)
        np.testing.assert_allclose(found.load / SIZE, load / SIZE, rtol=0, atol=1e-8)
        np.testing.assert_allclose(found.past.row, answer.past.row, rtol=1e-6, atol=1e-5)


@both
@pytest.mark.parametrize("curve", [PERFECT, LINEAR, BENT_CURVE], ids=["perfect", "linear", "bent"])
def test_smaller_steps_come_to_one_answer(law: SectionLaw, curve: Floats) -> None:
    """Bent, then twisted: a path with a corner, the error of the implicit steps falls with their number."""
    law = replace(law, curve=curve, kinematic=0.3)
    ends = []
    for steps in (2, 8, 32, 128):
        past = law.start()
        for twist in np.linspace(0, 0.03, steps + 1):
            answer = law.at(np.array([np.nan, 1 / 50, 0, twist]), past)
            past = answer.past
        ends.append(answer.load[[1, 3]] / SIZE[[1, 3]])
    off = [float(np.abs(one - two).max()) for one, two in pairwise(ends)]
    assert off[0] < 0.1
    assert off[1] < 0.4 * off[0]
    assert off[2] < 0.4 * off[1]


@both
def test_far_too_great_loads_still_have_an_answer(law: SectionLaw) -> None:
    law = replace(law, curve=PERFECT)
    for seed in range(8):
        load = np.random.default_rng(seed).standard_normal(4) * 30 * SIZE
        w, dp, f = flow(law, load, law.start())
        assert np.isfinite(w)
        assert w > 0
        assert np.isfinite(dp).all()
        assert np.linalg.eigvalsh(f * SIZE * SIZE[:, None]).min() >= -1e-9 * np.abs(f * SIZE * SIZE[:, None]).max()


def test_no_answer_is_told() -> None:
    assert flow(FIBRES, np.full(4, np.nan), FIBRES.start())[0] == np.inf
    with pytest.raises((NoEquilibrium, np.linalg.LinAlgError)):
        RESULTANTS.at(np.array([np.inf, 0, 0, 0]), RESULTANTS.start())


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"wire": np.array([193e3, 75e3, -0.75])}, "all positive"),
        ({"wire": np.array([193e3, 0.75])}, "all positive"),
        ({"curve": np.array([[0.0, 205.0]])}, "at least two rows"),
        ({"curve": np.array([[0.0, 205.0, 1.0], [1.0, 300.0, 1.0]])}, "at least two rows"),
        ({"curve": np.array([[0.01, 205.0], [1.0, 300.0]])}, "begins with the strain 0"),
        ({"curve": np.array([[0.0, 205.0], [0.0, 300.0]])}, "must grow"),
        ({"curve": np.array([[0.0, 205.0], [1.0, 205.0]])}, "must rise"),
        ({"kinematic": 1.2}, "between 0 and 1"),
        ({"kinematic": np.nan}, "between 0 and 1"),
        ({"stretch": 0.0}, "a stretch is positive"),
        ({"points": np.array([[0.0, 0.0, 1.0]])}, "no circle of unit diameter"),
    ],
)
def test_wrong_input_is_told(wrong: dict[str, Floats], told: str) -> None:
    with pytest.raises(InputError, match=told):
        replace(RESULTANTS, **wrong)  # type: ignore[arg-type]
