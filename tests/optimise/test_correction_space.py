"""The spaces of corrections: orthogonal shapes, their symmetry, the taper, and what a case makes of them."""

from __future__ import annotations

import numpy as np
import pytest
from linear_dishes import APERTURE, RIM, space_of

from punchform.arrays import Floats
from punchform.case import Case, varied
from punchform.case.reading import case_from_text
from punchform.errors import InputError
from punchform.optimise.correction_space import KINDS, Kind, Term, numbers_of, space, terms_of, zernike
from punchform.punch import Corrected, surface

RNG = np.random.default_rng(6)
CASE = """
schema = 1
[grid]
step = "10 mm"
blank = { shape = "circle", radius = "70 mm" }
[wire]
diameter = "0.75 mm"
youngs_modulus = "210 GPa"
[punch]
profile = { kind = "paraboloid", focal_length = "60 mm" }
rim_radius = "60 mm"
fillet = "20 mm"
[release]
hold = { from_radius = "60 mm" }
[target]
profile = { kind = "paraboloid", focal_length = "60 mm" }
aperture_radius = "50 mm"
tolerance = "0.1 mm"
"""


def case() -> Case:
    return case_from_text(CASE)


def points(count: int = 400) -> Floats:
    return np.asarray(RIM * (2.0 * RNG.random((count, 2)) - 1.0))


def test_zernike_polynomials_are_orthonormal_on_the_unit_circle() -> None:
    terms = terms_of("field", 8, mirrored=False)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    radius = np.sqrt(0.5 * (nodes + 1.0))
    angle = 2.0 * np.pi * np.arange(32) / 32
    rho, phi = (part.ravel() for part in np.meshgrid(radius, angle, indexing="ij"))
    area = np.repeat(0.5 * weights / 32, 32)
    shapes = zernike(terms, rho, phi)
    np.testing.assert_allclose(shapes.T @ (area[:, None] * shapes), np.eye(len(terms)), atol=1e-12)


def test_the_first_shapes_are_the_closed_ones() -> None:
    rho, phi = RNG.random(20), 2 * np.pi * RNG.random(20)
    found = zernike((Term(0, 0), Term(2, 0), Term(4, 4)), rho, phi)
    expected = [np.ones(20), np.sqrt(3) * (2 * rho**2 - 1), np.sqrt(10) * rho**4 * np.cos(4 * phi)]
    np.testing.assert_allclose(found, np.column_stack(expected), atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_mirrored_shapes_are_even_in_x_and_in_y(kind: Kind) -> None:
    shapes, where = space_of(kind), points()
    for image in ((-1.0, 1.0), (1.0, -1.0)):
        np.testing.assert_allclose(shapes.columns(where * image), shapes.columns(where), atol=1e-12)


def test_a_turned_punch_is_the_same_all_round_and_lobes_repeat_after_a_quarter() -> None:
    where = points()
    for kind, degrees in (("revolution", 17.0), ("lobes", 90.0)):
        angle = np.radians(degrees)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        shapes = space_of(kind)  # type: ignore[arg-type]
        np.testing.assert_allclose(shapes.columns(where @ turn), shapes.columns(where), atol=1e-11)


def test_without_mirror_planes_there_are_all_lobes_and_both_waves() -> None:
    terms = terms_of("field", 4, mirrored=False)
    assert len(terms) == 15
    assert {term.m for term in terms} == {0, 1, 2, 3, 4}
    assert {(term.m, term.sine) for term in terms_of("lobes", 4, mirrored=False)} == {(0, False), (4, False), (4, True)}


def test_the_taper_is_one_inside_nil_outside_and_smooth() -> None:
    shapes = space_of("field")
    np.testing.assert_array_equal(shapes.taper(np.array([0.0, APERTURE])), 1.0)
    np.testing.assert_array_equal(shapes.taper(np.array([RIM, 2 * RIM])), 0.0)
    near, step = np.array([APERTURE, RIM]), 1e-3
    ahead, here, behind = (shapes.taper(near + h) for h in (step, 0.0, -step))
    np.testing.assert_allclose((ahead - behind) / (2 * step), 0.0, atol=1e-6)
    np.testing.assert_allclose((ahead - 2 * here + behind) / step**2, 0.0, atol=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_holds_the_correction_and_gives_it_back(kind: Kind) -> None:
    shapes = space(case(), kind, nodes=400, mirrored=True)
    numbers = 0.1 * RNG.standard_normal(len(shapes.terms)) / (1.0 + np.array([term.n for term in shapes.terms])) ** 2
    corrected = varied(case(), {"punch.correction": shapes.correction(numbers)})
    tool = surface(corrected.tool)
    assert isinstance(tool, Corrected)
    where = 0.6 * points()
    expected = shapes.heights(numbers, where)
    np.testing.assert_allclose(tool.correction.value(where), expected, atol=2e-3 * np.abs(expected).max())
    np.testing.assert_allclose(numbers_of(corrected, shapes), numbers, atol=5e-3 * np.abs(numbers).max())
    outside = points()[np.hypot(*points().T) > 0]
    outside = outside / np.hypot(*outside.T)[:, None] * (60.0 + 40.0 * RNG.random((len(outside), 1)))
    assert np.abs(tool.correction.value(outside)).max() < 1e-3 * np.abs(expected).max()


def test_a_case_without_correction_has_no_numbers() -> None:
    shapes = space(case(), "field", nodes=400, mirrored=True)
    assert not numbers_of(case(), shapes).any()


def test_fewer_crossings_carry_fewer_shapes() -> None:
    sizes = [len(space(case(), "field", nodes=nodes, mirrored=True).terms) for nodes in (20, 60, 180, 1000)]
    assert sizes == sorted(sizes)
    assert sizes[0] < sizes[-1]


def test_a_ring_for_the_taper_is_always_left() -> None:
    wide = varied(case(), {"target.aperture_radius": 60.0})
    shapes = space(wide, "field", nodes=100, mirrored=True)
    assert shapes.end - shapes.start >= 2 * 10.0


def test_a_case_without_target_is_refused() -> None:
    text = CASE[: CASE.index("[target]")]
    with pytest.raises(InputError, match="target"):
        space(case_from_text(text), "field", nodes=10, mirrored=True)
