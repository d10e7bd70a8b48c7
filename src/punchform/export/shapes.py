"""The shapes that the files of a run show, by the names that they have there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from punchform.export.told import told

if TYPE_CHECKING:
    from punchform.run import Run
    from punchform.solved import Shaped

TRIMMED = "trimmed"


def shapes(run: Run) -> dict[str, Shaped]:
    """formed, released and loaded where there are such, of the last press and what came after it; and trimmed, what a
    trim has left, where nothing was done after it."""
    shown = told(run)
    stages = {"formed": shown.formed, "released": shown.released, "loaded": shown.loaded}
    found: dict[str, Shaped] = {name: stage for name, stage in stages.items() if stage is not None}
    if run.stages[-1].kind == "trim":
        found[TRIMMED] = run.stages[-1].done
    return found
