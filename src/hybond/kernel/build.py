"""Compiling the kernel: with a C compiler of the system, else with the zig of package `ziglang`.

Run where hybond is built; nothing of hybond is imported here, because it is not installed yet.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

SOURCES = Path(__file__).parent / "c"
NAME = {"win32": "_kernel.dll", "darwin": "_kernel.dylib"}.get(sys.platform, "_kernel.so")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-shared")
"""Products are not fused with sums, so that a result does not depend on which instructions a
machine has; the functions of its C library may still differ in the last place."""
TIMEOUT = 300.0


def digest() -> str:
    """Return what tells these sources from others; empty if they are not here."""
    files = sorted([*SOURCES.glob("*.c"), *SOURCES.glob("*.h")])
    text = b"".join(f.name.encode() + f.read_bytes().replace(b"\r\n", b"\n") for f in files)
    return hashlib.sha256(text).hexdigest()[:16] if files else ""


def compiler() -> list[str] | None:
    """Return the command of a C compiler, or None.

    ``CC`` names one; ``HYBOND_NO_COMPILER`` says to do without. The command ``cc`` comes after
    those that optimise, because it may be tcc. Where there is no other, tcc does: it ignores the
    flags that it does not know, never fuses products with sums, and nothing has to be fetched. Its
    kernel takes up to twice as long as that of gcc, many times less than the reference.
    """
    if os.environ.get("HYBOND_NO_COMPILER"):
        return None
    if os.environ.get("CC"):
        return shlex.split(os.environ["CC"])
    for name in ("gcc", "clang", "cc", "tcc"):
        if shutil.which(name):
            return [name]
    if importlib.util.find_spec("ziglang") is not None:
        # zig compiles for the very machine it runs on unless told not to: libraries go elsewhere
        return [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]
    return None


def wants_zig() -> bool:
    """Return whether a compiler has to be fetched."""
    return compiler() is None and not os.environ.get("HYBOND_NO_COMPILER")


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
