"""The paper's Table 1: where it comes from, Eq. (2.3), and how its axes turn into ours, Eq. (2.2)."""

from __future__ import annotations

import numpy as np
import pytest

from punchform.arrays import Floats
from punchform.wire import cosine_line, flexibility, inverse, paper, round_section

ENTRIES = ("11", "13", "33", "15", "35", "55", "22", "24", "26", "44", "46", "66")
COWPER = 6 * (1 + 0.25) / (7 + 6 * 0.25)


def printed() -> Floats:
    table = np.array(paper.TABLE_1)
    symmetric: Floats = 0.5 * (table + table.T)
    return symmetric


def deviations(*, segments: int, youngs_modulus: float = 210e3, shear_factor: float = 0.9) -> list[float]:
    """Ours over the print, less one, for the twelve entries [%]."""
    section = round_section(0.75, youngs_modulus=youngs_modulus, poisson=0.25, shear_factor=shear_factor)
    C = paper.to_paper_axes(inverse(flexibility(cosine_line(0.75, 7.5, segments=segments), section)))
    ratio = C / printed()
    return [100 * float(ratio[int(name[0]) - 1, int(name[1]) - 1] - 1) for name in ENTRIES]


def test_table_1_is_eight_chords() -> None:
    assert max(np.abs(deviations(segments=8))) < 0.75


def test_table_1_is_closer_with_211_gpa() -> None:
    assert max(np.abs(deviations(segments=8, youngs_modulus=211e3))) < 0.26


def test_no_other_number_of_chords_explains_table_1() -> None:
    worst = {n: max(np.abs(deviations(segments=n, youngs_modulus=211e3))) for n in (6, 7, 8, 9, 10, 64)}
    assert min(worst, key=lambda n: worst[n]) == 8


@pytest.mark.parametrize(
    ("segments", "shear_factor", "wanted"),
    [
        (8, 0.9, [-0.55, -0.59, -0.55, -0.54, -0.72, -0.54, -0.38, -0.39, -0.39, -0.43, -0.39, -0.48]),
        (4000, COWPER, [0.97, 0.51, -0.72, 1.49, 7.03, -0.02, -0.47, -0.47, -0.47, -0.50, -0.47, -0.49]),
    ],
    ids=["8 segments", "closed form"],
)
def test_golden_deviations_from_the_print(segments: int, shear_factor: float, wanted: list[float]) -> None:
    """Two rows of an independent code, in %, to the digits given."""
    np.testing.assert_allclose(deviations(segments=segments, shear_factor=shear_factor), wanted, atol=0.0051)


def test_the_axial_stiffness_is_along_x_and_near_its_bound() -> None:
    C = paper.to_element_axes(printed())
    area = np.pi * 0.75**2 / 4
    assert C[0, 0] == pytest.approx(11810.0)
    assert 0.9 < C[0, 0] / (210e3 * area / 7.5) < 1.0


def test_the_way_to_element_axes_is_a_rotation_of_forces_and_moments_alike() -> None:
    """Power of forces over motions and the cross product r × P survive it."""
    unit = np.outer([1e-3] * 3 + [1.0] * 3, [1.0] * 3 + [1e3] * 3)
    turn = np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]])
    assert np.linalg.det(turn) == pytest.approx(1.0)
    probe = np.arange(36.0).reshape(6, 6)
    block = np.kron(np.eye(2), turn)
    np.testing.assert_allclose(paper.to_element_axes(probe), block @ (probe * unit) @ block.T)


def test_axes_there_and_back() -> None:
    table = np.array(paper.TABLE_1)
    np.testing.assert_allclose(paper.to_paper_axes(paper.to_element_axes(table)), table, rtol=1e-14)
    C = paper.to_element_axes(printed())
    identity = paper.to_paper_axes(C) @ paper.flexibility_to_paper_axes(inverse(C))
    np.testing.assert_allclose(identity, np.eye(6), atol=1e-7)
