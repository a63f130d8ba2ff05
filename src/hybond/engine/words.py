"""The words of portable Python, as Python itself understands them.

`hybond.translate` says what they mean, and prints them as C and as Java.
"""

from __future__ import annotations

import math
import sys
from typing import Any, TypeAlias, TypeVar

T = TypeVar("T")
Text: TypeAlias = str
Floats: TypeAlias = list[float]
Ints: TypeAlias = list[int]
Records: TypeAlias = list[T | None]
Outside: TypeAlias = Any
"""The type of a field that exists in Python only."""

_ZERO: dict[str, object] = {"int": 0, "float": 0.0, "bool": False, "Text": ""}


def record(kind: type[T]) -> type[T]:
    """Make a class of annotated fields a record: ``Kind()`` has zeros, and None for all else.

    Examples
    --------
    >>> @record
    ... class Point:
    ...     x: float
    ...     row: Floats
    >>> p = Point()
    >>> p.x, p.row
    (0.0, None)
    """
    fields = kind.__annotations__.items()
    zero = {f: _ZERO.get(t if isinstance(t, str) else t.__name__) for f, t in fields}

    def begin(self: object) -> None:
        for name, value in zero.items():
            setattr(self, name, value)

    kind.__init__ = begin  # type: ignore[method-assign]
    return kind


def given(what: T) -> T:
    """Mark a function that each model brings along; its Python body is not printed.

    A class so marked is a record that holds the tables of a model.
    """
    if isinstance(what, type):
        record(what)
    return what


def floats(n: int) -> Floats:
    """Return `n` zeros."""
    return [0.0] * n


def ints(n: int) -> Ints:
    """Return `n` zeros."""
    return [0] * n


def records(kind: type[T], n: int) -> Records[T]:
    """Return `n` places for records, none of them taken.

    Examples
    --------
    >>> records(object, 2)
    [None, None]
    """
    return [None] * n


def some(what: T | None) -> T:
    """Return `what`, which is there; for the type checker, and printed as `what` alone."""
    assert what is not None
    return what


def float_table(*values: float) -> Floats:
    """Return a constant table, at the top of a module."""
    return list(values)


def int_table(*values: int) -> Ints:
    """Return a constant table, at the top of a module."""
    return list(values)


def quotient(a: float, b: float) -> float:
    """Return ``a / b``, also where `b` is zero: infinite, or not a number.

    Examples
    --------
    >>> quotient(1.0, 0.0), quotient(-1.0, 0.0), quotient(0.0, 0.0), quotient(3.0, 2.0)
    (inf, -inf, nan, 1.5)
    """
    if b != 0.0:
        return a / b
    if a == 0.0 or a != a:
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


def put_text(text: Text) -> None:
    """Write a text."""
    sys.stdout.write(text)


def put_number(x: float) -> None:
    """Write a number with 15, 16 or 17 digits, the fewest of these that read back as it.

    Examples
    --------
    >>> for x in (0.1, 1.0 / 3.0, 1e300, -0.0, 2.0, math.inf, math.nan):
    ...     put_number(x)
    ...     put_text(" ")
    0.1 0.3333333333333333 1e+300 -0 2 inf nan
    """
    sys.stdout.write(number_text(x))


def number_text(x: float) -> Text:
    """Return what `put_number` writes; not a word of portable modules."""
    for digits in (15, 16):
        text = f"{x:.{digits}g}"
        if float(text) == x:
            return text
    return f"{x:.17g}"


def put_int(i: int) -> None:
    """Write a whole number."""
    sys.stdout.write(str(i))


def put_line() -> None:
    """End the line."""
    sys.stdout.write("\n")
