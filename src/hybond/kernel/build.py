"""Compiling the kernel: with a C compiler of the system, else with the zig of package `ziglang`.

Run where hybond is built; nothing of hybond is imported here, because it is not installed yet.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

from hybond.engine.compiled.compiler import TIMEOUT, compiler

SOURCES = Path(__file__).parent / "c"
NAME = {"win32": "_kernel.dll", "darwin": "_kernel.dylib"}.get(sys.platform, "_kernel.so")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-shared")
"""Products are not fused with sums, so that a result does not depend on which instructions a
machine has; the functions of its C library may still differ in the last place."""


def digest() -> str:
    """Return what tells these sources from others; empty if they are not here."""
    files = sorted([*SOURCES.glob("*.c"), *SOURCES.glob("*.h")])
    text = b"".join(f.name.encode() + f.read_bytes().replace(b"\r\n", b"\n") for f in files)
    return hashlib.sha256(text).hexdigest()[:16] if files else ""


def compile_into(target: Path, *, flags: tuple[str, ...] = ()) -> str:
    """Compile the kernel into the file `target`; return why that failed, empty if it did not."""
    command = compiler()
    if command is None:
        return "there is no C compiler"
    pic: tuple[str, ...] = () if sys.platform == "win32" else ("-fPIC",)
    files = [str(f) for f in sorted(SOURCES.glob("*.c"))]
    mark = f'-DHYBOND_SOURCE="{digest()}"'
    libraries = () if sys.platform == "win32" else ("-lm",)
    whole = [*command, *FLAGS, *pic, mark, *flags, "-o", str(target), *files, *libraries]
    try:
        done = subprocess.run(
            whole, capture_output=True, text=True, timeout=TIMEOUT, check=False, errors="replace"
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"{command[0]}: {error}"
    return "" if done.returncode == 0 else f"{command[0]}: {done.stderr.strip()[-2000:]}"
