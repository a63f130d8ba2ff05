"""One case in bounds of time, memory and place, and what is said of how it ended."""

from __future__ import annotations

import contextlib
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hybond.errors import HybondError

PATIENCE = 10.0
"""Seconds of CPU that a case may take."""
ROOM = 2**30
"""Bytes that a case may need more than what was there."""
ADDRESSES = 6 * 2**30
"""Bytes of addresses: what stands between a case and the machine."""
LONGEST = 6000
"""Letters of a refusal."""
PAGES = Path(__file__).parents[2] / "docs/errors"
_CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
_INTERNAL = ("HB-X001", "HB-X003")


class HangError(BaseException):
    """A case has taken longer than it may."""


class WrongError(Exception):
    """What a case found out itself: values that are none, a text that is read as another."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """How a case ended: ``fine``, ``refused``, or what is wrong."""

    reader: str
    seed: int
    kind: str
    code: str = ""
    said: str = ""
    cpu: float = 0.0
    room: int = 0

    @property
    def wrong(self) -> bool:
        return self.kind not in ("fine", "refused")


_watched: list[str] = []
_written: list[str] = []
_CHANGES = {
    "os.rename": 2,
    "os.remove": 1,
    "os.rmdir": 1,
    "os.mkdir": 1,
    "os.link": 2,
    "os.symlink": 2,
    "os.truncate": 1,
    "os.chmod": 1,
}
_RUNS = ("os.system", "os.exec", "os.posix_spawn", "subprocess.Popen", "socket.connect")


def _watch(event: str, given: tuple[Any, ...]) -> None:
    if not _watched:
        return
    if event == "open":
        path, mode, flags = given
        writing = (isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)) or (
            isinstance(mode, str) and set(mode) & set("wax+")
        )
        if writing and not isinstance(path, int):
            _note(path)
    elif event in _CHANGES:
        if event in ("os.remove", "os.rmdir") and given[-1] != -1:
            return  # beside an open folder: what removes a temporary one
        for path in given[: _CHANGES[event]]:
            _note(path)
    elif event in _RUNS:
        _written.append(f"{event} {str(given)[:200]}")


def _note(path: Any) -> None:
    place = os.path.realpath(os.fsdecode(path))
    if not place.startswith((_watched[0] + os.sep, "/dev/null", "/dev/tty")):
        _written.append(place)


def limit() -> None:
    """Bound this process for good: addresses, files, what it leaves when it dies."""
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (256 * 2**20, 256 * 2**20))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    sys.addaudithook(_watch)


def _too_long(*_: object) -> None:
    signal.setitimer(signal.ITIMER_PROF, 2.0)  # once more, if somebody holds on
    raise HangError


@contextlib.contextmanager
def _bounded() -> Iterator[None]:
    used = resource.getrusage(resource.RUSAGE_SELF)
    soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
    # where no signal is seen, as in a loop of C, the kernel ends the process
    end = int(used.ru_utime + used.ru_stime + PATIENCE + 15)
    resource.setrlimit(resource.RLIMIT_CPU, (end, hard))
    seen = signal.signal(signal.SIGPROF, _too_long)
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, seen)
        # who judges a case in a process of its own goes on after it
        resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))


def judged(reader: str, seed: int, folder: Path, case: Callable[[Path], None]) -> Verdict:
    """Run a case in a folder of its own and return what is to be said of it."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    temporary, tempfile.tempdir = tempfile.tempdir, str(folder)
    before = _peak(again=True)
    start = time.process_time()
    kind, code, said = "fine", "", ""
    _written.clear()
    _watched.append(os.path.realpath(folder))
    try:
        with _bounded():
            try:
                case(folder)
            except HybondError as error:
                code = error.code
                kind, said = _refusal(error)
    except HangError:
        kind, said = "hang", traceback.format_exc()
    except WrongError as error:
        kind, said = "wrong", str(error)
    except BaseException as error:
        # one by one: a traceback of a deep recursion is long
        kind, said = type(error).__name__, traceback.format_exc(limit=-12)
    finally:
        _watched.clear()
        tempfile.tempdir = temporary
    cpu, room = time.process_time() - start, _peak() - before
    if kind in ("fine", "refused"):
        if _written:
            kind, said = "outside", "\n".join(_written)
        elif left := [p.name for p in folder.rglob(".*") if p.name[0] == "."]:
            kind, said = "left over", str(left)
        elif room > ROOM:
            kind, said = "memory", f"{room / 2**20:.0f} MiB, {said}"
    return Verdict(reader, seed, kind, code, said[-6000:], cpu, room)


def _refusal(error: HybondError) -> tuple[str, str]:
    """Return whether a refusal is as refusals are."""
    text = str(error)
    end = traceback.format_exc(limit=-3)
    shown = text[:500]
    if not (PAGES / f"{error.code}.md").is_file() or error.code in _INTERNAL:
        return "code without page", f"{shown}\n{end}"
    if not error.why or not error.where or not error.hint:
        return "no place or remedy", f"{shown!r} at {error.where!r} try {error.hint!r}\n{end}"
    if len(text) > LONGEST:
        return "long refusal", f"{len(text)} letters: {shown}\n{end}"
    try:
        text.encode()
    except UnicodeEncodeError:
        return "unprintable", f"{shown!r}\n{end}"
    if found := _CONTROL.search(text):
        return "control character", f"{found[0]!r} in {shown!r}\n{end}"
    return "refused", shown


def _peak(*, again: bool = False) -> int:
    """Return the largest size that this process had, in bytes, since it was asked for `again`."""
    if again:
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5")
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) * 1024
    return 0
