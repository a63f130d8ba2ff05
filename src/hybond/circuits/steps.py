"""``.step``: a parameter of a netlist and its values."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hybond.circuits.cards import words_of
from hybond.circuits.formulas import read_formula
from hybond.circuits.notices import Line
from hybond.model.expressions import Expr


@dataclass(frozen=True, slots=True)
class Step:
    """A ``.step`` line, its values as they are written."""

    name: str
    """In lower case."""
    written: str
    line: Line
    form: str
    """``"list"``, ``"lin"``, ``"dec"`` or ``"oct"``."""
    values: tuple[Expr, ...]
    """All of a list; else first, last, and distance or number."""


def read_step(rest: str, line: Line) -> Step:
    """Return what a ``.step`` line says.

    Raises
    ------
    FileError
        HB-F131, HB-F137 (what is stepped is no parameter).

    Examples
    --------
    >>> line = Line("x.net", 1, "")
    >>> read_step("param R list 10 20", line).form, read_step("dec param C 1n 1u 5", line).form
    ('list', 'dec')
    """
    words = [w for w in words_of(rest, line) if w not in "()"]
    form = "lin"
    if words and words[0].lower() in ("lin", "dec", "oct"):
        form = words.pop(0).lower()
    if len(words) < 3 or words[0].lower() != "param" or not re.fullmatch(r"\w+", words[1]):
        raise line.refuse(
            "what is stepped is no parameter",
            code="HB-F137",
            hint=".step param R 10 100 10, and {R} where it is used",
        )
    name, given = words[1].lower(), words[2:]
    if given[0].lower() in ("list", "lin", "dec", "oct"):
        form = given.pop(0).lower()
    if form != "list" and len(given) != 3:
        raise line.refuse(
            "a range has three numbers", code="HB-F130", hint="first, last, distance (or number)"
        )
    return Step(name, words[1], line, form, tuple(read_formula(w, line) for w in given))
