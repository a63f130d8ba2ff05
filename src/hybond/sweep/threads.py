"""Members of an ensemble in threads: the library runs them, and holds no lock of Python's."""

from __future__ import annotations

import ctypes
import os
import threading
import time
from collections.abc import Callable, Sequence
from queue import Empty, SimpleQueue
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.members import NativeMembers, Ran
from hybond.engine.compiled.native import NativeModel
from hybond.errors import UsageError

Vector = NDArray[np.float64]

CHUNK = 0.05
"""What a thread gets to do at a time, s."""
LARGE = 512
"""Members in that at the most: what is kept of them is put away then."""
SHORT = 0.004
"""And at the least: what it takes to hand out members is little of that."""
SHARE = 4
"""Parts that every thread gets at the least, so that all end together."""
BEGINNING = 1.0
"""For a thread to begin, s."""
WAITING = 0.1
"""Between two looks at whoever wants it to stop, s."""


def cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_threads(
    model: NativeModel,
    slots: NDArray[np.intc],
    t: Vector,
    numbers: Vector,
    workers: int,
    keep: Callable[[int, Ran], None],
    *,
    modes: bool = False,
    look: Callable[[], object] | None = None,
    measured: NDArray[np.intc] | None = None,
    measure: Callable[[int, Ran], Ran] | None = None,
) -> None:
    """Run members; hand those that are done to `keep`, with the number of the first.

    Parameters
    ----------
    slots : array of int
        What is looked at.
    t : array
        When, s, and at the end besides.
    numbers : array, shape (members, entries)
        What parameters write.
    workers : int
        Threads.
    keep : callable
        Called in this thread.
    modes : bool
        Whether the modes that were written are kept.
    look : callable, optional
        Called in this thread, ten times a second at the least; may raise KeyboardInterrupt.
    measured : array of int
        What is measured.
    measure : callable
        Called with the number of the first member and what was kept, in the thread that ran them;
        what it returns is handed on.

    Raises
    ------
    KeyboardInterrupt
        At Ctrl-C, soon, or from `look`; the threads have ended.
    MemoryError
    """

    def begin(stop: ctypes.c_int) -> Callable[[range], Ran]:
        members = NativeMembers(model, slots, t, stop, modes=modes, measured=measured)

        def do(part: range) -> Ran:
            ran = members.run(numbers[part.start : part.stop])
            return ran if measure is None else measure(part.start, ran)

        return do

    spread(len(numbers), workers, begin, keep, look=look)


Kept = TypeVar("Kept")


def spread(
    many: int,
    workers: int,
    begin: Callable[[ctypes.c_int], Callable[[range], Kept]],
    keep: Callable[[int, Kept], None],
    *,
    look: Callable[[], object] | None = None,
) -> None:
    """Do members in threads, part after part; hand what comes of each to `keep`.

    Parameters
    ----------
    many : int
        Members.
    workers : int
        Threads. One alone does them in order.
    begin : callable
        Called in each thread, with what is not zero when members are to end early; returns what
        does the members of a part.
    keep : callable
        Called in this thread, with the number of the first.
    look : callable, optional
        Called in this thread, ten times a second at the least; may raise KeyboardInterrupt.

    Raises
    ------
    KeyboardInterrupt
        At Ctrl-C, soon, or from `look`; the threads have ended.
    """
    stop = ctypes.c_int(0)
    found: SimpleQueue[tuple[int, Kept] | BaseException | None] = SimpleQueue()
    parts = _Parts(many, workers)

    def work(over: threading.Event) -> None:
        do = None
        try:
            do = begin(stop)
            each = CHUNK
            while not stop.value and (part := parts.next(each)):
                began = time.perf_counter()
                ran = do(part)
                each = (time.perf_counter() - began) / len(part)
                found.put((part.start, ran))
            found.put(None)
        except BaseException as error:
            found.put(error)
        finally:
            del do
            over.set()

    threads: list[tuple[threading.Thread, threading.Event]] = []
    try:
        for _ in range(workers):
            over = threading.Event()
            threads.append((threading.Thread(target=work, args=(over,), daemon=True), over))
            threads[-1][0].start()
        left = workers
        while left:
            if look is not None:
                look()
            try:
                done = found.get(timeout=WAITING)
            except Empty:
                continue
            if isinstance(done, BaseException):
                raise done
            if done is None:
                left -= 1
            else:
                keep(*done)
    finally:
        stop.value = 1
        _ended(threads)


def _ended(threads: Sequence[tuple[threading.Thread, threading.Event]]) -> None:
    """Wait until threads have ended, whatever is pressed meanwhile.

    One that went on in the library while Python ends would work on memory that is freed.
    """
    pressed = False
    end = time.monotonic() + BEGINNING
    for thread, over in threads:
        # Ctrl-C may have been pressed while it was begun: then it is not known whether it was
        while not over.is_set() and (thread.ident is not None or time.monotonic() < end):
            try:
                over.wait(0.01)
            except KeyboardInterrupt:
                pressed = True
    if pressed:
        raise KeyboardInterrupt


class _Parts:
    """The members, part after part, to whoever asks next."""

    def __init__(self, many: int, workers: int) -> None:
        self._many, self._workers = many, workers
        self._first = 0
        self._lock = threading.Lock()

    def next(self, each: float) -> range:
        """Return the next members for a thread that takes `each` second for one."""
        with self._lock:
            left = self._many - self._first
            least = int(SHORT / max(each, 1e-9))
            share = max(-(-left // (SHARE * self._workers)), least)
            most = min(int(CHUNK / max(each, 1e-9)), LARGE, share)
            part = range(self._first, min(self._first + max(most, 1), self._many))
            self._first = part.stop
            return part


def workers_of(workers: int | None) -> int:
    """Return the number of threads.

    Raises
    ------
    UsageError
        HB-S115.
    """
    if workers is None:
        return cores()
    if not isinstance(workers, int) or isinstance(workers, bool) or workers < 1:
        raise UsageError(
            f"workers = {workers!r}", code="HB-S115", where="workers", hint="1 or more threads"
        )
    return workers
