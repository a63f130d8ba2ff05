"""What tests need from the machine, found once.

A test says with a mark what it needs, ``@pytest.mark.java``; `conftest.py` skips it where `MISSING`
has the mark. `without.py` runs tests as on a machine that has less.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest


def found(name: str) -> list[str] | None:
    """Return the command of a program, or None."""
    path = shutil.which(name)
    return [path] if path else None


def named() -> list[str] | None:
    """Return the compiler that the environment variable CC names, or None."""
    words = shlex.split(os.environ.get("CC", ""))
    return words if words and shutil.which(words[0]) else None


def strict(command: list[str] | None) -> bool:
    """Whether this is a compiler that warns and has sanitizers; ``cc`` may be a link to tcc."""
    path = shutil.which(command[0]) if command else None
    return path is not None and "tcc" not in Path(path).resolve().name


GCC, CLANG, TCC = found("gcc"), found("clang"), found("tcc")
ZIG = [sys.executable, "-m", "ziglang", "cc"] if importlib.util.find_spec("ziglang") else None
CC = named() or found("cc")

STRICT = next((c for c in (named(), GCC, CLANG, found("cc")) if strict(c)), None)
"""gcc or clang, with which programs compile without a warning."""

QUICK = TCC or STRICT or CC
"""The compiler that takes least time."""

JAVA, JAVAC = (
    [name, *(f"{to}-XX:{how}" for how in ("TieredStopAtLevel=1", "+UseSerialGC"))]
    for name, to in (("java", ""), ("javac", "-J"))
)
"""Java that does not make itself fast first, which takes it half of such short runs."""

COMPILERS = {"gcc": GCC, "clang": CLANG, "tcc": TCC, "zig": ZIG}

MISSING = {
    mark: f"no {reason}"
    for mark, reason, there in (
        ("c", "C compiler (gcc, clang or tcc)", QUICK),
        ("strict", "C compiler that warns (gcc or clang)", STRICT),
        ("gcc", "gcc", GCC),
        ("clang", "clang", CLANG),
        ("tcc", "quick C compiler (tcc)", TCC),
        ("zig", "zig (pip install ziglang)", ZIG),
        ("java", "Java compiler (javac)", found("javac") and found("java")),
        ("ngspice", "ngspice", found("ngspice")),
        ("latex", "pdflatex", found("pdflatex")),
    )
    if not there
}
"""Why tests with a mark are skipped here."""


@functools.cache
def sanitizers() -> list[str]:
    """Return the flags that end a program at its first error; skip a test if `STRICT` has none.

    Their libraries are packages of their own in places: clang comes without.
    """
    assert STRICT is not None, "the test lacks the mark `strict`"
    flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "empty.c")
        source.write_text("int main(void) { return 0; }\n", encoding="utf-8")
        command = [*STRICT, *flags, "-o", str(source.with_suffix("")), str(source)]
        done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode:
        pytest.skip(f"no sanitizers of {Path(STRICT[0]).name}")
    return flags
