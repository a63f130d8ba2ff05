"""The document: the text of one model file, with undo, kept on disk after each edit.

The text is all that is kept; data are what it says. An edit changes the data, the text is then
edited so that it says the same (comments, order and spelling stay), and written to the file.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hybond.errors import FileError, HybondError, UsageError
from hybond.files.check import check_depth, check_plain
from hybond.files.edit import edit_toml, same
from hybond.files.limits import FILE_BYTES
from hybond.files.parse import parse, read_text
from hybond.files.place import Place, Source
from hybond.files.toml_text import toml_text
from hybond.files.whole import write_whole
from hybond.studio.edits import apply
from hybond.studio.levels import Data
from hybond.studio.recovery import Recovery

EMPTY = 'hybond = 1\ntitle  = ""\ndomain = "electrical"\n\n[experiment]\nuntil = "1 s"\n'
UNDO = 1000
"""Texts that undo goes back to."""


class Document:
    """A model file under edit.

    Parameters
    ----------
    file : Path or None
        Where it is kept; None for one that is only in memory.
    text : str
        What is edited if there is no file, or it does not exist yet.
    journal : Recovery or None
        Where edits are written down before they are done.

    Examples
    --------
    >>> document = Document(None, "hybond = 1  # mine")
    >>> document.edit({"do": "add", "stem": "R", "element": {"R": "1 ohm"}})
    >>> print(document.text)
    hybond = 1  # mine
    <BLANKLINE>
    [elements]
    R = { R = "1 ohm" }
    <BLANKLINE>
    >>> document.undo()
    >>> document.text
    'hybond = 1  # mine'
    """

    def __init__(
        self, file: Path | None = None, text: str = EMPTY, journal: Recovery | None = None
    ) -> None:
        self.file = file
        self.journal = journal
        self.revision = 0
        self.unsaved = ""
        """Why the text is not in the file, empty if it is."""
        self.error: HybondError | None = None
        """Why the text says no data; `data` are then those of the last one that did."""
        self.data: Data = {}
        self._past: list[str] = []
        self._future: list[str] = []
        self._later: Callable[[], None] | None = None
        self._on_disk: str | None = None
        self._glanced: tuple[int, int] | None = None
        self._taken: tuple[int, int] | None = None
        if file is not None and file.exists():
            self._taken = self._stamp()
            text = self._on_disk = read_text(file, str(file))
        self._text = text
        self._read()
        if journal is not None:
            self._recover(journal)

    @property
    def name(self) -> str:
        """The name of the file, or what an unnamed one is called."""
        return self.file.name if self.file is not None else "untitled"

    @property
    def text(self) -> str:
        """What the file says, or will in a moment."""
        self.settle()
        return self._text

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return bool(self._past) or self._later is not None

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return bool(self._future) and self._later is None

    def edit(self, edit: Mapping[str, Any]) -> None:
        """Do one edit of `hybond.studio.edits`; the text follows with `settle`.

        Raises
        ------
        UsageError
            HB-W101 for an edit that cannot be done, HB-W102 while the text cannot be read.
        """
        self.settle()
        if self.error is not None and "hybond" not in self.data:
            raise UsageError(
                f"the text cannot be read: {self.error.why}",
                code="HB-W102",
                where=self.error.place,
                hint="mend the text, or undo",
            )
        if self.error is not None and self.error.code == "HB-F105":
            raise UsageError(
                f"the text is not TOML: {self.error.why}",
                code="HB-W102",
                where=self.error.place,
                hint="mend the text, or undo",
            )
        # values that no file can hold: half a character, no finite number, too many levels
        given = {k: v for k, v in edit.items() if v is not None}
        check_plain(given, Place(Source("edit")))
        new = apply(self.data, edit)
        if same(new, self.data):
            return
        if self.journal is not None:
            self.journal.note(dict(edit))
        old, self.data = self.data, new
        self.revision += 1
        self._later = lambda: self._write_out(old, new)

    def replace(self, text: str) -> None:
        """Take another text, whether or not it can be read.

        Raises
        ------
        FileError
            HB-F103 for one that is too large, HB-F104 for one that no file can hold.
        """
        try:
            size = len(text.encode())
        except UnicodeEncodeError:
            raise FileError(
                "the text holds half a character, which UTF-8 cannot write",
                code="HB-F104",
                where=self.name,
                hint="write the character in full",
            ) from None
        if size > FILE_BYTES:
            raise FileError(
                f"the text has more than {FILE_BYTES} bytes",
                code="HB-F103",
                where=self.name,
                hint="a model of this size is made of submodels in files of their own",
            )
        self.settle()
        if text != self._text:
            self._change_to(text)

    def undo(self) -> None:
        """Go back by one edit."""
        self.settle()
        if self._past:
            self._future.append(self._text)
            self._set(self._past.pop())

    def redo(self) -> None:
        """Go forward again."""
        self.settle()
        if self._future:
            self._past.append(self._text)
            self._set(self._future.pop())

    def settle(self) -> None:
        """Make the text of the last edit and write it to the file."""
        if self._later is not None:
            later, self._later = self._later, None
            later()

    def glance(self) -> bool:
        """Return whether the file was written since it was last found so, and stands still since.

        A file that changes from one glance to the next is still being written, and waits.
        """
        before, self._glanced = self._glanced, self._stamp()
        if self._glanced is None or self._glanced != before or self._glanced == self._taken:
            return False
        self._taken = self._glanced
        return True

    def _stamp(self) -> tuple[int, int] | None:
        """Return time and size of the file, None without one."""
        try:
            found = None if self.file is None else self.file.stat()
        except OSError:
            return None
        return None if found is None else (found.st_mtime_ns, found.st_size)

    def changed_outside(self) -> bool:
        """Take the file as something else has written it, if so; undo brings back what was here."""
        self.settle()
        if self.file is None or self._on_disk is None:
            return False
        try:
            found = read_text(self.file, str(self.file))
        except FileError:
            return False
        if found == self._on_disk or found == self._text:
            self._on_disk = found
            return False
        self._on_disk = found
        self._past.append(self._text)
        self._future.clear()
        self._text = found
        self._after()
        return True

    def save(self) -> None:
        """Write the text to the file; `unsaved` says why that was not possible."""
        if self.file is not None:
            self._keep_foreign()
            try:
                write_whole(self.file, self._text.encode())
                self.unsaved, self._on_disk, self._taken = "", self._text, self._stamp()
            except OSError as error:
                self.unsaved = error.strerror or str(error)
                return
        if self.journal is not None:
            self.journal.keep(self._text)

    def close(self) -> None:
        """Write what is left to write."""
        self.settle()
        if self.journal is not None:
            self.journal.close()

    # -- inside

    def _write_out(self, old: Data, new: Data) -> None:
        self._past.append(self._text)
        del self._past[:-UNDO]
        self._future.clear()
        self._text = edited(self._text, old, new)
        self.error = None
        self.save()

    def _change_to(self, text: str) -> None:
        self._past.append(self._text)
        del self._past[:-UNDO]
        self._future.clear()
        self._set(text)

    def _set(self, text: str) -> None:
        self._text = text
        self._after()
        self.save()

    def _after(self) -> None:
        self.revision += 1
        self._read()

    def _read(self) -> None:
        source = Source(self.name, self._text)
        try:
            data = parse(source)
            check_depth(data, Place(source))
            self.data, self.error = data, None
        except HybondError as error:
            self.error = error
            return
        if "hybond" not in self.data and not self.data:
            self.error = Place(source).refuse(
                "not a hybond model: it has no key 'hybond'",
                code="HB-F106",
                hint="a model begins with hybond = 1",
            )

    def _keep_foreign(self) -> None:
        """If something else has changed the file, put its text among what undo goes back to."""
        assert self.file is not None
        if self._on_disk is None:
            return
        try:
            found = read_text(self.file, str(self.file))
        except FileError:
            return  # gone: written anew
        if found not in (self._on_disk, self._text):
            self._past.append(found)
            if self.journal is not None:
                self.journal.keep(found)

    def _recover(self, journal: Recovery) -> None:
        found = journal.remembered()
        texts = [t for t, after in zip(found.texts, [*found.texts[1:], None]) if t != after]
        lost = found.pending if found.texts and found.texts[-1] == self._text else []
        self._past = [t for t in texts if t != self._text][-UNDO:]
        journal.begin([*self._past, self._text])
        if journal.broken:
            self.unsaved = journal.broken if self.file is None else ""
        for edit in lost:
            # what a damaged journal holds may be no edit
            with contextlib.suppress(
                HybondError, TypeError, ValueError, LookupError, AttributeError
            ):
                self.edit(edit)
                self.settle()


def must_be_model(file: Path) -> None:
    """Refuse a file that the studio does not edit: HB-W104."""
    if file.suffix.lower() != ".toml":
        raise UsageError(
            f"the studio edits .toml files, not {file.suffix or 'files without an ending'}",
            code="HB-W104",
            where=file.name,
            hint=f"hybond convert {file.name} {file.stem}.toml",
        )
    if file.exists() and not file.is_file():
        raise UsageError(
            f"{file.name} is no ordinary file",
            code="HB-W104",
            where=file.name,
            hint="take another name",
        )


def edited(text: str, old: Data, new: Data) -> str:
    r"""Return a text edited to say `new`; one that cannot be edited is written anew.

    Examples
    --------
    >>> edited("hybond = 1 # one\n", {"hybond": 1}, {"hybond": 1, "title": "Ball"})
    'hybond = 1 # one\ntitle = "Ball"\n'
    """
    from tomlkit.exceptions import TOMLKitError

    for finely in (True, False):
        try:
            found = edit_toml(text, old, new, finely=finely)
            if same(parse(Source("text", found)), new):
                return found
        except (FileError, TOMLKitError, LookupError, TypeError, ValueError, RecursionError):
            continue
    return toml_text(new)


class Lock:
    """One writer per file: held from opening to closing, given back by the system after a crash.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     one, two = Lock(Path(folder, "a.lock")), Lock(Path(folder, "a.lock"))
    ...     held = one.held, two.held
    ...     one.release()
    >>> held
    (True, False)
    """

    def __init__(self, path: Path) -> None:
        self.held = False
        self._file: Any = None
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(path, "a+b")  # noqa: SIM115
        except OSError:
            self.held = True  # nothing to lock with: better one writer too many than none
            return
        try:
            if os.name == "nt":
                import msvcrt

                msvcrt.locking(self._file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
            else:
                import fcntl

                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self.held = True
        except OSError:
            self._file.close()
            self._file = None

    def release(self) -> None:
        """Let another write."""
        if self._file is not None:
            self._file.close()
            self._file = None
