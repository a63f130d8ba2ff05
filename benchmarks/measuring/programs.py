"""The C programs that say how fast a problem can be done on this machine."""

from __future__ import annotations

import functools
import math
import subprocess
import tempfile
from pathlib import Path

from hybond.engine.compiled.compiler import compiler
from measuring.problem import Outcome

LIMIT = Path(__file__).parents[1] / "limit"
FLAGS = ["-std=c11", "-O3", "-D_POSIX_C_SOURCE=199309L"]
"""Not for the very machine: with gcc 12 and AVX-512 some of these programs were 20 times slower."""
ENOUGH = 0.02
"""Seconds that a measurement takes at least; shorter jobs are repeated."""


@functools.cache
def folder() -> tempfile.TemporaryDirectory[str]:
    """Return where programs are compiled to; it goes with the process."""
    return tempfile.TemporaryDirectory()


@functools.cache
def compiled(name: str) -> Path | None:
    """Compile a limit program; None without a compiler."""
    command = compiler()
    if command is None:
        return None
    target = Path(folder().name) / name
    subprocess.run([*command, *FLAGS, "-o", target, LIMIT / f"{name}.c", "-lm"], check=True)
    return target


def once(program: Path, repeats: int, given: tuple[float, ...]) -> Outcome:
    """Do a job so many times; return the seconds for one."""
    words = [str(program), str(repeats), *(f"{a:.17g}" for a in given)]
    out = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    return Outcome(float(out[0]), tuple(float(a) for a in out[1:]))


def in_c(name: str, *given: float) -> Outcome | None:
    """Do the job of a limit program, often enough to be timed."""
    program = compiled(name)
    if program is None:
        return None
    first = once(program, 1, given)
    if first.seconds >= ENOUGH:
        return first
    return once(program, math.ceil(1.2 * ENOUGH / max(first.seconds, 1e-6)), given)
