"""Ctrl-C between two steps, so that what a run has written down is whole."""

from __future__ import annotations

import signal
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any

from hybond.cli.streams import complain


class Interruptible:
    """While it is entered, the first Ctrl-C waits for `check`, the second does not wait.

    A run that is interrupted in the middle of a step would leave its records half written.
    """

    def __init__(self) -> None:
        self.asked = False
        self._before: Callable[[int, FrameType | None], Any] | int | None = None
        self._installed = False

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C has been pressed."""
        if self.asked:
            raise KeyboardInterrupt

    def __enter__(self) -> Interruptible:
        self._before = signal.getsignal(signal.SIGINT)
        # A shell starts background jobs with Ctrl-C ignored, and that is respected.
        if self._before is signal.default_int_handler:
            try:
                signal.signal(signal.SIGINT, self._handle)
                self._installed = True
            except ValueError:  # not in the main thread, where no signal arrives either
                pass
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        if self._installed:
            signal.signal(signal.SIGINT, self._before)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True
        complain("stopping after this step; Ctrl-C again stops at once")
