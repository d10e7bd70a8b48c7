"""What the program was checked against: computes every figure of docs/validation.md and writes its tables.

    python benchmarks/validation.py [--write docs/validation.md]

Ends with 1 when a figure is further from what it must be than its test allows. The page needs the markers
`<!-- table: validation -->` and `<!-- end: validation -->`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path
from time import perf_counter

from tables import put_between
from validation_checks import ROOMS, Check

HEAD = ("what", "expected", "by", "found", "off by", "may be off by", "test")


def table(checks: Iterable[Check]) -> str:
    """The table of some checks in Markdown."""
    lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    return "\n".join([*lines, *(row(check) for check in checks)])


def row(check: Check) -> str:
    """One check as a row."""
    test = f"[`{Path(check.test).stem}`](../{check.test})" if "/" in check.test else check.test
    off = f"{check.off:.1g}" if check.off else "0"
    cells = (check.what, number(check.expected), check.source, number(check.found), off, f"{check.most:.1g}", test)
    return f"| {' | '.join(cells)} |"


def number(value: float) -> str:
    """To seven digits; what is nothing but rounding to one."""
    return f"{value:.7g}" if abs(value) > 1e-6 else f"{value:.0e}" if value else "0"


def main() -> int:
    """Compute, print, and write."""
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--write", metavar="PAGE", type=Path)
    page = arguments.parse_args().write
    parts, bad = [], []
    for title, checks in ROOMS.items():
        begun = perf_counter()
        done = list(checks())
        print(f"{title}: {len(done)} checks, {perf_counter() - begun:.1f} s", file=sys.stderr)
        bad += [check for check in done if not check.off <= check.most]
        parts.append(f"### {title}\n\n{table(done)}")
    text = "\n\n".join(parts)
    print(text)
    for check in bad:
        print(f"too far off: {row(check)}", file=sys.stderr)
    if page:
        put_between(page, "validation", text)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
