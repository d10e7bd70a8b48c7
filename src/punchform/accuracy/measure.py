"""The accuracy of a shape: deviations, best fits, harmonics and the verdict, from arrays alone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from punchform.accuracy.crown import MIDDLE, WireSurface
from punchform.accuracy.deviation import MEASURES, Deviations, Measure, deviations, offset
from punchform.accuracy.facets import Facets, facets
from punchform.accuracy.fit import ALIGNMENTS, Fit, best_fit, implied_shift
from punchform.accuracy.harmonics import Harmonics, harmonics
from punchform.accuracy.hidden import hidden_error
from punchform.accuracy.statistics import Statistics, statistics
from punchform.accuracy.target import Target, place
from punchform.accuracy.weights import Aperture, tributary_areas
from punchform.arrays import Bools, Floats, Ints
from punchform.case import TargetCase
from punchform.errors import InputError


@dataclass(frozen=True)
class Judge:
    """What decides: the weighted rms of a measure in an alignment against the tolerance [mm]; None decides nothing."""

    tolerance: float | None = None
    measure: Measure = "normal"
    alignment: Literal["as held", "best fit"] = "as held"


@dataclass(frozen=True)
class Aligned:
    """The deviations in one alignment of the target.

    name: a key of ALIGNMENTS; deviations: of all n nodes, NaN for those without a place; statistics: per measure,
    of the judged nodes; implied_shift (3,) [mm]: of the focus of a paraboloid, of the vertex of others;
    harmonics: of the judged measure, None with too few nodes.
    """

    name: str
    fit: Fit
    deviations: Deviations
    statistics: MappingProxyType[Measure, Statistics]
    implied_shift: Floats
    harmonics: Harmonics | None

    @property
    def boresight_tilt(self) -> float:
        """Angle by which the axis of the best fit leans [rad]."""
        return self.fit.pose.tilt


@dataclass(frozen=True)
class Accuracy:
    """How near a shape comes to its target.

    mask (n,): the judged nodes; weights (n,): 0 outside the mask; alignments: as held first, then the best fits,
    narrow before wide; best_fit: the name of the one that is judged; surface: which surface of the wires is told of;
    facets: what flat cells add between perfect nodes, None without cells; within: the verdict, None without tolerance.
    """

    target: Target
    aperture: Aperture
    judge: Judge
    surface: WireSurface
    fit_measure: Measure
    weighting: str
    mask: Bools
    weights: Floats
    alignments: tuple[Aligned, ...]
    best_fit: str
    facets: Facets | None
    warnings: tuple[str, ...]

    @property
    def nodes(self) -> int:
        """Number of judged nodes."""
        return int(self.mask.sum())

    @property
    def as_held(self) -> Aligned:
        """The deviations from the target where it is meant to be."""
        return self.alignments[0]

    @property
    def fitted(self) -> Aligned:
        """The deviations after the best fit that is judged."""
        return self.named(self.best_fit)

    @property
    def aligned(self) -> Aligned:
        """The deviations in the alignment that is judged."""
        return self.aligned_for(self.judge)

    @property
    def judged(self) -> Statistics:
        """The statistics that decide."""
        return self.aligned.statistics[self.judge.measure]

    @property
    def within(self) -> bool | None:
        """Whether the judged rms keeps the tolerance."""
        return None if self.judge.tolerance is None else self.judged.rms <= self.judge.tolerance

    def aligned_for(self, judge: Judge) -> Aligned:
        """The deviations in the alignment that a judge asks for, be it that of another run."""
        return self.as_held if judge.alignment == "as held" else self.fitted

    def named(self, name: str) -> Aligned:
        """One alignment by its name. Raises KeyError for one that was not made."""
        for aligned in self.alignments:
            if aligned.name == name:
                return aligned
        raise KeyError(name)


def measure_case(
    points: Floats,
    cells: Ints,
    case: TargetCase,
    *,
    apex_height: float,
    surface: WireSurface = MIDDLE,
    mask: Bools | None = None,
) -> Accuracy:
    """The accuracy of points (n, 3) [mm] with cells (K, 4) by the [target] of a case, its vertex at z = apex_height.

    mask (n,): the judged nodes, when it is not the aperture that says so. Raises what `measure` and `place` raise.
    """
    target = place(case.profile, case.aperture_radius, apex_height=apex_height)
    aperture = Aperture(case.aperture_radius, case.inner_radius, case.taper or 0.0)
    judge = Judge(case.tolerance, case.measure, case.alignment)
    return measure(points, target, aperture, cells=cells, judge=judge, surface=surface, mask=mask)


def measure(
    points: Floats,
    target: Target,
    aperture: Aperture,
    *,
    cells: Ints | None = None,
    weights: Floats | None = None,
    judge: Judge | None = None,
    fit_measure: Measure | None = None,
    surface: WireSurface = MIDDLE,
    mask: Bools | None = None,
) -> Accuracy:
    """How near points (n, 3) [mm] come to the target inside the aperture.

    cells (K, 4): give each node its projected area, Eq. (9.6), or weights (n,) do; all nodes count alike without both.
    fit_measure: what the best fits minimise, half-path for paraboloids and normal for others unless given.
    surface: the deviations are told of points that far above the nodes; mask (n,): the judged nodes, so that none
    comes or goes between shapes that hardly differ; those in the aperture when it is not given. Raises InputError
    when the aperture holds too few nodes.
    """
    judge = judge or Judge()
    fit_measure = fit_measure or ("normal" if target.focal_length is None else "half-path")
    places = offset(points, target, surface.offset) if surface.offset else points
    mask = aperture.mask(points) if mask is None else mask
    weighed, weighting, notes = _weigh(points, cells, weights, aperture, mask)
    inside, heavy = places[mask], weighed[mask]
    narrow = "3-parameter" if target.focal_length is None else "4-parameter"
    wide = "5-parameter" if target.focal_length is None else "6-parameter"
    fits = {name: best_fit(inside, heavy, target, ALIGNMENTS[name], fit_measure) for name in ("as held", narrow, wide)}
    if math.isinf(fits[wide].condition):
        # A sphere or a plane looks the same after a shift and a tilt: there is nothing wider to tell.
        del fits[wide]
    else:
        notes += _doubts(inside, heavy, target, fits[narrow], fits[wide])
    return Accuracy(
        target=target,
        aperture=aperture,
        judge=judge,
        surface=surface,
        fit_measure=fit_measure,
        weighting=weighting,
        mask=mask,
        weights=weighed,
        alignments=tuple(
            _aligned(name, fit, places, mask, weighed, target, aperture, judge) for name, fit in fits.items()
        ),
        best_fit=narrow,
        facets=_facets(points, cells, mask, target),
        warnings=notes,
    )


def _weigh(
    points: Floats, cells: Ints | None, weights: Floats | None, aperture: Aperture, mask: Bools
) -> tuple[Floats, str, tuple[str, ...]]:
    """Weights (n,), 0 outside the mask, how they came about, and what must be known of them."""
    if weights is not None:
        area, what = weights, "given weights"
    elif cells is not None:
        area, what = tributary_areas(points, cells), "projected area of the node"
    else:
        area, what = np.ones(len(points)), "all nodes alike"
    if aperture.taper:
        what += f" x feed amplitude with {aperture.taper:g} dB at the edge"
    known = np.where(mask[:, None], points, 0.0)
    found = np.where(mask, area * aperture.illumination(known), 0.0)
    if not found.sum() > 0:
        raise InputError.of(
            f"no node of the grid lies between {aperture.inner_radius:g} mm and {aperture.radius:g} mm from the axis "
            "with an area of its own",
            where="target.aperture_radius",
            hint="take a larger aperture or a finer grid",
        )
    without = int((mask & (found == 0)).sum())
    notes = (f"{without} nodes of the aperture belong to no cell and have no weight",) if without else ()
    return found, what, notes


def _doubts(points: Floats, weights: Floats, target: Target, narrow: Fit, wide: Fit) -> tuple[str, ...]:
    warning = hidden_error(points, weights, target, narrow, wide)
    unsettled = [
        f"the {len(fit.free)}-parameter best fit did not settle; its figures are not the least"
        for fit in (narrow, wide)
        if not fit.converged
    ]
    return (*unsettled, *(() if warning is None else (warning,)))


def _aligned(
    name: str,
    fit: Fit,
    places: Floats,
    mask: Bools,
    weights: Floats,
    target: Target,
    aperture: Aperture,
    judge: Judge,
) -> Aligned:
    known: Bools = np.asarray(np.isfinite(places).all(axis=1))
    found = deviations(places[known], target, fit.pose)
    axial, normal, half_path = (_spread(part, known) for part in (found.axial, found.normal, found.half_path))
    everywhere = Deviations(axial, normal, half_path)
    return Aligned(
        name=name,
        fit=fit,
        deviations=everywhere,
        statistics=MappingProxyType({m: statistics(everywhere.of(m)[mask], weights[mask]) for m in MEASURES}),
        implied_shift=implied_shift(target, fit.pose),
        harmonics=harmonics(everywhere.of(judge.measure)[mask], places[mask], weights[mask], aperture.radius),
    )


def _spread(values: Floats, known: Bools) -> Floats:
    whole = np.full(len(known), np.nan)
    whole[known] = values
    return whole


def _facets(points: Floats, cells: Ints | None, mask: Bools, target: Target) -> Facets | None:
    if cells is None:
        return None
    return facets(points, cells[mask[cells].all(axis=1)], target)
