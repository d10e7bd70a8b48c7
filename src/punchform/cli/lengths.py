"""Lengths that are given as options."""

from __future__ import annotations

import math

from punchform.errors import InputError
from punchform.units import LENGTH, UnitError, quantity


def length_above_zero(option: str, text: str | None, *, hint: str, refusal: str) -> float | None:
    """The length [mm] that an option such as "--to" was given, None where it was not.

    Raises InputError with the hint for what is no length, and with the refusal for one that is not above zero.
    """
    if text is None:
        return None
    try:
        value = quantity(text, LENGTH)
    except UnitError as problem:
        raise InputError.of(str(problem), where=f"{option} {text}", hint=hint) from problem
    if not (math.isfinite(value) and value > 0):
        raise InputError.of(refusal, where=f"{option} {text}")
    return value
