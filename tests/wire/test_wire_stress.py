"""The largest stress in a wire from the force at its end: textbook cases and statics."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given as for_all
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from punchform.arrays import Floats
from punchform.wire import (
    Element,
    along,
    cosine_line,
    given,
    line_through,
    round_section,
    straight_line,
    stress,
)
from punchform.wire.stress import CHUNK

STEEL = round_section(0.75, youngs_modulus=210e3, poisson=0.25, shear_factor=0.9)
STRAIGHT = along(straight_line(7.5), STEEL)
WOVEN = along(cosine_line(0.75, 7.5, segments=64), STEEL)
forces = arrays(np.float64, (3, 6), elements=st.floats(-100, 100))


def dense(element: Element, F: Floats) -> float:
    """The same statics for one F at 10 places on every chord, written out slowly."""
    line, section = element.centreline, element.section
    assert line is not None
    assert section is not None
    worst = 0.0
    for a, b, t in zip(line.points[:-1], line.points[1:], line.tangents, strict=True):
        for place in np.linspace(a, b, 10):
            moment = F[3:] + np.cross(line.tip - place, F[:3])
            twist = moment @ t
            bend = np.linalg.norm(moment - twist * t)
            sigma = abs(F[:3] @ t) / section.area + bend / section.bending_modulus
            worst = max(worst, float(np.hypot(sigma, np.sqrt(3) * twist / section.twisting_modulus)))
    return worst


def test_textbook_cases() -> None:
    loads = np.diag([2.0, 3.0, 3.0, 4.0, 5.0, 5.0])
    area, W, W_t = STEEL.area, STEEL.bending_modulus, STEEL.twisting_modulus
    wanted = [2 / area, 3 * 7.5 / W, 3 * 7.5 / W, np.sqrt(3) * 4 / W_t, 5 / W, 5 / W]
    np.testing.assert_allclose(stress(STRAIGHT, loads), wanted, rtol=1e-13)


@for_all(forces)
def test_statics_at_every_point_of_few_chords(F: Floats) -> None:
    element = along(line_through([(0, 0, 0), (2, 0.3, 0.1), (5, -0.2, 0.6), (7.5, 0, 0.75)], 7.5), STEEL)
    np.testing.assert_allclose(stress(element, F), [dense(element, row) for row in F], rtol=1e-12, atol=1e-12)


def test_nine_points_of_a_smooth_wire_are_enough() -> None:
    F = np.random.default_rng(3).normal(size=(15, 6)) * [50, 3, 3, 20, 20, 20]
    wanted = np.array([dense(WOVEN, row) for row in F])
    np.testing.assert_allclose(stress(WOVEN, F), wanted, rtol=0.02)


@for_all(forces, st.floats(0, 10))
def test_stress_grows_with_the_force_and_has_no_sign(F: Floats, factor: float) -> None:
    np.testing.assert_allclose(stress(WOVEN, -factor * F), factor * stress(WOVEN, F), rtol=1e-12, atol=1e-12)


def test_chunks_do_not_show() -> None:
    F = np.random.default_rng(4).normal(size=(CHUNK + 3, 6))
    together = stress(WOVEN, F)
    np.testing.assert_allclose(together[CHUNK - 2 :], stress(WOVEN, F[CHUNK - 2 :]), rtol=1e-12)


def test_no_elements_no_stresses() -> None:
    assert stress(WOVEN, np.zeros((0, 6))).shape == (0,)


def test_a_matrix_has_no_stress() -> None:
    assert np.isnan(stress(given(np.array(WOVEN.C), height=0.75, length=7.5), np.ones((4, 6)))).all()


def test_a_crimped_wire_in_tension_bends() -> None:
    """With its end guided, as between crossings, pulling 0.1 % strains it far beyond E × 0.1 %."""
    F = WOVEN.C @ [0.0075, 0, 0, 0, 0, 0]
    assert stress(WOVEN, F[None])[0] > 1.2 * 210.0
    assert stress(STRAIGHT, (STRAIGHT.C @ [0.0075, 0, 0, 0, 0, 0])[None])[0] == pytest.approx(210.0)
