"""Punches of every kind for the tests, and points near their surfaces."""

from __future__ import annotations

import math

import numpy as np

from punchform.arrays import Floats
from punchform.case import (
    ConeProfile,
    EllipsoidProfile,
    ExpressionProfile,
    FlatProfile,
    ParaboloidProfile,
    PolynomialProfile,
    Profile,
    PunchCase,
    SphereProfile,
    TableProfile,
)
from punchform.punch import Revolution, uncorrected


def punch(profile: Profile, rim_radius: float = 300.0, fillet: float = 30.0) -> Revolution:
    return uncorrected(PunchCase(profile=profile, rim_radius=rim_radius, fillet=fillet))


def table_of_paraboloid(count: int, *, end: float = 300.0, focal_length: float = 250.0) -> TableProfile:
    rho = np.linspace(0.0, end, count)
    return TableProfile(points=tuple((float(r), float(-(r**2) / (4 * focal_length))) for r in rho))


CHECK = PunchCase(profile=ParaboloidProfile(focal_length=250.0), rim_radius=300.0, fillet=30.0)
"""The punch of the check case (docs/theory.md, section 11)."""

PUNCHES: dict[str, Revolution] = {
    "paraboloid": uncorrected(CHECK),
    "sphere": punch(SphereProfile(radius=400.0)),
    "hemisphere": punch(SphereProfile(radius=270.0)),
    "ellipsoid": punch(EllipsoidProfile(radius=350.0, height=120.0)),
    "half ellipsoid": punch(EllipsoidProfile(radius=270.0, height=400.0)),
    "cone": punch(ConeProfile(half_angle=math.radians(35.0), nose_radius=60.0)),
    "low cup": punch(FlatProfile(height=40.0, edge_radius=30.0)),
    "cup": punch(FlatProfile(height=90.0, edge_radius=25.0)),
    "polynomial": punch(PolynomialProfile(coefficients=(5.0, 0.0, -1e-3, 1e-6, -4e-9))),
    "dented": punch(PolynomialProfile(coefficients=(0.0, 0.0, 1e-3, 0.0, -2e-8))),
    "table": punch(table_of_paraboloid(13)),
    "expression": punch(ExpressionProfile(z="40 * cos(pi*rho/400) + 10*exp(-(rho/100)**2)")),
}
"""A punch of every kind, rim radius 300 mm, fillet 30 mm."""


def points_near(surface: Revolution, count: int, *, seed: int = 7, away: float = 6.0) -> Floats:
    """(count, 3) points within `away` [mm] of the surface, spread along its meridian."""
    rng = np.random.default_rng(seed)
    meridian = surface.meridian(400)
    rho, z = meridian[rng.integers(0, len(meridian), count)].T
    shift = rng.uniform(-away, away, (2, count)) / math.sqrt(2)
    rho, z = np.abs(rho + shift[0]), z + shift[1]
    angle = rng.uniform(0, 2 * math.pi, count)
    return np.column_stack((rho * np.cos(angle), rho * np.sin(angle), z))
