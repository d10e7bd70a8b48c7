"""Which of several runs is nearer to the wanted shape, and why, in plain words. No HTML here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from punchform.accuracy import Accuracy, Aligned, Measure
from punchform.export.told import compared
from punchform.report.accuracy_words import PARTS, ROUNDING, in_the_tool, listed, lobes, makeup
from punchform.report.side_by_side import Side, changed_settings, settings
from punchform.report.words import percent, size

ALIKE = 1e-3
"""Runs whose rms differ by less than this part are told to be equally near."""
OF_THE_TOOL = 0.5
"""The tool is told of when its part of the difference in mean square is larger than this."""
TOLD = 6
"""So many settings that differ are named."""


@dataclass(frozen=True)
class Judged:
    """A run as the first one is judged: its deviation, the accuracy it is from, and its rms [mm]."""

    side: Side
    accuracy: Accuracy
    aligned: Aligned
    rms: float


def judged_alike(runs: Sequence[Side]) -> tuple[Judged, ...]:
    """The runs that have a target, nearest first, all by the measure and alignment of the first of them."""
    known = [(side, side.run.accuracy) for side in runs if side.run.accuracy is not None]
    if not known:
        return ()
    judge = known[0][1].judge
    found = []
    for side, accuracy in known:
        aligned = accuracy.aligned_for(judge)
        found.append(Judged(side, accuracy, aligned, aligned.statistics[judge.measure].rms))
    return tuple(sorted(found, key=lambda one: one.rms))


def nearest(runs: Sequence[Side]) -> str | None:
    """The name of the run that is nearest to the wanted shape; None where that cannot be told."""
    found = judged_alike(runs)
    return None if len(found) < 2 or _equally_near(found[0], found[1]) else found[0].side.name


def comparison_words(runs: Sequence[Side]) -> tuple[str, ...]:
    """Sentences: which run is nearest, which are within tolerance, why, and what differs in the cases."""
    return (*_nearness(runs), *_tolerances(runs), *_reasons(judged_alike(runs)), _settings(runs))


def _nearness(runs: Sequence[Side]) -> tuple[str, ...]:
    found = judged_alike(runs)
    if not found:
        return ("No run has a target: nothing says which is nearer to the wanted shape.",)
    if len(found) == 1:
        return (f"Only {found[0].side.name} has a target, so no run can be called the nearer one.",)
    judge = next(one.accuracy for one in found if one.side is _first(runs)).judge
    how = f"{judge.measure} deviation, {judge.alignment}"
    first, *others = found
    against = listed([f"{size(one.rms, 'mm', 3)} ({one.side.name})" for one in others])
    if _equally_near(first, others[0]):
        said = (
            f"{first.side.name} and {others[0].side.name} are equally near to the wanted shape: "
            f"{size(first.rms, 'mm', 3)} and {against} rms ({how})."
        )
    else:
        said = (
            f"{first.side.name} is {'nearest' if others[1:] else 'nearer'} to the wanted shape: "
            f"{size(first.rms, 'mm', 3)} rms ({how}), against {against}."
        )
    return said, *_after_fits(found, judge.measure), *_own_targets(found), *_own_judges(found, runs)


def _after_fits(found: Sequence[Judged], measure: str) -> tuple[str, ...]:
    """A remark when another run would be the nearest if its mounting and its feed could follow."""
    left = {one.side.name: one.accuracy.fitted.statistics[cast("Measure", measure)].rms for one in found}
    best, judged = min(left, key=lambda name: left[name]), found[0].side.name
    if best == judged or left[judged] - left[best] <= ALIKE * left[judged]:
        return ()
    return (
        f"Where mounting and feed may follow it is another one: after the best fits {best} has "
        f"{size(left[best], 'mm', 3)} left, {judged} {size(left[judged], 'mm', 3)}.",
    )


def _own_targets(found: Sequence[Judged]) -> tuple[str, ...]:
    """A warning when the runs are not held against the same shape."""
    wanted = [
        {key: value for key, value in settings(one.side.run.case).items() if key.startswith("target.") and _shapes(key)}
        for one in found
    ]
    if all(one == wanted[0] for one in wanted):
        return ()
    return ("Mind that each is held against a target of its own: the targets differ.",)


def _shapes(key: str) -> bool:
    return not key.startswith(("target.tolerance", "target.alignment", "target.measure"))


def _own_judges(found: Sequence[Judged], runs: Sequence[Side]) -> tuple[str, ...]:
    judge = next(one.accuracy for one in found if one.side is _first(runs)).judge
    others = [
        one.side.name
        for one in found
        if (one.accuracy.judge.measure, one.accuracy.judge.alignment) != (judge.measure, judge.alignment)
    ]
    if not others:
        return ()
    return (f"All are judged here as {_first(runs).name} is; the case of {listed(others)} asks otherwise.",)


def _tolerances(runs: Sequence[Side]) -> tuple[str, ...]:
    told = []
    for within, words in ((True, "Within"), (False, "Out of")):
        names = [side.name for side in runs if side.run.accuracy is not None and side.run.accuracy.within is within]
        if names:
            told.append(f"{words} tolerance: {listed(names)}.")
    return tuple(told)


def _reasons(found: Sequence[Judged]) -> tuple[str, ...]:
    """What the farthest run has more of than the nearest, and whether that is in the tool already."""
    if len(found) < 2 or _equally_near(found[0], found[-1]):
        return ()
    near, far = found[0], found[-1]
    more = far.rms**2 - near.rms**2
    told = []
    parts = {
        name: share * far.rms**2 - dict(makeup(near.aligned)).get(name, 0.0) * near.rms**2
        for name, share in makeup(far.aligned)
    }
    if parts and makeup(near.aligned):
        name = max(parts, key=lambda one: parts[one])
        what = f"is {PARTS[name]}" if name in PARTS else f"are its {lobes(int(name))}"
        told.append(
            f"Of what sets {far.side.name} behind {near.side.name} (the difference of the squares of their rms), "
            f"{_share(parts[name] / more)} {what}."
        )
    tools = [in_the_tool(compared(one.side.run), one.accuracy) for one in (near, far)]
    as_held = near.aligned is near.accuracy.as_held and near.accuracy.judge.measure == far.accuracy.judge.measure
    if tools[0] is not None and tools[1] is not None and as_held:
        if max(tools[0].rms, tools[1].rms) < ROUNDING:
            names = listed([one.side.name for one in (near, far)])
            told.append(
                f"In the tool the crossings of {names} lie on the target: the difference comes with the release."
            )
            return tuple(told)
        in_tool = (tools[1].rms ** 2 - tools[0].rms ** 2) / more
        where = "is there in the tool already" if in_tool > OF_THE_TOOL else "comes with the release"
        told.append(
            f"In the tool the same crossings lie {size(tools[0].rms, 'mm', 3)} ({near.side.name}) and "
            f"{size(tools[1].rms, 'mm', 3)} ({far.side.name}) rms from the target: most of the difference {where}."
        )
    return tuple(told)


def _settings(runs: Sequence[Side]) -> str:
    keys = [key for key, _ in changed_settings(runs)]
    if not keys:
        return "The cases are the same."
    more = f" and {len(keys) - TOLD} more" if len(keys) > TOLD else ""
    return f"The cases differ in {', '.join(f'`{key}`' for key in keys[:TOLD])}{more}."


def _share(part: float) -> str:
    return percent(part) if part <= 1.0 else "all, and more than outweighed elsewhere,"


def _first(runs: Sequence[Side]) -> Side:
    """The first run that has a target."""
    return next(side for side in runs if side.run.accuracy is not None)


def _equally_near(one: Judged, other: Judged) -> bool:
    return abs(one.rms - other.rms) <= ALIKE * max(one.rms, other.rms)
