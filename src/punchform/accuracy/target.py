"""The wanted surface, and where it stands: Eq. (9.1)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats
from punchform.case import ParaboloidProfile, Profile
from punchform.errors import InputError
from punchform.punch import Paraboloid, Revolution, bare

PARAMETERS = ("u", "v", "w", "alpha", "beta", "f")
"""The order of the parameters of a pose: shifts [mm], tilts [rad], focal length [mm]."""

MARGIN = 1.05
"""How far beyond its aperture a profile is used where it goes on."""


@dataclass(frozen=True)
class Pose:
    """Where a surface stands, Eq. (9.1): its vertex is moved by (u, v, w) [mm], then it turns about the vertex.

    The turn is R = R_y(beta) R_x(alpha), right-handed [rad]; f is the focal length [mm], None for a surface that
    is no paraboloid.
    """

    u: float = 0.0
    v: float = 0.0
    w: float = 0.0
    alpha: float = 0.0
    beta: float = 0.0
    f: float | None = None

    def moved(self, changes: Mapping[str, float]) -> Pose:
        """This pose with some parameters given anew."""
        values = {name: getattr(self, name) for name in PARAMETERS}
        return Pose(**{**values, **changes})

    @property
    def shift(self) -> Floats:
        """(u, v, w) [mm]."""
        return np.array([self.u, self.v, self.w])

    @property
    def rotation(self) -> Floats:
        """The matrix R (3, 3)."""
        return _about_y(self.beta) @ _about_x(self.alpha)

    @property
    def rotation_slopes(self) -> tuple[Floats, Floats]:
        """The derivatives of R by alpha and by beta, both (3, 3)."""
        quarter = 0.5 * math.pi
        turn_x, turn_y = np.diag([0.0, 1.0, 1.0]), np.diag([1.0, 0.0, 1.0])
        by_alpha = _about_y(self.beta) @ _about_x(self.alpha + quarter) @ turn_x
        by_beta = _about_y(self.beta + quarter) @ turn_y @ _about_x(self.alpha)
        return by_alpha, by_beta

    @property
    def tilt(self) -> float:
        """Angle between the axis and the z axis [rad]."""
        axis = self.rotation[:, 2]
        return float(math.atan2(math.hypot(axis[0], axis[1]), axis[2]))


def _about_x(angle: float) -> Floats:
    s, c = math.sin(angle), math.cos(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _about_y(angle: float) -> Floats:
    s, c = math.sin(angle), math.cos(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


@dataclass(frozen=True)
class Target:
    """A surface of revolution about the z axis with its vertex at (0, 0, apex_height) [mm].

    surface: in the place its formula gives it; focal_length [mm]: None when it is no paraboloid; end: the radius
    [mm] up to which the formula is used, beyond it the surface goes on straight.
    """

    surface: Revolution
    apex_height: float
    focal_length: float | None
    end: float

    @property
    def pose(self) -> Pose:
        """The pose in which the target stands as it is meant to."""
        return Pose(f=self.focal_length)

    def shape(self, pose: Pose) -> Revolution:
        """The surface of a pose, untilted and unmoved: another focal length is another surface."""
        if pose.f is None or pose.f == self.focal_length:
            return self.surface
        return Paraboloid(pose.f)

    def local(self, points: Floats, pose: Pose) -> Floats:
        """Points (n, 3) [mm] seen from the axes of the surface in this pose, Eq. (9.1)."""
        vertex = pose.shift + np.array([0.0, 0.0, self.apex_height])
        local: Floats = (points - vertex) @ pose.rotation
        local[:, 2] += self.surface.height_at_axis
        return local

    def focus(self, pose: Pose) -> Floats:
        """The focus (3,) [mm] of a paraboloid in this pose: f below its vertex. Raises ValueError for others."""
        if pose.f is None:
            raise ValueError("only a paraboloid has a focus")
        focus: Floats = pose.shift - pose.f * pose.rotation[:, 2]
        focus[2] += self.apex_height
        return focus


def place(profile: Profile, radius: float, *, apex_height: float, where: str = "target.profile") -> Target:
    """The target of a profile, used up to `radius` [mm], with its vertex at z = apex_height [mm].

    Where the profile goes on it is used a little further, so that points at the edge keep their foot when they are
    tilted. Raises InputError, whose place starts with `where`, for a profile that ends before the radius.
    """
    if isinstance(profile, ParaboloidProfile):
        focal_length = profile.focal_length
        return Target(Paraboloid(focal_length), apex_height, focal_length, math.inf)
    try:
        return Target(bare(profile, MARGIN * radius, where=where), apex_height, None, MARGIN * radius)
    except InputError:
        return Target(bare(profile, radius, where=where), apex_height, None, radius)
