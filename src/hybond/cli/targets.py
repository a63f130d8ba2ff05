"""Files to be written: refused before the work, not after it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from hybond.errors import UsageError


def check_target(text: str | None, suffixes: Sequence[str], option: str) -> Path | None:
    """Return the path to write, or None if none is asked for.

    Raises
    ------
    UsageError
        HB-X102 for an ending that is not one of `suffixes`, or a place that is not there.

    Examples
    --------
    >>> check_target("ball.gif", (".svg", ".png"), "--out")
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-X102 at --out: cannot write 'ball.gif': '.gif' is not known
      try: end the name in .svg or .png
    """
    if text is None:
        return None
    path = Path(text)
    why = hint = ""
    if not _is_name(text):
        why, hint = "that is no name of a file", "leave out what is no letter"
    elif path.is_dir():
        why, hint = "it is a folder", "name a file in it"
    elif path.suffix.lower() not in suffixes:
        why = f"{path.suffix!r} is not known" if path.suffix else "it has no ending"
        *others, last = suffixes
        hint = f"end the name in {', '.join(others)} or {last}" if others else f"end it in {last}"
    elif not path.parent.is_dir():
        why, hint = f"there is no folder {str(path.parent)!r}", "make it first"
    if why:
        raise UsageError(f"cannot write {text!r}: {why}", code="HB-X102", where=option, hint=hint)
    return path


def _is_name(text: str) -> bool:
    """Whether a file system may have such a name."""
    try:
        return b"\0" not in os.fsencode(text)
    except ValueError:
        return False


def check_new(path: Path, *, force: bool) -> None:
    """Refuse to replace a file, unless `force`.

    Raises
    ------
    UsageError
        HB-X104.
    """
    if path.exists() and not force:
        raise UsageError(
            "the file is there already",
            code="HB-X104",
            where=str(path),
            hint="choose another name, or add --force",
        )
