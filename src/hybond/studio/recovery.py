"""What was edited, kept beside the file for the case that the program ends in between.

A journal has one line per edit and per text that was kept. An edit is written down before it is
answered, the text that it makes some time later; after a crash the edits behind the last text are
done again. The last texts stay, so that undo goes back beyond the day.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

KEPT = 200
"""Texts that stay when a journal is opened again."""
LARGEST = 64_000_000
"""Bytes of a journal that is read; a larger one is begun anew."""


def home() -> Path:
    """Return the folder of journals: ``HYBOND_STATE``, or where the system keeps such things."""
    given = os.environ.get("HYBOND_STATE")
    if given:
        return Path(given)
    if os.name == "nt":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "hybond"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "hybond"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "hybond"


@dataclass(frozen=True, slots=True)
class Remembered:
    """What a journal holds."""

    texts: list[str] = field(default_factory=list)
    """The last texts of the file, oldest first."""
    pending: list[dict[str, Any]] = field(default_factory=list)
    """Edits whose text was not written."""


class Recovery:
    """The journal of one file.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     journal = Recovery(Path(folder, "ball.toml"), Path(folder))
    ...     journal.keep("hybond = 1")
    ...     journal.note({"do": "add"})
    ...     journal.close()
    ...     Recovery(Path(folder, "ball.toml"), Path(folder)).remembered()
    Remembered(texts=['hybond = 1'], pending=[{'do': 'add'}])
    """

    def __init__(self, file: Path, folder: Path | None = None) -> None:
        name = hashlib.sha256(str(file.resolve()).encode()).hexdigest()[:24]
        self.path = (folder or home()) / "studio" / f"{file.stem[:40]}-{name}.jsonl"
        self._open: Any = None
        self.broken = ""
        """Why it cannot be written, if so."""

    def remembered(self) -> Remembered:
        """Return what was written down, as far as it can be read."""
        try:
            if self.path.stat().st_size > LARGEST:
                return Remembered()
            lines = self.path.read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:
            return Remembered()
        texts: list[str] = []
        pending: list[dict[str, Any]] = []
        for line in lines:
            try:
                entry = json.loads(line)
            except (ValueError, RecursionError):
                continue  # the line at which the program ended
            if not isinstance(entry, dict):
                continue
            if isinstance(entry.get("text"), str):
                texts.append(entry["text"])
                pending = []
            elif isinstance(entry.get("edit"), dict):
                pending.append(entry["edit"])
        return Remembered(texts[-KEPT:], pending)

    def begin(self, texts: list[str]) -> None:
        """Begin anew with these texts, so that the journal does not grow for ever."""
        self.close()
        whole = "".join(json.dumps({"text": t}) + "\n" for t in texts[-KEPT:])
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            beside = self.path.with_suffix(".new")
            beside.write_text(whole, encoding="utf-8")
            os.replace(beside, self.path)
            self.broken = ""
        except OSError as error:
            self.broken = error.strerror or str(error)

    def note(self, edit: dict[str, Any]) -> None:
        """Write down an edit before its text is known."""
        self._write({"edit": edit, "at": round(time.time(), 1)})

    def keep(self, text: str) -> None:
        """Write down the text that is in the file now."""
        self._write({"text": text, "at": round(time.time(), 1)})

    def close(self) -> None:
        """Let go of the file."""
        if self._open is not None:
            with contextlib.suppress(OSError):
                self._open.close()
            self._open = None

    def _write(self, entry: dict[str, Any]) -> None:
        try:
            if self._open is None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._open = open(self.path, "a", encoding="utf-8")  # noqa: SIM115
            self._open.write(json.dumps(entry) + "\n")
            self._open.flush()
            self.broken = ""
        except OSError as error:
            self.broken = error.strerror or str(error)
