"""What matters: the derivatives of a run's figures by the numbers of its case, and what tolerance each number needs.

Elastic grids are followed by their tangents, and the gradient of an rms by its adjoint, Eqs. (13.21)-(13.26). Where
there are none, as for wires that yield, complete runs on both sides of the number tell the slope. What is held by its
radius changes crossing by crossing: there the runs are a step of the grid apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from punchform.accuracy import Judged
from punchform.case import Case, number, unit, varied
from punchform.errors import InputError
from punchform.forces import forces
from punchform.optimise.adjoint import adjoint
from punchform.optimise.equilibria import Equilibria, equilibria, why_not
from punchform.optimise.figures import FIGURES, figure
from punchform.optimise.knots import STEP, Knot, between, family, knots, slope, step_of
from punchform.optimise.looks import Many, Seen, one_by_one, seen
from punchform.optimise.numbers import crossing_by_crossing, numbers
from punchform.optimise.tangents import judged, tangents_of
from punchform.run import Run

How = Literal["tangent", "differences", "a step apart"]
APART = 5e-3
"""How far complete runs are from the number on either side, as a part of it."""
BENT = 0.2
"""A figure whose two one-sided slopes differ by more than this part of their mean is told to be far from a line."""
OF_LOADS = ("compliance", "rms_deflection")


@dataclass(frozen=True)
class Sensitivity:
    """What one number does.

    value: of the number, in `unit`; slopes: of the figures by it, None where a figure is not known; shape: weighted
    rms of the rate at which the judged nodes move along the judged measure [mm per unit], None without a target or
    where nodes come and go; how: it was found; remark: what to know about it, else empty.
    """

    place: str
    value: float
    unit: str
    slopes: Mapping[str, float | None]
    shape: float | None
    how: How
    remark: str = ""

    def tolerance(self, rms: float, allowed: float) -> float | None:
        """How far the number may be off, to either side, so that an rms [mm] stays within what is allowed, Eq. (13.28).

        0 where the rms is beyond it already, None where that is not known, infinite for a number without effect.
        """
        slope_ = self.slopes.get("rms")
        if slope_ is None or self.shape is None:
            return None
        left = allowed**2 - rms**2
        if left <= 0:
            return 0.0
        drift = abs(rms * slope_)
        return float("inf") if self.shape == 0.0 else left / (drift + (drift**2 + left * self.shape**2) ** 0.5)


@dataclass(frozen=True)
class Sensitivities:
    """All of them: rows in the order of `places`; seen: the run itself; factorisations: beyond those of the run."""

    case: Case
    rows: tuple[Sensitivity, ...]
    figures: tuple[str, ...]
    seen: Seen
    why_differences: str
    runs: int
    factorisations: int


def sensitivities(
    base: Run, places: Sequence[str] | None = None, *, names: Sequence[str] = ("rms",), many: Many | None = None
) -> Sensitivities:
    """The derivatives of figures of a run by numbers of its case: all that vary, or those at given places.

    many: runs the cases that differences need; one after the other when it is not given. Raises InputError for places
    that hold no number and for figures that do not exist.
    """
    case = base.case
    places = numbers(case) if places is None else tuple(dict.fromkeys(places))
    for name in names:
        figure(name)
    for place in places:
        number(case, place)
    reason, rest, rows = why_not(base), None, dict[str, Sensitivity]()
    here = seen(base, names)
    if not reason:
        rest = equilibria(base)
        try:
            rows = _by_tangents(rest, [one for one in places if not crossing_by_crossing(one)], names)
        except InputError as error:
            reason = error.problems[0].message
    others = [place for place in places if place not in rows]
    rows |= _by_differences(case, here, others, names, many or one_by_one)
    return Sensitivities(
        case,
        tuple(rows[place] for place in places),
        tuple(names),
        here,
        reason,
        2 * len(others),
        0 if rest is None else rest.factorisations,
    )


def gradients(base: Run, places: Sequence[str], names: Sequence[str]) -> dict[str, dict[str, float]]:
    """Derivatives {figure: {place: dF/dp}} of figures of a run whose equilibria have tangents.

    Those of an rms by its adjoint, whose cost does not grow with the number of places. Raises InputError where
    `why_not` finds a reason, for a figure that the run does not have, and for places that hold no number.
    """
    rest = equilibria(base)
    steps = {place: step_of(base.case, place) for place in places}
    at = {place: knots(rest.ready, family(base.case, place), step) for place, step in steps.items()}
    found: dict[str, dict[str, float]] = {}
    others = []
    for name in names:
        of = figure(name).deviation
        if figure(name).of(base) is None:
            raise InputError.of(f"the run has no figure {name!r}")
        if of is None or rest.remembers:
            others.append(name)
        else:
            back = adjoint(rest, of)
            found[name] = {place: back.slope(at[place]) for place in places}
    loaded = any(name in OF_LOADS for name in others)
    runs = tangents_of(rest, [at[place] for place in places], loaded=loaded) if others else ()
    for place, moved in zip(places, runs, strict=False):
        for name in others:
            found.setdefault(name, {})[place] = float(
                slope(
                    [_figure(rest, name, knot, one) for knot, one in zip(at[place], moved, strict=True)], steps[place]
                )
            )
    return found


def _figure(rest: Equilibria, name: str, knot: Knot, moved: Run) -> float:
    """A figure of a run at a knot."""
    of = FIGURES[name].deviation
    if of is not None:
        measure, fitted = of.judged(rest.run.case)
        return judged(rest, knot, moved.final.state, measure, fitted=fitted).rms
    value = FIGURES[name].of(moved)
    assert value is not None
    return value


def _by_tangents(rest: Equilibria, places: Sequence[str], names: Sequence[str]) -> dict[str, Sensitivity]:
    """By following the equilibria, all numbers through one stage after the other."""
    case, rows = rest.run.case, dict[str, Sensitivity]()
    at: dict[str, tuple[Knot, ...]] = {}
    for place in places:
        try:
            at[place] = knots(rest.ready, family(case, place), step_of(case, place))
            if rest.run.loaded is not None:
                _demand_bearable(rest, at[place])
        except InputError as error:
            at.pop(place, None)
            rows[place] = _unknown(case, place, names, "tangent", f"cannot vary: {error.problems[0].message}")
    runs = tangents_of(rest, tuple(at.values()), loaded=any(name in OF_LOADS for name in names))
    for (place, near), moved in zip(at.items(), runs, strict=True):
        rows[place] = _by_tangent(rest, place, names, near, moved)
    return rows


def _demand_bearable(rest: Equilibria, at: Sequence[Knot]) -> None:
    """Raise InputError where a load of a knot cannot act on the grid as it was solved."""
    assert rest.run.released is not None
    for knot in at:
        assert knot.case.load is not None
        lengths = tuple(element.wire_length for element in knot.elements)
        forces(knot.grid, rest.run.released.state, knot.case.load, knot.case.wire, lengths)


def _by_tangent(
    rest: Equilibria, place: str, names: Sequence[str], at: Sequence[Knot], runs: Sequence[Run]
) -> Sensitivity:
    case, step = rest.run.case, between(at)
    slopes: dict[str, float | None] = {}
    shape: float | None = None
    for name in dict.fromkeys(("rms", *names)):
        of = FIGURES[name].deviation
        if of is None:
            slopes[name] = _slope([FIGURES[name].of(one) for one in runs], step)
        elif rest.run.accuracy is None:
            slopes[name] = None
        else:
            measure, fitted = of.judged(case)
            pairs = zip(at, runs, strict=True)
            looks = [judged(rest, knot, one.final.state, measure, fitted=fitted) for knot, one in pairs]
            slopes[name] = float(slope([look.rms for look in looks], step))
            if name == "rms":
                weights = rest.run.accuracy.weights[rest.run.accuracy.mask]
                shape = Judged(slope([look.deviations for look in looks], step), weights).rms
    return Sensitivity(place, number(case, place), unit(case, place), slopes, shape, "tangent")


def _slope(values: Sequence[float | None], step: float) -> float | None:
    known = [value for value in values if value is not None]
    return float(slope(known, step)) if len(known) == len(values) else None


def _by_differences(
    case: Case, here: Seen, places: Sequence[str], names: Sequence[str], many: Many
) -> dict[str, Sensitivity]:
    """By complete runs on both sides of each number; all of them are asked for at once, so that they can be shared."""
    asked: list[tuple[str, float]] = []
    cases: list[Case] = []
    rows: dict[str, Sensitivity] = {}
    for place in places:
        apart = _apart(case, place)
        try:
            both = [varied(case, {place: number(case, place) + sign * apart}) for sign in (-1, 1)]
        except InputError as error:
            rows[place] = _unknown(case, place, names, "differences", f"cannot vary: {error.problems[0].message}")
            continue
        asked.append((place, apart))
        cases += both
    answers = list(many(cases, names))
    for (place, apart), below, above in zip(asked, answers[::2], answers[1::2], strict=True):
        how: How = "a step apart" if crossing_by_crossing(place) else "differences"
        if isinstance(below, str) or isinstance(above, str):
            wrong = below if isinstance(below, str) else str(above)
            rows[place] = _unknown(case, place, names, how, f"a run beside it failed: {wrong}")
        else:
            rows[place] = _between(case, place, apart, (below, here, above), how)
    return rows


def _apart(case: Case, place: str) -> float:
    if crossing_by_crossing(place):
        return max(case.grid.step)
    value = abs(number(case, place))
    return APART * (value or step_of(case, place) / STEP)


def _between(case: Case, place: str, apart: float, looks: tuple[Seen, Seen, Seen], how: How) -> Sensitivity:
    """The slopes between the runs below and above a number, with what makes them doubtful."""
    below, here, above = looks
    slopes: dict[str, float | None] = {}
    bent = []
    for name, middle in here.figures.items():
        low, high = below.figures[name], above.figures[name]
        if low is None or high is None or middle is None:
            slopes[name] = None
            continue
        slopes[name] = (high - low) / (2 * apart)
        if abs(high + low - 2 * middle) > BENT * max(abs(high - low), 1e-6 * abs(middle)):
            bent.append(name)
    same = below.judged == here.judged == above.judged
    remark = "crossings come and go between the runs" if not same else ""
    if how == "a step apart":
        remark = f"held crossings change one by one: {_stepped(looks)}"
    elif bent and same:
        remark = f"{', '.join(bent)} not a line between the runs"
    shape = None
    known = below.deviations, here.deviations, above.deviations
    if same and how == "differences" and all(one is not None for one in known):
        low_side, middle_one, high_side = (one for one in known if one is not None)
        rate = (high_side.deviations - low_side.deviations) / (2 * apart)
        shape = Judged(rate, middle_one.weights).rms
    return Sensitivity(place, number(case, place), unit(case, place), slopes, shape, how, remark)


def _stepped(looks: tuple[Seen, Seen, Seen]) -> str:
    """What a step of the grid less and more does to the first figure that is known."""
    for name, middle in looks[1].figures.items():
        low, high = looks[0].figures[name], looks[2].figures[name]
        if low is not None and high is not None and middle is not None:
            return f"{name} {low - middle:+.3g} with one step less, {high - middle:+.3g} with one more"
    return "no figure is known"


def _unknown(case: Case, place: str, names: Sequence[str], how: How, remark: str) -> Sensitivity:
    nothing = dict.fromkeys(("rms", *names))
    return Sensitivity(place, number(case, place), unit(case, place), nothing, None, how, remark)
