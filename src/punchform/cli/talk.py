"""Talk and progress on stderr: coloured on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from punchform.progress import Progress

_STYLES = {"error:": "bold red", "hint:": "bold cyan", "note:": "bold yellow"}


def say(text: str) -> None:
    """Write lines to stderr; on a terminal the leading word `error:`, `hint:` or `note:` is coloured."""
    if not sys.stderr.isatty():
        print(text, file=sys.stderr, flush=True)
        return
    from rich.text import Text

    coloured = Text(text)
    for word, style in _STYLES.items():
        coloured.highlight_regex(rf"(?m)^ *{word}", style)
    _console().print(coloured)


class Talk:
    """The observer of a run: a progress line on a terminal, the messages alone elsewhere.

    Use it as a context manager, so that the progress line is cleared however the run ends.
    """

    def __init__(self, *, quiet: bool) -> None:
        self._quiet = quiet
        self._line: Any = None

    def __enter__(self) -> Self:
        if not self._quiet and sys.stderr.isatty():
            self._line = _console().status("starting")
            self._line.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._line is not None:
            self._line.stop()

    def __call__(self, event: Progress) -> None:
        """Show one event of the run."""
        if self._quiet:
            return
        if event.step < 0:
            say(event.message)
        else:
            self.show(progress_line(event))

    def show(self, words: str) -> None:
        """Put words into the progress line, where there is one."""
        if self._line is not None:
            from rich.text import Text

            self._line.update(Text(words))


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
