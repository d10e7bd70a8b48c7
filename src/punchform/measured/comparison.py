"""Measured against wanted and predicted: deviations, statistics, and whether the shape came out as predicted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from punchform.arrays import Bools, Floats, Ints
from punchform.case import Case
from punchform.errors import InputError
from punchform.measured.alignment import Alignment, Scene, Wish, align, fit_prediction, matched
from punchform.measured.callouts import call_outs
from punchform.measured.cloud import Cloud
from punchform.measured.fitting import fit_to_points
from punchform.measured.pose import Pose
from punchform.measured.reading import check_size
from punchform.measured.sheet import Sheet, sheet
from punchform.measured.statistics import Statistics, statistics
from punchform.measured.target import Reference, target_of, whole_punch

FEWEST = 4
FOLLOWS, IN_PART, UNLIKE = 0.3, 0.8, 0.5
"""Shares of the predicted deviation that may be left for "follows" and "follows in part"; a correlation that says
nothing."""


@dataclass(frozen=True)
class Predicted:
    """The grid of a run: index (N, 2), flat (N, 2) and nodes (N, 3) [mm]; stage: what these nodes are."""

    index: Ints
    flat: Floats
    nodes: Floats
    stage: Literal["formed", "released"]


@dataclass(frozen=True)
class Deviation:
    """Signed distances (N,) [mm] of aligned points, positive above the surface; direction (N, 3): its normal.

    inside (N,): points that lie over the part that counts; the others are NaN. table: of those that are counted.
    """

    value: Floats
    direction: Floats
    inside: Bools
    table: Statistics | None

    @property
    def vector(self) -> Floats:
        """From the nearest point of the surface to the measured one, (N, 3) [mm]."""
        return np.asarray(self.value[:, None] * self.direction)


@dataclass(frozen=True)
class SameShape:
    """Is the measured shape the predicted one? Rms values [mm] over `n` points, in their own best fit to it.

    left: measured - predicted; expected: predicted - wanted; found: measured - wanted; correlation of the last two;
    these three are None without a target. deviation (N,) [mm]: measured - predicted, NaN off the prediction.
    """

    n: int
    left: float
    expected: float | None
    found: float | None
    correlation: float | None
    deviation: Floats
    verdict: str


@dataclass(frozen=True)
class Comparison:
    """A cloud held against a run; aligned (N, 3) [mm] in the axes of the run, counted (N,): not dropped."""

    case: Case
    stage: str
    cloud: Cloud
    sheet: Sheet
    alignment: Alignment
    aligned: Floats
    target: Deviation | None
    prediction: Deviation
    shape: SameShape
    counted: Bools
    tolerance: float | None
    labelled: Ints
    notes: tuple[str, ...]

    @property
    def judged(self) -> Deviation:
        """The deviation that is judged and drawn: from the target, without one from the prediction."""
        return self.prediction if self.target is None else self.target

    @property
    def outliers(self) -> Bools:
        """Points (N,) that stray from all others."""
        return self.alignment.outliers

    @property
    def within(self) -> bool | None:
        """Whether the rms is within the tolerance; None when there is none."""
        table = self.judged.table
        return None if table is None else table.within


def compare(
    case: Case, predicted: Predicted, cloud: Cloud, wish: Wish | None = None, *, tolerance: float | None = None
) -> Comparison:
    """Align a cloud with a run and compare it with target and prediction.

    tolerance [mm]: of the rms, and of each point in the table; that of the target when not given. Raises InputError
    when the cloud cannot be of this run or cannot be aligned as wished.
    """
    wish = wish or Wish()
    scene = _scene(case, predicted)
    size_notes = check_size(cloud, _size(predicted.nodes))
    alignment = align(cloud, scene, wish)
    aligned = alignment.pose.to_run(cloud.points)
    counted = ~(alignment.outliers & wish.drop_outliers)
    if tolerance is None and case.target is not None:
        tolerance = case.target.tolerance
    target = None if scene.target is None else _deviation(aligned, scene.target, counted, tolerance)
    prediction = _deviation(aligned, scene.prediction, counted, tolerance)
    judged = prediction if target is None else target
    if judged.table is None:
        raise InputError.of(
            "no point of the aligned cloud lies over the part that counts",
            where=cloud.source,
            hint="check the units and the alignment",
        )
    return Comparison(
        case=case,
        stage=predicted.stage,
        cloud=cloud,
        sheet=scene.prediction,
        alignment=alignment,
        aligned=aligned,
        target=target,
        prediction=prediction,
        shape=_same_shape(cloud, scene, alignment, counted),
        counted=counted,
        tolerance=tolerance,
        labelled=call_outs(aligned, judged.value, judged.inside & counted),
        notes=(*cloud.notes, *size_notes, *alignment.notes, *_outlier_notes(cloud, alignment, wish)),
    )


def _scene(case: Case, predicted: Predicted) -> Scene:
    return Scene(
        punch=whole_punch(case),
        prediction=sheet(predicted.index, predicted.flat, predicted.nodes),
        target=target_of(case),
        nodes={(int(i), int(j)): number for number, (i, j) in enumerate(predicted.index)},
        rim_radius=case.tool.rim_radius,
        step=max(case.grid.step),
    )


def _size(nodes: Floats) -> float:
    return float(np.sqrt(((nodes - np.median(nodes, axis=0)) ** 2).sum(axis=1).mean()))


def _deviation(aligned: Floats, reference: Reference, counted: Bools, tolerance: float | None) -> Deviation:
    inside = reference.covers(aligned)
    value, direction = reference.distance_gradient(aligned)
    value = np.where(inside, value, np.nan)
    kept = value[inside & counted]
    return Deviation(value, direction, inside, statistics(kept, tolerance) if kept.size else None)


def _same_shape(cloud: Cloud, scene: Scene, alignment: Alignment, counted: Bools) -> SameShape:
    """Held against the prediction in its own best fit, so that another alignment does not pass for another shape."""
    pose = _fitted_to_prediction(cloud, scene, alignment, counted)
    aligned = pose.to_run(cloud.points)
    over = scene.prediction.covers(aligned)
    value, normal = scene.prediction.distance_gradient(aligned)
    deviation = np.where(over, value, np.nan)
    if scene.target is not None:
        over = over & scene.target.covers(aligned)
    kept = over & counted
    count = int(kept.sum())
    if count < FEWEST:
        return SameShape(count, np.nan, None, None, None, deviation, "too few points lie on the prediction to tell")
    left = _rms(value[kept])
    if scene.target is None:
        verdict = f"without a target only this can be said: {left:.3g} mm rms are left between measured and predicted"
        return SameShape(count, left, None, None, None, deviation, verdict)
    found, _ = scene.target.distance_gradient(aligned[kept])
    expected, _ = scene.target.distance_gradient((aligned - value[:, None] * normal)[kept])
    spread = float(found.std() * expected.std())
    correlation = float(np.mean((found - found.mean()) * (expected - expected.mean()))) / spread if spread > 0 else None
    verdict = _verdict(left, _rms(expected), _rms(found), correlation)
    return SameShape(count, left, _rms(expected), _rms(found), correlation, deviation, verdict)


def _fitted_to_prediction(cloud: Cloud, scene: Scene, alignment: Alignment, counted: Bools) -> Pose:
    if alignment.to in ("nodes", "prediction"):
        return alignment.pose
    mine, known = matched(cloud, scene)
    mine &= counted
    if mine.sum() >= FEWEST:
        return fit_to_points(cloud.points[mine], known[mine], weights=np.ones(int(mine.sum()))).pose
    if alignment.kind == "best-fit":
        return fit_prediction(cloud, scene, alignment.pose, counted).pose
    return align(cloud, scene, Wish(to="prediction")).pose


def _verdict(left: float, expected: float, found: float, correlation: float | None) -> str:
    told = f"{left:.3g} mm rms are left of {found:.3g} mm; the prediction expected {expected:.3g} mm"
    alike = correlation if correlation is not None else 0.0
    if expected < 0.5 * left and abs(alike) < UNLIKE:
        return f"cannot be told: next to what is left, hardly any deviation was predicted ({told})"
    if left <= FOLLOWS * expected and alike > 0.9:
        return f"yes, the measured shape follows the prediction ({told}, correlation {alike:.3f})"
    if left <= IN_PART * expected and alike > 0.6:
        return f"in part: the measured shape follows the prediction roughly ({told}, correlation {alike:.3f})"
    return f"no, the measured shape is another one than predicted ({told}, correlation {alike:.3f})"


def _outlier_notes(cloud: Cloud, alignment: Alignment, wish: Wish) -> tuple[str, ...]:
    strays = np.flatnonzero(alignment.outliers)
    if not strays.size:
        return ()
    names = ", ".join(cloud.names[row] for row in strays[:10]) + (", ..." if strays.size > 10 else "")
    done = "left out of fit and statistics" if wish.drop_outliers else "kept; --drop-outliers would leave them out"
    return (f"{strays.size} outlier{'s' if strays.size > 1 else ''} beyond 5 robust sigmas ({names}): {done}",)


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))
