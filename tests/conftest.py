"""Which tests run, on which worker, and with which random examples.

Tests that need what the machine lacks are skipped, and the end of a run counts what was, by reason.
"""

import gc
import itertools
import math
import os
import signal
import zlib
from collections import Counter, defaultdict
from collections.abc import Generator
from pathlib import Path

import needs
import pytest
from _pytest.doctest import DoctestModule
from example_runs import SHARE_RUNS
from hypothesis import settings
from part_sheets import SHARE_SHEETS

WORKER = os.environ.get("PYTEST_XDIST_WORKER", "")
"""Which of several processes this is: gw0, gw1, ..."""
LARGE_GRID = 8
"""Cases from which on a 24th of a grid is kept."""

SMALL_GRID = 6
"""Cases from which on a sixth of it is: of two by two that would be one diagonal, on which neither
axis is told from the other."""

LONG_LIST = 4
"""Cases of one list from which on it is sampled."""
FEWEST = 4
"""Cases of a grid that are kept at the least, if its longest axis has as many values."""

RUNS = {"engine", "cases", "simulation", "property", "model"}
"""Folders of tests whose slow ones are run in part."""
DEAR = {
    "test_any_compiler_makes_a_library_that_runs",
    "test_a_nonlinear_graph_is_linearised_at_its_start",
}
"""Tests of these that take more than some seconds."""
COMPILED = {"c", "java", "strict", "gcc", "clang"}
"""Marks of what compiles a program first, which takes some seconds each."""

settings.register_profile("same", derandomize=True, deadline=None, database=None)
settings.register_profile("new", deadline=None)
settings.load_profile("new" if os.environ.get("HYBOND_FUZZ") else "same")


class ExamplesWhereThereAreSome:
    """Leaves the modules alone that have no example: most have none, and searching takes long."""

    @pytest.hookimpl(wrapper=True)
    def pytest_collect_file(
        self, file_path: Path
    ) -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
        found = yield
        if (
            any(isinstance(c, DoctestModule) for c in found)
            and b">>>" not in file_path.read_bytes()
        ):
            return [c for c in found if not isinstance(c, DoctestModule)]
        return found


def pytest_configure(config: pytest.Config) -> None:
    """Hear interrupts, also where the tests were started in the background, which ignores them.

    Until all tests are collected, little that is made is garbage: nobody looks for it.
    """
    # hooks of this file are for its folder; examples stand in the package, too
    config.pluginmanager.register(ExamplesWhereThereAreSome())
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.disable()


def pytest_collection_finish() -> None:
    """Let the garbage collector look at what tests make, not at all modules and tests each time.

    And less often: looking took a twentieth of the time of all tests.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 50)
    gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if WORKER:  # all have them in the same order
        items.sort(key=lambda item: item.path.parts)
    for item in items:
        for mark, reason in needs.MISSING.items():
            if item.get_closest_marker(mark):
                item.add_marker(pytest.mark.skip(reason=reason))
    if not config.option.keyword:  # who asks for tests by name gets all of their cases
        sample(items)
        take_a_few(items)


def sample(items: list[pytest.Item]) -> None:
    """Of a test with many cases keep some; the rest are slow.

    Marked ``sampled(n)`` it keeps n, spread over all. Of a large grid, which several
    ``parametrize`` make, it keeps a 24th, and of a small one a sixth, in which the values of
    each come about as often as each other. Those are at least as many as its longest axis has
    values, or four, but for one that is marked. Of a long list it keeps the first and from the
    second on every sixth one, of one as long as a large grid every twelfth.
    """
    cases: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("slow"):
            continue
        if next(item.iter_markers("parametrize"), None) or item.get_closest_marker("sampled"):
            cases[item.nodeid.partition("[")[0]].append(item)
    for found in cases.values():
        mark = found[0].get_closest_marker("sampled")
        if mark is not None:
            (many,) = mark.args
            kept = {k * len(found) // many for k in range(many)}
            if is_grid(lengths_of(found), found) and many < len(found):
                kept = balanced(lengths_of(found), many)
        elif is_grid(lengths_of(found), found) and len(found) >= SMALL_GRID:
            many = -(-len(found) // (24 if len(found) >= LARGE_GRID else 6))
            kept = balanced(lengths_of(found), max(many, min(FEWEST, max(lengths_of(found)))))
        else:
            every = 12 if len(found) >= LARGE_GRID else 6 if len(found) >= LONG_LIST else 1
            # the second too: of solvers it is the other kind
            kept = {0, *range(1, len(found), every)}
        for k, item in enumerate(found):
            if k not in kept:
                item.add_marker(pytest.mark.slow)


def take_a_few(items: list[pytest.Item]) -> None:
    """Of the slow tests of what a run does, let one in 192 be none, always the same ones.

    Which these are is by a checksum of their names: cases that no pattern of a grid chooses. A test
    that is marked ``sampled(n)`` has the n that it wants already.
    """
    for item in items:
        slow = next((m for m in item.own_markers if m.name == "slow"), None)
        chosen = zlib.crc32(item.nodeid.encode()) % 192 == 0
        dear = getattr(item, "originalname", "") in DEAR or item.get_closest_marker("sampled")
        dear = dear or any(m.name in COMPILED for m in item.iter_markers())
        if slow and chosen and not dear and RUNS & {*item.path.parts}:
            item.own_markers.remove(slow)


def lengths_of(found: list[pytest.Item]) -> list[int]:
    """Return how many values each ``parametrize`` of a test has."""
    return [*map(length, found[0].iter_markers("parametrize"))]


def is_grid(lengths: list[int], found: list[pytest.Item]) -> bool:
    """Whether the cases are those of several ``parametrize``, each with each."""
    return len(lengths) > 1 and len(found) == math.prod(lengths)


def length(parametrize: pytest.Mark) -> int:
    """Return how many values there are; 0 where that is not told, which makes no grid."""
    values = parametrize.args[1] if len(parametrize.args) > 1 else parametrize.kwargs["argvalues"]
    return len(values) if hasattr(values, "__len__") else 0


def balanced(lengths: list[int], many: int) -> set[int]:
    """Return which cases of a grid to keep.

    The first of all is one. The next is the one whose values, and then whose pairs of values, are
    there least so far.
    """
    cases = dict(enumerate(itertools.product(*map(range, lengths))))
    had = Counter[tuple[int, ...]]()
    kept: list[int] = []

    def parts(case: tuple[int, ...]) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        alone = [*enumerate(case)]
        return alone, [(*a, *b) for a, b in itertools.combinations(alone, 2)]

    def times(k: int) -> tuple[int, int, int]:
        alone, pairs = parts(cases[k])
        return sum(map(had.__getitem__, alone)), sum(map(had.__getitem__, pairs)), k

    while len(kept) < many:
        kept.append(min(cases, key=times))
        for part in parts(cases.pop(kept[-1])):
            had.update(part)
    return {*kept}


def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Send the files that look at the same runs or sheets to one worker, others file by file."""
    from xdist.scheduler import LoadScopeScheduling

    class Scheduling(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            path = nodeid.partition("::")[0]
            for scope, files in (("examples", SHARE_RUNS), ("parts", SHARE_SHEETS)):
                if path.endswith(files):
                    return scope
            return super()._split_scope(nodeid)

    return Scheduling(config, log)


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
