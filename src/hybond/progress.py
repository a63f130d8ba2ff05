"""How far a run is: a bar on stderr with the time to go, or a bar of tqdm.

``progress=True`` of `hybond.simulate` and `hybond.ensemble` shows the bar, a bar of tqdm is moved
along, and a function is called with the time and the number of events.
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Protocol, TypeAlias, runtime_checkable

from hybond.errors import UsageError

PATIENCE = 1.0
"""Nothing is shown for runs shorter than this, s."""
REDRAW = 0.1
"""Time between two pictures of the bar, s."""
_CELLS = 30


@runtime_checkable
class Bar(Protocol):
    """What tqdm has: ``n`` of ``total``, and `refresh`."""

    n: float
    total: float | None

    def refresh(self) -> object:
        """Show the bar again."""


Asked: TypeAlias = bool | Bar | Callable[[float, int], object] | None
"""What may be given as `progress`."""


class Progress:
    """Called after each step of a run; shows how far it is if `active`, by default on a terminal.

    Examples
    --------
    >>> Progress(2.0).picture(0.5, 12, took=3.0)
    '[#######-----------------------]  25 %  t = 0.5 s  12 events  9 s to go'
    """

    def __init__(self, until: float, *, active: bool | None = None) -> None:
        self.until = until
        self.begin = time.monotonic()
        self.due = self.begin + PATIENCE
        self.width = 0
        self.active = sys.stderr.isatty() if active is None else active

    def __call__(self, t: float, events: int) -> None:
        """Show the time reached, if it is time to."""
        if not self.active or (now := time.monotonic()) < self.due:
            return
        self.due = now + REDRAW
        self._write(self.picture(t, events, took=now - self.begin))

    def picture(self, t: float, events: int, *, took: float) -> str:
        """Return the bar as text, after `took` seconds."""
        part = min(max(t / self.until, 0.0), 1.0)
        full = int(part * _CELLS)
        bar = "#" * full + "-" * (_CELLS - full)
        return f"[{bar}] {100 * part:3.0f} %  {self.words(t, events)}{to_go(part, took)}"

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


def to_go(part: float, took: float) -> str:
    """Return how long the rest takes if it goes on as it went.

    Examples
    --------
    >>> to_go(0.25, 3.0), to_go(0.5, 3600.0), to_go(0.0, 1.0)
    ('  9 s to go', '  60 min to go', '')
    """
    if not 0.0 < part < 1.0:
        return ""
    left = took * (1.0 - part) / part
    if left >= 7200.0:
        return f"  {left / 3600.0:.1f} h to go"
    if left >= 120.0:
        return f"  {left / 60.0:.0f} min to go"
    return f"  {left:.0f} s to go" if left >= 1.0 else "  under 1 s to go"


@contextlib.contextmanager
def shown(
    asked: Asked, until: float, *, members: bool = False
) -> Iterator[Callable[[float, int], object] | None]:
    """Give what is to be called with how far a run is, None if nobody wants to know.

    Parameters
    ----------
    asked : bool, bar of tqdm, callable or None
    until : float
        The end, s; of an ensemble the number of members.
    members : bool
        Whether members are counted.

    Raises
    ------
    UsageError
        HB-S131 for what is none of these.

    Examples
    --------
    >>> with shown(print, 1.0) as call:
    ...     call(0.5, 3)
    0.5 3
    """
    if asked is None or asked is False:
        yield None
    elif asked is True:
        with (MembersDone if members else Progress)(until, active=True) as bar:
            yield bar
    elif isinstance(asked, Bar):
        asked.total = until

        def move(t: float, _: int) -> None:
            asked.n = min(t, until)
            asked.refresh()

        yield move
    elif callable(asked):
        yield asked
    else:
        raise UsageError(
            f"progress = {asked!r}",
            code="HB-S131",
            where="progress",
            hint="True for a bar, a bar of tqdm, or a function progress(t, events)",
        )
