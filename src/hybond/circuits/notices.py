"""What a conversion has to say: refusals and warnings that name a line of the netlist."""

from __future__ import annotations

from dataclasses import dataclass, field

from hybond.errors import FileError
from hybond.files.place import shortened
from hybond.model.expressions import Expr


@dataclass(frozen=True, slots=True)
class Line:
    """A logical line of a netlist: continuations joined, comments gone."""

    file: str
    """The file as the caller named it."""
    number: int
    """Its first line, counted from 1."""
    text: str
    functions: dict[str, tuple[tuple[str, ...], Expr]] = field(
        default_factory=dict, compare=False, repr=False
    )
    """What ``.func`` defines in the netlist: names of arguments, and the body."""

    @property
    def place(self) -> str:
        """Return the place for messages, ``rectifier.cir:12``."""
        return f"{self.file}:{self.number}"

    def refuse(self, why: str, *, code: str, hint: str = "") -> FileError:
        """Return the error that says `why` about this line."""
        error = FileError(f"{why} ({shortened(self.text)})", code=code, where=self.place, hint=hint)
        return error.said_in(self.file, self.number)


@dataclass(frozen=True, slots=True)
class Notice:
    """Something that was idealised or left out, and the line that asked for it.

    Examples
    --------
    >>> print(Notice("rectifier.cir:12", "AC analysis is left out"))
    rectifier.cir:12: AC analysis is left out
    """

    where: str
    what: str

    def __str__(self) -> str:
        return f"{self.where}: {self.what}"


@dataclass
class Notices:
    """The warnings of one conversion, in the order in which they came up, each once."""

    found: dict[Notice, None] = field(default_factory=dict)

    def add(self, line: Line, what: str) -> None:
        """Note something about a line."""
        self.found[Notice(line.place, what)] = None
