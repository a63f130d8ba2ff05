"""The compiled library: made of the printed engine, by a C compiler."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from hybond.engine.compiled.compiler import TIMEOUT, compiler
from hybond.engine.compiled.fresh import NAME, WHY
from hybond.engine.compiled.printing import library_text
from hybond.uncollected import uncollected

HOME = Path(__file__).with_name(NAME)
"""Where runs look for it."""
NOTE = HOME.with_name(WHY)
"""Where they look for the reason why it is not there."""
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-shared")
IN_PARTS = ("-flto=auto",)
"""What has gcc optimise parts of the one file beside each other: on two cores it takes 41 s
instead of 68, and what is made runs as fast."""


def compile_into(target: Path = HOME, *, flags: tuple[str, ...] = ()) -> str:
    """Print and compile the engine into the file `target`; return why not, empty if it is there."""
    command = compiler()
    if command is None:
        return "there is no C compiler"
    hidden = () if sys.platform == "win32" else ("-fPIC", "-fvisibility=hidden")
    libraries = () if sys.platform == "win32" else ("-lm",)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "engine.c")
        source.write_text(uncollected(library_text)(), encoding="utf-8")
        made = Path(folder, target.name)
        whole = [*command, *FLAGS, *hidden, *flags, "-o", str(made), str(source), *libraries]
        try:
            done = _run([*whole, *IN_PARTS] if _has_parts(command, flags) else whole)
            if done.returncode and _has_parts(command, flags):
                done = _run(whole)  # an old gcc, or one without the plugin of its linker
            if done.returncode == 0:
                # whole or not at all: somebody may have the old one loaded
                shutil.copyfile(made, target.with_suffix(".new"))
                os.replace(target.with_suffix(".new"), target)
        except (OSError, subprocess.TimeoutExpired) as error:
            return f"{command[0]}: {error}"
    return "" if done.returncode == 0 else f"{command[0]}: {done.stderr.strip()[-2000:]}"


def _has_parts(command: list[str], flags: tuple[str, ...]) -> bool:
    """Return whether the compiler makes parts beside each other; flags may not go with that."""
    return (
        Path(command[0]).name.startswith("gcc") and sys.platform.startswith("linux") and not flags
    )


def _run(command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, capture_output=True, text=True, timeout=TIMEOUT, check=False, errors="replace"
    )
