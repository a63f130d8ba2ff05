"""The folder of a sweep: what it is of, its parts, and a lock; kill -9 leaves it whole.

sweep.json    what is computed: model, plan, collectors, options; its key
parts/        what was collected of members, with the key
runs/         full runs, if they were asked for
table.csv     everything, once all members are there; table.parquet with pyarrow
notes.txt     workers that died, parts that were run again
lock          held as long as a sweep goes on; who dies lets go
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from hybond.errors import UsageError
from hybond.files.whole import write_whole
from hybond.sweep.part import Part

ABOUT = "sweep.json"
NOTES = "notes.txt"
_LEFT = re.compile(
    r"\.[0-9a-f]{8}\.(table\.csv|table\.parquet|sweep\.json|\d+-\d+\.npz|\d+\.(nc|zarr))"
)
"""Names of files that are not whole yet, see `hybond.files.whole`."""
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_WHAT = {
    "model": "the model has been edited",
    "plan": "the plan is another",
    "drawn": "other numbers are drawn, as by another version of SciPy",
    "units": "a functional mock-up unit is another file",
    "collect": "other things are collected",
    "until": "it ends at another time",
    "ends": "other conditions end it",
    "options": "the options are others",
    "fixed": "other parameters are set",
    "runs": "full runs are kept in another form",
    "hybond": "it was begun by another version of hybond",
}


class Folder:
    """A folder that holds a sweep.

    Parameters
    ----------
    path : Path

    Raises
    ------
    UsageError
        HB-P105 where another sweep is at work, HB-P106 for a place that cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.parts = path / "parts"
        self.runs = path / "runs"
        self.key = ""
        self._found = path.exists()
        with told(path):
            if path.exists() and not path.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, "not a folder", str(path))
            self.parts.mkdir(parents=True, exist_ok=True)
        self._lock = _locked(path / "lock")

    def begin(self, data: Mapping[str, Any], key: str, size: int) -> int:
        """Note what the sweep is, or see that the one that is there is the same; return its size.

        Parameters
        ----------
        data : mapping
            Of the job.
        key : str
        size : int
            Members of a part, if the sweep begins here.

        Raises
        ------
        UsageError
            HB-P107 for a folder that holds another sweep.
        """
        self.key = key
        about = self.about()
        if about is None:
            if any(self.path.glob("table.*")) or any(self.parts.iterdir()):
                raise UsageError(
                    f"{self.path} has files of a sweep, but no {ABOUT} that says of which",
                    code="HB-P107",
                    where=str(self.path),
                    hint="take another folder, or delete what is in it",
                )
            with told(self.path):
                text = json.dumps({"key": key, "part": size, "job": data}, indent=1)
                write_whole(self.path / ABOUT, text + "\n")
        elif about["key"] != key:
            raise self._other(about.get("job", {}), data)
        else:
            size = int(about["part"])
        with told(self.path):
            # what was being written when somebody died
            for place in (self.path, self.parts, self.runs):
                for left in place.glob(".*"):
                    if not _LEFT.fullmatch(left.name):
                        continue
                    if left.is_dir():
                        import shutil

                        shutil.rmtree(left)
                    else:
                        left.unlink()
        return size

    def about(self) -> dict[str, Any] | None:
        """Return what the folder says that it holds, None if nothing."""
        try:
            found = json.loads((self.path / ABOUT).read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError, RecursionError):
            return None
        if not isinstance(found, dict) or not isinstance(found.get("job"), dict):
            return None
        part = found.get("part")
        whole = isinstance(part, int) and not isinstance(part, bool) and part > 0
        return found if whole and isinstance(found.get("key"), str) else None

    def _other(self, old: Mapping[str, Any], new: Mapping[str, Any]) -> UsageError:
        changed = [k for k in _WHAT if old.get(k) != new.get(k)]
        if "plan" in changed and "drawn" in changed:
            changed.remove("drawn")  # of another plan other numbers are drawn
        words = [_WHAT[k] for k in changed]
        line = ""
        if old.get("model") != new.get("model"):
            pairs = [str(d.get("model", "")).splitlines() for d in (old, new)]
            both = zip(*(lines + [""] * (max(map(len, pairs)) - len(lines)) for lines in pairs))
            was, now = next(((a, b) for a, b in both if a != b), ("", ""))
            line = f": {was.strip()!r} is {now.strip()!r} now"
        return UsageError(
            f"{self.path} holds another sweep: {', '.join(words) or 'its key differs'}{line}",
            code="HB-P107",
            where=str(self.path),
            hint="--out another folder, or undo the change; what is there stays as it is",
        )

    def place(self, first: int, last: int) -> Path:
        """Return where a part lies."""
        return self.parts / f"{first:010}-{last:010}.npz"

    def write(self, part: Part) -> None:
        """Write a part, whole or not at all, and for good."""
        self.write_bytes(part.to_bytes(self.key), part.first, part.last)

    def write_bytes(self, data: bytes, first: int, last: int) -> None:
        """Write the bytes of a part."""
        with told(self.path):
            write_whole(self.place(first, last), data)

    def read(self, first: int, last: int) -> Part | None:
        """Return a part, None if it is not there or damaged."""
        try:
            part = Part.from_bytes(self.place(first, last).read_bytes(), self.key)
        except (OSError, ValueError):
            return None
        return part if (part.first, part.last) == (first, last) else None

    def note(self, text: str) -> None:
        """Write down what is to be said of the sweep, at once: who runs it may die."""
        with told(self.path), open(self.path / NOTES, "a", encoding="utf-8") as file:
            file.write(text + "\n")

    def close(self) -> None:
        """Let go of the lock."""
        os.close(self._lock)

    def leave(self) -> None:
        """Let go of the lock, and take away what was made here, if nothing was written into it."""
        self.close()
        if self._found or any(self.parts.glob("*")) or any(self.runs.glob("*")):
            return
        with contextlib.suppress(OSError):
            for file in (self.path / "lock", self.path / ABOUT, self.path / NOTES):
                file.unlink(missing_ok=True)
            for place in (self.parts, self.runs, self.path):
                if place.is_dir():
                    place.rmdir()


@contextlib.contextmanager
def told(path: Path) -> Iterator[None]:
    """Say of what the system refuses whether the disk is full or the place not ours.

    Raises
    ------
    UsageError
        HB-P106.
    """
    try:
        yield
    except OSError as error:
        full = error.errno in FULL
        raise UsageError(
            "the disk is full" if full else f"{error.strerror or error}",
            code="HB-P106",
            where=str(error.filename or path),
            hint="make room and give the same command again: what is written is kept"
            if full
            else "check that the place is there and yours to write",
        ) from None


def _locked(path: Path) -> int:
    """Return a descriptor of a file that this process alone holds."""
    with told(path):
        found = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        if os.name == "nt":
            import msvcrt

            msvcrt.locking(found, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined, unused-ignore]
        else:
            import fcntl

            fcntl.flock(found, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(found)
        if error.errno not in (errno.EACCES, errno.EAGAIN, errno.EDEADLK):
            with told(path):
                raise
        raise UsageError(
            "another sweep is at work in this folder",
            code="HB-P105",
            where=str(path.parent),
            hint="wait until it ends, or take another folder",
        ) from None
    return found
