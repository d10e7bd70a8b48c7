"""Variables and designs: what a number of a design means, and that near designs are alike."""

from __future__ import annotations

import numpy as np
import pytest

from punchform.case import VariableCase, number, read_case, setting, varied
from punchform.errors import InputError
from punchform.optimise.space import space_of

CASE = read_case("packaged:design")
VARIABLES = {
    "wire.diameter": VariableCase(least="0.5 mm", most="1 mm"),
    "grid.step": VariableCase(among=("12 mm", "8 mm", "1 cm")),
    "grid.subdivide": VariableCase(least=1, most=3),
    "grid.crossing": VariableCase(among=("pinned", "welded", {"stiffness": "20 N*mm/rad"})),
}
SPACE = space_of(CASE, VARIABLES)


def test_kinds_follow_from_what_stands_at_the_place() -> None:
    kinds = [(one.continuous, len(one.levels), bool(one.positions)) for one in SPACE.variables]
    assert kinds == [(True, 0, False), (False, 3, True), (False, 3, True), (False, 3, False)]
    assert SPACE.variables[1].levels == ("8 mm", "1 cm", "12 mm")
    assert SPACE.variables[1].unit == "mm"
    assert SPACE.size == np.inf


def test_every_design_makes_a_case() -> None:
    designs = SPACE.scattered(12, np.random.default_rng(1))
    for design in designs:
        made = varied(CASE, SPACE.changes(design))
        found = SPACE.of(made)
        assert found is not None
        np.testing.assert_allclose(found, design, atol=1e-9)


def test_a_hypercube_covers_ranges_and_lists_evenly() -> None:
    designs = SPACE.scattered(9, np.random.default_rng(2))
    assert sorted(np.floor(9 * designs[:, 0]).astype(int)) == list(range(9))
    for column in (3,):
        assert np.bincount(designs[:, column].astype(int)).tolist() == [3, 3, 3]


def test_values_are_told_with_few_digits_and_lie_where_they_say() -> None:
    designs = SPACE.scattered(50, np.random.default_rng(3))
    for design in designs:
        value = SPACE.changes(design)["wire.diameter"]
        assert isinstance(value, float)
        assert len(repr(value)) <= 9
        assert (value - 0.5) / 0.5 == pytest.approx(design[0], abs=1e-12)


def test_words_lie_equally_far_apart_and_numbers_by_their_size() -> None:
    design = np.zeros((3, 4))
    words, steps = design.copy(), design.copy()
    words[:, 3], steps[:, 1] = range(3), range(3)
    apart = [np.linalg.norm(np.subtract(*SPACE.features(words)[[a, b]])) for a, b in ((0, 1), (0, 2), (1, 2))]
    np.testing.assert_allclose(apart, 1.0)
    np.testing.assert_allclose(SPACE.features(steps)[:, 1], (0.0, 0.5, 1.0))


def test_a_neighbour_differs_and_a_narrow_one_by_little() -> None:
    designs = np.tile(SPACE.nearest(np.full((1, 4), 0.5)), (400, 1))
    moved = SPACE.near(designs, 0.01, np.random.default_rng(4))
    assert np.abs(moved[:, 0] - designs[:, 0]).max() < 0.05
    assert (moved[:, 1:3] == designs[:, 1:3]).all()
    assert 0 < (moved[:, 3] != designs[:, 3]).mean() < 0.2


def test_an_end_that_other_variables_may_mend_is_allowed() -> None:
    """A blank smaller than the rim is wrong as the case stands, and right with another rim."""
    space = space_of(CASE, {"grid.blank.radius": VariableCase(least="100 mm", most="140 mm")})
    assert space.variables[0].low == 100.0


def test_a_case_outside_of_the_ranges_is_no_design() -> None:
    assert SPACE.of(varied(CASE, {"wire.diameter": 0.4})) is None
    assert SPACE.of(varied(CASE, {"grid.crossing": {"stiffness": 3.0}})) is None


def test_all_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        space_of(CASE, {"wire.x": VariableCase(least=1, most=2), "wire.diameter": VariableCase(least=2, most=1)})
    assert [one.where for one in caught.value.problems] == [
        'optimise.variables."wire.x"',
        'optimise.variables."wire.diameter".to',
    ]


def test_changes_are_numbers_in_internal_units() -> None:
    made = varied(CASE, SPACE.changes(np.array([0.5, 1, 2, 1])))
    assert (number(made, "wire.diameter"), number(made, "grid.step"), made.grid.subdivide) == (0.75, 10.0, 3)
    assert setting(made, "grid.crossing") == "welded"
