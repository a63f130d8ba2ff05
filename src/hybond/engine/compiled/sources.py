"""Where the modules of the engine stand that are printed, and what tells them from others.

Nothing of the translator is imported here: who runs a library does not print it.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path

ENGINE = Path(__file__).parents[1]
ORDINARY = ("tables", "compiled", "interpreted", "outcome")
"""Rooms of the engine that are not printed."""
SHOWN = ("library.c", "members.c", "sections.c", "kept_steps.c")
"""What it shows, in C."""


def portable_paths() -> list[Path]:
    """Return the modules of the engine that are written to be printed, in order.

    Examples
    --------
    >>> portable_paths()[0].name
    'blocks.py'
    """
    found = [p for p in ENGINE.rglob("*.py") if p.relative_to(ENGINE).parts[0] not in ORDINARY]
    return sorted(p for p in found if p.stem != "__init__")


@lru_cache(maxsize=1)
def digest() -> str:
    """Return what tells the sources of the library from others."""
    here = Path(__file__).parent
    own = [here / "printing.py", *(here / name for name in SHOWN)]
    paths = sorted([*portable_paths(), *(ENGINE.parent / "translate").glob("*.py"), *own])
    text = b"".join(p.name.encode() + p.read_bytes().replace(b"\r\n", b"\n") for p in paths)
    return hashlib.sha256(text).hexdigest()[:16]
