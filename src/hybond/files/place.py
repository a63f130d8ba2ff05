"""Places in a model file, for messages: ``ball.toml:12: elements.pad.C``."""

from __future__ import annotations

import re
from typing import Literal

from hybond.errors import FileError
from hybond.records import dataclass

Format = Literal["toml", "json"]
Path = tuple[str | int, ...]

WIDTH = 100
"""Most characters of a line that a message shows."""
_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


@dataclass(frozen=True, slots=True)
class Source:
    """Where data came from: the name for messages and the text, if there is one."""

    name: str
    text: str = ""
    format: Format = "toml"


@dataclass(frozen=True, slots=True)
class Place:
    r"""A path of keys and list indices within a source.

    Examples
    --------
    >>> place = Place(Source("ball.toml", "[elements]\npad = { C = 1 }")) / "elements" / "pad"
    >>> str(place / "C"), str(place / "two words" / 0)
    ('ball.toml:2: elements.pad.C', "ball.toml:2: elements.pad.'two words'[0]")
    """

    source: Source
    path: Path = ()

    def __truediv__(self, key: str | int) -> Place:
        return Place(self.source, (*self.path, key))

    def __str__(self) -> str:
        path = dotted(self.path)
        name = f"{self.source.name}:{self.line}" if self.line else self.source.name
        return f"{name}: {path}" if path else name

    @property
    def line(self) -> int | None:
        """The line of the text, counted from 1, or None if it cannot be told."""
        if not self.source.text or not self.path:
            return None
        # Only a refusal asks for a line, so reading the text again costs nothing that matters.
        if self.source.format == "json":
            from hybond.files.json_lines import find_line
        else:
            from hybond.files.toml_lines import find_line
        return find_line(self.source.text, self.path)

    def refuse(self, why: str, *, code: str, hint: str = "") -> FileError:
        """Return the error that says `why` at this place."""
        error = FileError(why, code=code, where=str(self), hint=hint)
        return error.said_in(self.source.name, self.line, line_of(self.source, self.line))

    def within(self, path: Path) -> tuple[str, int | None, str]:
        """Return the file, the line and the text of what stands at a path from here."""
        place = Place(self.source, (*self.path, *path))
        line = place.line
        return self.source.name, line, line_of(self.source, line)


def line_of(source: Source, line: int | None) -> str:
    r"""Return what a line says, empty if there is none; of a long one the beginning.

    Examples
    --------
    >>> line_of(Source("ball.toml", "hybond = 1\n  domain = 'x'\n"), 2)
    "domain = 'x'"
    """
    lines = source.text.split("\n")
    if line is None or not 1 <= line <= len(lines):
        return ""
    return shortened(lines[line - 1].strip(), WIDTH)


def dotted(path: Path) -> str:
    """Write a path the way it is written in a file.

    Examples
    --------
    >>> dotted(("graph", "bonds", 2))
    'graph.bonds[2]'
    """
    text = ""
    for key in path:
        if isinstance(key, int):
            text += f"[{key}]"
        else:
            text += ("." if text else "") + (shortened(key) if _BARE.match(key) else quoted(key))
    return text


def shortened(text: str, most: int = 60) -> str:
    """Return a text cut to a length that a message can hold."""
    return text if len(text) <= most else text[: most - 3] + "..."


def quoted(text: str) -> str:
    """Return a text in quotes, shortened."""
    return repr(shortened(text))
