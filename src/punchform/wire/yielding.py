"""From the [wire] section to the flow curve of the wire."""

from __future__ import annotations

from typing import TYPE_CHECKING

from punchform.errors import InputError
from punchform.wire.hardening import Hardening, linear, perfect, power, table, voce
from punchform.wire.tensile import from_tensile

if TYPE_CHECKING:
    from punchform.case import WireCase


def hardening_of(case: WireCase) -> Hardening | None:
    """How the wire of a case yields, None for one that stays elastic. Raises InputError for a law that cannot be."""
    law, E, begin = case.hardening, case.youngs_modulus, case.yield_strength
    if law == "none":
        return None
    if law != "perfect" and law.kind == "table":
        return table(law.points, E, kinematic=law.kinematic)
    if law != "perfect" and law.kind == "tensile":
        return from_tensile(law.points, E, kinematic=law.kinematic)
    if begin is None:
        raise InputError.of("nobody says at what stress the wire yields", where="wire.yield_strength")
    if law == "perfect":
        return perfect(begin, E)
    if law.kind == "linear":
        return linear(begin, E, modulus=law.modulus, kinematic=law.kinematic)
    if law.kind == "power":
        return power(begin, E, strength=law.strength, exponent=law.exponent, kinematic=law.kinematic)
    return voce(begin, E, saturation=law.saturation, rate=law.rate, modulus=law.modulus, kinematic=law.kinematic)
