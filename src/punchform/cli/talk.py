"""Talk and progress on stderr: coloured and with bars on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from time import perf_counter
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from punchform.cli.voice import Voice

if TYPE_CHECKING:
    from punchform.cli.bars import Bars
    from punchform.progress import Progress

WRITING = "writing tables, figures and the report"
_STYLES = {"error:": "bold red", "hint:": "bold cyan", "note:": "bold yellow"}


def is_live() -> bool:
    """Whether stderr is a terminal that understands more than plain lines."""
    return sys.stderr.isatty() and os.environ.get("TERM", "") not in ("dumb", "unknown")


def say(text: str) -> None:
    """Write lines to stderr; on a terminal the leading word `error:`, `hint:` or `note:` is coloured, unless the
    environment has NO_COLOR."""
    if not is_live() or os.environ.get("NO_COLOR"):
        print(text, file=sys.stderr, flush=True)
        return
    from rich.text import Text

    coloured = Text(text)
    for word, style in _STYLES.items():
        coloured.highlight_regex(rf"(?m)^ *{word}", style)
    _console().print(coloured)


def notes(texts: Iterable[str], voice: Voice) -> None:
    """Say every text as a note, unless quiet."""
    if voice is not Voice.QUIET:
        for text in texts:
            say(f"note: {text}")


class Talk:
    """The observer of a run: bars on a terminal, the messages alone elsewhere; when verbose a line for every step.

    Use it as a context manager, so that the bars are cleared however the run ends. at_once: how many of the things that
    are counted are worked on at the same time.
    """

    def __init__(self, voice: Voice, *, at_once: int = 1) -> None:
        self._voice = voice
        self._at_once = at_once
        self._bars: Bars | None = None
        self._begun = perf_counter()

    def __enter__(self) -> Self:
        if self._voice is not Voice.QUIET and is_live():
            from punchform.cli.bars import Bars

            self._bars = Bars(_console(), at_once=self._at_once)
            self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bars is not None:
            self._bars.stop()
            self._bars = None

    @property
    def has_bars(self) -> bool:
        """Whether somebody sees bars move."""
        return self._bars is not None

    def __call__(self, event: Progress, *, known: float = 0.0) -> None:
        """Show one event of the run; `known` of what it says is done took no time."""
        if self._voice is Voice.QUIET:
            return
        if event.total is not None and self._bars is not None:
            self._bars.tell(event, known=known)
        if event.step >= 0:
            self.show(f"{event.stage}: step {event.step}")
        elif event.message:
            say(event.message)
        if self._voice is Voice.VERBOSE:
            self._say_all(event)

    def show(self, words: str) -> None:
        """Say below the bars what is being done, where there are bars."""
        if self._bars is not None:
            self._bars.words(words)

    def begin(self, words: str) -> None:
        """Say what is begun now, where there are bars; when verbose as a line."""
        self.show(words)
        if self._voice is Voice.VERBOSE:
            say(f"{self._seconds}  {words}")

    @property
    def _seconds(self) -> str:
        return f"{perf_counter() - self._begun:8.2f} s"

    def _say_all(self, event: Progress) -> None:
        """The lines that only verbose commands say."""
        if event.step >= 0:
            say(f"{self._seconds}  {progress_line(event)}")
        if event.total is not None:
            say(f"{self._seconds}  {event.stage}: {event.done:.3g} of {event.total:.6g} done")


def progress_line(event: Progress) -> str:
    """One step in words.

    >>> from punchform.progress import Progress
    >>> progress_line(Progress("press", 3, 6600.058, 0.0021, "full Hessian"))
    'press: step 3, energy 6600.06 mJ, largest gradient 0.0021, full Hessian'
    """
    ending = f", {event.message}" if event.message else ""
    return (
        f"{event.stage}: step {event.step}, energy {event.energy:.6g} mJ, largest gradient {event.gradient:.2g}{ending}"
    )


def _console() -> Any:
    """A console that knows about NO_COLOR and old Windows terminals."""
    from rich.console import Console

    return Console(file=sys.stderr, highlight=False, soft_wrap=True)
