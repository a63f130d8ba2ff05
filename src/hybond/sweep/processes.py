"""Members of an ensemble in other processes, one for each core.

The processes are fresh ones, spawned and not forked: that works on every system and beside other
threads. The script that asked for them is not run again in them, so that it needs no
``if __name__ == "__main__"``.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from multiprocessing import current_process
from multiprocessing.context import SpawnContext, SpawnProcess
from multiprocessing.reduction import ForkingPickler
from types import ModuleType
from typing import Any

from hybond.model.parts import Value
from hybond.sweep.member import Member, Task, member_of, run_of

AHEAD = 2
"""Chunks that are handed out per process, so that none waits for work."""
SELDOM = 5_000
"""Containers that a process may make more than it frees before the collector looks at them."""
MOST = 61 if os.name == "nt" else 4096
"""Processes that one pool can have: Windows cannot wait for more."""

Sets = Sequence[tuple[int, Mapping[str, Value]]]
"""Numbers of members with their parameters."""


def cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def stays(task: Task) -> str:
    """Return why the members cannot run in other processes; empty if they can."""
    if current_process().daemon:
        return "this process may not start others"
    try:
        sent = bytes(ForkingPickler.dumps(task))
    except Exception as error:
        return f"the model cannot be sent to other processes ({error})"
    if b"__main__" in sent:
        return "the model holds a function of this script"
    return ""


def in_processes(
    task: Task, sets: Sets, workers: int, chunk: int, keep: Callable[[list[Member]], None]
) -> str:
    """Run members in other processes; hand each chunk that is done to `keep`.

    Parameters
    ----------
    task : Task
    sets : sequence of (number, parameters)
    workers : int
        Processes.
    chunk : int
        Members that a process does at a time.
    keep : callable

    Returns
    -------
    str
        Why some members have not been run; empty if all have.

    Raises
    ------
    HybondError
        For what is wrong with the call.
    KeyboardInterrupt
        At Ctrl-C; the processes are ended.
    """
    context = _Fresh()
    rest = iter(sets)
    chunks = iter(lambda: list(islice(rest, chunk)), [])
    pending: set[Future[list[Member]]] = set()
    pool = ProcessPoolExecutor(workers, context, _begin, (task,))
    try:
        while True:
            for part in islice(chunks, AHEAD * workers - len(pending)):
                pending.add(pool.submit(_run, part))
            if not pending:
                break
            done, pending = wait(pending, return_when=FIRST_COMPLETED)
            # a process that ends takes others' results with it only if they are asked later
            for future in sorted(done, key=lambda f: f.exception() is not None):
                keep(future.result())
        pool.shutdown()
    except BrokenProcessPool:
        pool.shutdown()
        return "a process of the ensemble ended unexpectedly"
    except BaseException:
        context.end()
        pool.shutdown(cancel_futures=True)
        raise
    return ""


# -- in this process


class _Process(SpawnProcess):
    """A process in which the present script is not run again, and that Ctrl-C leaves alone."""

    def start(self) -> None:
        with _no_script(), _without_interrupt():
            super().start()


class _Fresh(SpawnContext):
    """Starts such processes, and can end them."""

    def __init__(self) -> None:
        super().__init__()
        self._started: list[SpawnProcess] = []

    def Process(self, *args: Any, **options: Any) -> SpawnProcess:  # type: ignore[override]
        process = _Process(*args, **options)
        self._started.append(process)
        return process

    def end(self) -> None:
        """End all that were started."""
        for process in self._started:
            process.terminate()


@contextlib.contextmanager
def _no_script() -> Iterator[None]:
    """Let a new process find no main module, which it would run again."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextlib.contextmanager
def _without_interrupt() -> Iterator[None]:
    """Hold Ctrl-C back, which a new process inherits."""
    if not hasattr(signal, "pthread_sigmask") or (
        threading.current_thread() is not threading.main_thread()
    ):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# -- in the others

_task: list[Task] = []
"""What a process has been told to do."""


def _begin(task: Task) -> None:
    with contextlib.suppress(ValueError):
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    # what is there by now stays, and a run leaves next to no cycles behind
    gc.freeze()
    gc.set_threshold(SELDOM)
    _task[:] = [task]


def _run(sets: Sets) -> list[Member]:
    return [member_of(_task[0], number, run_of(_task[0], given)) for number, given in sets]
