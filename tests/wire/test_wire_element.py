"""From the [wire] section to the element of each family, and what it refuses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from punchform.case import WireCase
from punchform.errors import InputError
from punchform.wire import (
    Element,
    cosine_line,
    flexibility,
    given,
    inverse,
    paper,
    round_section,
    stiffness,
    straight_wire,
)
from punchform.wire.centreline import line_through

STEEL: dict[str, Any] = {"diameter": 0.75, "youngs_modulus": 210e3, "poisson": 0.25, "shear_factor": 0.9}
SECTION = round_section(0.75, youngs_modulus=210e3, poisson=0.25, shear_factor=0.9)
COSINE = {"kind": "cosine", "height": 0.75, "segments": 64}


def wire(**values: Any) -> WireCase:
    return WireCase.model_validate(values)


def message(error: pytest.ExceptionInfo[InputError]) -> str:
    assert len(error.value.problems) == 1
    return str(error.value)


def test_check_case() -> None:
    first, second = stiffness(wire(**STEEL, centreline=COSINE), (7.5, 7.5))
    assert first is second
    assert (first.height, first.length, first.section) == (0.75, 7.5, SECTION)
    assert first.centreline is not None
    assert len(first.centreline.lengths) == 64
    np.testing.assert_array_equal(first.C, inverse(flexibility(cosine_line(0.75, 7.5, segments=64), SECTION)))
    np.testing.assert_allclose(first.C @ first.B, np.eye(6), atol=1e-10)
    assert (first.eigenvalues > 0).all()
    assert first.asymmetry < 1e-15
    with pytest.raises(ValueError, match="read-only"):
        first.C[0, 0] = 0


def test_unequal_steps_give_two_elements() -> None:
    first, second = stiffness(wire(**STEEL, centreline=COSINE), (7.5, 6.0))
    assert (first.length, second.length) == (7.5, 6.0)
    assert second.height == 0.75
    assert second.C[0, 0] > first.C[0, 0]


def test_stacked_straight_wires_lie_apart_and_stay_straight() -> None:
    element, _ = stiffness(wire(**STEEL, centreline={"kind": "straight", "height": 0.75}), (7.5, 7.5))
    assert element.height == 0.75
    np.testing.assert_allclose(element.C, straight_wire(7.5, SECTION), rtol=1e-12, atol=1e-12)


def test_points_are_any_polyline() -> None:
    points = cosine_line(0.75, 7.5, segments=20).points + np.array([0.0, 0.0, 3.0])
    flat = {"kind": "points", "points": points[:, [0, 2]].tolist()}
    full = {"kind": "points", "points": points.tolist()}
    wanted = inverse(flexibility(cosine_line(0.75, 7.5, segments=20), SECTION))
    for line in (flat, full):
        element, _ = stiffness(wire(**STEEL, centreline=line), (7.5, 7.5))
        assert element.height == pytest.approx(0.75)
        np.testing.assert_allclose(element.C, wanted, rtol=1e-10, atol=1e-9)


def test_table_1_as_printed() -> None:
    element, _ = stiffness(wire(stiffness="paper"), (7.5, 7.5))
    assert element.height == 0.75
    assert element.section is None
    assert element.centreline is None
    table = np.array(paper.TABLE_1)
    np.testing.assert_allclose(paper.to_paper_axes(element.C), 0.5 * (table + table.T), rtol=1e-14)


def test_a_matrix_is_taken_as_it_is() -> None:
    C = inverse(flexibility(cosine_line(0.75, 7.5, segments=8), SECTION))
    element, _ = stiffness(wire(diameter=0.75, stiffness=C.tolist(), height=0.6), (7.5, 7.5))
    np.testing.assert_array_equal(element.C, C)
    assert element.height == 0.6


def test_table_1_holds_for_its_own_step_only() -> None:
    with pytest.raises(InputError) as error:
        stiffness(wire(stiffness="paper"), (6.0, 6.0))
    assert "step of 7.5 mm, not 6 mm" in message(error)


def test_one_matrix_cannot_serve_two_steps() -> None:
    with pytest.raises(InputError) as error:
        stiffness(wire(stiffness="paper"), (7.5, 6.0))
    assert "two lengths (7.5 and 6 mm)" in message(error)


def test_a_height_that_contradicts_the_centreline() -> None:
    with pytest.raises(InputError) as error:
        stiffness(wire(**STEEL, centreline=COSINE, height=0.5), (7.5, 7.5))
    assert "wire.height: the height is 0.5 mm, but the centreline says 0.75 mm" in message(error)


@pytest.mark.parametrize(
    ("points", "said"),
    [
        ([(0, 0)], "at least 2 points"),
        ([(0, 0), (7.5, 0, 0)], "same 2 or 3 numbers"),
        ([(0, 0), (float("nan"), 0), (7.5, 0)], "point 2 is not a finite number"),
        ([(0.5, 0), (7.5, 0.75)], "must be at x = 0, not 0.5 mm"),
        ([(0, 0), (7, 0.75)], "must be at x = 7.5 mm, the step, not 7 mm"),
        ([(0, 0, 0), (7.5, 0.2, 0.75)], "same y"),
        ([(0, 0.75), (7.5, 0)], "must rise"),
        ([(0, 0), (3, 0.2), (3, 0.2), (7.5, 0.75)], "points 2 and 3 are the same"),
    ],
)
def test_points_that_do_not_fit(points: list[tuple[float, ...]], said: str) -> None:
    with pytest.raises(InputError) as error:
        line_through(points, 7.5)
    assert said in message(error)
    assert message(error).startswith("error: wire.centreline.points: ")


def test_a_cosine_needs_a_segment() -> None:
    with pytest.raises(InputError, match="at least 1"):
        cosine_line(0.75, 7.5, segments=0)


def changed(row: int, column: int, value: float) -> Element:
    C = straight_wire(7.5, SECTION)
    C[row, column] = value
    return given(C, height=0.0, length=7.5)


def test_symmetry_is_demanded_to_a_millionth() -> None:
    wanted = straight_wire(7.5, SECTION)
    entry = wanted[1, 5]
    assert changed(1, 5, entry * (1 + 1e-7)).asymmetry == pytest.approx(1e-7, rel=0.2)
    with pytest.raises(InputError) as error:
        changed(1, 5, entry * (1 + 1e-4))
    assert "not symmetric: row 2, column 6" in message(error)


def test_a_negative_diagonal_is_named() -> None:
    with pytest.raises(InputError) as error:
        changed(3, 3, -1.0)
    assert "C44 = -1 (twist about the wire) must be positive" in message(error)


def test_a_negative_eigenvalue_is_named() -> None:
    C = straight_wire(7.5, SECTION)
    C[0, 3] = C[3, 0] = 1.1 * np.sqrt(C[0, 0] * C[3, 3])
    with pytest.raises(InputError) as error:
        given(C, height=0.0, length=7.5)
    said = message(error)
    assert "smallest of the 6 eigenvalues is -" in said
    assert "its motion is mostly twist about the wire" in said
    assert np.linalg.eigvalsh(C).min() < 0


def test_a_matrix_of_another_size_or_with_holes() -> None:
    with pytest.raises(InputError, match="6 rows of 6 numbers"):
        given(np.eye(5), height=0.0, length=7.5)
    with pytest.raises(InputError, match="finite"):
        changed(0, 0, float("inf"))
