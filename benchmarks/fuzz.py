"""What is read from outside, changed at random: refused with a code or understood, never else.

``python benchmarks/fuzz.py --cpu 3600`` changes examples, netlists, descriptions of units, states,
tables, texts of options and messages, each from a seed, and has them read within bounds of time,
memory and place. It counts cases per reader, and keeps the input and the reason of what was wrong
in ``out/fuzz``. ``--reader toml --seed 17`` does one case again.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import select
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MPLBACKEND", "agg")

from fuzzing.everything import READERS
from fuzzing.judging import Verdict, judged, limit

OUT = Path("out/fuzz")
BATCH = 100
"""Cases of one child: what one leaves behind reaches no further."""
PATIENCE = 240.0
"""Seconds of a wall clock without a word from a child; then it is ended."""


def case_of(reader: str, seed: int, folder: Path) -> Verdict:
    """Return how one case ended."""
    draw = random.Random(f"{reader} {seed}")
    return judged(reader, seed, folder, lambda place: READERS[reader](draw, place))


def _child(reader: str, seeds: range, folder: Path, out: int) -> None:
    with os.fdopen(out, "w") as pipe, open(os.devnull, "w") as nothing:
        sys.stdout = sys.stderr = nothing
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        limit()
        warnings.simplefilter("ignore")
        for seed in seeds:
            print(json.dumps({"seed": seed}), file=pipe, flush=True)
            verdict = case_of(reader, seed, folder)
            if verdict.wrong:
                keep(verdict, folder)
            print(json.dumps(asdict(verdict)), file=pipe, flush=True)
            if verdict.kind in ("hang", "MemoryError", "memory"):
                break  # nobody knows what was left


def batch(reader: str, seeds: range, folder: Path) -> Iterator[Verdict]:
    """Yield how the cases of some seeds ended, each in a child that may die."""
    at = seeds.start
    while at < seeds.stop:
        read, write = os.pipe()
        number = os.fork()
        if number == 0:
            code = 1
            try:
                os.close(read)
                os.setsid()
                _child(reader, range(at, seeds.stop), folder, write)
                code = 0
            finally:
                os._exit(code)
        os.close(write)
        last = at
        done = False
        with os.fdopen(read) as pipe:
            while True:
                if not select.select([pipe], [], [], PATIENCE)[0]:
                    os.kill(number, signal.SIGKILL)
                line = pipe.readline()
                if not line:
                    break
                record = json.loads(line)
                if "kind" not in record:
                    last, done = record["seed"], False
                else:
                    done = True
                    yield Verdict(**record)
        _, status = os.waitpid(number, 0)
        if not done:
            said = f"signal {os.WTERMSIG(status)}" if os.WIFSIGNALED(status) else f"exit {status}"
            verdict = Verdict(reader, last, "died", said=said)
            keep(verdict, folder)
            yield verdict
        at = last + 1


def keep(verdict: Verdict, folder: Path) -> None:
    """Keep the input of a case that went wrong, and what is to be said of it."""
    place = OUT / f"{verdict.reader}-{verdict.seed}"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    shutil.copytree(folder, place / "input", symlinks=True, ignore_dangling_symlinks=True)
    (place / "said.txt").write_text(
        f"{verdict.kind} {verdict.code}\n{verdict.said}\n", errors="backslashreplace"
    )


def used() -> float:
    """Return the CPU that children had so far, s."""
    found = resource.getrusage(resource.RUSAGE_CHILDREN)
    return found.ru_utime + found.ru_stime


def main() -> int:
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--cpu", type=float, default=60.0, help="seconds of CPU, shared by readers")
    words.add_argument("--reader", action="append", choices=READERS)
    words.add_argument("--seed", type=int, help="do one case")
    words.add_argument("--first", type=int, default=0, help="the first seed")
    given = words.parse_args()
    readers = given.reader or list(READERS)
    OUT.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home, "case")
        os.environ["MPLCONFIGDIR"] = home
        import matplotlib.font_manager  # noqa: F401 - what it writes is written before

        os.environ["HYBOND_STATE"] = str(folder / "state")
        if given.seed is not None:
            verdict = case_of(readers[0], given.seed, folder)
            if verdict.wrong:
                keep(verdict, folder)
            print(verdict.kind, verdict.code, verdict.said, f"{verdict.cpu:.2f} s", sep="\n")
            return int(verdict.wrong)
        return _campaign(readers, given.cpu, given.first, folder)


def _campaign(readers: list[str], cpu: float, first: int, folder: Path) -> int:
    cases, kinds = Counter[str](), Counter[tuple[str, str]]()
    codes: dict[str, Counter[str]] = {r: Counter() for r in readers}
    spent = dict.fromkeys(readers, 0.0)
    slowest = dict.fromkeys(readers, 0.0)
    largest = dict.fromkeys(readers, 0)
    begin = used()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        while used() - begin < cpu:
            # who had least goes on
            reader = min(readers, key=lambda r: spent[r])
            start = used()
            seeds = range(first + cases[reader], first + cases[reader] + BATCH)
            for verdict in batch(reader, seeds, folder):
                kinds[reader, verdict.kind] += 1
                codes[reader][verdict.code] += 1
                slowest[reader] = max(slowest[reader], verdict.cpu)
                largest[reader] = max(largest[reader], verdict.room)
                if verdict.wrong:
                    print(f"{reader} {verdict.seed}: {verdict.kind}: {_last(verdict)}", flush=True)
            cases[reader] += BATCH
            spent[reader] += max(used() - start, 1e-3)
    except KeyboardInterrupt:
        print("interrupted")  # what was counted is told
    print(f"{'reader':14} {'cases':>7} {'fine':>7} {'refused':>7} {'wrong':>6} {'codes':>5}"
          f" {'slowest':>8} {'most':>8} {'CPU':>7}")  # fmt: skip
    wrong = 0
    for r in readers:
        fine, refused = kinds[r, "fine"], kinds[r, "refused"]
        bad = sum(n for (reader, _), n in kinds.items() if reader == r) - fine - refused
        wrong += bad
        print(f"{r:14} {cases[r]:7} {fine:7} {refused:7} {bad:6} {len(codes[r]) - 1:5}"
              f" {slowest[r]:6.1f} s {largest[r] / 2**20:4.0f} MiB {spent[r]:5.0f} s")  # fmt: skip
    print(f"{sum(cases.values())} cases, {wrong} wrong, {used() - begin:.0f} s of CPU")
    (OUT / f"counts-{int(time.time())}.json").write_text(
        json.dumps({"cases": cases, "codes": codes, "spent": spent}, indent=1)
    )
    return int(wrong > 0)


def _last(verdict: Verdict) -> str:
    lines = [row for row in verdict.said.splitlines() if row.strip()]
    return (lines[-1] if verdict.kind[0].isupper() else lines[0] if lines else "")[:160]


if __name__ == "__main__":
    sys.exit(main())
