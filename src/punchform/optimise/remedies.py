"""What would help where the punch does not: tried, each by one press and release over the punch as it is."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from punchform.case import Case, HoldFrom, varied
from punchform.case.materials import library, settings_of
from punchform.errors import InputError, NoEquilibrium
from punchform.progress import Observer, Progress, silent
from punchform.run import run

SOFT = "304 annealed"
"""The wire that is tried where the wires do not yield."""
HOOP = 2 / 3
"""Radius of the hoop that is tried, of that of the aperture."""
SPOKES = 8
"""How many spokes are tried."""
FURTHER_IN = 0.9
"""Where holding is tried, of the radius of the aperture."""

TAUT = 100.0
"""Stress [MPa] at which the wires of a grid are pulled taut for a trial."""

Name = Literal["soft", "weld", "ribs", "hold", "pull"]


@dataclass(frozen=True)
class Remedy:
    """A change of the case: which, the settings that it changes, and the rms that it leaves [mm], None where it could
    not be pressed."""

    name: Name
    changes: Mapping[str, object]
    rms: float | None = None


def remedies_of(case: Case) -> tuple[Remedy, ...]:
    """The changes that a case has not made already; none for one that names its stages."""
    return () if case.stages is not None or case.target is None or case.release is None else tuple(_changes(case))


def tried(case: Case, *, observe: Observer = silent) -> tuple[Remedy, ...]:
    """The remedies of a case with what each of them leaves, least first; those that failed come last."""
    found = []
    for number, remedy in enumerate(all_of := remedies_of(case), start=1):
        told = f"remedy {number} of {len(all_of)}"
        observe(Progress("remedies", message=told, done=number - 1, total=len(all_of)))
        found.append(Remedy(remedy.name, remedy.changes, _rms(case, remedy)))
    return tuple(sorted(found, key=lambda one: (one.rms is None, one.rms)))


def _rms(case: Case, remedy: Remedy) -> float | None:
    try:
        accuracy = run(varied(case, remedy.changes)).accuracy
    except (InputError, NoEquilibrium):
        return None
    return None if accuracy is None else accuracy.judged.rms


def _changes(case: Case) -> Iterator[Remedy]:
    assert case.target is not None
    assert case.release is not None
    radius = case.target.aperture_radius
    if not case.wire.yields:
        # All that the material says is written out: the case may have said otherwise.
        said = {f"wire.{key}": value for key, value in settings_of(library()[SOFT]).items()}
        yield Remedy("soft", {**said, "wire.material": SOFT, "wire.stiffness": None, "press.rim": "clamp"})
    if case.grid.crossing == "pinned":
        yield Remedy("weld", {"grid.crossing": "welded"})
    press = case.press
    if press.pull is None and press.hold is None and press.rim == "draw" and press.strokes is None:
        force = float(f"{0.25 * math.pi * case.wire.diameter**2 * TAUT:.2g}")
        yield Remedy("pull", {"press.pull": (force, force), "press.frame": "chord"})
    if not case.release.ribs:
        yield Remedy("ribs", {"release.ribs": [{"radius": _round(HOOP * radius)}, {"spokes": SPOKES}]})
    hold = case.release.hold
    if not (isinstance(hold, HoldFrom) and hold.from_radius <= radius):
        yield Remedy("hold", {"release.hold": {"from_radius": _round(FURTHER_IN * radius)}})


def _round(length: float) -> float:
    """A length to three digits, as one would write it."""
    return float(f"{length:.3g}")
