"""The section of a yielding round wire: what it has gone through, and what it does under a load or at a strain.

A face for people and tests over the two kernels `resultants` and `fibres`. A wire is bent and let go:

>>> import numpy as np
>>> wire = np.array([193e3, 75e3, 0.75])
>>> law = SectionLaw(wire, curve=np.array([[0.0, 205.0], [1.0, 207.0]]))
>>> bent = law.at(np.array([np.nan, 1 / 100, 0.0, 0.0]), law.start())
>>> free = law.under(np.zeros(4), bent.past)
>>> bool(0.5 < free.strain[1] / bent.strain[1] < 0.6)
True
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.errors import InputError, NoEquilibrium, Problem
from punchform.mechanics import fibres, resultants

LEAST_SLOPE = 1e-5
"""Least slope of a flow curve as a part of Young's modulus: what perfect plasticity is taken for."""
MOST_STEPS = 200


@dataclass(frozen=True)
class Past:
    """What a section has gone through: plastic strain (4,) so far, last load (4,), and the row of its kernel."""

    plastic: Floats
    load: Floats
    row: Floats


@dataclass(frozen=True)
class Response:
    """Answer of a section: load (4,) = N, M_2, M_3, T [N, N mm]; strain (4,) = elongation, two curvatures and twist
    [-, 1/mm], elastic and plastic together; compliance (4, 4) = d strain / d load; and the past that follows."""

    load: Floats
    strain: Floats
    compliance: Floats
    past: Past


@dataclass(frozen=True)
class SectionLaw:
    """A round wire that yields, docs/theory.md section 12.

    wire (3,): E, G [MPa], diameter [mm]; curve (K, 2): equivalent plastic strain and flow stress [MPa], as in
    `flow_curve`; kinematic: share of every rise of the flow stress that moves the centre of the elastic range;
    points (n, 3) of `fibres.round_points`, or None for the law of the resultants; stretch: current length over the
    length at which the wire had that diameter. Raises InputError for what cannot be used.
    """

    wire: Floats
    curve: Floats
    kinematic: float = 0.0
    points: Floats | None = None
    stretch: float = 1.0

    def __post_init__(self) -> None:
        if problems := [*self._problems()]:
            raise InputError(problems)

    @property
    def elastic(self) -> Floats:
        """Elastic compliances (4,): 1/EA, 1/EI, 1/EI, 1/GJ of the stretched wire [1/N, 1/(N mm²)]."""
        young, shear, diameter = self.wire
        area = pi * diameter**2 / 4 / self.stretch
        inertia = area**2 / (4 * pi)
        return 1 / np.array([young * area, young * inertia, young * inertia, 2 * shear * inertia])

    def start(self) -> Past:
        """The past of a wire that has never yielded."""
        size = resultants.PAST if self.points is None else fibres.past_size(len(self.points))
        return Past(np.zeros(4), np.zeros(4), np.zeros(size))

    def under(self, load: Floats, past: Past) -> Response:
        """The section under a load (4,), reached in one step from the past."""
        load = np.asarray(load, dtype=np.float64)
        _, added, f = self._flow(load, past.row)
        plastic = past.plastic + added
        strain = self.elastic * load + plastic
        return Response(load, strain, np.diag(self.elastic) + f, Past(plastic, load, self._settled(load, past.row)))

    def at(self, strain: Floats, past: Past) -> Response:
        """The section at a strain (4,), reached in one step from the past; where the strain is NaN it is free, and
        the load there is nil.

        Newton on the convex complementary energy ½ s·S s + w(s) - s·(e - p), cut back where it goes too far. Raises
        NoEquilibrium where no load gives that strain.
        """
        held = ~np.isnan(strain)
        wanted = np.where(held, strain - past.plastic, 0.0)
        load = np.where(held, past.load, 0.0)
        gap, compliance = self._gap(load, past.row, wanted, held)
        for _ in range(MOST_STEPS):
            step = np.zeros(4)
            step[held] = np.linalg.solve(compliance[np.ix_(held, held)], gap[held])
            descent = gap @ step
            if descent <= 1e-26 * (wanted @ (wanted / self.elastic)):
                return self.under(load, past)
            part = 1.0
            while part > 1e-12:
                gap, compliance = self._gap(load + part * step, past.row, wanted, held)
                slope = gap @ step
                if slope >= -0.5 * descent:
                    break
                part *= max(float(descent / (descent - slope)), 0.1)
            load = load + part * step
        raise NoEquilibrium(f"no load gives the section the strain {strain}; go there in more steps")

    def largest_plastic_strain(self, past: Past) -> float:
        """Largest equivalent plastic strain in the section: of its fibres, or Eq. (12.8) at its edge."""
        return float((resultants if self.points is None else fibres).plastic(past.row))

    def dissipated(self, past: Past) -> float:
        """Work that has become heat so far, per original length [N = mJ/mm]."""
        return float((resultants if self.points is None else fibres).dissipated(past.row))

    def _gap(self, load: Floats, row: Floats, wanted: Floats, held: Bools) -> tuple[Floats, Floats]:
        """What of the wanted strain is missing under a load, and the compliance there."""
        _, added, f = self._flow(load, row)
        return np.where(held, wanted - added - self.elastic * load, 0.0), np.diag(self.elastic) + f

    def _flow(self, load: Floats, row: Floats) -> tuple[float, Floats, Floats]:
        """Potential, added plastic strain (4,) and its derivative (4, 4)."""
        added, f = np.empty(4), np.empty((4, 4))
        made_of = (self.curve, self.kinematic, self.wire, self.stretch)
        if self.points is None:
            return resultants.flow(load, row, *made_of, added, f), added, f
        nowhere = np.full(fibres.MEMORY, np.nan)
        return fibres.flow(load, row, *made_of, self.points, nowhere, added, f), added, f

    def _settled(self, load: Floats, row: Floats) -> Floats:
        after = np.empty_like(row)
        made_of = (self.curve, self.kinematic, self.wire, self.stretch)
        if self.points is None:
            resultants.settle(load, row, *made_of, after)
        else:
            fibres.settle(load, row, *made_of, self.points, np.full(fibres.MEMORY, np.nan), after)
        return after

    def _problems(self) -> Iterator[Problem]:
        """All that keeps the law from being used."""
        wire, curve = self.wire, self.curve
        if wire.shape != (3,) or not (np.isfinite(wire).all() and (wire > 0).all()):
            yield Problem(f"a wire is E, G and diameter, all positive, not {wire}", "wire")
        elif curve.ndim != 2 or curve.shape[1] != 2 or len(curve) < 2 or not np.isfinite(curve).all():
            yield Problem("a flow curve is at least two rows of plastic strain and flow stress", "curve")
        elif curve[0, 0] != 0 or curve[0, 1] <= 0:
            yield Problem("a flow curve begins with the strain 0 and a positive yield strength", "curve")
        elif (np.diff(curve[:, 0]) <= 0).any():
            yield Problem("the strains of a flow curve must grow", "curve")
        elif (np.diff(curve[:, 1]) < 0.99 * LEAST_SLOPE * wire[0] * np.diff(curve[:, 0])).any():
            least = LEAST_SLOPE * wire[0]
            yield Problem("a flow curve must rise", "curve", f"its slope is at least E/100000, here {least:.3g} MPa")
        if not 0 <= self.kinematic <= 1:
            yield Problem(f"the kinematic share lies between 0 and 1, not at {self.kinematic}", "kinematic")
        if not (np.isfinite(self.stretch) and self.stretch > 0):
            yield Problem(f"a stretch is positive, not {self.stretch}", "stretch")
        if self.points is not None and not _is_round(self.points):
            yield Problem("these fibres are no circle of unit diameter", "points", "take those of fibres.round_points")


def _is_round(points: Floats) -> bool:
    """Whether area and first and second moments are those of the circle of unit diameter, Eq. (12.2)."""
    if points.ndim != 2 or points.shape[1] != 3 or not (np.isfinite(points).all() and (points[:, 2] > 0).all()):
        return False
    y, z, share = points.T
    found = [share.sum(), share @ y, share @ z, share @ y**2, share @ z**2, share @ (y * z)]
    return bool(np.allclose(found, [1, 0, 0, 1 / 16, 1 / 16, 0], rtol=0, atol=1e-9))
