"""A case whose punch is compensated: the whole job, from a case to the case with the corrected punch."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from punchform.arrays import Floats
from punchform.case import Case, varied
from punchform.errors import InputError, NoEquilibrium
from punchform.optimise.compensation import Compensation, Ending, Limits, compensate
from punchform.optimise.correction_space import KINDS, Kind, Space, numbers_of, space
from punchform.optimise.equilibria import why_not
from punchform.optimise.figures import in_its_tool
from punchform.optimise.misfit import Misfit, misfit
from punchform.optimise.reach import Reach, probing, reach, reach_by_tangents
from punchform.optimise.remedies import Remedy, tried
from punchform.prepare import prepare
from punchform.progress import Observer, silent
from punchform.punch import Revolution, uncorrected
from punchform.run import Run, run

PLACE = "punch.correction"


@dataclass(frozen=True, eq=False)
class Compensated:
    """What became of the punch of a case.

    kind: of surface that was asked for; found: its compensation; others: of the kinds that a simpler machine makes;
    floors: for each kind the rms [mm] that a punch of it would leave if the shape followed it one to one, from the
    first solve; reach: what the punch can do about the error, where that was measured; remedies: what else was tried
    where the punch does nothing, over the punch as it was, least rms first; given: the case as it was; case:
    with the best correction; other_cases: the same of the other kinds; tolerance [mm]; notes: what to beware of.
    """

    kind: Kind
    found: Compensation
    others: Mapping[Kind, Compensation]
    floors: Mapping[Kind, float]
    reach: Reach | None
    remedies: tuple[Remedy, ...]
    given: Case
    case: Case
    other_cases: Mapping[Kind, Case]
    tolerance: float | None
    notes: tuple[str, ...]

    @property
    def before(self) -> Misfit:
        """The misfit over the punch that it began with."""
        return _known(self.found.first.misfit)

    @property
    def after(self) -> Misfit:
        """The misfit over the best punch."""
        return _known(self.found.best.misfit)

    @property
    def run(self) -> Run:
        """The run over the best punch."""
        assert self.after.run is not None
        return self.after.run

    @property
    def within(self) -> bool | None:
        """Whether the best punch keeps the tolerance."""
        return None if self.tolerance is None else self.after.rms <= self.tolerance

    @property
    def moved(self) -> bool:
        """Whether a correction has helped."""
        return self.found.best is not self.found.first


@dataclass(frozen=True)
class Wish:
    """What is asked for: the kind of surface; limits of the search; compare: search the other kinds to their end too,
    instead of pressing once over the simpler ones; response: measure it also for wires that yield."""

    kind: Kind = "field"
    limits: Limits = field(default_factory=Limits)
    compare: bool = False
    response: bool = False


def compensate_case(case: Case, wish: Wish, *, observe: Observer = silent) -> Compensated:
    """Compensate the punch of a case for its target.

    Raises InputError for a case without punch or target, and NoEquilibrium when the punch as it is cannot be pressed.
    """
    job = _Job(case, observe)
    asked = job.space(wish.kind)
    tolerance = wish.limits.tolerance
    found = compensate(job.press(asked), asked, wish.limits, start=numbers_of(case, asked), observe=observe)
    first = _known(found.first.misfit)
    floors = {kind: first.left(job.space(kind)) for kind in KINDS}
    others = job.others(wish, found)
    # Elastic wires are pressed in a few seconds, so that what would help can be tried.
    explained = found.ending is Ending.UNMOVED and not case.wire.yields
    measured = job.reach(found, asked) if wish.response or explained else None
    done = Compensated(
        kind=wish.kind,
        found=found,
        others=others,
        floors=floors,
        reach=measured,
        remedies=tried(case, observe=observe) if explained else (),
        given=case,
        case=case if found.best is found.first else job.case(asked, found.best.numbers),
        other_cases={kind: job.case(one.space, one.best.numbers) for kind, one in others.items()},
        tolerance=tolerance,
        notes=(),
    )
    return replace(done, notes=tuple(_doubts(done)))


class _Job:
    """The presses of one case."""

    def __init__(self, case: Case, observe: Observer) -> None:
        self._case, self._observe = case, observe
        self._base: Revolution = uncorrected(case.tool)
        if in_its_tool(case):
            raise InputError.of(
                "is missing: a grid in its tool has not sprung back, so there is nothing to answer",
                where="release",
                hint="say in [release] what is held when the punch has gone",
            )
        if case.target is None:
            # The message on what is missing, before anything is built.
            space(case, "field", nodes=0, mirrored=True)
            raise AssertionError("a case without target has no space")
        grid = prepare(case).grid
        within = np.hypot(*grid.flat.T) <= case.target.aperture_radius
        self._nodes, self._mirrored = int((grid.crossings & within).sum()), grid.quarter
        self._start: dict[Kind, Floats] = {}

    def space(self, kind: Kind) -> Space:
        return space(self._case, kind, nodes=self._nodes, mirrored=self._mirrored)

    def case(self, space: Space, numbers: Floats) -> Case:
        """The case with a correction."""
        if not numbers.any():
            return self._case
        return varied(self._case, {PLACE: space.correction(numbers)})

    def press(self, space: Space) -> Callable[[Floats], Misfit]:
        """From the numbers of a correction to its misfit."""
        return lambda numbers: misfit(self._run(self.case(space, numbers)), self._base, space)

    def _run(self, case: Case) -> Run:
        done = run(case, observe=self._observe)
        if not done.formed.outcome.usable:
            raise NoEquilibrium(f"press: {done.formed.outcome.value}")
        return done

    def others(self, wish: Wish, found: Compensation) -> dict[Kind, Compensation]:
        """The other kinds of surface: searched to their end where that is asked for, else, after a full field, pressed
        once over what they can take of the answer."""
        best = _known(found.best.misfit)
        idle = found.best is found.first or found.ending is Ending.UNMOVED
        if idle and not wish.compare:
            return {}
        done: dict[Kind, Compensation] = {}
        for kind in KINDS:
            if kind == wish.kind or (not wish.compare and wish.kind != "field"):
                continue
            other = self.space(kind)
            begin = fitted(found.space, found.best.numbers, other, best)
            limits = wish.limits if wish.compare else replace(wish.limits, solves=1)
            known = None if begin.any() else found.first.misfit
            done[kind] = compensate(self.press(other), other, limits, start=begin, known=known, observe=self._observe)
        return done

    def reach(self, found: Compensation, asked: Space) -> Reach | None:
        """The response around the punch that it began with."""
        probes, here = probing(asked), _known(found.first.misfit)
        if found.first.numbers.any():
            return None
        step = min(self._case.grid.step)
        assert here.run is not None
        if not why_not(here.run):
            return reach_by_tangents(lambda numbers: self.case(probes, numbers), here, probes, step=step)
        central = not self._case.wire.yields
        return reach(self.press(probes), here, probes, step=step, central=central, observe=self._observe)


def fitted(space: Space, numbers: Floats, other: Space, here: Misfit) -> Floats:
    """The numbers of another space whose correction is nearest to that of these."""
    return replace(here, error=here.shapes(space) @ numbers).answer(other)


def _known(found: Misfit | None) -> Misfit:
    assert found is not None, "the first and the best solve have not failed"
    return found


def _doubts(done: Compensated) -> Iterator[str]:
    """What to beware of: nothing that springs back, an aperture that the correction does not cover, holds that jump."""
    target, asked = done.given.target, done.found.space
    assert target is not None
    if target.aperture_radius > 0.5 * (asked.start + asked.end):
        yield (
            f"the correction dies out from {asked.start:g} mm to the rim at {asked.end:g} mm, but the dish is judged "
            f"up to {target.aperture_radius:g} mm: its outermost ring is hardly corrected; give the punch a wider rim"
        )
    runs = [one.misfit.run for one in done.found.solves if one.misfit is not None]
    held = [one.released.hold.count for one in runs if one is not None and one.released is not None]
    if len(set(held)) > 1:
        yield (
            f"between {min(held)} and {max(held)} nodes were held in the releases: some cross the radius of the hold "
            "as the punch changes, which lets the error jump a little"
        )
