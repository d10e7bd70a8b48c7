"""What a press and release tells about the punch: how each crossing missed, and what the punch should answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from punchform.accuracy.weights import tributary_areas
from punchform.arrays import Floats, Ints
from punchform.errors import InputError
from punchform.optimise.correction_space import Space
from punchform.punch import Revolution
from punchform.run import Run
from punchform.whole import places_in

LIGHT = 1e-6
"""How little the smoothing holds back: relative to the mean square of the shapes, per square of their degree."""


@dataclass(frozen=True, eq=False)
class Misfit:
    """How a released grid of n crossings misses what is wanted, and where those lay on the punch.

    rms, p95, largest [mm]: of what is judged; places (n, 2) [mm]: in the tool; lift (n,): how far the punch moves along
    its normal there when it is raised by 1; error (n,) [mm]: along the normals of the target, led over to the
    uncorrected punch towards the rim, Eq. (13.3); weights (n,): area that counts for a fit; judged (n,): weight in the
    judgement, and deviation (n,) [mm] there; both weights add up to 1. run: what it was read from.
    """

    rms: float
    p95: float
    largest: float
    places: Floats
    lift: Floats
    error: Floats
    weights: Floats
    judged: Floats
    deviation: Floats
    run: Run | None = None

    def shapes(self, space: Space) -> Floats:
        """What a unit of each number of a space moves the punch along its normal, at the crossings (n, k)."""
        return np.asarray(space.columns(self.places) * self.lift[:, None])

    def answer(self, space: Space) -> Floats:
        """The numbers (k,) whose shape is that of the error: a light least squares, Eq. (13.4)."""
        return self._fit(space, self.error, self.weights)

    def left(self, space: Space) -> float:
        """The rms deviation [mm] that would be left if the shape followed a punch of this space one to one: of what is
        judged, in the measure that is."""
        over = self.deviation - self.shapes(space) @ self._fit(space, self.deviation, self.judged)
        whole, rest = (float(np.sqrt(self.judged @ values**2)) for values in (self.deviation, over))
        return rest * (self.rms / whole if whole > 0 else 1.0)

    def _fit(self, space: Space, values: Floats, weights: Floats) -> Floats:
        shapes = self.shapes(space)
        normal = shapes.T @ (weights[:, None] * shapes)
        degrees = np.array([term.n for term in space.terms], dtype=np.float64)
        light = LIGHT * np.trace(normal) / len(normal) * np.diag(1.0 + degrees**2)
        return np.asarray(np.linalg.solve(normal + light, shapes.T @ (weights * values)))


def misfit(run: Run, base: Revolution, space: Space) -> Misfit:
    """The misfit of a run over a punch whose surface without correction is `base`.

    Raises InputError for a run without accuracy.
    """
    accuracy = run.accuracy
    if accuracy is None:
        raise InputError.of("nothing is judged without a target", where="target")
    aligned, whole, final = accuracy.aligned, run.formed.whole, run.final.whole
    rows = judged_rows(run)
    # A trim leaves fewer crossings than were pressed: what was cut off tells nothing.
    pressed, places = places_in(whole.flat, final.flat)[rows], final.positions[rows]
    taper = space.taper(np.hypot(whole.positions[pressed, 0], whole.positions[pressed, 1]))
    deviation = aligned.deviations.normal[rows]
    known = np.isfinite(deviation)
    deviation = np.where(known, deviation, 0.0)
    error = taper * deviation + (1.0 - taper) * base.distance(places)
    area = tributary_areas(whole.positions, whole.cells)[pressed] * taper * known
    judged = accuracy.weights[rows] * known
    stated = accuracy.judged
    return Misfit(
        rms=stated.rms,
        p95=stated.p95,
        largest=max(stated.highest, -stated.lowest),
        places=whole.positions[pressed, :2],
        lift=whole.normals[pressed, 2],
        error=error,
        weights=area / area.sum(),
        judged=judged / judged.sum(),
        deviation=deviation,
        run=run,
    )


def judged_rows(run: Run) -> Ints:
    """The nodes of the final grid that a misfit has, in its order: crossings with a place."""
    final = run.final.whole
    return np.asarray(np.flatnonzero((final.between == 0) & np.isfinite(final.positions).all(axis=1)))
