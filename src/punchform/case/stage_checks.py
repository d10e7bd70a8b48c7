"""In which order stages make sense, and what their settings cannot be beside those of the stages before them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from punchform.case.findings import Finding
from punchform.case.press import PressCase
from punchform.case.punch import PunchCase
from punchform.case.release import ReleaseCase
from punchform.case.stages import Kind, Stage, Step, TrimCase, kind_of
from punchform.case.target import TargetCase

AFTER: dict[Kind, tuple[tuple[Kind, ...], str]] = {
    "press": (("release", "trim"), "a second press strikes a grid that was let go or trimmed"),
    "release": (("press", "release", "trim", "load"), "there is nothing to let go"),
    "trim": (("press", "release"), "a grid is trimmed in the tool or after its release"),
    "load": (("release",), "loads act on a grid that was just let go"),
}
"""What must stand right before a stage of each kind, and why."""


def order_findings(stages: Sequence[Stage]) -> Iterator[Finding]:
    """Stages that do not follow on the one before them."""
    kinds = [kind_of(stage) for stage in stages]
    if kinds[0] != "press":
        yield Finding(
            ("stages", 0), f"the first stage is the press, not '{kinds[0]}'", "a flat grid must be formed first"
        )
    for number, (before, kind) in enumerate(pairwise(kinds), start=1):
        allowed, reason = AFTER[kind]
        if before not in allowed:
            yield Finding(
                ("stages", number),
                f"'{kind}' cannot follow '{before}': {reason}",
                f"put a '{_between(before, kind)}' between them" if _between(before, kind) else "leave it out",
            )


def _between(before: Kind, kind: Kind) -> str:
    """A stage that may stand between two others, empty when there is none."""
    return next((one for one in ("release", "trim") if before in AFTER[one][0] and one in AFTER[kind][0]), "")


def stage_findings(
    steps: Sequence[Step], *, stages: Sequence[Stage], punch: PunchCase | None, target: TargetCase | None
) -> Iterator[Finding]:
    """What contradicts in the stages as a whole; steps: those whose settings are known."""
    yield from order_findings(stages)
    known = {step.number for step in steps}
    for number, stage in enumerate(stages):
        if number not in known:
            yield Finding(
                ("stages", number),
                f"'{kind_of(stage)}' needs a section [{kind_of(stage)}], which the case has not",
                "say there what acts, or here, as in { load = { gravity = [0, 0, -1] } }",
            )
    for before, step in pairwise(steps):
        if isinstance(step.settings, ReleaseCase) and step.settings == before.settings:
            yield Finding(
                ("stages", step.number or 0), "the stage before has let the grid go with the same hold", "leave it out"
            )
    for step in steps:
        if isinstance(step.settings, PressCase) and step.settings.ends is not None:
            yield Finding(step.place("ends"), "wire ends go to given points without stages", "leave out `stages`")
        if isinstance(step.settings, TrimCase) and punch and target:
            yield from _aperture_is_left(step, step.settings.radius or punch.rim_radius, target)


def _aperture_is_left(step: Step, radius: float, target: TargetCase) -> Iterator[Finding]:
    if radius < target.aperture_radius:
        yield Finding(
            step.place("radius"),
            f"the grid is cut off at {radius:g} mm, inside the aperture of {target.aperture_radius:g} mm",
            "trim it further out, or judge a smaller aperture",
        )
