"""Putting a generated table into a page of the docs."""

from __future__ import annotations

import re
from pathlib import Path


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
