"""What a compensation comes to, in words that a toolmaker understands, and what would help where it fails. No HTML."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from punchform.optimise.compensation import Ending
from punchform.optimise.remedies import Name, Remedy, remedies_of
from punchform.report.accuracy_words import lobes
from punchform.report.words import percent, size

if TYPE_CHECKING:
    from punchform.case import Case
    from punchform.optimise.compensated import Compensated
    from punchform.optimise.compensation import Compensation, Solve
    from punchform.optimise.correction_space import Kind
    from punchform.optimise.reach import Reach

NAMES: dict[Kind, str] = {"field": "full field", "revolution": "lathe", "lobes": "lathe + 4 lobes"}
"""The kinds of surface in short."""
MADE: dict[Kind, str] = {
    "field": "A punch milled to the full height field",
    "revolution": "A turned punch, the same all round, as a lathe makes it,",
    "lobes": "A turned punch with four lobes added",
}
HEAD = ("punch", "solve", "rms [mm]", "p95 [mm]", "max [mm]", "correction [mm]", "follows", "")
ADVICE: dict[Name, str] = {
    "soft": "Let the wires yield: annealed wire (`wire.material`), stretched over the punch with the rim clamped "
    '(`press.rim = "clamp"`). What has flowed stays, and then the shape follows the punch, as in `packaged:dish600`.',
    "weld": 'Weld the crossings (`grid.crossing = "welded"`): the meshes then keep their corners.',
    "pull": "Pull the wires taut over the punch and hold them so (`press.pull`), with {force} on every wire end.",
    "ribs": "Put ribs under the finished grid (`release.ribs`), such as a hoop of {radius} and eight spokes: what lies "
    "on them at the right height does not sag.",
    "hold": "Hold the finished grid further in (`release.hold`), such as from {radius} on, where the antenna allows "
    "it.",
}
"""What is said for each remedy."""
BRIEFLY: dict[Name, str] = {
    "soft": "annealed wires and a clamped rim",
    "weld": "welded crossings",
    "pull": "wires pulled taut",
    "ribs": "ribs",
    "hold": "holding it further in",
}
HELPS = 0.8
"""A remedy helps when it leaves less than this part of the rms."""
TOLD = 0.05
"""Lobes that make less than this share of what is left are not told of."""
CLEAR = 0.05
"""A figure that differs by less than this part is told as the same."""


def solve_rows(done: Compensated) -> tuple[tuple[str, ...], ...]:
    """The table of all presses and releases: its head and its rows."""
    rows = [(NAMES[kind], *_row(one, found)) for kind, found in all_found(done).items() for one in found.solves]
    return (HEAD, *rows)


def all_found(done: Compensated) -> dict[Kind, Compensation]:
    """The compensations by their kind of surface, that which was asked for first."""
    return {done.kind: done.found, **done.others}


def explained(done: Compensated) -> tuple[str, ...]:
    """Sentences: what came of it, whether that is within tolerance, what other punches would leave, and why no more."""
    if not done.moved:
        return (*_as_it_was(done), *_reach(done))
    why = (_why(done.given),) if done.found.ending is Ending.UNMOVED else ()
    return (_gain(done), _verdict(done), *why, *_others(done), *_reach(done))


def remedies(done: Compensated) -> tuple[str, ...]:
    """What would help where the punch alone does not, as far as the case does not do it already: what was tried with
    what it leaves, the best first."""
    if done.within is not False or done.found.ending is Ending.LIMIT:
        return ()
    if done.found.ending is Ending.FLOOR:
        return tuple(filter(None, (_better_punch(done),)))
    if done.remedies:
        helps = [one for one in done.remedies if one.rms is not None and one.rms < HELPS * done.before.rms]
        return (*(_advised(one) for one in helps), *_no_help(done, helps))
    known = [_advised(one) for one in remedies_of(done.given) if one.name != "weld"]
    return tuple(filter(None, (_by_stretching(done.given), *known)))


def _row(one: Solve, found: Compensation) -> tuple[str, ...]:
    kept = "best" if one is found.best else ""
    follows = "" if one.follows is None else f"{100 * one.follows:.0f} %"
    if one.misfit is None:
        return (f"{one.number}", "failed", "", "", f"{one.correction:.3f}", "", one.failure)
    figures = (one.misfit.rms, one.misfit.p95, one.misfit.largest, one.correction)
    return (f"{one.number}", *(_short(value) for value in figures), follows.replace("-", "−"), kept)


def _short(value: float) -> str:
    return size(value, "", 4 if abs(value) >= 1 else 3)


def _gain(done: Compensated) -> str:
    target, best = done.given.target, done.found.best
    assert target is not None
    solves = f"{len(done.found.solves)} presses and releases"
    return (
        f"With a punch that is corrected by up to {size(best.correction, 'mm', 3)} the released grid lies "
        f"{size(done.after.rms, 'mm', 3)} rms from the target ({target.measure} deviation, {target.alignment}), over "
        f"the punch as it was {size(done.before.rms, 'mm', 4)}: {size(done.found.gain, '', 3)} times less, after "
        f"{solves}."
    )


def _verdict(done: Compensated) -> str:
    if done.tolerance is None:
        return f"The search ended: {done.found.ending.value}."
    limit = size(done.tolerance, "mm", 3)
    if done.within:
        return f"That is within the {limit} that were asked for."
    return f"That is out of the {limit} that were asked for; {done.found.ending.value}."


def _others(done: Compensated) -> tuple[str, ...]:
    """What simpler punches would leave: pressed, with the floor that their kind of surface has."""
    said = []
    for kind, found in done.others.items():
        best = found.best.misfit
        assert best is not None
        pressed = "searched to its end" if len(found.solves) > 1 else "pressed once"
        floor = f", and {size(found.floor, 'mm', 3)} at the least"
        if found.floor > (1 - CLEAR) * best.rms:
            floor = ", which is its floor" + (": it cannot answer the lobes" if kind == "revolution" else "")
        kept = "" if done.tolerance is None else (" (within)" if best.rms <= done.tolerance else " (out of tolerance)")
        said.append(f"{MADE[kind]} would leave {size(best.rms, 'mm', 3)} rms{kept}, {pressed}{floor}.")
    return tuple(said)


def _as_it_was(done: Compensated) -> tuple[str, ...]:
    before = size(done.before.rms, "mm", 3)
    if done.within:
        assert done.tolerance is not None
        limit = size(done.tolerance, "mm", 3)
        return (
            f"Over the punch as it is the released grid lies {before} rms from the target, within the {limit} that "
            "were asked for: there is nothing to correct. A smaller length for --to goes on.",
        )
    if done.found.ending is Ending.FLOOR:
        return (
            f"The released grid lies {before} rms from the target, and no punch of this kind of surface would do much "
            "better: what is left has more or other lobes than it can have.",
        )
    if done.found.ending is Ending.LIMIT:
        return (f"The released grid lies {before} rms from the target; {done.found.ending.value}.",)
    return (_did_not_help(done), _why(done.given))


def _did_not_help(done: Compensated) -> str:
    before = size(done.before.rms, "mm", 3)
    pressed = [one for one in done.found.solves[1:] if one.misfit is not None]
    if not pressed:
        return (
            f"The released grid lies {before} rms from the target over the punch as it is; over the punches that "
            f"should answer this error it could not be pressed: {done.found.solves[-1].failure}."
        )
    first = pressed[0]
    assert first.misfit is not None
    return (
        f"No correction of the punch that was tried brings this grid to its target. Over the punch as it is the "
        f"released grid lies {before} rms from it; over a punch that was corrected by this error, by up to "
        f"{size(first.correction, 'mm', 3)}, it lies {size(first.misfit.rms, 'mm', 3)} from it."
    )


def _why(case: Case) -> str:
    if not case.wire.yields:
        return (
            "The wires stay elastic: when the punch has gone they do not keep the bends that it gave them, but spring "
            "back into the shape that is easiest for them between what still holds them. Another punch changes where "
            "they begin, and hardly where they end."
        )
    return (
        "What the wires have kept of the shape when the punch has gone is decided by how far they have yielded and by "
        "what holds them, more than by the height of the punch."
    )


def _reach(done: Compensated) -> tuple[str, ...]:
    reach = done.reach
    if reach is None:
        return ()
    made = _lobes(reach)
    shapes = f" ({made})" if made else ""
    said = (
        f"By small, smooth changes of the punch {percent(reach.beyond)} of the squared error cannot be moved: "
        f"{size(reach.left, 'mm', 3)} rms lies in shapes that take less than half of what the punch is changed by"
        f"{shapes}."
    )
    if done.tolerance is not None and reach.left > done.tolerance:
        said += f" The tolerance is {size(done.tolerance, 'mm', 3)}."
    return (said,)


def _lobes(reach: Reach) -> str:
    """What the part that is not moved is made of, largest first."""
    total = sum(part**2 for part in reach.lobes.values())
    parts = sorted(reach.lobes.items(), key=lambda part: -part[1])
    told = [f"{size(rms, 'mm', 2)} {_shape(m)}" for m, rms in parts if total > 0 and rms**2 > TOLD * total]
    return told[0] if len(told) == 1 else f"{', '.join(told[:-1])} and {told[-1]}" if told else ""


def _shape(m: int) -> str:
    if m == 0:
        return "the same all round"
    return f"in {lobes(m)}"


def _better_punch(done: Compensated) -> str:
    if done.kind == "field" or not done.moved:
        return ""
    best = min(done.floors.items(), key=lambda one: one[1])
    if best[0] == done.kind or best[1] > 0.5 * done.found.floor:
        return ""
    return (
        f"Mill the punch instead of turning it (`--surface {best[0]}`): if the shape follows it as it did, "
        f"{size(best[1], 'mm', 2)} rms would be left."
    )


def _advised(remedy: Remedy) -> str:
    left = "" if remedy.rms is None else f" Tried over the punch as it is: {size(remedy.rms, 'mm', 3)} rms."
    return ADVICE[remedy.name].format(**_sizes(remedy)) + left


def _sizes(remedy: Remedy) -> dict[str, str]:
    """The radius or force that a remedy names."""
    match remedy.changes:
        case {"release.ribs": [{"radius": radius}, *_]} | {"release.hold": {"from_radius": radius}}:
            return {"radius": f"{radius:g} mm"}
        case {"press.pull": (float(force), _)}:
            return {"force": f"{force:g} N"}
    return {}


def _no_help(done: Compensated, helps: Sequence[Remedy]) -> tuple[str, ...]:
    """What was tried in vain."""
    idle = [one for one in done.remedies if one.rms is not None and one not in helps]
    if not idle:
        return ()
    told = " and ".join(f"{BRIEFLY[one.name]} ({size(one.rms or 0.0, 'mm', 3)} rms)" for one in idle)
    return (f"What would not help here: {told}.",)


def _by_stretching(case: Case) -> str:
    if not case.wire.yields or case.press.rim == "clamp" or case.press.hold is not None:
        return ""
    return (
        'Stretch the wires while they are pressed: clamp the rim (`press.rim = "clamp"`) or brake the flange with a '
        "blank holder (`press.hold`). A wire that has yielded along its whole length keeps the length of the punch."
    )
