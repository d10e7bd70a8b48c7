"""Where nothing may be skipped (PUNCHFORM_NO_SKIP=1, as in CI), a skip is a failure with its reason."""

from __future__ import annotations

import os
from collections.abc import Generator
from typing import TypeVar

import pytest

AnyReport = TypeVar("AnyReport", pytest.TestReport, pytest.CollectReport)


class NoSkip:
    """Turns skipped tests and skipped modules into failures; expected failures (xfail) stay what they are."""

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        return _failed_if_skipped((yield))

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(self) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
        return _failed_if_skipped((yield))


def _failed_if_skipped(report: AnyReport) -> AnyReport:
    if report.skipped and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        report.outcome = "failed"
        report.longrepr = f"nothing may be skipped here (PUNCHFORM_NO_SKIP=1), but: {reason}"
    return report


def pytest_configure(config: pytest.Config) -> None:
    if os.environ.get("PUNCHFORM_NO_SKIP") == "1":
        # A plugin of its own and not hooks of this file, which would not reach the doctests in src.
        config.pluginmanager.register(NoSkip())
