"""A C compiler: one of the system, else the zig of package `ziglang`.

Run where hybond is built, too: nothing of hybond is imported here, it is not installed yet then.
"""

from __future__ import annotations

import importlib.util
import os
import shlex
import shutil
import sys

TIMEOUT = 900.0
"""Seconds that compiling may take: half a minute, but many times that on a machine with much to do
or by a compiler that has just been fetched."""


def compiler() -> list[str] | None:
    """Return the command of a C compiler, or None.

    ``CC`` names one; ``HYBOND_NO_COMPILER`` says to do without. The command ``cc`` comes after
    those that optimise, because it may be tcc. Where there is no other, tcc does: it ignores the
    flags that it does not know, never fuses products with sums, and nothing has to be fetched; what
    it compiles takes up to twice as long.
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
