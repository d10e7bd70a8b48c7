"""What the tests of the command line share: small cases, real processes, and a real terminal."""

from __future__ import annotations

import os
import select
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from time import monotonic

import tiny_dish

COMMAND = (sys.executable, "-m", "punchform")
PATIENCE = 60.0
"""Seconds after which a process that a test has started is given up."""

ELASTIC = 'diameter = "0.75 mm"\nyoungs_modulus = "210 GPa"\npoisson = 0.3\n'
YIELDS = 'diameter = "0.75 mm"\nmaterial = "304 annealed"\n'
STROKES = '[press]\nrim = "clamp"\nstrokes = 4\n[release]'
YIELDING = tiny_dish.TEXT.replace(ELASTIC, YIELDS).replace("[release]", STROKES)
"""The tiny dish of wires that yield, pressed in four strokes."""


def written(folder: Path, text: str = tiny_dish.TEXT) -> str:
    """A case file with a text; its name."""
    path = folder / "dish.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def environment(more: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment without what changes how terminals are written to."""
    kept = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR", "TERM")}
    return {**kept, **(more or {})}


def begun(*arguments: str, folder: Path) -> subprocess.Popen[str]:
    """The command as a process of its own, whose signals reach nobody else."""
    return subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def on_a_terminal(*arguments: str, folder: Path, more: Mapping[str, str]) -> tuple[int, str, str]:
    """Run the command with its stderr on a terminal; its exit code, stdout, and what it wrote to the terminal."""
    master, slave = os.openpty()
    out = folder / "stdout.txt"
    with out.open("w", encoding="utf-8") as stdout:
        process = subprocess.Popen(
            [*COMMAND, *arguments],
            cwd=folder,
            env=environment(more),
            stdout=stdout,
            stderr=slave,
            start_new_session=True,
        )
    os.close(slave)
    shown = b"".join(_read(master))
    os.close(master)
    return process.wait(PATIENCE), out.read_text(encoding="utf-8"), shown.decode("utf-8")


def _read(terminal: int) -> Iterator[bytes]:
    """What is written to a terminal until nobody has it open any more."""
    late = monotonic() + PATIENCE
    while monotonic() < late:
        if not select.select([terminal], [], [], 1.0)[0]:
            continue
        try:
            chunk = os.read(terminal, 1 << 16)
        except OSError:
            return
        if not chunk:
            return
        yield chunk
    raise TimeoutError("the command does not end")
