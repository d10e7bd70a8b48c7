"""How a wire yields: its flow curve, of which the makers here draw the usual laws, Eqs. (12.30)-(12.34)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil, exp, log, sqrt

import numpy as np

from punchform.arrays import Floats
from punchform.errors import InputError

LEAST_SLOPE = 1e-5
"""The least rise of a flow curve, as a part of Young's modulus: perfect plasticity rises by this much, Eq. (12.30)."""

CLOSE = 5e-5
"""How far a curve of straight pieces may lie below its formula, as a part of the yield strength."""

FAR = 1.0
"""Plastic strain up to which a power law is followed; no wire gets there."""

STEEPEST = 1e-9
"""A power law that starts at less than this plastic strain of its own would rise straight up."""

LARGEST_STRAIN = 3.0
"""A strain beyond this was written in per cent."""

STRONGEST = 0.1
"""No wire yields at this part of Young's modulus, however hard it was drawn."""

PLACE = "wire.hardening"


@dataclass(frozen=True, eq=False)
class Hardening:
    """The flow curve of a wire and what is known of its breaking.

    curve (K, 2), K >= 2: equivalent plastic strain from 0 [-] and true flow stress [MPa], both rising; straight
    between its points, its last slope continues for ever, Eq. (12.30). kinematic: the share b in [0, 1] of every rise
    that moves the centre of the yield surface, Eq. (12.31). breaks_at: true strain, elastic part included, at which a
    pulled wire carries most and begins to neck, Eq. (12.34); None where the law does not say.
    """

    curve: Floats
    kinematic: float = 0.0
    breaks_at: float | None = None

    @property
    def yield_strength(self) -> float:
        """The stress at which plastic strain begins [MPa]."""
        return float(self.curve[0, 1])

    def flow(self, strain: Floats | float) -> Floats:
        """True flow stress [MPa] at plastic strains from 0, of any shape."""
        p, stress = self.curve.T
        beyond = np.maximum(np.asarray(strain) - p[-1], 0.0)
        last = (stress[-1] - stress[-2]) / (p[-1] - p[-2])
        return np.asarray(np.interp(strain, p, stress) + last * beyond)


def perfect(yield_strength: float, youngs_modulus: float) -> Hardening:
    """No hardening but the least rise of Eq. (12.30), which keeps the tangent definite."""
    return _hardening([(0.0, yield_strength), (1.0, yield_strength)], youngs_modulus)


def linear(yield_strength: float, youngs_modulus: float, *, modulus: float, kinematic: float = 0.0) -> Hardening:
    """Linear hardening, Eq. (12.32); modulus E_t is the slope of the tensile curve beyond yield [MPa].

    Raises InputError unless 0 <= E_t < E.
    """
    if not 0.0 <= modulus < youngs_modulus:
        raise InputError.of(
            f"a tensile curve that rises by {youngs_modulus:g} MPa before yield cannot rise by {modulus:g} MPa beyond",
            where=f"{PLACE}.modulus",
            hint="give the slope beyond yield, from 0 to less than youngs_modulus",
        )
    rise = youngs_modulus * modulus / (youngs_modulus - modulus)
    return _hardening([(0.0, yield_strength), (1.0, yield_strength + rise)], youngs_modulus, kinematic=kinematic)


def voce(
    yield_strength: float,
    youngs_modulus: float,
    *,
    saturation: float,
    rate: float,
    modulus: float = 0.0,
    kinematic: float = 0.0,
) -> Hardening:
    """The law of Voce, Eq. (12.33), to 1 part in 10 000.

    saturation: the stress that the curve approaches [MPa]; rate b, how fast [-]; modulus: the plastic slope that it
    keeps [MPa]. Raises InputError when the curve would fall or the rate is not positive.
    """
    rise, slope = saturation - yield_strength, max(modulus, LEAST_SLOPE * youngs_modulus)
    if rise < 0.0:
        raise InputError.of(
            f"{saturation:g} MPa is less than the yield strength of {yield_strength:g} MPa: the flow stress would fall",
            where=f"{PLACE}.saturation",
            hint="give the true stress that the curve approaches; it is not the rise above the yield strength",
        )
    if not rate > 0.0:
        raise InputError.of(f"must be more than 0, not {rate:g}", where=f"{PLACE}.rate")
    # Equal steps of exp(-b p / 2) keep every piece equally far from the curve.
    step = min(1.0, sqrt(2 * CLOSE * yield_strength / max(rise, CLOSE * yield_strength)))
    half = np.linspace(1.0, 0.5 * step, 1 + ceil(1 / step))
    p = 2 / rate * -np.log(half)
    p[0] = 0.0
    stress = yield_strength + rise * (1 - half**2) + slope * p
    ends = np.append(p, p[-1] + 1.0), np.append(stress, stress[-1] + slope)
    breaks_at = _considere(
        lambda p: saturation - rise * exp(-rate * p) + slope * p,
        lambda p: rate * rise * exp(-rate * p) + slope,
        youngs_modulus,
    )
    return _hardening(np.column_stack(ends), youngs_modulus, kinematic=kinematic, breaks_at=breaks_at)


def power(
    yield_strength: float, youngs_modulus: float, *, strength: float, exponent: float, kinematic: float = 0.0
) -> Hardening:
    """Hollomon's K eps^n, shifted so that it starts at the yield strength, Eq. (12.33), to 1 part in 10 000.

    strength K [MPa], exponent n in (0, 1); followed to a plastic strain of 1. Raises InputError for K not above the
    yield strength.
    """
    if not 0.0 < exponent < 1.0:
        raise InputError.of(f"must be between 0 and 1, not {exponent:g}", where=f"{PLACE}.exponent")
    if strength <= yield_strength:
        raise InputError.of(
            f"{strength:g} MPa, the stress at a strain of 1, is not above the yield strength of {yield_strength:g} MPa",
            where=f"{PLACE}.strength",
            hint="give K of stress = K strain^n; it is larger than the tensile strength",
        )
    shift = log(yield_strength / strength) / exponent
    if shift < log(STEEPEST):
        raise InputError.of(
            f"a wire that yields at {yield_strength:g} MPa would harden from there straight up",
            where=f"{PLACE}.exponent",
            hint="take a larger exponent, or a yield strength nearer to `strength`",
        )
    # Equal ratios of steps keep every piece equally far from the curve, as a part of the stress.
    ratio = log(1 + sqrt(8 * CLOSE / (exponent * (1 - exponent))))
    start = exp(shift)
    points = 2 + ceil((log(start + FAR) - shift) / ratio)
    own = np.geomspace(start, start + FAR, points)
    p = own - start
    p[0] = 0.0
    stress = strength * own**exponent
    stress[0] = yield_strength
    breaks_at = _considere(
        lambda p: strength * (start + p) ** exponent,
        lambda p: strength * exponent * (start + p) ** (exponent - 1),
        youngs_modulus,
    )
    return _hardening(np.column_stack((p, stress)), youngs_modulus, kinematic=kinematic, breaks_at=breaks_at)


def table(points: Sequence[tuple[float, float]], youngs_modulus: float, *, kinematic: float = 0.0) -> Hardening:
    """A flow curve as it is: plastic strain from 0 and true stress [MPa], point by point.

    Raises InputError when it does not start at 0, when strains do not rise or stresses fall.
    """
    curve = np.array(points, dtype=np.float64)
    where = f"{PLACE}.points"
    if curve.ndim != 2 or curve.shape[1] != 2 or len(curve) < 2:
        raise InputError.of("a flow curve has at least two points, each a plastic strain and a stress", where=where)
    demand_plain(curve, where)
    if curve[0, 0] != 0.0:
        raise InputError.of(
            f"the first point is at a plastic strain of {curve[0, 0]:g}, not 0",
            where=where,
            hint="the first stress is the yield strength, where plastic strain begins",
        )
    for name, backwards in (
        ("strain must rise", np.diff(curve[:, 0]) <= 0),
        ("stress falls", np.diff(curve[:, 1]) < 0),
    ):
        if backwards.any():
            number = int(np.argmax(backwards))
            (p, stress), (next_p, next_stress) = curve[number], curve[number + 1]
            raise InputError.of(
                f"the {name} from point to point: point {number + 2} has {next_p:g}, {next_stress:g} MPa after {p:g}, "
                f"{stress:g} MPa",
                where=where,
                hint="true stress over plastic strain; a raw tensile test is for kind = 'tensile'",
            )
    return _hardening(curve, youngs_modulus, kinematic=kinematic, breaks_at=necking(curve, youngs_modulus))


def demand_plain(points: Floats, where: str) -> None:
    """Raise InputError for points (K, 2) of strain and stress that are not finite, or whose strains are in per cent."""
    if not np.isfinite(points).all():
        raise InputError.of("every strain and every stress must be finite", where=where)
    most = float(points[:, 0].max())
    if most > LARGEST_STRAIN:
        raise InputError.of(
            f"a strain of {most:g} is {most:g} times the length", where=where, hint="write 0.25 for 25 %"
        )


def necking(curve: Floats, youngs_modulus: float) -> float | None:
    """True strain at the largest load of a wire with a flow curve of straight pieces, Eq. (12.34).

    curve (K, 2) as in `Hardening`; None when the load is largest at its very start or at its end.
    """
    p, stress = curve.T
    rise = np.diff(stress) / np.diff(p)
    # The stress at which a straight piece, or the line through it, carries most.
    level = rise / (1 + rise / youngs_modulus)
    tops = np.flatnonzero((level > stress[:-1]) & (level < stress[1:]))
    all_p = np.append(p, p[tops] + (level[tops] - stress[tops]) / rise[tops])
    all_stress = np.append(stress, level[tops])
    total = all_p + all_stress / youngs_modulus
    best = int(np.argmax(all_stress * np.exp(-total)))
    return None if best in (0, len(p) - 1) else float(total[best])


def _considere(
    stress: Callable[[float], float], slope: Callable[[float], float], youngs_modulus: float
) -> float | None:
    """True strain at the largest load of a law whose slope falls, Eq. (12.34); None when its load falls from the start.

    By a plastic strain of 1 the load of every law here falls.
    """
    from scipy.optimize import brentq

    def gain(p: float) -> float:
        return slope(p) * (1 - stress(p) / youngs_modulus) - stress(p)

    if gain(0.0) <= 0.0:
        return None
    p = brentq(gain, 0.0, FAR)
    return float(p + stress(p) / youngs_modulus)


def _hardening(
    points: Floats | Sequence[tuple[float, float]],
    youngs_modulus: float,
    *,
    kinematic: float = 0.0,
    breaks_at: float | None = None,
) -> Hardening:
    """The law of a curve, which is made to rise by at least Eq. (12.30)."""
    curve = np.array(points, dtype=np.float64)
    begins = float(curve[0, 1])
    if not 0.0 < begins < STRONGEST * youngs_modulus:
        raise InputError.of(
            f"no wire with a Young's modulus of {youngs_modulus:g} MPa yields at {begins:g} MPa",
            where="wire.yield_strength",
            hint="check the units of both: a bare number is in MPa",
        )
    if not 0.0 <= kinematic <= 1.0:
        raise InputError.of(f"must be between 0 and 1, not {kinematic:g}", where=f"{PLACE}.kinematic")
    least = LEAST_SLOPE * youngs_modulus * curve[:, 0]
    curve[:, 1] = np.maximum.accumulate(curve[:, 1] - least) + least
    curve.setflags(write=False)
    return Hardening(curve, float(kinematic), breaks_at)
