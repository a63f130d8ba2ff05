"""Random tests draw the same examples in every run; ``HYBOND_FUZZ=1`` draws new ones.

Tests that need what the machine lacks are skipped, and the end of a run counts what was, by reason.
"""

import os
from collections import Counter

import needs
import pytest
from hypothesis import settings

settings.register_profile("same", derandomize=True, deadline=None, database=None)
settings.register_profile("new", deadline=None)
settings.load_profile("new" if os.environ.get("HYBOND_FUZZ") else "same")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        for mark, reason in needs.MISSING.items():
            if item.get_closest_marker(mark):
                item.add_marker(pytest.mark.skip(reason=reason))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = terminalreporter.stats.get("skipped", [])
    tests, files = Counter[str](), Counter[str]()
    for report in reports:
        # the reason is the last of file, line and "Skipped: reason"
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longreprtext
        count = tests if isinstance(report, pytest.TestReport) else files
        count[reason.removeprefix("Skipped: ")] += 1
    if reports:
        terminalreporter.section("skipped, and why")
    for count, unit in ((tests, "test"), (files, "whole file")):
        for reason, n in sorted(count.items()):
            terminalreporter.line(f"{reason}: {n} {unit}{'s' * (n > 1)}")
