"""The expressions of a model, each known by a number."""

from __future__ import annotations

from hybond.model.expressions import Bool, Expr, Number
from hybond.model.expressions.slots import is_slotted

CONSTANT = -1
"""What stands for an expression that is a number: the number is in the table beside it."""


def number_of(value: float) -> float:
    """Return an entry of a table: a float, or what parameters make of it."""
    return value if is_slotted(value) else float(value)


class Expressions:
    """Expressions in the order in which they were asked for, the same one once.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> book = Expressions()
    >>> book.number(parse("a + 1")), book.number(parse("b")), book.number(parse("a + 1"))
    (0, 1, 0)
    >>> book.entry(parse("2"))
    (-1, 2.0)
    """

    def __init__(self) -> None:
        self.all: list[Expr] = []
        self.text: list[str] = []
        """What each is, for a comment."""
        self._place: dict[Expr, int] = {}

    def number(self, e: Expr, text: str = "") -> int:
        """Return the number of an expression; `text` is what it is."""
        at = self._place.get(e)
        if at is None:
            at = self._place[e] = len(self.all)
            self.all.append(e)
            self.text.append(text)
        elif text and not self.text[at]:
            self.text[at] = text
        return at

    def entry(self, e: Expr, text: str = "") -> tuple[int, float]:
        """Return an expression as two entries of a table: its number, or -1 and its value."""
        if isinstance(e, Number | Bool):
            return CONSTANT, number_of(e.value)
        return self.number(e, text), 0.0
