"""The core idea: form the grid over the punch, let it go, and measure it."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

from punchform.case import Case
from punchform.errors import InputError
from punchform.grid import lay
from punchform.press import Formed, press
from punchform.progress import Observer, silent
from punchform.punch import check_sharpness, surface
from punchform.wire import mirror_symmetric, stiffness


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
    punch = surface(case.punch)
    errors, warnings = check_sharpness(punch, min(case.grid.step))
    if errors:
        raise InputError(errors)
    elements = stiffness(case.wire, case.grid.step)
    grid = lay(
        case.grid,
        rim_radius=punch.rim_radius,
        mirror_planes=punch.mirror_planes and mirror_symmetric(elements),
        reason="the wire is crimped out of its plane" if punch.mirror_planes else "the punch has none",
    )
    formed = press(
        grid,
        elements,
        punch,
        case.press,
        crossing=case.grid.crossing,
        solver=case.solver,
        yield_strength=case.wire.yield_strength,
        observe=observe,
    )
    notes = (*(warning.message for warning in warnings), *_later(case))
    return Run(case, formed, None, None, notes, perf_counter() - begun)


def _later(case: Case) -> tuple[str, ...]:
    """What the case asks for that is checked but not computed yet."""
    asked = [name for name, part in (("release", case.release), ("target", case.target)) if part is not None]
    if not asked:
        return ()
    sections = " and ".join(f"[{name}]" for name in asked)
    return (f"{sections} of the case: read and checked; this version stops at the formed grid",)
