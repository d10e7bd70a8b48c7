"""Unit loads along a centreline, Eq. (2.4): closed forms, orders, symmetries, limits."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from punchform.arrays import Floats
from punchform.wire import (
    Centreline,
    Section,
    cosine_line,
    deflections,
    flexibility,
    inverse,
    line_through,
    round_section,
    straight_line,
    straight_wire,
)
from punchform.wire.flexibility import asymmetry, section_loads

STEEL = round_section(0.75, youngs_modulus=210e3, poisson=0.25, shear_factor=0.9)
# Rigidities without the ties of a round section: an error in one of them cannot hide behind another.
ODD = Section(diameter=0.7, EA=310.0, EI=23.0, GJ=7.0, kappa_GA=55.0)

coordinates = st.floats(-2.0, 2.0)
polylines = st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=0, max_size=8).map(
    lambda middle: Centreline(
        np.array(
            [
                [0.0, 0.0, 0.0],
                *((1.0 + k + 0.2 * x, y, z) for k, (x, y, z) in enumerate(middle)),
                [10, 0, 1.0],
            ]
        )
    )
)


def quarter_circle(R: float, s: Section) -> Floats:
    """Flexibility of a quarter of a circle that leaves O along x and arrives at A along z."""
    pi = np.pi
    B = np.zeros((6, 6))
    B[0, 0] = R * pi / 4 * (1 / s.EA + 1 / s.kappa_GA) + R**3 * pi / 4 / s.EI
    B[2, 2] = R * pi / 4 * (1 / s.EA + 1 / s.kappa_GA) + R**3 * (3 * pi / 4 - 2) / s.EI
    B[0, 2] = R / 2 * (1 / s.EA - 1 / s.kappa_GA) - R**3 / 2 / s.EI
    B[4, 4] = R * pi / 2 / s.EI
    B[0, 4] = R**2 / s.EI
    B[2, 4] = -(R**2) * (pi / 2 - 1) / s.EI
    B[1, 1] = R * pi / 2 / s.kappa_GA + R**3 * ((3 * pi / 4 - 2) / s.GJ + pi / 4 / s.EI)
    B[3, 3] = B[5, 5] = R * pi / 4 * (1 / s.GJ + 1 / s.EI)
    B[1, 3] = -(R**2) / 2 * (1 / s.GJ + 1 / s.EI)
    B[1, 5] = R**2 * ((pi / 4 - 1) / s.GJ + pi / 4 / s.EI)
    B[3, 5] = R / 2 * (1 / s.GJ - 1 / s.EI)
    return B + np.triu(B, 1).T


def arc(R: float, chords: int) -> Centreline:
    angle = np.linspace(0, np.pi / 2, chords + 1)
    return Centreline(R * np.column_stack([np.sin(angle), 0 * angle, 1 - np.cos(angle)]))


def relative(B: Floats, wanted: Floats) -> float:
    """Largest difference of two matrices, on the scale of their diagonals."""
    scale = np.sqrt(np.diag(wanted))
    return float((np.abs(B - wanted) / np.outer(scale, scale)).max())


def test_round_section() -> None:
    assert pytest.approx(210e3 * np.pi * 0.140625) == STEEL.EA
    assert pytest.approx(210e3 * np.pi * 0.75**4 / 64) == STEEL.EI
    assert pytest.approx(1 / 1.25) == STEEL.GJ / STEEL.EI
    assert STEEL.kappa_GA / STEEL.EA == pytest.approx(0.9 / 2.5)
    assert STEEL.area * 0.75 / 8 == pytest.approx(STEEL.bending_modulus)
    assert STEEL.twisting_modulus == pytest.approx(2 * STEEL.bending_modulus)


@pytest.mark.parametrize("section", [STEEL, ODD], ids=["steel", "odd"])
def test_straight_wire_is_the_textbook_beam(section: Section) -> None:
    L = 7.5
    B = flexibility(straight_line(L), section)
    assert B[2, 2] == pytest.approx(L**3 / (3 * section.EI) + L / section.kappa_GA)
    assert B[1, 5] == pytest.approx(L**2 / (2 * section.EI))
    assert B[2, 4] == pytest.approx(-(L**2) / (2 * section.EI))
    np.testing.assert_allclose(inverse(B), straight_wire(L, section), rtol=1e-12, atol=1e-12)


def test_a_wire_with_hardly_any_crimp_is_straight() -> None:
    """The difference is of second order in h on the diagonal, of first order beside it."""
    wanted = flexibility(straight_line(7.5), ODD)
    errors = [relative(flexibility(cosine_line(h, 7.5, segments=16), ODD), wanted) for h in (0.002, 0.001)]
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.02)
    assert errors[1] < 0.003


@pytest.mark.parametrize("section", [STEEL, ODD], ids=["steel", "odd"])
def test_quarter_circle_is_approached_with_the_square_of_the_chords(section: Section) -> None:
    wanted = quarter_circle(5.0, section)
    errors = [relative(flexibility(arc(5.0, n), section), wanted) for n in (20, 40, 80)]
    assert errors[2] < 3e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.01)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.005)


def test_two_gauss_points_are_exact_on_a_chord() -> None:
    """Cutting the chords changes nothing but rounding."""
    line = cosine_line(0.75, 7.5, segments=5)
    cut = np.linspace(line.points[:-1], line.points[1:], 7, endpoint=False).transpose(1, 0, 2).reshape(-1, 3)
    finer = Centreline(np.vstack([cut, line.tip]))
    assert relative(flexibility(finer, ODD), flexibility(line, ODD)) < 1e-14


@given(polylines)
def test_any_wire_has_a_symmetric_positive_definite_stiffness(line: Centreline) -> None:
    B = flexibility(line, STEEL)
    assert asymmetry(B).max() < 1e-14
    C = inverse(B)
    assert (C == C.T).all()
    assert np.linalg.eigvalsh(C * np.outer([1, 1, 1, 0.1, 0.1, 0.1], [1, 1, 1, 0.1, 0.1, 0.1])).min() > 0
    np.testing.assert_allclose(C @ B, np.eye(6), atol=1e-7)


@given(polylines)
def test_end_forces_are_in_equilibrium_whichever_end_is_held(line: Centreline) -> None:
    """With A held and O loaded the same wire has B' = G B Gᵀ, G the rigid motion from A to O."""
    turned = Centreline(line.points[::-1] - line.tip)
    G = section_loads(line.tip[None])[0].T
    G[:3, 3:] *= -1
    x, y, z = line.tip
    np.testing.assert_array_equal(G[:3, 3:], [[0, -z, y], [z, 0, -x], [-y, x, 0]])
    # D at O seen from A is −(Δ + L × φ, φ); the two signs cancel in G B Gᵀ.
    wanted = G @ flexibility(line, ODD) @ G.T
    assert relative(flexibility(turned, ODD), wanted) < 1e-12


@given(polylines, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_turning_the_axes_turns_the_flexibility(line: Centreline, first: float, second: float) -> None:
    about_z = np.array([[np.cos(first), -np.sin(first), 0], [np.sin(first), np.cos(first), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(second), -np.sin(second)], [0, np.sin(second), np.cos(second)]])
    turn = about_z @ about_x
    block = np.kron(np.eye(2), turn)
    turned = flexibility(Centreline(line.points @ turn.T), ODD)
    scale = np.repeat([flexibility(line, ODD)[k : k + 3, k : k + 3].trace() for k in (0, 3)], 3) ** 0.5
    wrong = np.abs(turned - block @ flexibility(line, ODD) @ block.T) / np.outer(scale, scale)
    assert wrong.max() < 1e-12


def test_a_wire_that_falls_is_the_mirror_image_of_one_that_rises() -> None:
    """z → −z turns the signs of P_z, M_x, M_y: what the weave sign σ does in Eq. (3.2)."""
    rises, falls = cosine_line(0.75, 7.5, segments=9), cosine_line(-0.75, 7.5, segments=9)
    mirror = np.diag([1.0, 1, -1, -1, -1, 1])
    np.testing.assert_allclose(flexibility(falls, ODD), mirror @ flexibility(rises, ODD) @ mirror, rtol=1e-13)


@given(st.floats(0.2, 5.0), st.floats(0.2, 5.0))
@settings(max_examples=20)
def test_scale_laws(size: float, hardness: float) -> None:
    """All lengths × k and E × c: forces per displacement × k c, moments × k² c, per rotation × k³ c."""
    steel = round_section(0.75 * size, youngs_modulus=210e3 * hardness, poisson=0.25, shear_factor=0.9)
    C = inverse(flexibility(cosine_line(0.75 * size, 7.5 * size, segments=12), steel))
    before = inverse(flexibility(cosine_line(0.75, 7.5, segments=12), STEEL))
    lengths = np.repeat([1.0, size], 3)
    np.testing.assert_allclose(C, before * hardness * size * np.outer(lengths, lengths), rtol=1e-9, atol=1e-9)


def test_smooth_crimp_is_approached_with_the_square_of_the_segments() -> None:
    B = [flexibility(cosine_line(0.75, 7.5, segments=n), STEEL) for n in (32, 64, 128, 256)]
    steps = [relative(a, b) for a, b in pairwise(B)]
    np.testing.assert_allclose(np.log2(np.divide(steps[:-1], steps[1:])), 2, atol=0.01)


def test_a_stiff_wire_still_stretches_through_its_crimp() -> None:
    hard = replace(STEEL, EA=1e12)
    straight = flexibility(straight_line(7.5), hard)[0, 0]
    crimped = flexibility(cosine_line(0.75, 7.5, segments=64), hard)[0, 0]
    assert straight < 1e-11
    assert crimped > 1e-4


@given(polylines)
def test_the_last_deflection_is_the_flexibility(line: Centreline) -> None:
    motions = deflections(line, ODD)
    assert motions.shape == (len(line.points), 6, 6)
    assert not motions[0].any()
    scale = np.sqrt(np.diag(flexibility(line, ODD)))
    wrong = np.abs(motions[-1] - flexibility(line, ODD)) / np.outer(scale, scale)
    assert wrong.max() < 1e-12


def test_deflections_of_a_cantilever_follow_its_elastic_line() -> None:
    L, x = 10.0, np.linspace(0, 10.0, 11)
    line = line_through(np.column_stack([x, 0 * x]).tolist(), L)
    motions = deflections(line, ODD)
    elastic = x**2 * (3 * L - x) / (6 * ODD.EI) + x / ODD.kappa_GA
    np.testing.assert_allclose(motions[:, 2, 2], elastic, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(motions[:, 1, 5], x**2 / (2 * ODD.EI), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(motions[:, 0, 0], x / ODD.EA, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(motions[:, 3, 3], x / ODD.GJ, rtol=1e-12, atol=1e-13)
