"""What a wire that yields cannot have beside it."""

from __future__ import annotations

from collections.abc import Iterator

from punchform.case.findings import Finding
from punchform.case.grid import GridCase
from punchform.case.press import PressCase
from punchform.case.release import ReleaseCase
from punchform.case.wire import WireCase


def yield_findings(wire: WireCase, press: PressCase) -> Iterator[Finding]:
    """All contradictions of a wire that yields with the press; none for an elastic one."""
    if not wire.yields:
        return
    elastic = 'write wire.hardening = "none" for an elastic wire'
    if press.ends is not None:
        given = "hardening" if "hardening" in wire.model_fields_set else "material"
        yield Finding(("wire", given), "the wires of a gridshell do not yield yet", elastic)
        return
    if press.kinematics != "free":
        yield Finding(
            ("press", "kinematics"),
            "a wire that yields needs the free kinematics: the paper's differences are of elastic wires",
            f'use kinematics = "free"; {elastic}',
        )
    if press.frame == "O":
        yield Finding(
            ("press", "frame"),
            "a wire that yields is stretched too far for the frame at its end O",
            f'leave out `frame` or write frame = "chord"; {elastic}',
        )
    if press.method != "newton":
        yield Finding(
            ("press", "method"),
            "the paper's descent follows an energy, and a wire that yields has none",
            f'use method = "newton"; {elastic}',
        )


def memory_findings(wire: WireCase, grid: GridCase, release: ReleaseCase) -> Iterator[Finding]:
    """A release that would need to know what the wires of the other quarters remember."""
    if wire.yields and release.symmetry == "full" and grid.symmetry == "quarter":
        yield Finding(
            ("release", "symmetry"),
            "what wires that yield remember of the press is known of the solved quarter only",
            'press the whole grid: grid.symmetry = "full"',
        )
