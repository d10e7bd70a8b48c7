"""A case with other values at some places: what was left out follows, what cannot be is told with its place."""

from __future__ import annotations

import pytest

from punchform.case import Case, number, read_case, setting, unit, varied, written
from punchform.errors import InputError
from punchform.optimise.figures import FIGURES, figure

STRETCH = read_case("packaged:dish600")


def test_the_same_values_give_the_same_case() -> None:
    """Setting what stands there already changes nothing, for every kind of value."""
    places = ("wire.diameter", "grid.step", "grid.crossing", "punch.profile", "wire.material", "target.tolerance")
    for case in (read_case(f"packaged:{name}") for name in ("check", "paper", "dish600")):
        known = {place: setting(case, place) for place in places}
        assert varied(case, {place: value for place, value in known.items() if value is not None}) == case


def test_what_was_left_out_follows() -> None:
    """The crimp is one diameter, the fillet a tenth of the rim: unless they are given themselves."""
    thick = varied(STRETCH, {"wire.diameter": "0.9 mm"})
    assert number(thick, "wire.centreline.height") == 0.9
    assert number(varied(thick, {"wire.centreline.height": 0.6}), "wire.centreline.height") == 0.6
    assert number(varied(STRETCH, {"wire.material": "Al 5056-O"}), "wire.youngs_modulus") != 193000.0


def test_numbers_and_units() -> None:
    """A number is told in internal units, and its unit with it."""
    assert (number(STRETCH, "grid.step"), unit(STRETCH, "grid.step")) == (7.5, "mm")
    assert (number(STRETCH, "wire.hardening.exponent"), unit(STRETCH, "wire.hardening.exponent")) == (0.45, "")
    assert written(STRETCH, "wire.youngs_modulus") == "193000 MPa"
    assert unit(STRETCH, "wire.material") == ""


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        ("wire.diametr", 0.8, "did you mean `diameter`"),
        ("wire.diameter", "0.8 mmm", "did you mean `mm`"),
        ("wire.diameter", -1.0, "must be more than 0"),
        ("load.gravity", (0, 0, -1), "no such setting"),
        ("wire", 3, "no such setting"),
        ("grid.step[7]", 3, "no such setting"),
        ("grid.step.x", 3, "no such setting"),
        ("punch.profile.focal_length.x", 3, "no such setting"),
        ("target.inner_radius", "300 mm", "leaves nothing"),
        ("grid.blank.radius", "1 mm", "does not reach|not to the rim"),
    ],
)
def test_what_cannot_be_is_told(place: str, value: object, words: str) -> None:
    """One message for one mistake, with the place and without a traceback of the reader of cases."""
    with pytest.raises(InputError, match=words) as caught:
        varied(STRETCH, {place: value})
    told = [problem for problem in caught.value.problems if problem.where == place]
    assert len(told) == 1


@pytest.mark.parametrize("place", ["wire.material", "punch.profile", "grid.blank.shape", "wire.poison"])
def test_words_and_tables_are_no_numbers(place: str) -> None:
    with pytest.raises(InputError, match=r"not a number|no such setting"):
        number(STRETCH, place)


def test_figures_are_known_by_name() -> None:
    assert figure("rms") is FIGURES["rms"]
    with pytest.raises(InputError, match="known are rms"):
        figure("roughness")


def test_a_polynomial_and_a_table_vary_point_by_point() -> None:
    """List entries are named by their number."""
    table = {"kind": "table", "points": [("0 mm", "50 mm"), ("60 mm", "40 mm"), ("120 mm", "0 mm")]}
    case = varied(STRETCH, {"punch.profile": table})
    bent = varied(case, {"punch.profile.points[1][1]": "41 mm"})
    assert isinstance(bent, Case)
    assert setting(bent, "punch.profile.points")[1] == (60.0, 41.0)
    poly = varied(STRETCH, {"punch.profile": {"kind": "polynomial", "coefficients": [0.0, 0.0, "-0.001 mm^-1"]}})
    assert number(varied(poly, {"punch.profile.coefficients[2]": -0.0011}), "punch.profile.coefficients[2]") == -0.0011
