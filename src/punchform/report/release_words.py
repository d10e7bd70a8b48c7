"""What the release and the load come to, in plain words. No HTML here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from punchform.case import HoldFrom, HoldNodes, HoldPoints, HoldRing, ReleaseCase, Rib
from punchform.report.words import energy, percent, size

if TYPE_CHECKING:
    from punchform.load import Loaded
    from punchform.release import Released
    from punchform.run import Run

NONE = 1e-9
"""A smaller share of the energy is none."""
STILL = 1e-6
"""A smaller move [mm] is none."""


def release_words(run: Run) -> tuple[str, ...]:
    """Sentences on what the release leaves: energy, how the grid moves, and whether it stays; none without one."""
    released, case = run.released, run.case.release
    if released is None or case is None:
        return ()
    share = released.energy / run.formed.energy if run.formed.energy > 0 else 0.0
    kept = f"{energy(released.energy)} ({percent(share)}) of its energy" if share > NONE else "nothing of its energy"
    return (
        f"When the punch has gone and {hold_words(case)}, the grid keeps {kept}; {_moves(released)}.",
        stability_words(released),
    )


def load_words(run: Run) -> tuple[str, ...]:
    """Sentences on what the load does to the shape; none without one."""
    if run.loaded is None:
        return ()
    loaded = run.loaded
    said = (
        f"{_load(run)}, {size(loaded.load, 'N', 3)} in all, moves the crossings by "
        f"{size(loaded.rms_deflection, 'mm', 3)} rms along the normals and by up to "
        f"{size(loaded.largest_deflection, 'mm', 3)}."
    )
    if run.accuracy is not None and run.accuracy.judge.tolerance is not None:
        said += f" That is {percent(loaded.rms_deflection / run.accuracy.judge.tolerance)} of the tolerance."
    return said, _rest(loaded)


def hold_words(case: ReleaseCase) -> str:
    """What keeps holding the grid, as a clause."""
    match case.hold:
        case HoldFrom(from_radius=radius):
            held = f"what was formed at or beyond {radius:g} mm stays as the press left it"
        case HoldRing(ring=ring):
            held = f"the crossings on a ring of {ring:g} mm keep their height"
        case HoldPoints(points=points, radius=radius):
            held = f"{points} supports {radius:g} mm from the axis keep their places"
        case HoldNodes(nodes=nodes):
            held = f"{len(nodes)} chosen crossings keep their places"
        case "rim":
            held = "the wire ends keep their places"
        case _:
            held = "nothing holds it"
    ribs = [_rib(rib) for rib in case.ribs]
    return f"{held}, with {' and '.join(ribs)} under it" if ribs else held


def stability_words(released: Released) -> str:
    """Whether the equilibrium is one that the grid keeps."""
    negative = released.stability.negative
    if negative is None:
        return "Whether it would stay there was not counted."
    if not negative:
        return "It is a minimum of the energy of the whole grid: it stays there."
    ways = "one way" if negative == 1 else f"{negative} ways"
    return (
        f"It would not stay there: the whole grid has {ways} of leaving this equilibrium. Take its figures as a hint, "
        'hold it better, or let it leave its symmetry (`release.symmetry = "full"`).'
    )


def _moves(released: Released) -> str:
    rises, sinks = released.apex, released.max_sag
    middle = f"its middle {'rises' if rises > 0 else 'sinks'} by {size(abs(rises), 'mm', 3)}"
    if abs(rises) < STILL:
        middle = "its middle stays"
    if sinks > -STILL:
        return f"{middle}, and no crossing sinks"
    i, j = released.whole.index[released.lowest]
    return f"{middle}, and the lowest crossing, ({i}, {j}), sinks by {size(-sinks, 'mm', 3)}"


def _rib(rib: Rib) -> str:
    if rib.spokes is not None:
        return f"{rib.spokes} spokes"
    assert rib.radius is not None
    return f"a hoop of {rib.radius:g} mm"


def _load(run: Run) -> str:
    case = run.case.load
    assert case is not None
    kinds = [
        name
        for name, given in (
            ("gravity", case.gravity is not None),
            ("pressure", case.pressure is not None),
            ("wind", case.wind is not None),
            ("forces on single crossings", bool(case.forces)),
        )
        if given
    ]
    said = " and ".join(kinds)
    return f"{said[:1].upper()}{said[1:]}"


def _rest(loaded: Loaded) -> str:
    if loaded.outcome.name == "CONVERGED":
        return "The loaded grid rests in a minimum of its energy."
    return f"The loaded grid does not rest in a minimum: {loaded.outcome.value}."
