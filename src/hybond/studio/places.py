"""Where nodes were shown: what a file puts nowhere stays where it is while one edits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Places = Mapping[str, tuple[float, float]]


class Shown:
    """The places of the nodes of each level, with what they were before each edit.

    Examples
    --------
    >>> shown = Shown()
    >>> shown.note("", {"nodes": [{"name": "m", "x": 0.0, "y": 1.0}]})
    >>> shown.edited()
    >>> shown.note("", {"nodes": [{"name": "m", "x": 2.0, "y": 1.0}]})
    >>> shown.undone()
    >>> shown.of("")
    {'m': (0.0, 1.0)}
    """

    def __init__(self) -> None:
        self._now: dict[str, Places] = {}
        self._past: list[dict[str, Places]] = []
        self._future: list[dict[str, Places]] = []

    def of(self, level: str) -> Places:
        """Return the places on a level."""
        return self._now.get(level, {})

    def note(self, level: str, seen: Mapping[str, Any]) -> None:
        """Note what is shown of a level."""
        self._now[level] = {n["name"]: (n["x"], n["y"]) for n in seen["nodes"]}

    def edited(self) -> None:
        """Note that something is edited; what is shown until then is gone back to."""
        self._past.append(dict(self._now))
        self._future.clear()

    def undone(self) -> None:
        """Go back by one edit; to none before the first, which a layout finds again."""
        self._future.append(self._now)
        self._now = self._past.pop() if self._past else {}

    def redone(self) -> None:
        """Go forward again."""
        self._past.append(self._now)
        self._now = self._future.pop() if self._future else {}
