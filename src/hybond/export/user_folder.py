"""The folder of a user for what may be made anew: where it is, and reading only what is one's own.

What lies there goes into programs that are exported. So nobody else may be able to write it: the
folder and the file are the user's own, no link, and for others to read at the most.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

FILES = 8
"""Files that stay there, the newest; those of other versions of hybond are taken away first."""
_WRITABLE = stat.S_IWGRP | stat.S_IWOTH


def user_folder() -> Path | None:
    """Return the folder of hybond among those of the user for such files; None without a home.

    ``XDG_CACHE_HOME`` says where these are, if it is a whole path; else ``~/.cache``, on macOS
    ``~/Library/Caches``, on Windows ``%LOCALAPPDATA%``.
    """
    given = os.environ.get("XDG_CACHE_HOME", "")
    if given and Path(given).is_absolute():
        return Path(given) / "hybond"
    local = os.environ.get("LOCALAPPDATA", "")
    if sys.platform == "win32" and local and Path(local).is_absolute():
        return Path(local) / "hybond"
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if not home.is_absolute():
        return None
    return home / ("Library/Caches" if sys.platform == "darwin" else ".cache") / "hybond"


def make_own(folder: Path) -> bool:
    """Make a folder that only the user may write; whether it is one."""
    with suppress(OSError):
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    try:
        return _is_own(folder.lstat(), stat.S_ISDIR)
    except OSError:
        return False


def read_own(file: Path) -> bytes | None:
    """Return what a file holds that only the user can have written, else None."""
    try:
        if not _is_own(file.parent.lstat(), stat.S_ISDIR):
            return None
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        descriptor = os.open(file, flags | getattr(os, "O_NONBLOCK", 0))
        with open(descriptor, "rb") as opened:
            if not _is_own(os.fstat(descriptor), stat.S_ISREG):
                return None
            return opened.read()
    except OSError:
        return None


def tidy(folder: Path, pattern: str) -> None:
    """Take away all files of a pattern but the newest."""
    found: list[tuple[float, Path]] = []
    for file in folder.glob(pattern):
        with suppress(OSError):
            found.append((file.lstat().st_mtime, file))
    for _, file in sorted(found, reverse=True)[FILES:]:
        with suppress(OSError):
            file.unlink()


def _is_own(found: os.stat_result, kind: Callable[[int], bool]) -> bool:
    if not kind(found.st_mode):
        return False
    if not hasattr(os, "getuid"):
        return True  # Windows: the folder is the user's by its rights
    return found.st_uid == os.getuid() and not found.st_mode & _WRITABLE
