"""The report beside a run: whatever stops it, the run that took long to compute is kept."""

from __future__ import annotations

import shutil
from pathlib import Path

from punchform.cli.talk import say
from punchform.progress import Observer
from punchform.report.page import FIGURES, PAGE, write_report
from punchform.run import Run


class Drawing:
    """Writes the report into the folder of a run, as the last of its files; what goes wrong waits until the folder
    stands."""

    def __init__(self, observe: Observer) -> None:
        self._observe = observe
        self._failed: BaseException | None = None

    def __call__(self, run: Run, folder: Path) -> None:
        """Write the report, or nothing of it. Raises OSError: a disk that takes no report takes no run."""
        try:
            write_report(run, folder, observe=self._observe)
        except OSError:
            raise
        except BaseException as problem:
            (folder / PAGE).unlink(missing_ok=True)
            shutil.rmtree(folder / FIGURES, ignore_errors=True)
            self._failed = problem

    def settle(self, folder: Path) -> None:
        """Raise what stopped the report, after saying what is there without it."""
        if self._failed is not None:
            say(f"note: the run is in {folder}, without its report: `punchform report {folder}` draws it")
            raise self._failed
