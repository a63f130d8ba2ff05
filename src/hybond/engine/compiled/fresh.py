"""Whether the library was built from the sources that are here, without reading them every time."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import suppress

NAME = {"win32": "_engine.dll", "darwin": "_engine.dylib"}.get(sys.platform, "_engine.so")
"""The library, beside this file."""
WHY = "_engine.why"
"""What kept it from being built, where that was tried in vain."""
HERE = os.path.dirname(os.path.abspath(__file__))


def is_of_these_sources(made: str) -> bool:
    """Return whether a library that was built from sources with a digest is of those that are here.

    They are read unless each still has the size and the time that it had when that was last found:
    so Python knows that bytecode is that of its source, and beside bytecode it is kept.
    """
    seen, kept = f"{made}\n{stamps()}", _kept()
    if kept:
        with suppress(OSError), open(kept, encoding="utf-8") as file:
            if file.read() == seen:
                return True
    from hybond.engine.compiled.sources import digest

    if made != digest():
        return False
    if kept and not sys.dont_write_bytecode:
        new = f"{kept}.{os.getpid()}"
        with suppress(OSError):
            # whole or not at all: somebody may read the old one
            with open(new, "w", encoding="utf-8") as file:
                file.write(seen)
            os.replace(new, kept)
    return True


def stamps() -> str:
    """Return name, size and time of each file that `sources.digest` reads, and of some more.

    Examples
    --------
    >>> "motion.py " in stamps(), "library.c " in stamps()
    (True, True)
    """
    engine = os.path.dirname(HERE)
    folders = [engine, os.path.join(os.path.dirname(engine), "translate")]
    rows = []
    for folder in folders:  # grows by the rooms within
        for file in _listed(folder):
            if file.is_dir() and file.name != "__pycache__":
                folders.append(file.path)
            if file.name.endswith((".py", ".c")):
                found = file.stat()
                rows.append(f"{folder}/{file.name} {found.st_size} {found.st_mtime_ns}")
    return "\n".join(rows)


def _listed(folder: str) -> Iterator[os.DirEntry[str]]:
    with os.scandir(folder) as found:
        yield from sorted(found, key=lambda file: file.name)


def _kept() -> str:
    """Return the file for what was last found, empty where Python keeps no bytecode."""
    place = __spec__.cached
    return os.path.join(os.path.dirname(place), f"{NAME}.checked") if place else ""
