"""A progress bar on stderr, for a person who waits."""

from __future__ import annotations

import contextlib
import sys
import time
from types import TracebackType

PATIENCE = 1.0
"""Nothing is shown for runs shorter than this, s."""
REDRAW = 0.1
"""Time between two pictures of the bar, s."""
_CELLS = 30


class Progress:
    """Called after each step of a run; shows how far it is if stderr is a terminal."""

    def __init__(self, until: float) -> None:
        self.until = until
        self.due = time.monotonic() + PATIENCE
        self.width = 0
        self.active = sys.stderr.isatty()

    def __call__(self, t: float, events: int) -> None:
        """Show the time reached, if it is time to."""
        if not self.active or (now := time.monotonic()) < self.due:
            return
        self.due = now + REDRAW
        part = min(max(t / self.until, 0.0), 1.0)
        full = int(part * _CELLS)
        bar = "#" * full + "-" * (_CELLS - full)
        self._write(f"[{bar}] {100 * part:3.0f} %  {self.words(t, events)}")

    def words(self, t: float, events: int) -> str:
        """Return what stands behind the bar."""
        return f"t = {t:.4g} s  {events} events"

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        if self.width:
            self._write("")
            self._write("")

    def _write(self, text: str) -> None:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write("\r" + text.ljust(self.width))
            if not text:
                sys.stderr.write("\r")
            sys.stderr.flush()
        self.width = len(text)


class MembersDone(Progress):
    """The same for an ensemble: called with how many members are done, and how many there are."""

    def words(self, t: float, events: int) -> str:
        """Return what stands behind the bar."""
        return f"{t:.0f} of {events} members"
