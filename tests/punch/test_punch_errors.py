"""What cannot be a punch, said in one message that names the place; and bends too sharp for the grid."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from punches import PUNCHES, punch, table_of_paraboloid

from punchform.case import (
    ConeProfile,
    EllipsoidProfile,
    ExpressionProfile,
    FlatProfile,
    ParaboloidProfile,
    PolynomialProfile,
    Profile,
    SphereProfile,
    TableProfile,
)
from punchform.errors import InputError
from punchform.punch import bare, check_sharpness


def problem_of(profile: Profile, rim_radius: float = 300.0, fillet: float = 30.0) -> tuple[str, str]:
    with pytest.raises(InputError) as caught:
        punch(profile, rim_radius, fillet)
    (problem,) = caught.value.problems
    return problem.where, problem.message


@pytest.mark.parametrize(
    ("profile", "where", "words"),
    [
        (SphereProfile(radius=269.9), "punch.profile.radius", "does not reach the fillet"),
        (EllipsoidProfile(radius=269.9, height=5), "punch.profile.radius", "does not reach the fillet"),
        (ConeProfile(half_angle=0.2, nose_radius=290), "punch.profile.nose_radius", "no straight wall"),
        (FlatProfile(height=400, edge_radius=280), "punch.profile.edge_radius", "more than the rim radius"),
        (PolynomialProfile(coefficients=(0, 0.1, -1e-3)), "punch.profile.coefficients", "point on the axis"),
        (PolynomialProfile(coefficients=(0, 0, 1e-3)), "punch.profile", "does not fall towards the rim"),
        (PolynomialProfile(coefficients=(0, 0)), "punch.profile", "does not fall towards the rim"),
        (
            PolynomialProfile(coefficients=(0, 0, 5e-3, 0, -3e-8)),
            "punch.profile.coefficients",
            "below the flange",
        ),
        (TableProfile(points=((0, 0), (100, -10), (300, -90))), "punch.profile.points", "at least 4"),
        (
            TableProfile(points=((1, 0), (100, -10), (200, -40), (300, -90))),
            "punch.profile.points",
            "not on the axis",
        ),
        (table_of_paraboloid(9, end=280.0), "punch.profile", "ends at rho = 280 mm, before the fillet"),
        (ExpressionProfile(z="-rho/2"), "punch.profile.z", "slope -0.5 on the axis"),
        (ExpressionProfile(z="-sqrt(rho)"), "punch.profile.z", "not defined on the axis"),
        (ExpressionProfile(z="-rho**1.5"), "punch.profile.z", "not defined on the axis"),
        (ExpressionProfile(z="sqrt(250**2 - rho**2)"), "punch.profile", "ends at rho = 250 mm"),
        (
            ExpressionProfile(z="-log(rho**2 - 100**2)*rho**2"),
            "punch.profile.z",
            "not defined on the axis",
        ),
        (
            ExpressionProfile(z="sqrt((rho - 90)*(rho - 110)) - rho**3"),
            "punch.profile.z",
            "not defined at rho = 90",
        ),
        (ExpressionProfile(z="1/(rho**2 - 101**2) - rho**2/1000"), "punch.profile.z", "jumps near rho = "),
        (
            ExpressionProfile(z="30*cos(rho/3) - rho**2/1000"),
            "punch.fillet",
            "touches the profile at",
        ),
    ],
)
def test_profiles_that_do_not_make_a_punch(profile: Profile, where: str, words: str) -> None:
    place, message = problem_of(profile)
    assert place == where
    assert words in message
    assert "\n" not in message


def test_no_fillet() -> None:
    place, message = problem_of(ParaboloidProfile(focal_length=250), fillet=0.0)
    assert place == "punch.fillet"
    assert "sharp edge" in message


def test_a_sphere_given_as_an_expression_is_the_sphere() -> None:
    """It need not be defined up to the rim, only up to the fillet."""
    one = punch(SphereProfile(radius=290.0))
    other = punch(ExpressionProfile(z="sqrt(290**2 - rho**2)"))
    rho, z = other.meridian(50).T
    assert one.distance(np.column_stack((rho, 0 * rho, z))) == pytest.approx(0.0, abs=1e-9)


def test_a_dent_above_the_flange_is_allowed() -> None:
    assert PUNCHES["dented"].height_at_axis > 0


def test_limits_of_closed_forms_fit_exactly() -> None:
    """A cone of nose and fillet only, a cup of two quarter circles, a cup without flat."""
    angle = math.radians(30)
    cone = punch(ConeProfile(half_angle=angle, nose_radius=300 / math.cos(angle) - 30))
    assert len(cone.chain.segments) == 3
    low = punch(FlatProfile(height=60, edge_radius=30))
    assert low.meridian(100)[:, 0].max() == 360
    assert len(low.chain.segments) == 4
    full = punch(FlatProfile(height=400, edge_radius=270))
    assert full.height_at_axis == 400
    assert len(full.chain.segments) == 4


def test_bare_profile_must_reach_its_radius() -> None:
    for profile in (
        SphereProfile(radius=50),
        EllipsoidProfile(radius=50, height=10),
        table_of_paraboloid(5, end=50.0),
        ExpressionProfile(z="sqrt(2500 - rho**2)"),
    ):
        with pytest.raises(InputError, match="ends at rho = 50 mm, inside the radius of 60 mm"):
            bare(profile, 60.0, where="target.profile")


def test_gentle_punch_has_no_sharp_bend() -> None:
    assert check_sharpness(PUNCHES["paraboloid"], 7.5) == ((), ())


@pytest.mark.parametrize("name", list(PUNCHES))
def test_fillet_against_the_step(name: str) -> None:
    """Fillet 30 mm: fine at 10 mm, a warning at 20 mm, an error at 40 mm (if it turns by 3 degrees)."""
    made = PUNCHES[name]

    def at_fillet(step: float) -> list[int]:
        return [sum(p.where == "punch.fillet" for p in group) for group in check_sharpness(made, step)]

    assert at_fillet(10.0) == [0, 0]
    assert at_fillet(20.0) == [0, 1]
    assert at_fillet(40.0) == [1, 0]


def test_sharp_places_of_the_profile() -> None:
    (error,), _ = check_sharpness(punch(FlatProfile(height=100, edge_radius=5)), 7.5)
    assert error.where == "punch.profile"
    assert "radius of 5 mm by 90 degrees near rho = 265" in error.message
    kinked = table_of_paraboloid(31).model_copy(
        update={"points": tuple((float(10 * k), -0.4 * max(0.0, 10.0 * k - 100)) for k in range(31))}
    )
    (error,), _ = check_sharpness(punch(kinked), 40.0 / 2)
    assert re.search(r"near rho = (99\.|100)", error.message)
    (error,), _ = check_sharpness(bare(kinked, 250.0), 20.0, where="target")
    assert error.where == "target.profile"
    ripple = punch(ExpressionProfile(z="-rho**2/1000 + 0.0001*cos(rho)"))
    assert check_sharpness(ripple, 7.5) == ((), ())
