"""The two surfaces a cloud is held against have the same face: `Reference`. Here the wanted one, at its height."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.case import Case
from punchform.punch import Surface, bare, surface


class Reference(Protocol):
    """A surface that a cloud can be held against; distances are positive above it, on the grid's side."""

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Signed distance (n,) [mm] and its gradient (n, 3) at points (n, 3) [mm]."""
        ...

    def covers(self, points: Floats) -> Bools:
        """Which points (n, 3) lie over the part of the surface that counts."""
        ...


@dataclass(frozen=True)
class Target:
    """The wanted surface, `lift` [mm] above where its formula puts it; radii `inner` to `aperture` [mm] count."""

    surface: Surface
    lift: float
    aperture: float
    inner: float = 0.0

    def distance_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """Exact signed distance (n,) [mm] and its gradient (n, 3), of length 1."""
        return self.surface.distance_gradient(points - np.array([0.0, 0.0, self.lift]))

    def covers(self, points: Floats) -> Bools:
        """Points (n, 3) inside the aperture and outside the inner radius, in plan."""
        rho = np.hypot(points[:, 0], points[:, 1])
        return np.asarray((rho <= self.aperture) & (rho >= self.inner))


def target_of(case: Case) -> Target | None:
    """The target of a case, its apex at the height of the punch's; None without [target].

    A target with the punch's own profile is then the punch itself. Raises InputError when it ends inside.
    """
    if case.target is None:
        return None
    aperture = case.target.aperture_radius
    wanted = bare(case.target.profile, aperture, where="target.profile")
    lift = surface(case.tool).height_at_axis - wanted.height_at_axis
    return Target(wanted, lift, aperture, case.target.inner_radius or 0.0)


def whole_punch(case: Case) -> Target:
    """The punch with its fillet and flange: what a cloud of unknown place is first laid on."""
    return Target(surface(case.tool), 0.0, float("inf"))
