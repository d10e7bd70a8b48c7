"""What --over asks for: lists and ranges with units, words, whole numbers; all combinations or a Latin hypercube."""

from __future__ import annotations

import numpy as np
import pytest
import tiny_dish

from punchform.errors import InputError
from punchform.optimise.designs import Choice, Span, combinations, hypercube, variation

CASE = tiny_dish.case()


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("wire.diameter=0.5 mm, 0.6 mm,0.0007 m", (0.5, 0.6, 0.7)),
        ("wire.diameter = 0.5", (0.5,)),
        ("grid.step=5 mm:10 mm:6", (5.0, 6.0, 7.0, 8.0, 9.0, 10.0)),
        ("grid.step=0.1:0.4:4", (0.1, 0.2, 0.3, 0.4)),
        ("grid.crossing=pinned,welded", ("pinned", "welded")),
        ("wire.material=304 annealed,Al 5056-O", ("304 annealed", "Al 5056-O")),
        ("grid.subdivide=1:3:3", (1, 2, 3)),
        ("wire.youngs_modulus=200 GPa,30e6 psi", (200e3, 206842.71879504)),
        ("press.strokes=2,4", (2.0, 4.0)),
        ("target.taper=6,12", (6.0, 12.0)),
    ],
)
def test_lists_and_ranges_are_in_internal_units(text: str, values: tuple[object, ...]) -> None:
    found = variation(CASE, text)
    assert isinstance(found, Choice)
    assert found.values == pytest.approx(values) if isinstance(values[0], float) else found.values == values


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("wire.diameter", "does not say which setting takes which values"),
        ("wire.diameter=", "does not say which setting"),
        ("=1 mm", "does not say which setting"),
        ("wire.diametr=1 mm", r"wire\.diametr: the case has no such setting"),
        ("wire.diameter=1 kg", "expected a length such as '0.75 mm', not '1 kg'"),
        ("wire.diameter=thick", "expected a length"),
        ("wire.diameter=1 mm,,2 mm", "a value is missing"),
        ("wire.diameter=1 mm,0.1 cm", "given twice"),
        ("wire.diameter=2 mm:1 mm:3", "2 mm is not less than 1 mm"),
        ("wire.diameter=1 mm:2 mm:3:4", "neither a list nor a range"),
        ("wire.diameter=1 mm:2 mm,3 mm", "neither a list nor a range"),
        ("wire.diameter=1 mm:", "neither a list nor a range"),
        ("wire.diameter=1 mm:2 mm:one", "the count of a range is 2"),
        ("wire.diameter=1 mm:2 mm:1", "the count of a range is 2"),
        ("grid.crossing=pined", "did you mean `pinned`"),
        ("grid.crossing=pinned:welded:2", "is not a number"),
        ("grid.subdivide=1.5", "expected a whole number, not '1.5'"),
        ("grid.subdivide=1:4:3", "are no whole numbers"),
        ("punch.profile=flat", "profile"),
    ],
)
def test_what_cannot_be_is_told(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        variation(CASE, text)


def test_all_combinations_the_last_varying_fastest() -> None:
    over = [variation(CASE, "wire.diameter=0.5,0.6"), variation(CASE, "grid.crossing=pinned,welded")]
    assert [tuple(design.values()) for design in combinations(over)] == [
        (0.5, "pinned"),
        (0.5, "welded"),
        (0.6, "pinned"),
        (0.6, "welded"),
    ]
    with pytest.raises(InputError, match="no --samples are asked for"):
        combinations([variation(CASE, "wire.diameter=0.5:0.6")])
    with pytest.raises(InputError, match="is varied twice"):
        combinations([over[0], over[0]])
    with pytest.raises(InputError, match="a sweep has at most 1000000"):
        combinations([variation(CASE, "wire.diameter=0.5:0.6:1000"), variation(CASE, "grid.step=5:6:1001")])


def test_a_latin_hypercube_has_one_sample_in_every_slice() -> None:
    """Eq. (13.51): of n samples one lies in each n-th part of every range; lists and whole numbers share evenly."""
    over = [
        variation(CASE, "wire.diameter=0.5 mm:1 mm"),
        variation(CASE, "grid.crossing=pinned,welded"),
        variation(CASE, "grid.subdivide=1:4"),
    ]
    assert over[2] == Span("grid.subdivide", 1, 4, whole=True)
    n = 40
    designs = list(hypercube(over, n, np.random.default_rng(3)))
    slices = sorted(int((design["wire.diameter"] - 0.5) / 0.5 * n) for design in designs)
    assert slices == list(range(n))
    assert sum(design["grid.crossing"] == "welded" for design in designs) == n // 2
    assert [sum(design["grid.subdivide"] == k for design in designs) for k in range(1, 5)] == [n // 4] * 4
    again = list(hypercube(over, n, np.random.default_rng(3)))
    assert again == designs
    with pytest.raises(InputError, match="0 samples"):
        hypercube(over, 0, np.random.default_rng(3))


def test_the_ends_of_a_share_are_the_ends_of_a_range() -> None:
    assert [Span("grid.subdivide", 1, 4, whole=True).at(share) for share in (0.0, 0.249, 0.25, 1.0)] == [1, 1, 2, 4]
    assert [Choice("grid.crossing", ("a", "b")).at(share) for share in (0.0, 0.49, 0.5, 1.0)] == ["a", "a", "b", "b"]
