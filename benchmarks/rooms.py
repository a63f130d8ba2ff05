"""Where the time of a run goes, room by room of the engine.

    python benchmarks/rooms.py P3 [P5 ...] [--tool "hybond exact"] [--seconds 3] [--write table.md]

Each problem of the speed table is run beside Linux's `perf`, which samples what the processor does:
as often over its longer length as over its shorter one, and what the longer one takes more is what
its time goes into. What is inlined counts for the function that it is part of. Only the engine's
library is looked at: what the interpreter does around it is left out.
"""

from __future__ import annotations

import argparse
import collections
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from measuring.problem import Tool
from problems import ASKED, PROBLEMS

ENGINE = Path(__file__).parents[1] / "src" / "hybond" / "engine"
USUAL = ("P1", "P3", "P5")
SAMPLES = 2000
"""A second."""
SHOWN, LARGEST = 9, 3
"""Rooms and functions that are shown at the most."""
LEAST = 3.0
"""Percent that a room takes to be shown."""


def main() -> None:
    """Sample each problem that is named, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problems", nargs="*", metavar="P", help=f"by default {' '.join(USUAL)}")
    parser.add_argument("--tool", default="hybond")
    parser.add_argument("--seconds", type=float, default=3.0, help="of a run, about")
    parser.add_argument("--write", type=Path, metavar="FILE.md")
    parser.add_argument("--run", nargs=3, type=float, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.run:
        which, length, times = options.run
        tool = (PROBLEMS | ASKED)[options.problems[0]](False)[int(which)].tools[options.tool]
        for _ in range(int(times)):
            tool(length)
        return
    if shutil.which("perf") is None:
        print("where time goes is not looked at: there is no perf")
        return
    rooms = rooms_of_functions()
    rows = ["| row | rooms, % | functions, % |", "| --- | --- | --- |"]
    for key in options.problems or USUAL:
        for number, problem in enumerate((PROBLEMS | ASKED)[key](False)):
            if options.tool in problem.tools:
                times = often_enough(problem.tools[options.tool], problem.lengths, options.seconds)
                short, long = (
                    sampled(key, number, options.tool, n, times) for n in problem.lengths
                )
                found = long - short  # none below zero
                rows.append(f"| {key} {problem.title} | {' | '.join(shares(found, rooms))} |")
                print(rows[-1], flush=True)
    if options.write:
        options.write.write_text("\n".join(rows) + "\n", encoding="utf-8")


def often_enough(tool: Tool, lengths: tuple[float, float], seconds: float) -> int:
    """Return how many runs take so much longer over the longer length."""
    taken = []
    for length in (lengths[0], *lengths):  # the first one loads what is loaded once
        start = time.perf_counter()
        tool(length)
        taken.append(time.perf_counter() - start)
    return max(1, round(seconds / max(taken[2] - taken[1], 1e-3)))


def sampled(
    key: str, number: int, tool: str, length: float, times: int
) -> collections.Counter[str]:
    """Return how often each function was met in so many runs, in a process of their own."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "perf.data"
        run = [sys.executable, __file__, key, "--tool", tool, "--run"]
        run += [str(number), str(length), str(times)]
        record = ["perf", "record", "-q", "-F", str(SAMPLES), "-e", "cpu-clock", "-o", str(data)]
        subprocess.run([*record, *run], check=True, stdout=subprocess.DEVNULL)
        report = ["perf", "report", "-i", str(data), "--stdio", "-F", "sample,dso,symbol"]
        said = subprocess.run(report, check=True, capture_output=True, text=True).stdout
    found = collections.Counter[str]()
    for line in said.splitlines():
        if row := re.match(r"\s*(\d+)\s+(\S+)\s+\[.\]\s+(\S+)", line):
            many, place, name = row.groups()
            if "_engine" in place:
                found[name.partition(".")[0]] += int(many)
    return found


def rooms_of_functions() -> dict[str, str]:
    """Return the room of each function of the engine, as it is named in C."""
    found: dict[str, str] = {}
    for path in ENGINE.rglob("*.py"):
        room = path.parent.relative_to(ENGINE).as_posix().replace(".", "engine")
        for name in re.findall(r"^def (\w+)\(", path.read_text(encoding="utf-8"), re.MULTILINE):
            found[f"{path.stem}_{name}"] = room
            found.setdefault(name, room)
    return found


def shares(found: collections.Counter[str], rooms: dict[str, str]) -> tuple[str, str]:
    """Return what rooms, and what functions, take most, in words."""
    whole = sum(found.values())
    by_room = collections.Counter[str]()
    for name, many in found.items():
        by_room[rooms.get(name, "between them")] += many
    told = [
        f"{room} {100 * many / whole:.0f}"
        for room, many in by_room.most_common(SHOWN)
        if 100 * many >= LEAST * whole
    ]
    most = [f"`{name}` {100 * many / whole:.0f}" for name, many in found.most_common(LARGEST)]
    return ", ".join(told), ", ".join(most)


if __name__ == "__main__":
    main()
