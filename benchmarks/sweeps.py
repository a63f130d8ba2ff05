"""Sweeps against the engine's own loop: P7's balls, with threads, through the command.

    python benchmarks/sweeps.py [balls]

Times are of the processor, so that it may be run on a busy machine: user and system, of all
threads. What two threads bring is told from what runs in the library, and can be shared, and what
does not, as if nothing of that went on beside them.
"""

from __future__ import annotations

import ctypes
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from problems.ball import RTOL, model
from problems.ensemble import END

import hybond as hb
from hybond.engine.compiled import members
from hybond.engine.compiled.members import NativeMembers
from hybond.engine.tables.options import settings_of
from hybond.sweep.family import family_of

COLLECT = {
    "at the end": "final(height), final(v.f), count(events)",
    "extremes too": "final(height), count(events), max(height), min(v.f), mean(height)",
    "modes too": "final(height), final(v.f), count(events), mode_time(floor.away), sequence",
}


def main(balls: int) -> None:
    """Print times and what they are of the engine's own."""
    factors = {"restitution": "lin(0.85, 0.99, 100)", "drop": f"lin(1, 3, {balls // 100})"}
    plan = hb.Plan(factors)
    own = min(engine(plan) for _ in range(3))
    print(f"{balls} balls by the engine alone: {own:.3f} s of the processor")
    for name, collect in COLLECT.items():
        took, shares = [], []
        for workers in (1, 2):
            with tempfile.TemporaryDirectory() as folder, Shares() as share:
                began = time.process_time()
                hb.sweep(
                    *(model(), plan),
                    **{"until": END, "rtol": RTOL, "collect": collect},
                    **{"out": folder, "workers": workers},
                )
                took.append(time.process_time() - began)
                shares.append(sum(share.by.values()))
        path = took[1] - 0.5 * shares[1]
        print(
            f"  {name}: {took[0]:.3f} s, {took[0] / own:.2f} of that; "
            f"two threads bring at least {took[0] / path:.2f}"
        )
    with tempfile.TemporaryDirectory() as folder:
        hb.save(model(), f"{folder}/ball.toml")
        words = [w for p, v in factors.items() for w in ("--vary", f"{p}={v}")]
        words += ["--until", repr(END), "--rtol", repr(RTOL), "--collect", COLLECT["at the end"]]
        small = [w.replace(f", {balls // 100})", ", 1)").replace(", 100)", ", 1)") for w in words]
        rows = {
            "empty Python": [],
            "import numpy": [],
            "--version": ["--version"],
            "check": ["check", "ball.toml"],
            "run": ["run", "ball.toml", "--until", "1"],
            "sweep of one ball": ["sweep", "ball.toml", *small, "--out", "one"],
            f"sweep of {balls}": ["sweep", "ball.toml", *words, "--out", "all"],
        }
        codes = {"empty Python": "", "import numpy": "import numpy"}
        took = {}
        for name, given in rows.items():
            command(folder, codes.get(name), *given)  # its bytecode is there now
            took[name] = min(command(folder, codes.get(name), *given) for _ in range(5))
            print(f"  {name}: {took[name]:.3f} s")
    whole, one = took[f"sweep of {balls}"], took["sweep of one ball"]
    print(f"  the whole command takes {whole / own:.2f} of the engine alone;")
    print(f"  its balls {(whole - one) / own:.2f} of that, its start {one / own:.2f}")


def engine(plan: hb.Plan) -> float:
    """Return what the library takes for all members in one call, s."""
    ball = model()
    rows = plan.rows(0, len(plan))
    settings, band = settings_of(ball.experiment, END, rtol=RTOL)
    first = {path: float(column[0]) for path, column in rows.items()}
    family = family_of(ball, first, settings, band, ("height", "v.f"), None)
    assert family is not None
    _, numbers, _ = family.numbers(rows, len(plan))
    began = time.process_time()
    NativeMembers(family.model, family.looked, np.zeros(0), ctypes.c_int(0)).run(numbers)
    return time.process_time() - began


class Shares:
    """What each thread has run in the library, s of the processor."""

    def __enter__(self) -> Shares:
        self.by: dict[int, float] = {}
        self._run = run = members.NativeMembers.run

        def timed(own: NativeMembers, numbers: np.ndarray) -> members.Ran:
            began = time.thread_time()
            found = run(own, numbers)
            me = threading.get_ident()
            self.by[me] = self.by.get(me, 0.0) + time.thread_time() - began
            return found

        members.NativeMembers.run = timed  # type: ignore[method-assign]
        return self

    def __exit__(self, *_: object) -> None:
        members.NativeMembers.run = self._run  # type: ignore[method-assign]


def command(folder: str, code: str | None, *words: str) -> float:
    """Return what a command takes, s of the processor, from its start to its end.

    It is what ``hybond`` is once installed: bytecode is cached.
    """
    source = str(Path(hb.__file__).parents[1])
    env = {**os.environ, "PYTHONPATH": source, "PYTHONPYCACHEPREFIX": f"{folder}/bytecode"}
    env.pop("PYTHONDONTWRITEBYTECODE", None)
    for name in ("one", "all"):
        shutil.rmtree(f"{folder}/{name}", ignore_errors=True)
    entry = "import sys; from hybond.cli.main import main; sys.exit(main())"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-c", entry if code is None else code, *words],
        cwd=folder,
        env=env,
        stdout=subprocess.DEVNULL,
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else 10_000)
