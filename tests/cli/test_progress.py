"""Progress: the remaining time is honest, bars are for terminals alone, and files get lines."""

from __future__ import annotations

import io
import re
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from command_lines import YIELDING, on_a_terminal, written
from rich.console import Console

from punchform.case.reading import case_from_text
from punchform.cli import main
from punchform.cli.bars import Bars
from punchform.cli.remaining import Remaining
from punchform.cli.talk import Talk, is_live, say
from punchform.cli.voice import Voice
from punchform.progress import Progress
from punchform.run import run

CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f]")
"""What is no text: control characters but the end of a line."""


class Clock:
    """A clock that stands until it is moved."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Terminal(io.StringIO):
    """A stderr that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_at_a_steady_pace_the_remaining_time_is_exact() -> None:
    clock = Clock()
    remaining = Remaining(clock=clock)
    remaining.tell(0, 10)
    assert remaining.seconds is None
    for done in range(1, 11):
        clock.now += 3.0
        remaining.tell(done, 10)
        assert remaining.seconds == pytest.approx(3.0 * (10 - done))


def test_between_two_tellings_it_counts_down_but_not_below_what_follows() -> None:
    clock = Clock()
    remaining = Remaining(clock=clock)
    remaining.tell(0, 4)
    clock.now += 10.0
    remaining.tell(1, 4)
    assert remaining.seconds == pytest.approx(30.0)
    clock.now += 4.0
    assert remaining.seconds == pytest.approx(26.0)
    clock.now += 100.0
    assert remaining.seconds == pytest.approx(20.0), "two more follow the one that is late"
    remaining.tell(4, 4)
    assert remaining.seconds == 0.0


def test_what_was_known_before_says_nothing_of_the_pace() -> None:
    clock = Clock()
    remaining = Remaining(clock=clock)
    remaining.tell(0, 100)
    for known in range(1, 51):
        remaining.tell(known, 100, known=known)
    assert remaining.seconds is None
    clock.now += 2.0
    remaining.tell(51, 100, known=50)
    assert remaining.seconds == pytest.approx(98.0)


def test_the_first_of_several_workers_does_not_tell_the_pace() -> None:
    """Four at once: the first result would say four times too long."""
    clock = Clock()
    remaining = Remaining(at_once=4, clock=clock)
    remaining.tell(0, 40)
    clock.now += 8.0
    seen = []
    for done in range(1, 5):
        clock.now += 0.01
        remaining.tell(done, 40)
        seen.append(remaining.seconds)
    assert seen[:3] == [None, None, None]
    assert seen[3] == pytest.approx(72.0, rel=0.01)


def test_one_slow_piece_moves_the_estimate_by_its_share_only() -> None:
    clock, seen = Clock(), []
    remaining = Remaining(clock=clock)
    remaining.tell(0, 100)
    for done in range(1, 61):
        clock.now += 20.0 if done == 40 else 1.0
        remaining.tell(done, 100)
        seen.append(remaining.seconds)
    steps = [abs(after - before) for before, after in pairwise(seen) if before is not None and after is not None]
    assert max(steps) < 30.0
    assert seen[-1] == pytest.approx(40 * 79 / 60)


def test_strokes_tell_how_far_they_are() -> None:
    events: list[Progress] = []
    run(case_from_text(YIELDING), observe=events.append)
    told = [event for event in events if event.total is not None]
    assert [event.done for event in told] == [0, 1, 2, 3, 4]
    assert {event.total for event in told} == {4}
    assert {event.stage for event in told} == {"press"}


def test_one_stroke_is_not_counted() -> None:
    events: list[Progress] = []
    run(case_from_text(YIELDING.replace("strokes = 4", "strokes = 1")), observe=events.append)
    assert not [event for event in events if event.total is not None]


def test_a_bar_shows_how_far_and_how_long_and_begins_again() -> None:
    console = Console(file=io.StringIO(), width=100, force_terminal=True, color_system=None)
    bars = Bars(console)

    def shown() -> str:
        console.file = io.StringIO()
        console.print(bars.lines)
        return console.file.getvalue()

    bars.tell(Progress("press", done=0, total=4))
    assert "press" in shown()
    assert "0 of 4" in shown()
    assert "left" not in shown()
    bars.tell(Progress("press", done=1, total=4))
    assert re.search(r"1 of 4, about \d+ s left", shown())
    bars.tell(Progress("solves", done=1, total=6, limit=True))
    assert "1 of at most 6" in shown()
    bars.tell(Progress("press", done=0.5, total=4))
    assert "0.5 of 4" in shown()
    assert "1 of 4" not in shown()
    bars.tell(Progress("press", done=4, total=4))
    assert "of 4" not in shown()
    bars.words("release: step 3 [not markup]")
    assert "release: step 3 [not markup]" in shown()


def test_a_terminal_sees_bars_and_is_left_clean(tmp_path: Path) -> None:
    written(tmp_path, YIELDING)
    code, out, shown = on_a_terminal("form", "dish.toml", "-o", "out", folder=tmp_path, more={"TERM": "xterm-256color"})
    assert code == 0
    assert "outcome" in out
    assert "\x1b" not in out
    assert re.search(r"[0-4] of 4", shown)
    assert shown.rfind("\x1b[?25h") > shown.rfind("\x1b[?25l") >= 0, "the cursor is shown again"
    assert "\x1b[1;33mnote:" in shown
    last = shown.rpartition("\x1b[?25h")[2]
    assert "of 4" not in last, "nothing of the bars stays"


def test_words_are_plain_where_colour_is_not_understood(tmp_path: Path) -> None:
    written(tmp_path, YIELDING)
    code, _, shown = on_a_terminal("check", "dish.toml", folder=tmp_path, more={"TERM": "dumb"})
    assert code == 0
    assert shown.startswith("note: punch.fillet: the fillet bends")
    assert not CONTROL.search(shown.replace("\r\n", "\n"))


def test_without_colour_bars_move_only_the_cursor(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = on(monkeypatch)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("NO_COLOR", "1")
    with Talk(Voice.PLAIN) as talk:
        talk(Progress("press", done=1, total=2))
        talk(Progress("press", message="compiling"))
    assert "1 of 2" in stream.getvalue()
    assert "compiling" in stream.getvalue()
    assert not re.search(r"\x1b\[[\d;]*[3-4]\d[;m]", stream.getvalue()), "no foreground and no background"


def test_a_file_gets_no_control_characters_and_verbose_a_line_for_each_step(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = written(tmp_path, YIELDING)
    assert main(["form", case, "-o", str(tmp_path / "told"), "--verbose"]) == 0
    told = capsys.readouterr().err
    assert not CONTROL.search(told)
    assert re.search(r"^ +\d+\.\d\d s  press, 25% down: step 1, energy [\d.]+ mJ", told, re.MULTILINE)
    assert re.search(r"^ +\d+\.\d\d s  press: 2 of 4 done$", told, re.MULTILINE)
    assert re.search(r"^ +\d+\.\d\d s  writing tables, figures and the report$", told, re.MULTILINE)
    assert re.search(r"^ +\d+\.\d\d s in all$", told, re.MULTILINE)
    assert "note: the fillet bends" in told


@pytest.mark.parametrize("line", [["sensitivity", "--vary", "wire.diameter"], ["check"], ["element"]])
def test_quiet_says_nothing_but_errors(
    line: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, YIELDING)
    command, *rest = line
    assert main([command, "dish.toml", *rest, "--quiet"]) in (0, 1)
    printed = capsys.readouterr()
    assert printed.out
    assert printed.err == ""
    assert main([command, "missing.toml", *rest, "--quiet"]) == 2
    assert "error: missing.toml: cannot be read" in capsys.readouterr().err


def on(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """A terminal in place of stderr."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    for name in ("NO_COLOR", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    return stream


@pytest.mark.parametrize(("term", "live"), [("xterm", True), ("dumb", False), ("unknown", False)])
def test_a_dumb_terminal_is_not_live(term: str, live: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = on(monkeypatch)
    monkeypatch.setenv("TERM", term)
    assert is_live() is live
    say("error: x")
    with Talk(Voice.PLAIN) as talk:
        assert talk.has_bars is live
        talk(Progress("press", done=1, total=2))
    assert ("\x1b" in stream.getvalue()) is live


def test_a_quiet_talk_has_no_bars(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = on(monkeypatch)
    monkeypatch.setenv("TERM", "xterm")
    with Talk(Voice.QUIET) as talk:
        talk(Progress("press", message="compiling", done=1, total=2))
        assert not talk.has_bars
    assert stream.getvalue() == ""
