"""Ctrl-C and a request to terminate: the command tidies up, ends without a traceback, and says what is left."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from punchform.cli.exits import Exit

TIDYING = b"tidying up; once more ends at once, and may leave unfinished files behind\n"


class Terminated(KeyboardInterrupt):
    """The system asks the command to end, as batch systems do; whatever tidies up after Ctrl-C does so after this."""


class Stop:
    """Whether the command was asked to end. The first signal raises KeyboardInterrupt or Terminated; the second only
    says that this is being done, so that nothing stays half removed; the third ends at once."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal."""
        self.asked += 1
        if self.asked == 1:
            raise (Terminated if number == signal.SIGTERM else KeyboardInterrupt)
        if self.asked > 2:
            os._exit(128 + number)
        os.write(2, TIDYING)


@contextmanager
def stoppable() -> Iterator[Stop]:
    """Handle the signals while a command runs, but those that whoever started it lets it ignore.

    A command that was asked to end keeps the handler: another Ctrl-C shall not disturb its last moments.
    """
    stop = Stop()
    replaced: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) is not signal.SIG_IGN:
                replaced[number] = signal.signal(number, stop)
    try:
        yield stop
    finally:
        if not stop.asked:
            for replaced_number, handler in replaced.items():
                signal.signal(replaced_number, handler)


class Left:
    """What a command that is ended early leaves behind, judged by its folder before and after."""

    def __init__(self, chosen: Mapping[str, Any]) -> None:
        self._folder: str | None = chosen.get("output") if "path" in chosen or "run" in chosen else None
        self._grows = "scheduler" in chosen
        self._anew = bool(chosen.get("overwrite"))
        self._before = _mark(self._folder)

    def words(self, exit_code: Exit) -> str:
        """The last words: what is kept, and how to go on."""
        ended = "terminated" if exit_code is Exit.TERMINATED else "interrupted"
        folder, now = self._folder, _mark(self._folder)
        if folder is None:
            return ended
        if self._grows and now is not None and not (self._anew and now == self._before):
            how = "give the same command again" + (" without --overwrite" if self._anew else "")
            return f"{ended}; what was done is kept in {folder}\n  hint: {how} to go on from there"
        if now == self._before:
            old = "" if now is None else f"; {folder} is as it was"
            return f"{ended}; nothing was written{old}\n  hint: give the same command again; it begins anew"
        return f"{ended} after the results were written to {folder}"


def _mark(folder: str | None) -> tuple[int, int] | None:
    """What tells one state of a folder from another; None where there is none."""
    try:
        found = Path(os.path.expanduser(folder or "")).stat() if folder else None
    except OSError:
        return None
    return None if found is None else (found.st_ino, found.st_mtime_ns)
