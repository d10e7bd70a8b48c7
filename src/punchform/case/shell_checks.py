"""What a case with given wire ends, a gridshell, cannot have beside them."""

from __future__ import annotations

from collections.abc import Iterator

from punchform.case.findings import Finding
from punchform.case.grid import GridCase, WiresBlank
from punchform.case.load import LoadCase
from punchform.case.press import PressCase
from punchform.case.punch import PunchCase
from punchform.case.release import ReleaseCase
from punchform.case.target import TargetCase
from punchform.case.wire import StraightLine, WireCase

IDLE = ("kinematics", "offset", "rim", "hold", "strokes", "start", "method", "pull", "descent")
"""Settings of the press that say how a grid comes onto a punch."""


def shell_findings(
    *,
    grid: GridCase | None,
    wire: WireCase | None,
    punch: PunchCase | None,
    press: PressCase | None,
    release: ReleaseCase | None,
    load: LoadCase | None,
    target: TargetCase | None,
) -> Iterator[Finding]:
    """All contradictions of given wire ends and single wires with other sections."""
    if press and press.ends is not None:
        if punch:
            yield Finding(
                ("press", "ends"),
                "the wire ends are to go to given points, but there is a [punch] too",
                "leave out one of them: a gridshell is made without a punch",
            )
        yield from _nothing_is_idle(press)
        later = {"release": release, "load": load, "target": target}
        for name in (name for name, section in later.items() if section):
            yield Finding((name,), "a gridshell stays as its wire ends hold it", f"leave out [{name}], or press.ends")
    if grid and isinstance(grid.blank, WiresBlank):
        if punch and press and press.ends is None:
            yield Finding(("grid", "blank"), "single wires are for a gridshell, not for a punch", "give an outline")
        if grid.centre == "cell":
            yield Finding(("grid", "centre"), "wire 0 lies on the axis, so that no cell does", "leave it out")
        if wire:
            yield from _wires_are_straight(wire)


def _nothing_is_idle(press: PressCase) -> Iterator[Finding]:
    plain = PressCase()
    for name in IDLE:
        if getattr(press, name) != getattr(plain, name):
            yield Finding(
                ("press", name), "has no effect where wire ends go to given points", f"leave out `{name}` or `ends`"
            )


def _wires_are_straight(wire: WireCase) -> Iterator[Finding]:
    if wire.stiffness is not None:
        yield Finding(
            ("wire", "stiffness"),
            "the pieces of single wires differ in length, and so in stiffness",
            "give diameter, youngs_modulus and a straight centreline",
        )
    elif wire.centreline != StraightLine():
        yield Finding(
            ("wire", "centreline"),
            "single wires are straight and lie in one plane",
            'write centreline = { kind = "straight" }',
        )
