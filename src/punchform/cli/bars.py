"""The live lines of a terminal: a bar for each stage that knows how far it is, and below what is being done."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.progress import BarColumn, ProgressColumn, SpinnerColumn, TextColumn
from rich.progress import Progress as Lines
from rich.text import Text

from punchform.cli.remaining import Remaining, left

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Task, TaskID

    from punchform.progress import Progress

WIDTH = 24
"""Characters of a bar."""


class Bars:
    """Bars by the names of their stages, shown by `lines`. They leave nothing behind when they stop."""

    def __init__(self, console: Console, *, at_once: int = 1) -> None:
        self.lines = Lines(
            SpinnerColumn(finished_text=" "),
            TextColumn("{task.description}", markup=False),
            _Bar(bar_width=WIDTH),
            _Left(),
            console=console,
            transient=True,
        )
        self._at_once = at_once
        self._bars: dict[str, TaskID] = {}
        self._now = self.lines.add_task("starting", total=None, far=None)

    def start(self) -> None:
        """Show the lines."""
        self.lines.start()

    def stop(self) -> None:
        """Take the lines away."""
        self.lines.stop()

    def words(self, words: str) -> None:
        """Say below the bars what is being done."""
        self.lines.update(self._now, description=words)

    def tell(self, event: Progress, *, known: float = 0.0) -> None:
        """Move the bar of a stage; one that begins again has a new time, and one that is done goes away."""
        assert event.total is not None
        name = event.stage.partition(",")[0]
        bar = self._bars.get(name)
        far = None if bar is None else self.lines.tasks[self.lines.task_ids.index(bar)].fields["far"]
        if bar is None or far is None or event.done < far.done:
            if bar is not None:
                self.lines.remove_task(bar)
            far = _Far(Remaining(at_once=self._at_once))
            bar = self._bars[name] = self.lines.add_task(name, total=event.total, far=far)
        far.tell(event, known)
        self.lines.update(bar, completed=event.done, total=event.total)
        if event.done >= event.total:
            self.lines.remove_task(self._bars.pop(name))


class _Far:
    """How far a stage is, and how long it will take."""

    def __init__(self, remaining: Remaining) -> None:
        self._remaining = remaining
        self.done = 0.0
        self._total = 0.0
        self._limit = False

    def tell(self, event: Progress, known: float) -> None:
        assert event.total is not None
        self.done, self._total, self._limit = event.done, event.total, event.limit
        self._remaining.tell(event.done, event.total, known=known)

    def __str__(self) -> str:
        at_most = "at most " if self._limit else ""
        return f"{self.done:.3g} of {at_most}{self._total:.6g}{left(self._remaining.seconds, limit=self._limit)}"


class _Bar(BarColumn):
    """A bar where it is known how far it is; nothing beside mere words."""

    def render(self, task: Task) -> Any:
        return Text() if task.total is None else super().render(task)


class _Left(ProgressColumn):
    """How far it is in words."""

    max_refresh = 0.5

    def render(self, task: Task) -> Text:
        far = task.fields["far"]
        return Text("" if far is None else str(far))
