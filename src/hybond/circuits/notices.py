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


NAMED = 3
"""Elements of one notice that are named, the others are counted."""


@dataclass
class Notices:
    """The warnings of one conversion, in the order in which they came up, each once."""

    found: dict[Notice, str] = field(default_factory=dict)
    """With the first word of its line."""

    def add(self, line: Line, what: str) -> None:
        """Note something about a line."""
        self.found.setdefault(Notice(line.place, what), "".join(line.text.split(maxsplit=1)[:1]))

    def told(self) -> tuple[Notice, ...]:
        """Return the warnings; what is said of many elements is said once, at the first of them.

        Examples
        --------
        >>> notices = Notices()
        >>> for k in range(5):
        ...     notices.add(Line("ladder.cir", 2 + k, f"G{k} a 0 1"), "left out")
        >>> print(*notices.told())
        ladder.cir:2: left out (G0, G1, G2 and 2 more)
        """
        elements: dict[str, list[tuple[Notice, str]]] = {}
        for notice, name in self.found.items():
            if name[:1].isalpha():
                elements.setdefault(notice.what, []).append((notice, name))
        found = {notice: notice for notice in self.found}
        for what, group in elements.items():
            if len(group) > NAMED:
                names = ", ".join(name for _, name in group[:NAMED])
                first = group[0][0]
                for notice, _ in group[1:]:
                    del found[notice]
                more = len(group) - NAMED
                found[first] = Notice(first.where, f"{what} ({names} and {more} more)")
        return tuple(found.values())
