"""What the accuracy comes to, in plain words: the verdict, what the error is made of, and what to try. No HTML here."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from punchform.accuracy import Accuracy, Statistics, deviations, offset, statistics
from punchform.case import HoldFrom
from punchform.export.result import largest
from punchform.report.words import percent, size
from punchform.wire.materials import materials

if TYPE_CHECKING:
    from punchform.accuracy import Aligned
    from punchform.run import Run

PARTS = {
    "mean": "an even offset",
    "rest": "ripple finer than these parts",
    "0": "an error of the profile that is the same all round (m = 0)",
    "1": "a tilt or a sideways shift (m = 1)",
    "2": "a saddle (m = 2)",
}
"""What a part of a deviation is called, by its name in `makeup`; the others are lobes."""
LOBES = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 8: "eight"}
TOLD = 0.9
"""Parts are told until they make this share of the mean square,"""
MOST_PARTS = 3
"""but no more than so many of them."""
SMALL = 0.05
"""A part that makes less than this share is not worth a word,"""
MUCH = 0.1
"""and lobes of more than this are worth a rib."""
BETTER = 0.8
"""A best fit is offered when it leaves less than this part of the rms."""
GONE = 0.25
"""With an rms of this part of its wanted depth a shape is not worth a fit or a correction of the punch."""
ROUNDING = 1e-6
"""An rms below this [mm] is none."""
OWN = 0.5
"""When the grid in the tool has this part of the error, the tool is to blame."""


def judgement(accuracy: Accuracy) -> str:
    """One sentence: the judged figure against the tolerance."""
    judged, judge = accuracy.judged, accuracy.judge
    figure = f"{size(judged.rms, 'mm', 3)} rms {judge.measure} deviation, {judge.alignment}"
    if judge.tolerance is None:
        return figure
    kept = "within" if accuracy.within else "out of"
    return f"{figure}: {kept} the tolerance of {size(judge.tolerance, 'mm', 3)}"


def accuracy_lead(run: Run) -> tuple[str, ...]:
    """Sentences: whether the shape is within tolerance, by how much, and what its error is made of; none without a
    target."""
    accuracy = run.accuracy
    if accuracy is None:
        return ()
    return tuple(filter(None, (_against_tolerance(run, accuracy), _made_of(accuracy), _in_the_tool(run, accuracy))))


def advice(run: Run) -> tuple[str, ...]:
    """What may be tried when the shape is out of tolerance, as far as the figures of the run suggest it.

    Wires that yield come first where elastic ones carry more than wires bear; the rest goes by the share of the mean
    square that it may take away: of a hold all that is not the same all round.
    """
    accuracy = run.accuracy
    if accuracy is None or accuracy.within is not False:
        return ()
    shares = dict(makeup(accuracy.aligned))
    even = shares.get("mean", 0.0) + shares.get("0", 0.0)
    lobes = sum(share for name, share in shares.items() if name.isdigit() and int(name) >= 2)
    hints = (
        (_fitted_away(accuracy), _by_fit(accuracy)),
        (even, _by_punch(run, accuracy, even)),
        (lobes, _by_ribs(run, lobes)),
        (1.0 - even, _by_hold(run, accuracy)),
    )
    ordered = sorted(hints, key=lambda hint: -hint[0])
    return tuple(filter(None, (_by_wire(run, accuracy), *(words for _, words in ordered))))


def makeup(aligned: Aligned) -> tuple[tuple[str, float], ...]:
    """The parts of a deviation and their shares of its mean square, largest first; empty where none are known.

    A part is named "mean", by its number of lobes, or "rest".
    """
    found = aligned.harmonics
    if found is None:
        return ()
    total = found.mean**2 + found.sigma**2
    if total == 0:
        return ()
    variance = found.sigma**2 / total
    parts = [("mean", found.mean**2 / total), ("rest", variance * found.residual)]
    parts += [(f"{part.m}", variance * part.share) for part in found.parts]
    return tuple(sorted(parts, key=lambda part: -part[1]))


def in_the_tool(run: Run, accuracy: Accuracy) -> Statistics | None:
    """The judged measure of the same nodes in the tool, as held; None without a release: then they are judged there."""
    if run.released is None:
        return None
    mask = accuracy.mask
    points = run.formed.whole.positions[mask]
    if accuracy.surface.offset:
        points = offset(points, accuracy.target, accuracy.surface.offset)
    found = deviations(points, accuracy.target)
    return statistics(found.of(accuracy.judge.measure), accuracy.weights[mask])


def _against_tolerance(run: Run, accuracy: Accuracy) -> str:
    judge, rms = accuracy.judge, accuracy.judged.rms
    stage = "formed" if run.released is None else "released"
    how = f"{judge.measure} deviation, {judge.alignment}"
    lies = f"the {stage} grid lies {size(rms, 'mm', 3)} rms from the target ({how})"
    if judge.tolerance is None:
        return f"{lies[:1].upper()}{lies[1:]}; there is no tolerance to judge it by."
    limit = size(judge.tolerance, "mm", 3)
    if not accuracy.within:
        return f"Out of tolerance: {lies}, {size(rms / judge.tolerance, '', 3)} times the {limit} that are allowed."
    kept = f"Within tolerance: {lies}, {percent(rms / judge.tolerance)} of the {limit} that are allowed."
    if run.released is not None and run.released.stability.negative:
        return f"{kept} But the grid would not stay in this shape, see the release below."
    return kept


def _made_of(accuracy: Accuracy) -> str:
    aligned = accuracy.aligned
    told: list[str] = []
    sum_of_shares = 0.0
    for name, share in makeup(aligned):
        if share < SMALL or sum_of_shares >= TOLD or len(told) == MOST_PARTS:
            break
        told.append(f"{percent(share) if share < 0.995 else 'all'} {_part_words(name, aligned)}")
        sum_of_shares += share
    return f"Of its mean square, {listed(told)}." if told else ""


def _part_words(name: str, aligned: Aligned) -> str:
    if name == "mean":
        mean = 0.0 if aligned.harmonics is None else aligned.harmonics.mean
        return (
            f"is {PARTS[name]} (it lies {size(abs(mean), 'mm', 3)} too {'high' if mean > 0 else 'low'} on the average)"
        )
    return f"is {PARTS[name]}" if name in PARTS else f"makes {lobes(int(name))}"


def part(name: str) -> str:
    """What a part of a deviation is called, by its name in `makeup`."""
    return PARTS[name] if name in PARTS else lobes(int(name))


def lobes(m: int) -> str:
    """So many lobes around the axis, in words."""
    return f"{LOBES.get(m, m)} lobes (m = {m})"


def _in_the_tool(run: Run, accuracy: Accuracy) -> str:
    before = in_the_tool(run, accuracy)
    if before is None:
        return ""
    rms = f"In the tool the same crossings lie {size(before.rms, 'mm', 3)} rms from the target"
    if before.rms < ROUNDING:
        rms = "In the tool the same crossings lie on the target"
    if before.rms > OWN * accuracy.as_held.statistics[accuracy.judge.measure].rms:
        return f"{rms}: the error is in the punch already."
    return f"{rms}: the error comes with the release."


def _by_wire(run: Run, accuracy: Accuracy) -> str:
    """Elastic wires that spring back by more than is allowed, with a stress that wires do not bear."""
    before, most = in_the_tool(run, accuracy), largest(run.formed.whole.stress)
    if run.formed.hardening is not None or before is None or most is None:
        return ""
    if before.rms > OWN * accuracy.as_held.statistics[accuracy.judge.measure].rms:
        return ""
    strongest = max(materials(), key=lambda one: one.tensile_strength)
    ratio = largest(run.formed.whole.stress_ratio) or 0.0
    if most > strongest.tensile_strength:
        breaks = f"the strongest in `punchform materials`, {strongest.name}, breaks at "
        why = f"no wire bears {size(most, 'MPa')} ({breaks}{size(strongest.tensile_strength, 'MPa')})"
    elif ratio > 1:
        why = f"{size(most, 'MPa')} are {size(ratio, '', 3)} times the yield strength"
    else:
        return ""
    clamp = "" if run.case.press.rim == "clamp" else ' and clamp the rim (`press.rim = "clamp"`): stretch forming'
    return (
        f"Take a wire that yields: {why}, and what this elastic one stores springs back. Say how it yields "
        f"(`wire.material` or `wire.hardening`){clamp}. What has flowed stays when the punch has gone."
    )


def _fitted_away(accuracy: Accuracy) -> float:
    """The share of the mean square that the best fit takes away."""
    left = accuracy.fitted.statistics[accuracy.judge.measure].rms
    return 1.0 - (left / accuracy.judged.rms) ** 2


def _by_fit(accuracy: Accuracy) -> str:
    if accuracy.aligned is not accuracy.as_held:
        return ""
    fit, measure = accuracy.fitted, accuracy.judge.measure
    left, f = fit.statistics[measure].rms, fit.fit.pose.f
    if left > BETTER * accuracy.judged.rms or _gone(accuracy):
        return ""
    moved = float(np.linalg.norm(fit.implied_shift))
    what = "the vertex moves" if f is None else f"the focal length may be {size(f, 'mm')}, which moves the focus"
    return (
        f"Where the mounting and the feed may follow, judge the best fit (`target.alignment`): {size(left, 'mm', 3)} "
        f"rms would be left, if {what} by {size(moved, 'mm', 3)}."
    )


def _by_hold(run: Run, accuracy: Accuracy) -> str:
    if run.case.release is None:
        return "This is the grid in its tool: change the punch. A [release] shows what is left when the punch has gone."
    hold, edge = run.case.release.hold, accuracy.aperture.radius
    further = f"`release.hold = {{ from_radius = ... }}` no larger than the aperture of {edge:g} mm"
    if isinstance(hold, HoldFrom):
        if hold.from_radius <= edge:
            return ""
        return (
            f"Hold it further in: what lies between the aperture and {hold.from_radius:g} mm is let go, and bends "
            f"back. Try {further}."
        )
    if hold == "nothing":
        back = "" if run.formed.hardening else "elastic wires that nothing holds go back to the flat grid, and "
        return (
            f"Hold it: {back}nothing says where a grid stands that nothing holds. "
            f'Try {further}, or `release.hold = "rim"`.'
        )
    return f"Hold directions too: this hold lets the wires turn where they are held. Try {further}."


def _by_ribs(run: Run, lobes: float) -> str:
    if lobes < MUCH or run.case.release is None:
        return ""
    ribs = "more ribs (`release.ribs`)" if run.case.release.ribs else "ribs (`release.ribs`), a hoop or spokes,"
    return f"Lobes make {percent(lobes)} of the mean square: {ribs} would hold their heights."


def _by_punch(run: Run, accuracy: Accuracy, even: float) -> str:
    if run.released is None or even < OWN or _gone(accuracy):
        return ""
    return (
        f"{percent(even)} of the mean square is the same all round: another profile of the punch can answer that "
        "part. `punchform compensate` finds it, or says why the released shape does not follow the punch."
    )


def _gone(accuracy: Accuracy) -> bool:
    surface = accuracy.target.surface
    top, edge = surface.chain.height(np.array([0.0, accuracy.aperture.radius]))
    return accuracy.judged.rms > GONE * abs(float(top - edge))


def listed(parts: list[str]) -> str:
    """Words as a person lists them: one, two and three."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
