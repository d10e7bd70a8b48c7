"""The section of the report on the stages of a run, where its case names them. No HTML here."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from punchform.case import LoadCase, PressCase, ReleaseCase
from punchform.report.release_words import hold_words
from punchform.report.section import Matrix, Section
from punchform.report.words import energy, size

if TYPE_CHECKING:
    from punchform.run import Run, Stage
    from punchform.solved import Solved
    from punchform.trim import Trimmed

HEAD = ("stage", "what", "crossings", "energy", "ended", "factorisations")


def stage_sections(run: Run) -> tuple[Section, ...]:
    """The table of all stages; none where the case names no stages."""
    if run.case.stages is None:
        return ()
    table = Matrix(
        "One after the other, each as the one before has left the grid",
        HEAD,
        tuple(_row(stage) for stage in run.stages),
        note="What follows is told of the last press and of what came after it. A trim solves nothing: its energy is "
        "that of the wires that are left, before they find their equilibrium.",
    )
    return (Section("stages", "Stages", matrices=(table,)),)


def _row(stage: Stage) -> tuple[str, ...]:
    done = stage.done
    if stage.kind == "trim":
        ended, factored = "not solved", ""
    else:
        ended, factored = cast("Solved", done).outcome.value.partition(";")[0], f"{cast('Solved', done).factorisations}"
    return (stage.name, _what(stage), f"{done.whole.crossings}", energy(done.energy), ended, factored)


def _what(stage: Stage) -> str:
    match stage.settings:
        case PressCase(rim=rim):
            return "the rim is clamped" if rim == "clamp" else "the flange slides in"
        case ReleaseCase() as hold:
            return hold_words(hold)
        case LoadCase() as load:
            return ", ".join(name for name in ("gravity", "pressure", "wind", "forces") if getattr(load, name))
    trimmed = cast("Trimmed", stage.done)
    gone = f"{trimmed.crossings_cut} crossings beyond {size(trimmed.radius, 'mm')} cut off"
    return gone if trimmed.mass_cut is None else f"{gone}, {size(1000 * trimmed.mass_cut, 'g')} of wire"
