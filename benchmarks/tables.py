"""Making a table of rows that are measured apart, and putting a table into a page of the docs."""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path


def from_processes(script: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """The table in Markdown, each row from a process of its own: of the script with these arguments, which prints it as
    a JSON object by column. Lines go to standard error as they come."""
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    for arguments in rows:
        done = subprocess.run([sys.executable, script, *arguments], stdout=subprocess.PIPE, text=True, check=True)
        row = json.loads(done.stdout)
        lines.append(f"| {' | '.join(str(row.get(column, '–')) for column in head)} |")
        print(lines[-1], file=sys.stderr)
    return "\n".join([*lines, "", f"({platform.machine()}, {os.cpu_count()} cores)"])


def put_between(page: Path, name: str, text: str) -> None:
    """Replace what stands between the markers `<!-- table: name -->` and `<!-- end: name -->` of a page.

    Raises ValueError when the page has no such markers.
    """
    begin, end = f"<!-- table: {name} -->", f"<!-- end: {name} -->"
    old = page.read_text(encoding="utf-8")
    new, count = re.subn(f"{begin}.*?{end}", lambda _: f"{begin}\n\n{text}\n\n{end}", old, flags=re.DOTALL)
    if count != 1:
        raise ValueError(f"{page} needs the markers {begin} and {end} exactly once")
    page.write_text(new, encoding="utf-8")
