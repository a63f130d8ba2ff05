"""Where the modules of the engine stand that are printed, and the library made of them.

Nothing of the translator is imported here: who runs a library does not print it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

ENGINE = Path(__file__).parents[1]
ORDINARY = ("tables", "compiled", "interpreted", "outcome")
"""Rooms of the engine that are not printed."""
NAME = {"win32": "_engine.dll", "darwin": "_engine.dylib"}.get(sys.platform, "_engine.so")
"""The library, beside this file."""
SHOWN = ("library.c", "members.c", "sections.c", "kept_steps.c")
"""What it shows, in C."""


def portable_paths() -> list[Path]:
    """Return the modules of the engine that are written to be printed, in order.

    Examples
    --------
    >>> portable_paths()[0].name
    'blocks.py'
    """
    found = [*ENGINE.glob("*.py"), *ENGINE.glob("*/*.py")]
    return sorted(p for p in found if p.stem != "__init__" and p.parent.name not in ORDINARY)


@lru_cache(maxsize=1)
def digest() -> str:
    """Return what tells the sources of the library from others."""
    import hashlib

    here = Path(__file__).parent
    own = [here / "printing.py", *(here / name for name in SHOWN)]
    paths = sorted([*portable_paths(), *(ENGINE.parent / "translate").glob("*.py"), *own])
    text = b"".join(p.name.encode() + p.read_bytes().replace(b"\r\n", b"\n") for p in paths)
    return hashlib.sha256(text).hexdigest()[:16]


def are_those_of(made: str) -> bool:
    """Return whether the sources that are here have a digest.

    They are read unless each still has the size and the time that it had when that was last found:
    so Python knows that bytecode is that of its source, and beside bytecode it is kept.
    """
    seen, kept = f"{made}\n{stamps()}", _kept()
    if kept is not None:
        with suppress(OSError):
            if kept.read_text(encoding="utf-8") == seen:
                return True
    if made != digest():
        return False
    if kept is not None and not sys.dont_write_bytecode:
        new = kept.with_suffix(f".{os.getpid()}")
        with suppress(OSError):
            # whole or not at all: somebody may read the old one
            new.write_text(seen, encoding="utf-8")
            new.replace(kept)
    return True


def stamps() -> str:
    """Return the name, the size and the time of each file that `digest` reads, and of some more.

    Examples
    --------
    >>> len(stamps().splitlines()) > len(portable_paths())
    True
    """
    folders = [str(ENGINE), str(ENGINE.parent / "translate")]
    folders += [f.path for f in _listed(folders[0]) if f.is_dir() and f.name != "__pycache__"]
    rows = []
    for folder in folders:
        for file in _listed(folder):
            if file.name.endswith((".py", ".c")):
                found = file.stat()
                rows.append(f"{folder}/{file.name} {found.st_size} {found.st_mtime_ns}")
    return "\n".join(rows)


def _listed(folder: str) -> Iterator[os.DirEntry[str]]:
    with os.scandir(folder) as found:
        yield from sorted(found, key=lambda file: file.name)


def _kept() -> Path | None:
    """Return the file for what was last found, None where Python keeps no bytecode."""
    place = __spec__.cached
    return None if place is None else Path(place).with_name(f"{NAME}.checked")
