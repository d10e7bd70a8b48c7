"""The library of materials as numbers: elasticity, yielding, strength, and where they come from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from punchform.case import WireCase
from punchform.case.materials import library, likely, settings_of
from punchform.errors import InputError
from punchform.units import STRESS, quantity
from punchform.wire.hardening import Hardening
from punchform.wire.yielding import hardening_of


@dataclass(frozen=True)
class Material:
    """What a wire is made of.

    youngs_modulus, yield_strength (where plastic strain begins) and tensile_strength [MPa]; density [kg/m³]; law says
    `hardening` in words, source and remark where the numbers come from and which are estimates.
    """

    name: str
    youngs_modulus: float
    poisson: float
    density: float
    yield_strength: float
    tensile_strength: float
    law: str
    hardening: Hardening
    source: str
    remark: str

    @property
    def law_strength(self) -> float:
        """Tensile strength by the flow curve, Eq. (12.34) [MPa]: the largest load over the first section."""
        p, stress = self.hardening.curve.T
        strain = self.hardening.breaks_at
        assert strain is not None
        return float(np.interp(strain, p + stress / self.youngs_modulus, stress) * np.exp(-strain))


def materials() -> tuple[Material, ...]:
    """All materials of the library."""
    return tuple(_material(name, entry) for name, entry in library().items())


def material(name: str) -> Material:
    """A material of the library. Raises InputError for a name that is not in it."""
    known = library()
    if name not in known:
        raise InputError.of(f"there is no material '{name}'", hint=likely(name, known))
    return _material(name, known[name])


def _material(name: str, entry: dict[str, Any]) -> Material:
    # The wire's diameter says nothing of what it is made of.
    wire = WireCase.model_validate({**settings_of(entry), "diameter": 1.0})
    hardening = hardening_of(wire)
    assert hardening is not None
    assert wire.density is not None
    return Material(
        name=name,
        youngs_modulus=wire.youngs_modulus,
        poisson=wire.poisson,
        density=wire.density,
        yield_strength=hardening.yield_strength,
        tensile_strength=quantity(entry["tensile_strength"], STRESS),
        law=_in_words(entry["hardening"]),
        hardening=hardening,
        source=entry["source"],
        remark=entry["remark"],
    )


def _in_words(law: dict[str, Any]) -> str:
    """A law as the library gives it.

    >>> _in_words({"kind": "voce", "saturation": "573 MPa", "rate": 89.8})
    'voce, saturation 573 MPa, rate 89.8'
    """
    return ", ".join([law["kind"], *(f"{key} {value}" for key, value in law.items() if key != "kind")])
