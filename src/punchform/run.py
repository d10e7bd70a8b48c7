"""The core idea: form the grid over the punch, let it go, and measure it."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

from punchform.case import Case
from punchform.prepare import prepare
from punchform.press import Formed, press
from punchform.progress import Observer, silent


@dataclass(frozen=True)
class Run:
    """A case and what became of it; released and accuracy stay None until those stages exist."""

    case: Case
    formed: Formed
    released: None
    accuracy: None
    notes: tuple[str, ...]
    seconds: float


def run(case: Case, *, observe: Observer = silent) -> Run:
    """Form the grid over the punch.

    Raises InputError when the case cannot be pressed, NoEquilibrium when no equilibrium is found.
    """
    begun = perf_counter()
    ready = prepare(case)
    formed = press(
        ready.grid,
        ready.elements,
        ready.punch,
        case.press,
        crossing=case.grid.crossing,
        solver=case.solver,
        yield_strength=case.wire.yield_strength,
        observe=observe,
    )
    notes = (*(doubt.message for doubt in ready.doubts), *_later(case))
    return Run(case, formed, None, None, notes, perf_counter() - begun)


def _later(case: Case) -> tuple[str, ...]:
    """What the case asks for that is checked but not computed yet."""
    asked = [name for name, part in (("release", case.release), ("target", case.target)) if part is not None]
    if not asked:
        return ()
    sections = " and ".join(f"[{name}]" for name in asked)
    return (f"{sections} of the case: read and checked; this version stops at the formed grid",)
