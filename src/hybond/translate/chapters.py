"""Portable modules as chapters of a printed program: which parts of them are printed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping

from hybond.translate.braces import Braces
from hybond.translate.effects import Effects, effects_of
from hybond.translate.lines import line_comments, plain
from hybond.translate.modules import Program
from hybond.translate.reach import Reached, Uses, reached, uses_of
from hybond.translate.tree import Function, Member, Module, Record


class Chapters(Braces):
    """A printer of one chapter for each portable module; what differs is in its subclasses.

    Parameters
    ----------
    roots : iterable of str
        Functions that are called from outside; what they do not need is not printed.
    uses : mapping, optional
        What the program's functions change and use, if it is known already.
    """

    width = 99
    """Characters that a line may have where it is printed."""

    def __init__(
        self,
        program: Program,
        roots: Iterable[str],
        *,
        effects: Effects | None = None,
        uses: Mapping[str, Uses] | None = None,
    ) -> None:
        roots = tuple(roots)
        super().__init__(effects or effects_of(program, roots))
        self.uses = uses or uses_of(program)
        self.program = program
        self.reached: Reached = reached(program, roots, self.uses)
        self.given: Mapping[str, list[str]] = {}
        """The text of given functions, which stands where they are declared."""
        self.known: dict[int, list[str]] = {}
        """Definitions that were printed before, by the identity of the function."""
        self.opened: Callable[[Function], Function] = lambda f: f
        """A function with its body, where the program has been kept without."""
        self.kept: Collection[tuple[str, str]] = ()
        """Fields that are printed whether they are used or not: record and name."""

    def chapter(self, module: Module) -> list[str]:
        """Return what of a module is needed, as it stands there."""
        raise NotImplementedError

    def definition(self, f: Function) -> list[str]:
        """Return a function."""
        raise NotImplementedError

    def field(self, record: Record, m: Member) -> str:
        """Return the declaration of a field."""
        raise NotImplementedError

    def needed(self, module: Module) -> bool:
        """Say whether anything of a module is printed."""
        found = self.reached
        return (
            any(c.name in found.constants for c in module.constants.values())
            or any(f.name in found.functions for f in module.functions.values())
            or any(name in found.records for name in module.records)
        )

    def members(self, record: Record) -> list[Member]:
        """Return the fields that are printed: those that are used, and those that are kept."""
        wanted = (*self.reached.fields, *self.kept)
        return [m for m in record.members if (record.name, m.name) in wanted]

    def fields(self, record: Record) -> list[str]:
        """Return the lines of a record's fields, with their comments."""
        lines: list[str] = []
        for m in self.members(record):
            if m.above and lines:
                lines.append("")
            lines += line_comments(m.above, 4)
            lines += self.noted(f"    {self.field(record, m)};", m.note)
        return lines

    def noted(self, text: str, note: str) -> list[str]:
        """Return a line with a note behind it, or above it where there is no room."""
        behind = f" // {plain(note)}" if note else ""
        if len(text) + len(behind) > self.width:
            return [*line_comments((note,), len(text) - len(text.lstrip())), text]
        return [text + behind]

    def defined(self, f: Function) -> list[str]:
        """Return a function, printed once for all programs that have it."""
        if id(f) not in self.known:
            self.known[id(f)] = self.definition(self.opened(f))
        return self.known[id(f)]
