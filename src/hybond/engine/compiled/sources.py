"""Where the modules of the engine stand that are printed."""

from __future__ import annotations

from pathlib import Path

ENGINE = Path(__file__).parents[1]
ORDINARY = ("tables", "compiled", "interpreted", "outcome")
"""Rooms of the engine that are not printed."""


def portable_paths() -> list[Path]:
    """Return the modules of the engine that are written to be printed, in order.

    Examples
    --------
    >>> [path.name for path in portable_paths()][:2]
    ['blocks.py', 'lu.py']
    """
    found = [*ENGINE.glob("*.py"), *ENGINE.glob("*/*.py")]
    return sorted(p for p in found if p.stem != "__init__" and p.parent.name not in ORDINARY)
