"""The live lines of a terminal: a bar for each stage that knows how far it is, and below what is being done."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group
from rich.live import Live
from rich.progress import BarColumn, ProgressColumn, TextColumn
from rich.progress import Progress as Lines
from rich.spinner import Spinner
from rich.table import Column
from rich.text import Text

from punchform.cli.remaining import Remaining, left

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Task, TaskID

    from punchform.progress import Progress

WIDTH = 24
"""Characters of a bar."""
FRAMES = 8
"""Pictures a second."""
WHOLE = Column(no_wrap=True)
"""A column that is not broken into lines."""


class Bars:
    """Bars by the names of their stages, shown by `lines`. They leave nothing behind when they stop."""

    def __init__(self, console: Console, *, at_once: int = 1) -> None:
        self._at_once = at_once
        self._far: dict[str, tuple[TaskID, _Far]] = {}
        self._bars = Lines(
            TextColumn("{task.description}", markup=False), BarColumn(bar_width=WIDTH), _Left(table_column=WHOLE)
        )
        self._now = Spinner("dots", _one_line("starting"))
        self.lines = Group(self._bars, self._now)
        self._live = Live(self.lines, console=console, transient=True, refresh_per_second=FRAMES)

    def start(self) -> None:
        """Show the lines."""
        self._live.start()

    def stop(self) -> None:
        """Take the lines away."""
        self._live.stop()

    def words(self, words: str) -> None:
        """Say below the bars what is being done."""
        self._now.update(text=_one_line(words))

    def tell(self, event: Progress, *, known: float = 0.0) -> None:
        """Move the bar of a stage; one that begins again has a new time, and one that is done goes away."""
        assert event.total is not None
        name = event.stage.partition(",")[0]
        if name in self._far and event.done < self._far[name][1].done:
            self._bars.remove_task(self._far.pop(name)[0])
        if name not in self._far:
            new = _Far(Remaining(at_once=self._at_once))
            self._far[name] = self._bars.add_task(name, total=event.total, far=new), new
        bar, far = self._far[name]
        far.tell(event, known)
        self._bars.update(bar, completed=event.done, total=event.total)
        if event.done >= event.total:
            self._bars.remove_task(self._far.pop(name)[0])


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


class _Left(ProgressColumn):
    """How far it is in words."""

    max_refresh = 0.5

    def render(self, task: Task) -> Text:
        return Text(str(task.fields["far"]))


def _one_line(words: str) -> Text:
    return Text(words, no_wrap=True, overflow="ellipsis")
