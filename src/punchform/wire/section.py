"""The round section of a wire: how it resists stretch, shear, bending and twist."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class Section:
    """Rigidities of a wire's section, as Eq. (2.4) uses them.

    diameter [mm]; EA, kappa_GA [N]; EI, GJ [N mm²]. They are independent fields so that a limit
    (EA → ∞, no shear) can be taken one at a time; `round_section` makes them agree.
    """

    diameter: float
    EA: float
    EI: float
    GJ: float
    kappa_GA: float  # noqa: N815 - a letter of the formula

    @property
    def area(self) -> float:
        """A = π d²/4 [mm²]."""
        return pi * self.diameter**2 / 4

    @property
    def youngs_modulus(self) -> float:
        """E [MPa], by stretch."""
        return self.EA / self.area

    @property
    def shear_modulus(self) -> float:
        """G [MPa], by twist: J = 2 I of a round section."""
        return self.GJ * self.youngs_modulus / (2 * self.EI)

    @property
    def bending_modulus(self) -> float:
        """W = π d³/32 [mm³]: largest bending stress = M / W."""
        return pi * self.diameter**3 / 32

    @property
    def twisting_modulus(self) -> float:
        """W_t = π d³/16 [mm³]: largest shear stress from twist = T / W_t."""
        return pi * self.diameter**3 / 16


def round_section(diameter: float, *, youngs_modulus: float, poisson: float, shear_factor: float) -> Section:
    """Section of a round solid wire.

    diameter [mm], youngs_modulus E [MPa], poisson ν and shear_factor κ without unit.
    I = π d⁴/64, J = 2 I, G = E / 2(1 + ν); the paper's wire has κ = 0.9 (docs/theory.md, section 2).
    """
    area = pi * diameter**2 / 4
    inertia = pi * diameter**4 / 64
    shear_modulus = youngs_modulus / (2 * (1 + poisson))
    return Section(
        diameter=diameter,
        EA=youngs_modulus * area,
        EI=youngs_modulus * inertia,
        GJ=2 * shear_modulus * inertia,
        kappa_GA=shear_factor * shear_modulus * area,
    )
