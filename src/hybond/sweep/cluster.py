"""Parts of a sweep on other machines: a scheduler of Dask, or any executor.

A part goes there as plain data, the text of the model and two numbers, and comes back as bytes. Who
dies with a part in hand has not done it: it is given to another.
"""

from __future__ import annotations

import contextlib
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from pathlib import Path
from typing import Any

from hybond._version import __version__
from hybond.errors import HybondError, NumericsError, UsageError
from hybond.sweep.folder import told
from hybond.sweep.full_runs import put_files, read_files
from hybond.sweep.job import Job
from hybond.sweep.part import Part
from hybond.sweep.runner import Runner

Range = tuple[int, int]
Came = tuple[bytes, dict[str, bytes]]
TRIES = 4
"""How often a part is given away before the sweep gives up."""
AHEAD = 2
"""Parts for each worker that are given away ahead of time."""
WATCHED = 1.0
"""Between two looks at who is there, s."""
PATIENCE = 15.0
"""For a scheduler to answer, s."""
_KEPT = threading.local()


def run_part(
    data: Mapping[str, Any], key: str, first: int, last: int
) -> tuple[bytes, dict[str, bytes]]:
    """Run members of a job, wherever this is; return the bytes of the part, and full runs as files.

    Raises
    ------
    UsageError
        HB-P112 if this is another version of hybond.
    """
    if data["hybond"] != __version__:
        raise UsageError(
            f"a worker has hybond {__version__}, the sweep is of hybond {data['hybond']}",
            code="HB-P112",
            where="executor",
            hint="install the same version on all machines",
        )
    known = getattr(_KEPT, "runner", None)
    if known is None or known[0] != key:
        job = Job.from_dict(data)
        if job.plan.digest() != data["drawn"]:
            raise UsageError(
                "a worker draws other numbers from the same seed",
                code="HB-P112",
                where="executor",
                hint="install the same version of SciPy on all machines",
            )
        known = _KEPT.runner = (key, Runner(job, 1))
    runner: Runner = known[1]
    if not data["runs"]:
        return runner.run(first, last).to_bytes(key), {}
    with tempfile.TemporaryDirectory() as folder:
        runner.runs = Path(folder)
        part = runner.run(first, last)
        return part.to_bytes(key), read_files(runner.runs)


def elsewhere(
    executor: Any,
    data: Mapping[str, Any],
    key: str,
    missing: Sequence[Range],
    keep: Callable[[Part], None],
    tell: Callable[[int], None],
    note: Callable[[str], None],
    runs: Path | None = None,
) -> str:
    """Run parts by an executor; return how it was done. Full runs go into the folder `runs`.

    Raises
    ------
    UsageError
        HB-P110 for what is no executor, or a cluster that does not answer.
    NumericsError
        HB-P111 for parts whose workers die again and again, or executors that do.
    """
    if data["units"]:
        raise UsageError(
            "functional mock-up units are files of this machine, and programs: other machines "
            "have not agreed to run them",
            code="HB-P110",
            where="executor",
            hint="leave out executor",
        )
    with _opened(executor) as (pool, workers, who):
        work = _Given(pool, data, key, keep, tell, note, runs)
        work.all(missing, workers, who)
    many = sum(b - a for a, b in missing)
    again = f", {work.again} parts again" if work.again else ""
    return f"{many} members by {who}{again}"


@contextlib.contextmanager
def _opened(executor: Any) -> Any:
    """Give the executor, what tells its workers, and what it is called."""
    if isinstance(executor, Executor):
        many = getattr(executor, "_max_workers", None) or 4
        yield executor, lambda: {str(k): 1 for k in range(many)}, type(executor).__name__
        return
    try:
        from distributed import Client
    except ImportError:
        raise UsageError(
            "Dask's distributed is not installed",
            code="HB-P110",
            where="executor",
            hint="pip install distributed, or give an executor of concurrent.futures",
        ) from None
    client, own = executor, isinstance(executor, str)
    if own:
        try:
            client = Client(  # type: ignore[no-untyped-call, unused-ignore]
                executor, timeout=PATIENCE, set_as_default=False
            )
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            raise UsageError(
                f"no scheduler answers at {executor}: {error}",
                code="HB-P110",
                where="executor",
                hint="start one with: dask scheduler, then workers with: dask worker ADDRESS",
            ) from None
    elif not isinstance(executor, Client):
        raise UsageError(
            f"{executor!r} runs nothing",
            code="HB-P110",
            where="executor",
            hint="an address, a distributed.Client, or an executor of concurrent.futures",
        )
    try:
        yield client.get_executor(pure=False), client.nthreads, "a cluster"
    finally:
        if own:
            with contextlib.suppress(Exception):
                client.close(timeout=2)


class _Given:
    """The parts that were given away."""

    def __init__(
        self,
        pool: Any,
        data: Mapping[str, Any],
        key: str,
        keep: Callable[[Part], None],
        tell: Callable[[int], None],
        note: Callable[[str], None],
        runs: Path | None,
    ) -> None:
        self.runs = runs
        self.pool, self.data, self.key = pool, data, key
        self.keep, self.tell, self.note = keep, tell, note
        self.again = 0
        self._pending: dict[Future[Came], tuple[Range, int]] = {}

    def all(
        self, missing: Sequence[Range], workers: Callable[[], Mapping[str, int]], who: str
    ) -> None:
        """Run all parts."""
        left = list(reversed(missing))
        there: Mapping[str, int] = {}
        looked = 0.0
        try:
            while left or self._pending:
                if time.monotonic() - looked > WATCHED:
                    there = self._watched(there, workers, who)
                    looked = time.monotonic()
                room = max(AHEAD * sum(there.values()), 1)
                while left and len(self._pending) < room:
                    self._give(left.pop(), 1, who)
                done, _ = wait(self._pending, timeout=WATCHED, return_when=FIRST_COMPLETED)
                for future in done:
                    self._take(future, who)
        finally:
            for future in self._pending:
                future.cancel()

    def _watched(
        self, there: Mapping[str, int], workers: Callable[[], Mapping[str, int]], who: str
    ) -> Mapping[str, int]:
        try:
            now = dict(workers())
        except Exception as error:
            raise self._gone(who, error) from None
        for name in there.keys() - now.keys():
            self.note(f"worker {name} is gone; what it had in hand is run again")
        if not now and (there or not self._pending):
            self.note(f"{who} has no worker; waiting for one")
        return now

    def _give(self, part: Range, tries: int, who: str) -> None:
        try:
            future = self.pool.submit(run_part, self.data, self.key, *part)
        except (BrokenExecutor, RuntimeError, OSError) as error:
            raise self._gone(who, error) from None
        self._pending[future] = (part, tries)

    def _take(self, future: Future[Came], who: str) -> None:
        (first, last), tries = self._pending.pop(future)
        try:
            data, files = future.result()
        except HybondError:
            raise
        except BrokenExecutor as error:
            raise self._gone(who, error) from None
        except Exception as error:
            said = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
            if tries >= TRIES:
                raise NumericsError(
                    f"members {first} to {last - 1} were given away {tries} times, and came back "
                    f"with {said}",
                    code="HB-P111",
                    where="executor",
                    hint="see what the workers say; the same command goes on where it was",
                ) from None
            self.again += 1
            self.note(f"members {first} to {last - 1} are run again: {said}")
            self._give((first, last), tries + 1, who)
            return
        part = Part.from_bytes(data, self.key)
        if self.runs is not None:
            with told(self.runs):
                put_files(self.runs, files)  # before the part, which says that they are there
        self.keep(part)
        self.tell(last - first)

    def _gone(self, who: str, error: Exception) -> NumericsError:
        said = " ".join(str(error).split())[:200]
        return NumericsError(
            f"{who} is gone ({type(error).__name__}{': ' * bool(said)}{said})",
            code="HB-P111",
            where="executor",
            hint="start it again; the same command goes on where it was",
        )
