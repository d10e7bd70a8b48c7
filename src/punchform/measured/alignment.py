"""From the axes of the measurement to those of the run: as given, by the rim, or by a best fit."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from punchform.arrays import Bools, Floats
from punchform.errors import InputError
from punchform.measured.cloud import Cloud
from punchform.measured.fitting import SMOOTH, Fit, descend, fit_to_points, fit_to_surface
from punchform.measured.pose import Pose, unmoved
from punchform.measured.rim import clocked, fit_plane, fit_rim, named_points, point_named, rim_band, turn_between
from punchform.measured.sheet import Sheet
from punchform.measured.start import NOISE, best_turn, cauchy, rough_pose
from punchform.measured.target import Reference, Target

ALIGNMENTS = ("best-fit", "rim", "as-given")
FITS = ("nodes", "target", "prediction")
OUTLIER = 5.0
"""So many robust sigmas make an outlier."""
FEWEST = 4
VAGUE = 0.1
"""A standard error of the shift above this share of a grid step is worth a note."""
PASSES, ROBUST_STEPS, MANY_TURNS = 5, 20, 5
MOTIONS = (*(f"shift along {axis}" for axis in "xyz"), "tilt about x", "tilt about y", "turn about the axis")

Kind = Literal["best-fit", "rim", "as-given"]
FitTo = Literal["nodes", "target", "prediction"]


@dataclass(frozen=True)
class Wish:
    """How a cloud shall be aligned.

    to: what a best fit goes to; None for nodes where the points are named by them, else the target, else the
    prediction. rim_points: comma list of names. clock: a point's name and its direction in plan [rad].
    """

    kind: Kind = "best-fit"
    to: FitTo | None = None
    rim_points: str | None = None
    clock: tuple[str, float] | None = None
    drop_outliers: bool = False


@dataclass(frozen=True)
class Alignment:
    """A fit in words: `kind`, `to` what it went ("" when as given), the fit, `outliers` (N,), and notes."""

    kind: Kind
    to: str
    fit: Fit
    outliers: Bools
    notes: tuple[str, ...]

    @property
    def pose(self) -> Pose:
        """Where the part lies in the measurement."""
        return self.fit.pose


@dataclass(frozen=True)
class Scene:
    """What a cloud is aligned in: the punch, the prediction, the target; the nodes by name; the rim and the step."""

    punch: Reference
    prediction: Sheet
    target: Target | None
    nodes: dict[tuple[int, int], int]
    rim_radius: float
    step: float


def align(cloud: Cloud, scene: Scene, wish: Wish) -> Alignment:
    """Align a cloud. Raises InputError when the wish cannot be met by these points."""
    found = _aligned(cloud, scene, wish, np.ones(len(cloud.points), np.bool_))
    strays = _outliers(cloud, scene, found)
    for _ in range(PASSES if wish.drop_outliers else 0):
        found = _aligned(cloud, scene, wish, ~strays)
        again = _outliers(cloud, scene, found)
        if np.array_equal(again, strays):
            break
        strays = again
    return replace(found, notes=(*found.notes, *_words(found.fit, wish.kind, scene.step)), outliers=strays)


def _aligned(cloud: Cloud, scene: Scene, wish: Wish, kept: Bools) -> Alignment:
    match wish.kind:
        case "as-given":
            fit = Fit(unmoved(), np.zeros((6, 6)), np.zeros(6, np.bool_), math.nan, math.nan, kept)
            return Alignment("as-given", "", fit, ~kept, ())
        case "rim":
            return _by_rim(cloud, scene, wish, kept)
        case _:
            return _best(cloud, scene, wish, kept)


def weights_of(cloud: Cloud) -> Floats:
    """Weights (N,) with mean 1: the inverse squares of the stated uncertainties, or all equal."""
    if cloud.sigma is None:
        return np.ones(len(cloud.points))
    weights = cloud.sigma**-2.0
    return np.asarray(weights / weights.mean())


def matched(cloud: Cloud, scene: Scene) -> tuple[Bools, Floats]:
    """Which points (N,) carry the name of a node of the run, and where it is predicted: (N, 3) [mm], NaN elsewhere."""
    known = np.full((len(cloud.points), 3), np.nan)
    for row in np.flatnonzero(cloud.named):
        number = scene.nodes.get((int(cloud.nodes[row, 0]), int(cloud.nodes[row, 1])))
        if number is not None:
            known[row] = scene.prediction.nodes[number]
    return np.isfinite(known[:, 0]), known


def straying(residual: Floats) -> Bools:
    """Where residuals (n,), NaN allowed, lie more than five robust sigmas from their median."""
    known = residual[np.isfinite(residual)]
    if not known.size:
        return np.zeros(len(residual), np.bool_)
    middle = float(np.median(known))
    sigma = NOISE * float(np.median(np.abs(known - middle)))
    # Below this a spread is rounding, as in a cloud made from the run itself.
    floor = 1e-9 * max(float(np.abs(known).max()), 1.0)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(residual - middle) > OUTLIER * sigma + floor)


def fit_prediction(cloud: Cloud, scene: Scene, start: Pose, kept: Bools) -> Fit:
    """The best fit of a cloud on the predicted surface, from a start that is near."""
    weights = weights_of(cloud)
    return fit_to_surface(cloud.points, scene.prediction, start, kept=kept, weights=weights, least=SMOOTH)


def _best(cloud: Cloud, scene: Scene, wish: Wish, kept: Bools) -> Alignment:
    mine, known = matched(cloud, scene)
    to = wish.to or ("nodes" if mine.sum() >= FEWEST else "target" if scene.target else "prediction")
    if to == "nodes":
        return _on_nodes(cloud, mine, known, kept)
    if to == "target" and scene.target is None:
        raise InputError.of("the case has no [target] to fit to", where="--fit-to target", hint="take prediction")
    start = rough_pose(cloud.points[kept], scene.punch)
    notes: tuple[str, ...] = ()
    if to == "target" and scene.target is not None:
        fit = fit_to_surface(cloud.points, scene.target, start, kept=kept, weights=weights_of(cloud))
    else:
        start, others = best_turn(cloud.points, scene.prediction, fit_prediction(cloud, scene, start, kept).pose, kept)
        fit = fit_prediction(cloud, scene, start, kept)
        notes = _turn_notes(others) if fit.determined[5] else ()
    if fit.used.sum() < FEWEST:
        raise InputError.of(
            f"only {int(fit.used.sum())} points lie on the {to}; a fit needs {FEWEST}",
            where=cloud.source,
            hint="check the units and whether the run is of this part",
        )
    return Alignment("best-fit", to, fit, ~kept, notes)


def _turn_notes(others: tuple[float, ...]) -> tuple[str, ...]:
    """What to know when a cloud fits about as well turned by the other angles [rad]."""
    if not others:
        return ()
    if len(others) >= MANY_TURNS:
        return ("the predicted shape is nearly round, so it hardly says how far the cloud is turned about the axis",)
    turns = ", ".join(f"{math.degrees(turn):.0f}°" for turn in others)
    return (f"turned about the axis by {turns} the cloud lies about as well; names of nodes would settle it",)


def _on_nodes(cloud: Cloud, mine: Bools, known: Floats, kept: Bools) -> Alignment:
    used = mine & kept
    if used.sum() < FEWEST:
        raise InputError.of(
            f"{int(used.sum())} points are named by nodes of the run; a fit needs {FEWEST}",
            where=cloud.source,
            hint='name points "i:j" as in nodes.csv, or give --fit-to target or prediction',
        )
    spread = np.linalg.svd(known[used] - known[used].mean(axis=0), compute_uv=False)
    if spread[1] < 1e-6 * max(float(spread[0]), 1e-300):
        raise InputError.of("the points named by nodes lie on one line", where=cloud.source)
    strangers = int((cloud.named & ~mine).sum())
    said = f"{strangers} points are named by nodes that the run does not have; they are used as points only"
    fit = fit_to_points(cloud.points[used], known[used], weights=weights_of(cloud)[used])
    return Alignment("best-fit", "nodes", replace(fit, used=used), ~kept, (said,) if strangers else ())


def _by_rim(cloud: Cloud, scene: Scene, wish: Wish, kept: Bools) -> Alignment:
    rough = rough_pose(cloud.points[kept], scene.punch)
    if wish.rim_points is not None:
        rim = named_points(cloud, wish.rim_points) & kept
        fit, radius = fit_rim(cloud.points, rim, rough, rim_radius=scene.rim_radius)
        first = (
            f"plane and circle go through {int(rim.sum())} named points; the radius of the circle is {radius:.6g} mm"
        )
    else:
        rim = rim_band(rough.to_run(cloud.points), scene.rim_radius, 0.5 * scene.step) & kept
        fit = _centred(cloud, scene, fit_plane(cloud.points, rim, rough), kept)
        first = (
            f"the plane goes through {int(rim.sum())} points within half a step of the radius of the rim; no points "
            "are named that mark its circle (--rim-points), so its middle is a best fit to the prediction"
        )
    fit, second = _clocked(cloud, scene, wish, fit, kept)
    return Alignment("rim", "rim", fit, ~kept, (first, second))


def _centred(cloud: Cloud, scene: Scene, plane: Fit, kept: Bools) -> Fit:
    """The plane shifted within itself to where the cloud fits the prediction best."""
    lateral = fit_to_surface(
        cloud.points,
        scene.prediction,
        plane.pose,
        kept=kept,
        weights=weights_of(cloud),
        least=SMOOTH,
        motions=np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
    )
    return replace(
        plane,
        pose=lateral.pose,
        covariance=plane.covariance + lateral.covariance,
        determined=plane.determined | lateral.determined,
        settled=lateral.settled,
    )


def _clocked(cloud: Cloud, scene: Scene, wish: Wish, fit: Fit, kept: Bools) -> tuple[Fit, str]:
    """The rim fit turned about its axis as far as anything says by how much, and what said so."""
    mine, known = matched(cloud, scene)
    if wish.clock is not None:
        name, direction = wish.clock
        row = point_named(cloud, name, where=f"--clock {name}")
        x, y, _ = fit.pose.to_run(cloud.points[[row]])[0]
        turn = math.remainder(math.atan2(y, x) - direction, 2 * math.pi)
        said = f"turned so that {name} lies at {math.degrees(direction):g}°"
        return clocked(fit, turn, fit.scatter / max(math.hypot(x, y), 1e-300)), said
    named = mine & kept
    if named.sum() >= 2:
        turn, error = turn_between(fit.pose.to_run(cloud.points[named]), known[named])
        return clocked(fit, turn, error), f"turned to the {int(named.sum())} points named by nodes"
    return fit, "not turned about the axis: no point says by how much; --clock NAME=ANGLE would"


def _outliers(cloud: Cloud, scene: Scene, found: Alignment) -> Bools:
    """Points (N,) that stray from the named nodes, or from target or prediction, whichever the cloud keeps closer to.

    Residuals are those of a fit in which strays pull little, so that one of them does not hide another.
    """
    mine, known = matched(cloud, scene)
    if found.to == "nodes":
        away = np.linalg.norm(found.pose.to_run(cloud.points) - known, axis=1)
        return straying(np.where(mine, away, np.nan))
    strays, narrowest = np.zeros(len(cloud.points), np.bool_), math.inf
    for reference in (scene.prediction, scene.target):
        if reference is None:
            continue
        over = reference.covers(found.pose.to_run(cloud.points))
        if over.sum() < FEWEST:
            continue
        pose, _ = descend(cloud.points[over], reference, found.pose, cauchy, least=SMOOTH, steps=ROBUST_STEPS)
        residual = np.where(over, reference.distance_gradient(pose.to_run(cloud.points))[0], np.nan)
        width = float(np.median(np.abs(residual[over] - np.median(residual[over]))))
        if width < narrowest:
            strays, narrowest = straying(residual), width
    return strays


def _words(fit: Fit, kind: Kind, step: float) -> tuple[str, ...]:
    """What a user must know about a fit before trusting it."""
    notes = []
    if fit.pose.tilt > 0.5 * math.pi:
        notes.append("the cloud was measured upside down (the hollow side up); it is turned over to the run")
    if kind == "best-fit":
        if not fit.settled:
            notes.append("the best fit did not settle: look at the deviation map before using its figures")
        lost = [name for name, ok in zip(MOTIONS, fit.determined, strict=True) if not ok]
        if lost:
            notes.append(f"not determined by these points: {', '.join(lost)}; left as first found")
        if fit.determined[:2].any() and float(fit.errors[:2][fit.determined[:2]].max()) > VAGUE * step:
            notes.append(
                "shift and tilt can hardly be told apart by these points (see the standard errors): named nodes or the "
                "rim hold them better"
            )
    return tuple(notes)
