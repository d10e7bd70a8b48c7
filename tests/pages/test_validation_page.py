"""The figures of docs/validation.md, computed again: they keep their limits, and the page shows them."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from page_blocks import ROOT

PAGE = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
SHOWN = 2e-4
"""What two machines may differ by in a figure that is small beside its limit, as a part of that limit."""


@pytest.fixture(scope="module")
def checks() -> Iterator[ModuleType]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "benchmarks"))
        yield importlib.import_module("validation_checks")


def rows() -> dict[str, list[str]]:
    """The rows of the page by what they are of."""
    lines = (line for line in PAGE.splitlines() if line.startswith("| ") and not line.startswith("| what"))
    cells = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    return {row[0]: row[1:] for row in cells}


def test_every_figure_keeps_its_limit_and_is_the_one_on_the_page(checks: ModuleType) -> None:
    page, wrong, count = rows(), [], 0
    for room in checks.ROOMS.values():
        for check in room():
            count += 1
            expected, source, found, *_, test = page[check.what]
            if not check.off <= check.most or not shown(check, float(expected), float(found)):
                wrong.append(f"{check.what}: {check.found!r}, on the page {found}, expected {check.expected}")
            assert source == check.source
            assert check.test == test or test == f"[`{Path(check.test).stem}`](../{check.test})"
            assert "/" not in check.test or (ROOT / check.test).is_file()
    assert not wrong
    assert count == len(page) >= 50


def shown(check: Any, expected: float, found: float) -> bool:
    """Whether the page has this figure: to its digits, or, of what is nothing but rounding, within its limit."""
    rounding = abs(check.found) < 1e-6
    near = check.most if rounding else max(1e-6 * abs(check.found), SHOWN * check.most)
    return bool(abs(expected - check.expected) <= 1e-6 * abs(check.expected) and abs(found - check.found) <= near)
