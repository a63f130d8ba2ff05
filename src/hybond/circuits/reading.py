"""A netlist file to logical lines: continuations, comments, included files."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from hybond.circuits.notices import Line, Notices
from hybond.circuits.schematic import cards_of
from hybond.errors import FileError
from hybond.files import limits
from hybond.files.parse import read_text

LINES = 1_000_000
"""Lines of all files together."""
LONGEST = 100_000
"""Characters of one logical line."""
_COMMENT = re.compile(r"(?:^|(?<=\s))\$(?=\s|$).*|;.*|(?:^|(?<=\s))//.*")
_INCLUDE = re.compile(
    r"\.(include|inc|lib)\s+(\"[^\"]*\"|'[^']*'|\S+)\s*(\S+)?\s*\Z", re.IGNORECASE
)
_SECTION = re.compile(r"\s*\.(lib|endl)\b", re.IGNORECASE)
_ELEMENT = re.compile(r"[RCLVIEFGHDSWXK]\d\w*(\s+\S+){3,}\Z", re.IGNORECASE)


def read_lines(path: str | os.PathLike[str], notices: Notices) -> tuple[str, list[Line]]:
    """Return the title of a netlist and its logical lines, included files in their places.

    Parameters
    ----------
    notices : Notices
        Where warnings go.

    Returns
    -------
    title : str
        The first line of the file, as in every SPICE.
    lines : list of Line
        Up to ``.end``.

    Raises
    ------
    FileError
        HB-F101, HB-F103, HB-F104 (cannot be read), HB-F130 (a continuation of nothing), HB-F132
        (a file that cannot be included), HB-F142 (too many lines).
    """
    file = Path(path)
    return _Reading(file, notices).run()


class _Reading:
    """What is known while files are read: which are open, how much there was."""

    def __init__(self, top: Path, notices: Notices) -> None:
        self.top = top
        self.folder = top.parent.resolve()
        self.notices = notices
        self.lines: list[Line] = []
        self.count = 0
        self.bytes = 0
        self.files = 0
        self.functions: dict[str, Any] = {}
        """Filled by who reads the lines; all of them know it."""

    def run(self) -> tuple[str, list[Line]]:
        name = str(self.top)
        rows = self._rows(self.top, name)
        if self.top.suffix.lower() == ".asc":
            rows = cards_of(rows, str(self.top))
            name = f"{self.top} as a netlist"
        title = rows[0].strip() if rows else ""
        if title.lower().startswith(".title"):
            title = title[6:].strip()
        elif title.startswith(".") or (_ELEMENT.match(title) and not title.startswith("*")):
            self.notices.add(
                Line(name, 1, title),
                "the first line of a netlist is its title, although it looks like a card",
            )
        self._take(rows[1:], name, 2, (self.top.resolve(),))
        return title.lstrip("* ").strip(), self.lines

    def _rows(self, path: Path, name: str) -> list[str]:
        text = read_text(path, name)
        self.files += 1
        self.bytes += len(text)
        rows = re.split(r"\r\n|\r|\n", text)
        self.count += len(rows)
        if self.count > LINES or self.bytes > limits.FILE_BYTES or self.files > limits.FILES:
            raise FileError(
                f"more than {LINES} lines, {limits.FILES} files or "
                f"{limits.FILE_BYTES // 2**20} MiB",
                code="HB-F142",
                where=name,
                hint="convert a part of the circuit",
            )
        return rows

    def _take(self, rows: list[str], name: str, first: int, within: tuple[Path, ...]) -> bool:
        """Add logical lines; return whether there was an ``.end``."""
        pending: tuple[int, list[str]] | None = None
        size = 0
        for number, row in enumerate([*rows, ""], start=first):
            last = number == first + len(rows)
            text = row.strip()
            if not last and (not text or text.startswith("*")):
                continue
            if text.startswith("+"):
                text = _COMMENT.sub("", text[1:]).strip()
                size += len(text)
                if pending is None:
                    raise FileError(
                        "a continuation line with nothing before it",
                        code="HB-F130",
                        where=f"{name}:{number}",
                        hint="the line that '+' continues comes first",
                    )
                if size > LONGEST:
                    raise FileError(
                        f"a card of more than {LONGEST} characters",
                        code="HB-F142",
                        where=f"{name}:{pending[0]}",
                        hint="split it, for example into several sources",
                    )
                pending[1].append(text)
                continue
            if pending is not None:
                line = Line(name, pending[0], " ".join(pending[1]), self.functions)
                if line.text.split(None, 1)[0].lower() == ".end":
                    return True
                if self._line(line, within):
                    return True
            if last:
                break
            text = _COMMENT.sub("", text).strip()
            size = len(text)
            pending = (number, [text]) if text else None
        return False

    def _line(self, line: Line, within: tuple[Path, ...]) -> bool:
        if len(line.text) > LONGEST:
            raise line.refuse(
                f"a card of more than {LONGEST} characters", code="HB-F142", hint="split it"
            )
        word = line.text.split(None, 1)[0].lower()
        if word not in (".include", ".inc", ".lib"):
            self.lines.append(line)
            return False
        match = _INCLUDE.match(line.text)
        if match is None:
            raise line.refuse(
                "no file is named", code="HB-F130", hint='write .include "diodes.lib"'
            )
        path = self._inside(line, match[2].strip("\"'"), within)
        if path is None:
            self.notices.add(
                line,
                "the file is not here and is left out: what it defines is missing, and its "
                "elements, if it has any",
            )
            return False
        rows = self._rows(path, str(path))
        start = 1
        if match[3] is not None:
            start, rows = _section(rows, match[3], line)
        elif word == ".lib":
            rows = ["" if _SECTION.match(r) else r for r in rows]
        return self._take(rows, str(path), start, (*within, path.resolve()))

    def _inside(self, line: Line, name: str, within: tuple[Path, ...]) -> Path | None:
        """Return the path of an included file, which stays in the folder of the top file.

        A file that is not there is none: decks name the libraries of the machine that they come
        from, and often need nothing of them.
        """
        given = Path(name.replace("\\", "/"))
        path = Path(line.file).parent / given
        hint = "copy the file beside the netlist"
        try:
            real = path.resolve()
        except (OSError, ValueError, RuntimeError):
            raise line.refuse("not a path", code="HB-F132", hint=hint) from None
        if given.is_absolute() or re.match(r"[A-Za-z]:", name) or not path.exists():
            return None
        if not real.is_relative_to(self.folder):
            raise line.refuse(
                "the file is not in the folder of the netlist", code="HB-F132", hint=hint
            )
        if real in within:
            raise line.refuse(
                "the file includes itself", code="HB-F132", hint="take one of the includes out"
            )
        if not path.is_file():
            raise line.refuse("it is not a file", code="HB-F132", hint=hint)
        return path


def _section(rows: list[str], name: str, line: Line) -> tuple[int, list[str]]:
    """Return the lines between ``.lib name`` and ``.endl``, and the number of the first."""
    begin = re.compile(rf"\s*\.lib\s+{re.escape(name)}\s*\Z", re.IGNORECASE)
    at = next((k for k, row in enumerate(rows) if begin.match(row)), None)
    if at is None:
        raise line.refuse(
            f"the library has no section {name!r}", code="HB-F134", hint="check the spelling"
        )
    end = next(
        (k for k in range(at + 1, len(rows)) if re.match(r"\s*\.endl\b", rows[k], re.IGNORECASE)),
        len(rows),
    )
    return at + 2, rows[at + 1 : end]
