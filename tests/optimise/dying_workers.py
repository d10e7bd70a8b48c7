"""Workers that die: what a process pool can be begun with when it must break."""

from __future__ import annotations

import os
import signal

from punchform.case import Case
from punchform.optimise import evaluations
from punchform.optimise.worker import begin
from punchform.run import Run, run

DEADLY = 0.77
"""The diameter of wire [mm] at which the process is killed."""


def begin_mortal() -> None:
    """Begin as every worker does; the deadly design kills it."""
    begin()
    vars(evaluations)["run"] = _run


def _run(case: Case) -> Run:
    if case.wire.diameter == DEADLY:
        os.kill(os.getpid(), signal.SIGKILL)
    return run(case)
