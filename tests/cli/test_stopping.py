"""Ctrl-C and SIGTERM, sent to real processes: no traceback, nothing half-written, and what is said is true."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
from pathlib import Path
from time import sleep

import pytest
from command_lines import PATIENCE, YIELDING, begun, written
from tiny_dish import TEXT

from punchform.cli import main
from punchform.cli.exits import Exit
from punchform.cli.stopping import Left, Stop, Terminated, stoppable

SWEEP = ("sweep", "dish.toml", "--over", "wire.diameter=0.5 mm:0.9 mm:12")
DESIGNS = 12
LONG = YIELDING.replace("strokes = 4", "strokes = 400").replace('step = "10 mm"', 'step = "5 mm"')
"""A press that takes longer than any test waits for it."""


def stopped(process: subprocess.Popen[str], *signals: int) -> tuple[int, str, str]:
    """Send the signals as a terminal does, to all processes of the group; exit code, stdout and stderr."""
    for number in signals:
        os.killpg(process.pid, number)
        sleep(0.005)
    out, err = process.communicate(timeout=PATIENCE)
    assert "Traceback" not in err
    return process.returncode, out, err


def evaluations(folder: Path) -> dict[str, dict[str, object]]:
    """The record of a sweep by its keys, without the times that the evaluations took."""
    lines = (folder / "record.jsonl").read_text(encoding="utf-8").splitlines()
    found = {}
    for line in map(json.loads, lines):
        line.pop("seconds", None)
        found[line["key"]] = line
    return found


def rows(folder: Path) -> list[dict[str, str]]:
    """The table of a sweep without the column of times."""
    with (folder / "table.csv").open(encoding="utf-8", newline="") as file:
        return [{name: cell for name, cell in row.items() if "seconds" not in name} for row in csv.DictReader(file)]


def test_a_sweep_that_is_stopped_goes_on_to_the_same_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Stopped by two Ctrl-C in a row: what was done is not done again, and it ends as if nobody had stopped it."""
    monkeypatch.chdir(tmp_path)
    written(tmp_path, TEXT)
    cut, whole = tmp_path / "cut", tmp_path / "whole"
    record = cut / "record.jsonl"
    process = begun(*SWEEP, "-o", "cut", "--workers", "2", folder=tmp_path)
    while not record.exists() or record.read_text(encoding="utf-8").count("\n") < 2:
        assert process.poll() is None, process.communicate()
        sleep(0.02)
    code, out, err = stopped(process, signal.SIGINT, signal.SIGINT)
    assert code == Exit.INTERRUPTED
    assert out == ""
    assert "interrupted; what was done is kept in cut\n  hint: give the same command again to go on from there\n" in err
    kept, count = record.read_bytes(), len(evaluations(cut))
    assert 2 <= count < DESIGNS
    assert f"note: {count} of {DESIGNS} designs are done\n" in err

    assert main([*SWEEP, "-o", "cut", "--workers", "1"]) == Exit.DONE
    assert f"{DESIGNS} done, 0 failed" in capsys.readouterr().out
    assert record.read_bytes().startswith(kept)
    assert main([*SWEEP, "-o", "whole", "--workers", "1", "--quiet"]) == Exit.DONE
    assert evaluations(cut) == evaluations(whole)
    assert rows(cut) == rows(whole)


@pytest.mark.parametrize(("number", "ended"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")])
def test_a_form_that_is_stopped_leaves_all_as_it_was(number: int, ended: str, tmp_path: Path) -> None:
    written(tmp_path, LONG)
    old = tmp_path / "out"
    if number == signal.SIGTERM:
        old.mkdir()
        (old / "result.json").write_text('{"schema": 1, "version": "0"}', encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    process = begun("form", "dish.toml", "-o", "out", "--verbose", "--overwrite", folder=tmp_path)
    assert process.stderr is not None
    # It presses when the first steps are told.
    while "step 1" not in process.stderr.readline():
        assert process.poll() is None
    code, out, err = stopped(process, number)
    assert code == 128 + number
    assert out == ""
    untouched = "; out is as it was" if before[-1] != tmp_path / "dish.toml" else ""
    assert f"{ended}; nothing was written{untouched}\n  hint: give the same command again; it begins anew\n" in err
    assert sorted(tmp_path.rglob("*")) == before


def test_the_second_signal_waits_for_the_end_and_the_third_does_not(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    ended: list[int] = []
    stop = Stop()
    monkeypatch.setattr(os, "_exit", ended.append)
    with pytest.raises(Terminated):
        stop(signal.SIGTERM, None)
    stop(signal.SIGINT, None)
    assert "tidying up" in capfd.readouterr().err
    assert not ended
    stop(signal.SIGINT, None)
    assert ended == [130]


def test_signals_are_given_back_and_ignored_ones_stay_ignored() -> None:
    before = signal.getsignal(signal.SIGTERM)
    old = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with stoppable() as stop:
            assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN, "as nohup and `&` have it"
            assert signal.getsignal(signal.SIGTERM) is stop
    finally:
        signal.signal(signal.SIGINT, old)
    assert signal.getsignal(signal.SIGTERM) is before


def test_what_an_interrupt_turns_into_is_an_interrupt(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def library(*, as_json: bool) -> Exit:
        try:
            os.kill(os.getpid(), signal.SIGINT)
            sleep(1)
        except KeyboardInterrupt:
            raise ImportError("half of it") from None
        return Exit.DONE

    monkeypatch.setattr("punchform.cli.about.about", library)
    handler = signal.getsignal(signal.SIGINT)
    try:
        assert main(["about"]) == Exit.INTERRUPTED
    finally:
        signal.signal(signal.SIGINT, handler)
    assert capsys.readouterr().err == "interrupted\n"


def test_last_words_are_those_of_the_folder(tmp_path: Path) -> None:
    out = tmp_path / "out"
    form = {"path": "dish.toml", "output": str(out), "overwrite": False}
    grows = {**form, "scheduler": None}
    assert "nothing was written\n" in Left(form).words(Exit.INTERRUPTED)
    assert "nothing was written\n" in Left(grows).words(Exit.INTERRUPTED)
    late = Left(form)
    out.mkdir()
    assert late.words(Exit.TERMINATED) == f"terminated after the results were written to {out}"
    assert f"nothing was written; {out} is as it was" in Left(form).words(Exit.INTERRUPTED)
    assert f"kept in {out}" in Left(grows).words(Exit.INTERRUPTED)
    anew = Left({**grows, "overwrite": True})
    assert f"{out} is as it was" in anew.words(Exit.INTERRUPTED)
    (out / "record.jsonl").write_text("", encoding="utf-8")
    assert "the same command again without --overwrite to go on" in anew.words(Exit.INTERRUPTED)
    assert Left({"path": "dish.toml"}).words(Exit.INTERRUPTED) == "interrupted"
    assert Left({}).words(Exit.INTERRUPTED) == "interrupted"
