"""What the release, the load and the accuracy come to, in plain words. No HTML here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from punchform.report.words import size

if TYPE_CHECKING:
    from punchform.accuracy import Accuracy


def judgement(accuracy: Accuracy) -> str:
    """One sentence: the judged figure against the tolerance."""
    judged, judge = accuracy.judged, accuracy.judge
    figure = f"{size(judged.rms, 'mm', 3)} rms {judge.measure} deviation, {judge.alignment}"
    if judge.tolerance is None:
        return figure
    kept = "within" if accuracy.within else "out of"
    return f"{figure}: {kept} the tolerance of {size(judge.tolerance, 'mm', 3)}"
